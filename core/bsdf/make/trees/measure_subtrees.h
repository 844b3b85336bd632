/*
 * Measures the blocks of a panel's trees (subtree.h) in parallel, here or on other machines if the
 * BSDF is shared (oriel/bsdf/bsdf_distributed.h). With an accuracy, a survey of the blocks comes
 * first.
 */
#ifndef ORL_BSDF_MAKE_TREES_MEASURE_SUBTREES_H
#define ORL_BSDF_MAKE_TREES_MEASURE_SUBTREES_H

#include "bsdf/make/panel/panel_sample.h"
#include "bsdf/make/trees/subtree.h"

struct orl_gonio_trees {
    const struct orl_bsdf_make_request *request;
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
    struct orl_gonio_cull cull;
    unsigned rank, levels, split; /* split: the level of the blocks */
    size_t n_subtrees;            /* blocks on one side */
    uint32_t paths, paths_most;   /* paths in each batch */
    double from[2][2]; /* [side][transmitted]: least values whose errors count; with an accuracy */
    const atomic_bool *cancel;
    struct orl_gonio_subtree *subtrees; /* blocks for light from the back, then from the front */
    size_t *todo, n_todo;               /* blocks to measure, by index; no mirror images */
    size_t first;
    /* Results, by side: */
    struct orl_gonio_builder builders[2];
    struct orl_gonio_node roots[2][2];
    struct orl_gonio_color root_hues[2][2]; /* set if there is colour */
};

/* Returns an empty builder. */
static inline struct orl_gonio_builder orl_gonio_empty_builder(const struct orl_gonio_trees *t)
{
    return (struct orl_gonio_builder){.rank = t->rank, .cull = t->cull, .color = t->request->color};
}

/* Returns the number of cells of B at a level, for both components. */
static inline size_t orl_gonio_nodes_at(unsigned level)
{
    return (size_t)2 << 2 * level;
}

/* Returns the block of which this one is a mirror image: the one with the lower index. */
size_t orl_gonio_original_of(const struct orl_gonio_trees *t, size_t subtree, unsigned *ret_mirror);

/* Measures all blocks in todo. Returns 0 or a negative enum orl_err. */
int orl_gonio_measure_subtrees(struct orl_gonio_trees *t, const struct orl_bsdf_make_env *env,
                               struct orl_error *err);

/* Sets the error message of a code; returns the code. */
int orl_gonio_trees_fail(const struct orl_gonio_trees *t, int code, struct orl_error *err);

#endif
