/*
 * Bounding-box tree of rectangles around panes (bounding_rects.h). It answers two questions in time
 * that grows with the logarithm of their number. Does a ray pass any of them? Which of them,
 * sampled at random, matter at a place?
 *
 * Sampling: from the root down, both children are followed while they may fill a share of the view
 * larger than a sun's neighbourhood. Below that, Russian roulette may end the search. Otherwise one
 * child is drawn by its area over its squared distance (Conty Estevez and Kulla 2018, adaptive tree
 * splitting). Areas are weighted by strength, because light off a faint mirror matters less. A
 * rectangle's probability is the product of the probabilities on its path; dividing by it makes a
 * sum unbiased. A subtree is left out only if it lies behind the place.
 *
 * Immutable once built.
 */
#ifndef ORL_ANNUAL_PANES_PANE_BVH_H
#define ORL_ANNUAL_PANES_PANE_BVH_H

#include "annual/panes/bounding_rects.h"
#include "base/sampling/random.h"

struct orl_pane_bvh_node {
    struct orl_vec3 low, high;
    struct orl_vec3 center; /* centre of the bounding sphere */
    double radius, area;    /* radius of the sphere; area times strength */
    /* A leaf's item, else UINT32_MAX; the first child is stored next to its parent. */
    uint32_t item;
    uint32_t second_child; /* the second child */
};

struct orl_pane_bvh {
    struct orl_pane_bvh_node *nodes;
    size_t count;
};

/* Builds a tree of n windows; strengths are above 0, or NULL: 1 each. Borrows both. Returns 0 or
 * ORL_ERR_NOMEM; orl_pane_bvh_done in either case. */
int orl_pane_bvh_init(struct orl_pane_bvh *tree, const struct orl_bounding_rect *panes,
                      const double *strengths, size_t n);
void orl_pane_bvh_done(struct orl_pane_bvh *tree);

/* Returns true if the ray passes a pane nearer than `before`; slack as in orl_bounding_rect_passed.
 */
bool orl_pane_bvh_passed(const struct orl_pane_bvh *tree, const struct orl_bounding_rect *panes,
                         struct orl_vec3 origin, struct orl_vec3 direction, double slack,
                         double before);

typedef void (*orl_pane_visit)(void *ctx, uint32_t item, double probability);

/* Calls visit for panes sampled at a place, each with its probability; the normal is unit. Returns
 * the number of nodes tested. */
size_t orl_pane_bvh_sample(const struct orl_pane_bvh *tree, struct orl_vec3 point,
                           struct orl_vec3 normal, struct orl_random *random, orl_pane_visit visit,
                           void *ctx);

#endif
