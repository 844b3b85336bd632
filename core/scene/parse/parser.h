/*
 * Shared state of the scene parser: the parsed scene being built, the modifiers defined so far, and
 * the scope of the text being read. Internal to this folder.
 *
 * Errors have file, line and primitive set. Threads: one at a time.
 */
#ifndef ORL_SCENE_PARSE_PARSER_H
#define ORL_SCENE_PARSE_PARSER_H

#include "function/function.h"
#include "scene/generate/xform.h"
#include "scene/material/function_brdf/function_brdf.h"
#include "scene/material/patterns/pattern.h"
#include "scene/parse/instance/instanced_files.h"
#include "scene/parse/parse.h"
#include "scene/parse/primitive.h"
#include "scene/parse/symbols.h"
#include "scene/parsed_scene.h"

/* A warning that is issued once with a count. */
struct orl_warning_tally {
    uint64_t count;
    char first[ORL_ERROR_NAME_MAX]; /* "polygon w at a.rad:12" */
};

struct orl_parser {
    struct orl_parsed_scene *out;
    struct orl_sources sources;
    struct orl_symbols symbols;
    struct orl_primitive primitive;
    size_t surfaces_room, materials_room, distant_sources_room, skies_room, patterns_room,
        grids_room, warnings_room;
    struct orl_functions *functions; /* for all patterns; created with the first one */
    size_t text_bytes;               /* bytes of text read so far, repeats included */
    size_t name_bytes;               /* bytes of surface names stored so far */
    uint64_t vertices;               /* number stored so far */
    const double *uv;                /* current mesh triangle: (u, v) of its corners; or NULL */
    /* current mesh triangle: unit normals of its corners; or NULL */
    const struct orl_vec3 *normals;
    uint32_t *smooth; /* by material: its copy with corner normals, or UINT32_MAX */
    size_t n_smooth;
    int32_t void_material; /* index, or -1 */
    struct orl_refusals refusals;
    struct orl_deferred_errors deferred;
    struct orl_instanced_files instanced_files;
    bool cut_short; /* parsing stopped behind an unsupported primitive */
    struct orl_warning_tally degenerate, nonplanar, unmodified, white, below;
    double largest_bend; /* for `bent`: largest distance of corners along the normal */
};

/* Context of text: transform and overrides for its surfaces, and the folder for file names. */
struct orl_scope {
    const char *file; /* for messages and surfaces; lives as long as the parsed scene */
    const char *folder;
    struct orl_xform xform;
    const char *modifier; /* replaces that of surfaces; or NULL */
    const char *prefix;   /* prefix of surface names; or NULL */
    const struct orl_scope *outer;
    unsigned depth;
    const struct orl_markers *markers; /* commands.h: polygons to replace by objects; or NULL */
    /* with markers: transform from here to the scope of replmarks */
    struct orl_xform since;
};

/* parse_scene.c: reads text in a scope; line > 0: a command at this line wrote the text. */
int orl_parser_read(struct orl_parser *parser, const struct orl_scope *scope, const char *text,
                    size_t size, int line, struct orl_error *err);

/* parse_scene.c: reads a file in the scope made for it: scene text, or an object (mesh_import.h).
 */
int orl_parser_file(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct orl_file *file, struct orl_error *err);

/* command/piped_commands.c: a '!' line. */
int orl_parser_command(struct orl_parser *parser, const struct orl_scope *scope, const char *line,
                       int number, struct orl_error *err);

/* command/piped_commands.c: reads a file in the scope made for it. */
int orl_parser_include(struct orl_parser *parser, const struct orl_scope *inner, const char *name,
                       struct orl_error *err);

/* surfaces.c: polygon, sphere, ..., source. */
int orl_parser_surface(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err);
bool orl_parser_is_surface(const char *type);

/* materials.c: plastic, ..., glow (and brightfunc, by way of sky_patterns.c); and aliases. */
int orl_parser_modifier(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err);
int orl_parser_alias(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_error *err);
bool orl_parser_is_modifier(const char *type);

/* patterns.c: a brightfunc that is not a sky, a colorpict, a texfunc and the like. color, texture:
 * patterns of either sort that modify it, or NULL. of_material: it is modified by a material with
 * these; the name may stand for a material that already has this pattern, which then stays. */
bool orl_parser_is_pattern(const char *type);
int orl_parser_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_pattern *color, const struct orl_pattern *texture,
                       bool of_material, struct orl_error *err);
/* Adds the pattern to the parsed scene; takes it also on failure. Returns 0 or ORL_ERR_NOMEM. */
int orl_parser_add_pattern(struct orl_parser *parser, struct orl_pattern *pattern);

/* patterns.c: reads a mixture. mixed: two materials that differ only in colour and pattern; the
 * result is the pattern of both together, as a factor of 1. NULL: the result is the first's
 * share. */
bool orl_parser_is_mixture(const char *type);
int orl_parser_mixture(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_material *mixed, struct orl_pattern **ret_pattern,
                       struct orl_error *err);

/* patterns.c: reads the functions of a material. */
int orl_parser_function_brdf(struct orl_parser *parser, const struct orl_scope *scope,
                             enum orl_pattern_role role, struct orl_pattern **ret_pattern,
                             struct orl_error *err);

/* sky_patterns.c: a brightfunc of a sky's function file. */
bool orl_parser_is_sky(const struct orl_primitive *primitive);
int orl_parser_sky(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                   struct orl_error *err);

/* instance/compiled.c: the primitives instance and mesh. Reads the file that the current primitive
 * names. */
bool orl_parser_is_compiled(const char *type);
int orl_parser_compiled(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err);

/* Defines a name as refused, with an error that is deferred until the name is used. */
int orl_parser_define_refused(struct orl_parser *parser, const char *name,
                              const struct orl_error *refused, struct orl_error *err);

/* material_table.c: adds a material; takes its BSDF reference, also on failure. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_parser_add_material(struct orl_parser *parser, const char *name,
                            struct orl_material *material, uint32_t *ret_index);

/* material_table.c: returns a copy of the material with a mesh's corner normals as its texture. */
int orl_parser_smooth(struct orl_parser *parser, uint32_t material, uint32_t *ret_index);

/* material_table.c: returns the index of the material for "void". */
int orl_parser_void(struct orl_parser *parser, uint32_t *ret_index);

/* ---- Helpers, parser.c ----------------------------------------------------------------------- */

/* Finds a file that text in the scope names, and updates the scope for its content. */
int orl_parser_enter(struct orl_parser *parser, struct orl_scope *inner, const char *name,
                     struct orl_file *ret_file, struct orl_error *err);

/* Counts text that is read, repeats included; ORL_ERR_LIMIT if the total is too large. Arrays read
 * files again and again, so a read of a short file has a minimum cost. */
int orl_parser_count_text(struct orl_parser *parser, const struct orl_scope *scope, size_t size,
                          struct orl_error *err);

/* Returns ORL_ERR_CANCELLED if cancellation was requested. */
int orl_parser_check_cancel(const struct orl_parser *parser, struct orl_error *err);

/* Reports an error of the current primitive. Returns code. */
int orl_parser_fail(struct orl_parser *parser, const struct orl_scope *scope, struct orl_error *err,
                    int code, const char *format, ...) __attribute__((format(printf, 5, 6)));

/* orl_parser_fail with a hint. */
int orl_parser_refuse(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_error *err, int code, const char *hint, const char *format, ...)
    __attribute__((format(printf, 6, 7)));

/* Checks the counts of the primitive's arguments. */
int orl_parser_expect(struct orl_parser *parser, const struct orl_scope *scope, size_t n_strings,
                      size_t n_reals, struct orl_error *err);

/* Reads the transform in the string arguments from index first on, composed with the scope's. */
int orl_parser_string_xform(struct orl_parser *parser, const struct orl_scope *scope, size_t first,
                            struct orl_xform *ret_xform, struct orl_error *err);

/* Adds a warning to the parsed scene, at most a hundred of them. */
void orl_parser_warn(struct orl_parser *parser, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void orl_parser_tally(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_warning_tally *tally);
/* Adds warnings for the tallies. */
void orl_parser_report(struct orl_parser *parser);

#endif
