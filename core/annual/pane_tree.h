/*
 * Rectangles about panes (windows.h) in a tree of bounding boxes. It answers two questions at a
 * cost that grows with the logarithm of their number: does a ray pass any of them; and which of
 * them matter at a place, chosen by lot.
 *
 * The lot: from the root down, both halves are followed as long as they may fill a share of the
 * view that is larger than a sun's neighbourhood; below that a roulette ends the search, or one of
 * the two is drawn by its area over the square of its distance (Conty Estevez and Kulla 2018,
 * adaptive tree splitting). Areas count by their strength, as what a faint mirror throws matters
 * less. Each rectangle that is reached has the product of the probabilities on its way: dividing
 * by it makes a sum without bias. A half is left out only where it lies behind the place.
 *
 * Immutable once built.
 */
#ifndef ORL_ANNUAL_PANE_TREE_H
#define ORL_ANNUAL_PANE_TREE_H

#include "annual/windows.h"
#include "base/random.h"

struct orl_pane_node {
    struct orl_vec3 low, high;
    struct orl_vec3 center; /* of a ball about it */
    double radius, area;    /* the latter times strength */
    uint32_t item;          /* a leaf's, else UINT32_MAX; the first child follows its parent */
    uint32_t other;         /* the second child */
};

struct orl_pane_tree {
    struct orl_pane_node *nodes;
    size_t count;
};

/* Builds a tree of n windows; strengths are above 0, or NULL: 1 each. Borrows both. Returns 0 or
 * ORL_ERR_NOMEM; orl_pane_tree_done in either case. */
int orl_pane_tree_init(struct orl_pane_tree *tree, const struct orl_window *panes,
                       const double *strengths, size_t n);
void orl_pane_tree_done(struct orl_pane_tree *tree);

/* Returns true if the ray passes a pane nearer than `before`; slack as in orl_window_passed. */
bool orl_pane_tree_passed(const struct orl_pane_tree *tree, const struct orl_window *panes,
                          struct orl_vec3 origin, struct orl_vec3 direction, double slack,
                          double before);

typedef void (*orl_pane_visit)(void *ctx, uint32_t item, double probability);

/* Calls visit for panes drawn by lot at a place; its normal is unit. Returns how many nodes were
 * looked at. */
size_t orl_pane_tree_draw(const struct orl_pane_tree *tree, struct orl_vec3 point,
                          struct orl_vec3 normal, struct orl_random *random, orl_pane_visit visit,
                          void *ctx);

#endif
