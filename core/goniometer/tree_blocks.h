/*
 * The blocks of a panel's trees (block.h), measured: side by side here, or by others with whom the
 * BSDF is shared (oriel/bsdf_shared.h); with an accuracy a survey of them goes before.
 */
#ifndef ORL_GONIOMETER_TREE_BLOCKS_H
#define ORL_GONIOMETER_TREE_BLOCKS_H

#include "goniometer/block.h"
#include "goniometer/sample.h"

struct orl_gonio_trees {
    const struct orl_bsdf_make_request *request;
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
    struct orl_gonio_cull cull;
    unsigned rank, levels, split; /* split: the level of blocks */
    size_t n_blocks;              /* on one side */
    uint32_t paths, paths_most;   /* in each batch */
    double from[2][2]; /* side, transmitted: values from which on errors count; with an accuracy */
    const atomic_bool *cancel;
    struct orl_gonio_block *blocks; /* of light from the back, then from the front */
    size_t *todo, n_todo; /* their places; those that mirrors make of others are left out */
    size_t first;
    /* What they come to, by side: */
    struct orl_gonio_forest forests[2];
    struct orl_gonio_node roots[2][2];
    struct orl_gonio_hue root_hues[2][2]; /* of colour */
};

/* An empty one. */
static inline struct orl_gonio_forest orl_gonio_forest_of(const struct orl_gonio_trees *t)
{
    return (struct orl_gonio_forest){.rank = t->rank, .cull = t->cull, .color = t->request->color};
}

/* Cells of B at a level, of both components. */
static inline size_t orl_gonio_nodes_at(unsigned level)
{
    return (size_t)2 << 2 * level;
}

/* Mirrors take a block from another one: the one with the lesser place. */
size_t orl_gonio_original_of(const struct orl_gonio_trees *t, size_t block, unsigned *ret_mirror);

/* All that are to do. */
int orl_gonio_measure_blocks(struct orl_gonio_trees *t, const struct orl_bsdf_make_env *env,
                             struct orl_error *err);

/* Says what is wrong, and returns that. */
int orl_gonio_trees_fail(const struct orl_gonio_trees *t, int code, struct orl_error *err);

#endif
