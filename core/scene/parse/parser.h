/*
 * What the parts of the scene parser share: the description in the making, the modifiers defined so
 * far, and the scope in which the text being read stands. Internal to this folder.
 *
 * Errors from here on carry file, line and primitive. Threads: one at a time.
 */
#ifndef ORL_SCENE_PARSE_PARSER_H
#define ORL_SCENE_PARSE_PARSER_H

#include "function/function.h"
#include "scene/description.h"
#include "scene/generate/xform.h"
#include "scene/material/own.h"
#include "scene/parse/deferred.h"
#include "scene/parse/primitive.h"
#include "scene/parse/refusals.h"
#include "scene/parse/repeats.h"
#include "scene/parse/sources.h"
#include "scene/parse/symbols.h"

/* Something that is warned about once, with a count, however often it happens. */
struct orl_warning_tally {
    uint64_t count;
    char first[ORL_ERROR_NAME_MAX]; /* "polygon w at a.rad:12" */
};

struct orl_parser {
    struct orl_description *out;
    struct orl_sources sources;
    struct orl_symbols symbols;
    struct orl_primitive primitive;
    size_t surfaces_room, materials_room, distants_room, skies_room, patterns_room, grids_room,
        warnings_room;
    struct orl_functions *functions; /* of all patterns; made when there is one */
    size_t text_bytes;               /* read so far, repeats included */
    size_t name_bytes;               /* of surfaces, kept so far */
    uint64_t vertices;               /* kept so far */
    const double *places; /* of a mesh's triangle at hand: (u, v) of its corners; or NULL */
    const struct orl_vec3 *normals; /* the same: unit normals of its corners, or NULL */
    uint32_t *smooth;               /* by material: that with such normals, or UINT32_MAX */
    size_t n_smooth;
    int32_t void_material; /* index, or -1 */
    struct orl_refusals refusals;
    struct orl_deferred deferred;
    struct orl_repeats repeats;
    bool cut_short; /* what was refused could not be read past */
    struct orl_warning_tally degenerate, bent, unmodified, white, below;
    double largest_bend; /* of bent: how far corners are apart along the normal */
};

/* Where text stands: what is applied to its surfaces, and where file names are looked up. */
struct orl_scope {
    const char *file; /* for messages and surfaces; lives as long as the description */
    const char *folder;
    struct orl_xform xform;
    const char *modifier; /* replaces that of surfaces, or NULL */
    const char *prefix;   /* goes before their names, or NULL */
    const struct orl_scope *outer;
    unsigned depth;
    const struct orl_markers *markers; /* markers.h: polygons that stand for objects; or NULL */
    struct orl_xform since;            /* with markers: from here to where these were named */
};

/* parse.c: reads text in a scope; line > 0 when a command wrote it, and then is the command's. */
int orl_parser_read(struct orl_parser *parser, const struct orl_scope *scope, const char *text,
                    size_t size, int line, struct orl_error *err);

/* parse.c: a file whose scope has been made: scene text, or an object (objects.h). */
int orl_parser_file(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct orl_file *file, struct orl_error *err);

/* commands.c: a '!' line. */
int orl_parser_command(struct orl_parser *parser, const struct orl_scope *scope, const char *line,
                       int number, struct orl_error *err);

/* commands.c: reads a file within the scope already made for it. */
int orl_parser_include(struct orl_parser *parser, const struct orl_scope *inner, const char *name,
                       struct orl_error *err);

/* surfaces.c: polygon, sphere, ..., source. */
int orl_parser_surface(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err);
bool orl_parser_is_surface(const char *type);

/* materials.c: plastic, ..., glow (and brightfunc, by way of skies.c); and aliases. */
int orl_parser_modifier(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err);
int orl_parser_alias(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_error *err);
bool orl_parser_is_modifier(const char *type);

/* patterns.c: a brightfunc that is no sky, a colorpict, a texfunc and the like; color, texture:
 * what of either sort modifies it, or NULL. of_material: a material with these does, and the name
 * may stand for one that has it already, which it then stays. */
bool orl_parser_is_pattern(const char *type);
int orl_parser_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_pattern *color, const struct orl_pattern *texture,
                       bool of_material, struct orl_error *err);
/* Takes it into the description, whatever happens. 0 or ORL_ERR_NOMEM. */
int orl_parser_keep_pattern(struct orl_parser *parser, struct orl_pattern *pattern);

/* patterns.c: a mixture of two materials that differ in colour and pattern alone: the pattern that
 * has what they are together, as a factor of 1. Of others (mixed NULL): that of the first's share.
 */
bool orl_parser_is_mixture(const char *type);
int orl_parser_mixture(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_material *mixed, struct orl_pattern **ret_pattern,
                       struct orl_error *err);

/* patterns.c: what a material's own functions say. */
int orl_parser_own(struct orl_parser *parser, const struct orl_scope *scope, enum orl_own_kind own,
                   struct orl_pattern **ret_pattern, struct orl_error *err);

/* skies.c: a brightfunc of a sky's file. */
bool orl_parser_is_sky(const struct orl_primitive *primitive);
int orl_parser_sky(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                   struct orl_error *err);

/* Defines a name as of something refused, of which err tells and which can wait until it is used.
 */
int orl_parser_define_refused(struct orl_parser *parser, const char *name,
                              const struct orl_error *refused, struct orl_error *err);

/* material_table.c: are they one but for their names? */
bool orl_material_same(const struct orl_material *a, const struct orl_material *b);

/* material_table.c: adds a material; takes its BSDF reference, whatever happens. 0 or
 * ORL_ERR_NOMEM. */
int orl_parser_add_material(struct orl_parser *parser, const char *name,
                            struct orl_material *material, uint32_t *ret_index);

/* smoothing.c: the material with the normals of a mesh's corners as its texture. */
int orl_parser_smooth(struct orl_parser *parser, uint32_t material, uint32_t *ret_index);

/* material_table.c: the index of the material that stands for "void". */
int orl_parser_void(struct orl_parser *parser, uint32_t *ret_index);

/* ---- Helpers, parser.c ----------------------------------------------------------------------- */

/* Finds a file that text in the scope names, and makes the scope that of what is in it. */
int orl_parser_enter(struct orl_parser *parser, struct orl_scope *inner, const char *name,
                     struct orl_file *ret_file, struct orl_error *err);

/* So much is read, again perhaps; ORL_ERR_LIMIT where that is too much together. */
int orl_parser_count_text(struct orl_parser *parser, const struct orl_scope *scope, size_t size,
                          struct orl_error *err);

/* ORL_ERR_CANCELLED once nobody wants the scene any more. */
int orl_parser_heed_cancel(const struct orl_parser *parser, struct orl_error *err);

/* Reports on the primitive at hand. Returns code. */
int orl_parser_fail(struct orl_parser *parser, const struct orl_scope *scope, struct orl_error *err,
                    int code, const char *format, ...) __attribute__((format(printf, 5, 6)));

/* Checks the counts of the primitive's arguments. */
int orl_parser_expect(struct orl_parser *parser, const struct orl_scope *scope, size_t n_strings,
                      size_t n_reals, struct orl_error *err);

/* The transform among its string arguments from index first on, within the scope's. */
int orl_parser_string_xform(struct orl_parser *parser, const struct orl_scope *scope, size_t first,
                            struct orl_xform *ret_xform, struct orl_error *err);

/* A warning in the description, at most a hundred of them. */
void orl_parser_warn(struct orl_parser *parser, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void orl_parser_count(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_warning_tally *tally);
/* Turns the tallies into warnings. */
void orl_parser_report(struct orl_parser *parser);

#endif
