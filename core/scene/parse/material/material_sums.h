/*
 * Materials that are sums of other materials (material/mixture.c): WGMDfunc, and BRTDfunc with
 * lobes. Parts are added one after the other.
 */
#ifndef ORL_SCENE_PARSE_MATERIAL_MATERIAL_SUMS_H
#define ORL_SCENE_PARSE_MATERIAL_MATERIAL_SUMS_H

#include "scene/parse/material/material_readers.h"

struct orl_material_sum {
    struct orl_parser *parser;
    const struct orl_scope *scope;
    struct orl_error *err;
    struct orl_material own; /* has the main modifier's pattern and texture */
    struct orl_material sum; /* sum so far */
    bool any;                /* a part was added */
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

/* Returns the sum; black if it has no parts. */
struct orl_material orl_material_sum_result(const struct orl_material_sum *sum);

#endif
