/*
 * What the types of material share when they are read: a reader for each, and its helpers.
 * A reader fills in the fields of material that its type's arguments give; kind is set before.
 * Internal to the parser; errors as in parser.h.
 */
#ifndef ORL_SCENE_PARSE_MATERIAL_READERS_H
#define ORL_SCENE_PARSE_MATERIAL_READERS_H

#include "scene/parse/parser.h"

typedef int (*orl_material_reader)(struct orl_parser *parser, const struct orl_scope *scope,
                                   struct orl_material *material, struct orl_error *err);

/* material_readers.c; reflector: plastic, metal, trans; grained: plastic2, metal2, trans2 */
int orl_material_read_reflector(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err);
int orl_material_read_grained(struct orl_parser *parser, const struct orl_scope *scope,
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

/* mixtures.c: mixfunc, mixdata, mixpict of materials; kind as well. */
int orl_parser_mix(struct orl_parser *parser, const struct orl_scope *scope,
                   struct orl_material *ret_material, struct orl_error *err);
/* What the mixture mixes gets its texture, in copies of its own. */
int orl_parser_mix_under(struct orl_parser *parser, const struct orl_scope *scope,
                         struct orl_material *mixture, struct orl_error *err);

int orl_material_read_mist(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err);

/* mirror_material.c */
int orl_material_read_mirror(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err);

/* wgmd_material.c */
int orl_material_read_wgmd(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err);

/* glazing_material.c */
int orl_material_read_glazing(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_material *material, struct orl_error *err);

/* own_material.c */
int orl_material_read_prism(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err);

int orl_material_read_lobed(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err);

/* antimatter_material.c */
int orl_material_read_antimatter(struct orl_parser *parser, const struct orl_scope *scope,
                                 struct orl_material *material, struct orl_error *err);

/* bsdf_material.c; the reference in material->bsdf is the caller's to drop, also on failure. */
int orl_material_read_bsdf(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err);

/* ---- Helpers, material_readers.c ------------------------------------------------------------- */

/* What a pattern may lie on; and of what it may depend on the direction there. */
bool orl_material_is_patterned(enum orl_material_kind kind, bool directed);

/* The material that the first string argument names, for views: that, or what that is seen as, or
 * ORL_SEEN_AS_NOTHING. */
int orl_material_alternate(struct orl_parser *parser, const struct orl_scope *scope,
                           int32_t *ret_seen_as, struct orl_error *err);

/* Of a transmissivity, or a mirror's reflectance: what exceeds 1 by a little is 1, with a warning.
 */
void orl_material_bound_clear(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_rgb *c);

/* Three number arguments from index i on. */
struct orl_rgb orl_material_rgb(const struct orl_parser *parser, size_t i);

/* Fails unless the channels are from 0 up to below 1 (or to 1 itself, if closed). */
int orl_material_share(struct orl_parser *parser, const struct orl_scope *scope, struct orl_rgb c,
                       bool closed, const char *what, struct orl_error *err);

/* Colour, specularity, transmission and roughness; what is a hair above 1 is bounded. */
int orl_material_check_reflector(struct orl_parser *parser, const struct orl_scope *scope,
                                 struct orl_material *material, struct orl_error *err);

/* A string argument that must be a number: expressions of function files are not evaluated. */
int orl_material_number(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                        double *ret_value, struct orl_error *err);

/* A string argument that must be '.': where Radiance's types name a function file. */
int orl_material_no_function(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                             struct orl_error *err);

#endif
