/*
 * Materials that are sums of what others are alone (material/mixture.c), as WGMDfunc and BRTDfunc
 * with lobes: parts are added one after the other.
 */
#ifndef ORL_SCENE_PARSE_SUMS_H
#define ORL_SCENE_PARSE_SUMS_H

#include "scene/parse/material_readers.h"

struct orl_material_sum {
    struct orl_parser *parser;
    const struct orl_scope *scope;
    struct orl_error *err;
    struct orl_material own; /* with the main modifier's pattern and texture */
    struct orl_material sum; /* so far */
    bool any;                /* whether there is a sum */
};

/* A material of that kind and colour, without anything else. */
struct orl_material orl_material_sum_part(enum orl_material_kind kind, struct orl_rgb color);

int orl_material_sum_add(struct orl_material_sum *sum, const struct orl_material *part);

/* What is scattered evenly, of light from the front and from behind: plastic, on the side that it
 * is for, with the main modifier's pattern and texture. */
int orl_material_sum_add_reflected(struct orl_material_sum *sum, struct orl_rgb front,
                                   struct orl_rgb back);

/* What gets through evenly: trans with that pattern, or NULL. */
int orl_material_sum_add_through(struct orl_material_sum *sum, struct orl_rgb color,
                                 struct orl_pattern *pattern);

/* The sum; of no parts, what is black. */
struct orl_material orl_material_sum_whole(const struct orl_material_sum *sum);

#endif
