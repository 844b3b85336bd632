/*
 * Readers for the arguments of each type of material, and their helpers.
 * A reader fills the fields of material that its type's arguments give; kind is set before.
 * Internal to the parser; errors as in parser.h.
 */
#ifndef ORL_SCENE_PARSE_MATERIAL_MATERIAL_READERS_H
#define ORL_SCENE_PARSE_MATERIAL_MATERIAL_READERS_H

#include "scene/parse/parser.h"

typedef int (*orl_material_reader)(struct orl_parser *parser, const struct orl_scope *scope,
                                   struct orl_material *material, struct orl_error *err);

/* material_readers.c; reflector: plastic, metal, trans; anisotropic: plastic2, metal2, trans2 */
int orl_material_read_reflector(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err);
int orl_material_read_anisotropic(struct orl_parser *parser, const struct orl_scope *scope,
                                  struct orl_material *material, struct orl_error *err);
int orl_material_read_ashikhmin(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err);
int orl_material_read_glass(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err);
int orl_material_read_dielectric(struct orl_parser *parser, const struct orl_scope *scope,
                                 struct orl_material *material, struct orl_error *err);
int orl_material_read_interface(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err);
int orl_material_read_light(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err);
int orl_material_read_illum(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err);
int orl_material_read_spotlight(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err);

/* mixtures.c: mixfunc, mixdata, mixpict of materials; sets kind, too. */
int orl_parser_mix(struct orl_parser *parser, const struct orl_scope *scope,
                   struct orl_material *ret_material, struct orl_error *err);
/* Gives the mixed materials, in copies, the mixture's texture. */
int orl_parser_texture_mixture(struct orl_parser *parser, const struct orl_scope *scope,
                               struct orl_material *mixture, struct orl_error *err);

int orl_material_read_mist(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err);

/* material_readers.c */
int orl_material_read_mirror(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err);

/* wgmd_material.c */
int orl_material_read_wgmd(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err);

/* function_materials.c */
int orl_material_read_glazing(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_material *material, struct orl_error *err);

/* function_materials.c */
int orl_material_read_prism(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err);

int orl_material_read_function_lobes(struct orl_parser *parser, const struct orl_scope *scope,
                                     struct orl_material *material, struct orl_error *err);

/* antimatter_material.c */
int orl_material_read_antimatter(struct orl_parser *parser, const struct orl_scope *scope,
                                 struct orl_material *material, struct orl_error *err);

/* bsdf_reader.c; the caller drops the reference of orl_material_bsdf, also on failure. */
int orl_material_read_bsdf(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err);

/* ---- Helpers, material_readers.c ------------------------------------------------------------- */

/* Returns true if the kind may have a pattern; directed: one that depends on the ray's
 * direction. */
bool orl_material_is_patterned(enum orl_material_kind kind, bool directed);

/* Returns three number arguments from index i on. */
struct orl_rgb orl_material_rgb(const struct orl_parser *parser, size_t i);

/* Fails unless all channels are in [0, 1), or [0, 1] if closed. */
int orl_material_check_range(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_rgb c, bool closed, const char *what,
                             struct orl_error *err);

/* Checks colour, specularity and transmission; clamps values slightly above 1. shares: of the
 * material. */
int orl_material_check_shares(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_material *material, struct orl_reflector_shares *shares,
                              struct orl_error *err);

/* Reads a string argument that must be a number: expressions of function files are not
 * evaluated. */
int orl_material_number(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                        double *ret_value, struct orl_error *err);

/*
 * Materials that are sums of other materials (material/mixture.c): WGMDfunc, and BRTDfunc with
 * lobes. Terms are added one after the other.
 */

struct orl_material_sum {
    struct orl_parser *parser;
    const struct orl_scope *scope;
    struct orl_error *err;
    struct orl_material own; /* has the main modifier's pattern and texture */
    struct orl_material sum; /* sum so far */
    bool any;                /* a term was added */
};

/* Returns a material of that kind and colour, with defaults otherwise. */
struct orl_material orl_material_sum_part(enum orl_material_kind kind, struct orl_rgb color);

int orl_material_sum_add(struct orl_material_sum *sum, const struct orl_material *part);

/* Adds diffuse reflection of the front and of the back: one-sided plastics, with the main
 * modifier's pattern and texture. */
int orl_material_sum_add_reflected(struct orl_material_sum *sum, struct orl_rgb front,
                                   struct orl_rgb back);

/* Adds diffuse transmission: trans with that pattern, or NULL. */
int orl_material_sum_add_through(struct orl_material_sum *sum, struct orl_rgb color,
                                 struct orl_pattern *pattern);

/* Returns the sum; black if it has no terms. */
struct orl_material orl_material_sum_result(const struct orl_material_sum *sum);

#endif
