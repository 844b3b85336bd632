/*
 * Internal state of the MGF reader (mgf.h): current and named items.
 *
 * Colours, materials and vertices each have a current item, unnamed at first, and any number of
 * named ones. Defaults are the format's: an equal-energy grey, a material that absorbs everything,
 * the origin.
 */
#ifndef ORL_SCENE_GENERATE_MGF_MGF_CONTEXT_H
#define ORL_SCENE_GENERATE_MGF_MGF_CONTEXT_H

#include <oriel/base/limits.h>

#include <oriel/base/scanner.h>

#include "scene/generate/mgf/mgf.h"
#include "scene/generate/xform.h"

struct orl_mgf_color {
    double x, y; /* CIE chromaticity */
};

/* A share of the light with its colour; roughness if specular. For ed: lm/m2. */
struct orl_mgf_component {
    double value, roughness;
    struct orl_mgf_color color;
};

struct orl_mgf_material {
    struct orl_mgf_component rd, td, rs, ts, ed;
    double index; /* refractive index */
    bool one_sided;
    bool written; /* its current state has been written to the text */
};

struct orl_mgf_vertex {
    struct orl_vec3 point, normal; /* normal: 0 0 0 if none */
};

enum orl_mgf_kind { ORL_MGF_COLOR, ORL_MGF_MATERIAL, ORL_MGF_VERTEX, ORL_MGF_KINDS };

/* A colour, material or vertex; name is "" if unnamed. */
struct orl_mgf_item {
    char *name;
    union {
        struct orl_mgf_color color;
        struct orl_mgf_material material;
        struct orl_mgf_vertex vertex;
    } is;
};

enum { ORL_MGF_DEPTH = 64, ORL_MGF_WORDS = 4096, ORL_MGF_COPY_NAME = 64 };

/* One copy that a transform makes. */
struct orl_mgf_copy {
    struct orl_xform xform;
    char name[ORL_MGF_COPY_NAME]; /* prefix of object names; "" for none */
};
struct orl_mgf_frame {
    struct orl_mgf_copy *copies;       /* owned */
    size_t n_copies, room, copy, most; /* copy: current one; most: allowed number of copies */
    size_t n_objects;                  /* number of objects when it began */
    struct orl_xform outer;
    struct orl_scanner start; /* start of its content */
};

/* A text being read: the main one, or an included one. */
struct orl_mgf_open_text {
    struct orl_mgf_text text;
    size_t n_frames;           /* number of transforms when it began, its own included */
    bool has_transform;        /* has a transform of its own */
    struct orl_scanner resume; /* where the including text continues */
};

struct orl_mgf_reader {
    const struct orl_mgf *mgf;
    struct orl_text *text;
    int code;              /* of the first error, or 0 */
    struct orl_error *err; /* may be NULL */
    struct orl_mgf_open_text texts[ORL_LIMIT_INCLUDE_DEPTH];
    size_t n_texts;
    struct orl_scanner scanner; /* position in the innermost text */
    int line;                   /* line of the current entity; the last of its continued lines */
    char *buffer;               /* storage for the words of the current entity */
    const char *words[ORL_MGF_WORDS];
    size_t n_words;
    void *named[ORL_MGF_KINDS]; /* trees of items, by tsearch(3) */
    struct orl_mgf_item *current[ORL_MGF_KINDS];
    struct orl_mgf_item nameless[ORL_MGF_KINDS];
    char *objects[ORL_MGF_DEPTH]; /* names of the open objects */
    size_t n_objects;
    struct orl_mgf_frame frames[ORL_MGF_DEPTH];
    size_t n_frames;
    struct orl_xform xform;
    /* n_read: bytes, repeats included; n_cut: colours that were clamped to 1 */
    size_t n_surfaces, n_read, n_unknown, n_cut;
    size_t counts[5]; /* surfaces of each kind, for their names */
    bool smooth;      /* some corners had normals */
};

/*
 * The first error stays in the reader's code and err; later ones are ignored. After an error the
 * functions still return, but with arbitrary values, and what they write is not used.
 */

/* ---- Words (mgf_context.c) ------------------------------------------------------------------- */

/* Reads word i as a number; words[0] is the entity. */
double orl_mgf_number(struct orl_mgf_reader *reader, size_t i);
void orl_mgf_fail(struct orl_mgf_reader *reader, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Fails with ORL_ERR_SYNTAX unless the number of words behind the entity is in that range. */
void orl_mgf_expect_words(struct orl_mgf_reader *reader, size_t least, size_t most);

/* ---- Names (mgf_context.c) ------------------------------------------------------------------- */

void orl_mgf_context_init(struct orl_mgf_reader *reader);
void orl_mgf_context_done(struct orl_mgf_reader *reader);

/* Handles "c|m|v [name [= [template]]]": creates an item or makes one current. */
void orl_mgf_context(struct orl_mgf_reader *reader, enum orl_mgf_kind kind);
/* Returns the item of that kind and name, or the kind's default with an error set. */
const struct orl_mgf_item *orl_mgf_find(struct orl_mgf_reader *reader, enum orl_mgf_kind kind,
                                        const char *name);

/* ---- Colours (mgf_material.c) ---------------------------------------------------------------- */

/* These, and those of surfaces, handle the current entity, whose number of words is right. */
void orl_mgf_cxy(struct orl_mgf_reader *reader);
void orl_mgf_cspec(struct orl_mgf_reader *reader);
void orl_mgf_cct(struct orl_mgf_reader *reader);
void orl_mgf_cmix(struct orl_mgf_reader *reader);

/* ---- Materials (mgf_material.c), surfaces (mgf_surfaces.c) ----------------------------------- */

/* Writes the current material, unless it is unchanged since it was written; returns its name. */
const char *orl_mgf_use_material(struct orl_mgf_reader *reader);

void orl_mgf_face(struct orl_mgf_reader *reader);
void orl_mgf_face_with_holes(struct orl_mgf_reader *reader);
void orl_mgf_prism(struct orl_mgf_reader *reader);
void orl_mgf_sphere(struct orl_mgf_reader *reader);
void orl_mgf_cylinder(struct orl_mgf_reader *reader);
void orl_mgf_cone(struct orl_mgf_reader *reader);
void orl_mgf_ring(struct orl_mgf_reader *reader);
void orl_mgf_torus(struct orl_mgf_reader *reader);

#endif
