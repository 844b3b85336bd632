/*
 * Inside the reader of MGF (mgf.h): what is current, and what has a name. Not for anyone else.
 *
 * Colours, materials and vertices each have a current one, nameless at first, and any number of
 * named ones. Defaults are the format's: an even grey, a material that absorbs all, the origin.
 */
#ifndef ORL_SCENE_GENERATE_MGF_CONTEXT_H
#define ORL_SCENE_GENERATE_MGF_CONTEXT_H

#include <oriel/limits.h>

#include <oriel/scanner.h>

#include "scene/generate/mgf.h"
#include "scene/generate/xform.h"

struct orl_mgf_color {
    double x, y; /* CIE chromaticity */
};

/* A share of the light, of a colour; roughness where it is specular. Of ed: lm/m2. */
struct orl_mgf_part {
    double value, roughness;
    struct orl_mgf_color color;
};

struct orl_mgf_material {
    struct orl_mgf_part rd, td, rs, ts, ed;
    double index; /* of refraction */
    bool one_sided;
    bool written; /* in the text, as it is now */
};

struct orl_mgf_vertex {
    struct orl_vec3 point, normal; /* normal: 0 0 0 for none */
};

enum orl_mgf_kind { ORL_MGF_COLOR, ORL_MGF_MATERIAL, ORL_MGF_VERTEX, ORL_MGF_KINDS };

/* One of the three; name is "" for the nameless. */
struct orl_mgf_item {
    char *name;
    union {
        struct orl_mgf_color color;
        struct orl_mgf_material material;
        struct orl_mgf_vertex vertex;
    } is;
};

enum { ORL_MGF_DEPTH = 64, ORL_MGF_WORDS = 4096, ORL_MGF_COPY_NAME = 64 };

/* A transform that holds until it is ended, and what it repeats. */
struct orl_mgf_copy {
    struct orl_xform xform;
    char name[ORL_MGF_COPY_NAME]; /* before those of objects; "" for none */
};
struct orl_mgf_frame {
    struct orl_mgf_copy *copies;       /* owned */
    size_t n_copies, room, copy, most; /* most: copies that it may make */
    size_t n_objects;                  /* where it began */
    struct orl_xform outer;
    struct orl_scanner start; /* of what is repeated */
};

/* A text under way, by itself or within those before it. */
struct orl_mgf_place {
    struct orl_mgf_text text;
    size_t n_frames;         /* transforms when it began, that of all of it included */
    bool placed;             /* by such a one */
    struct orl_scanner back; /* where the one before goes on */
};

struct orl_mgf_reader {
    const struct orl_mgf *mgf;
    struct orl_text *text;
    struct orl_error *err;
    struct orl_mgf_place texts[ORL_LIMIT_INCLUDE_DEPTH];
    size_t n_texts;
    struct orl_scanner scanner; /* of the last of them */
    int line;                   /* of the entity at hand, the last of those it is joined of */
    char *buffer;               /* the words of the entity at hand */
    const char *words[ORL_MGF_WORDS];
    size_t n_words;
    void *named[ORL_MGF_KINDS]; /* trees of items, by tsearch(3) */
    struct orl_mgf_item *current[ORL_MGF_KINDS];
    struct orl_mgf_item nameless[ORL_MGF_KINDS];
    char *objects[ORL_MGF_DEPTH]; /* names under way */
    size_t n_objects;
    struct orl_mgf_frame frames[ORL_MGF_DEPTH];
    size_t n_frames;
    struct orl_xform xform;
    size_t n_surfaces, n_read, n_unknown, n_cut; /* n_read: bytes, those of repeats each time;
                                          n_cut: colours of more than all light */
    size_t counts[5];                            /* of surfaces by their kind, for their names */
    bool smooth;                                 /* corners had normals of their own */
};

/* ---- Words (mgf_context.c) ------------------------------------------------------------------- */

/* Word i as a number; words[0] is the entity. */
int orl_mgf_number(struct orl_mgf_reader *reader, size_t i, double *ret_value);
int orl_mgf_fail(struct orl_mgf_reader *reader, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* ORL_ERR_SYNTAX unless the entity has that many words behind it. */
int orl_mgf_takes(struct orl_mgf_reader *reader, size_t least, size_t most);

/* ---- Names (mgf_context.c) ------------------------------------------------------------------- */

void orl_mgf_context_init(struct orl_mgf_reader *reader);
void orl_mgf_context_done(struct orl_mgf_reader *reader);

/* "c|m|v [name [= [template]]]": makes one, or makes one current. */
int orl_mgf_context(struct orl_mgf_reader *reader, enum orl_mgf_kind kind);
/* NULL, with an error set, when nothing of that kind has the name. */
const struct orl_mgf_item *orl_mgf_find(struct orl_mgf_reader *reader, enum orl_mgf_kind kind,
                                        const char *name);

/* ---- Colours (mgf_color.c) ------------------------------------------------------------------- */

int orl_mgf_cxy(struct orl_mgf_reader *reader);
int orl_mgf_cspec(struct orl_mgf_reader *reader);
int orl_mgf_cct(struct orl_mgf_reader *reader);
int orl_mgf_cmix(struct orl_mgf_reader *reader);

bool orl_mgf_is_gray(struct orl_mgf_color color);
bool orl_mgf_same_color(struct orl_mgf_color a, struct orl_mgf_color b);
/* RGB of a colour of that luminance. */
struct orl_rgb orl_mgf_rgb(struct orl_mgf_color color, double luminance);

/* ---- Materials (mgf_material.c), surfaces (mgf_surfaces.c) ----------------------------------- */

/* Writes the current material, unless that has been done since it was changed last; its name, or
 * NULL with an error set. */
const char *orl_mgf_use_material(struct orl_mgf_reader *reader);

int orl_mgf_face(struct orl_mgf_reader *reader);
int orl_mgf_face_with_holes(struct orl_mgf_reader *reader);
int orl_mgf_prism(struct orl_mgf_reader *reader);
int orl_mgf_sphere(struct orl_mgf_reader *reader);
int orl_mgf_cylinder(struct orl_mgf_reader *reader);
int orl_mgf_cone(struct orl_mgf_reader *reader);
int orl_mgf_ring(struct orl_mgf_reader *reader);

/* mgf_torus.c */
int orl_mgf_torus(struct orl_mgf_reader *reader);

#endif
