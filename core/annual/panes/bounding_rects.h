/* Bounding rectangles, a tree that searches them, and the rectangles of a sealed building's ports.
 */
#ifndef ORL_ANNUAL_PANES_BOUNDING_RECTS_H
#define ORL_ANNUAL_PANES_BOUNDING_RECTS_H

#include "annual/sun/direction_tree.h"
#include "base/sampling/sampling.h"
#include "light/lit_scene.h"

/*
 * Bounding rectangles of flat surfaces, for a cheap test before rays to the sun are traced. The
 * surfaces are the windows through which light enters a sealed building, and mirrors
 * (mirror_planes.h). The rectangles are slightly too large: a ray that misses all of them cannot
 * reach the sun through them.
 *
 * Immutable once made.
 */

struct orl_bounding_rect {
    uint32_t facet;
    struct orl_vec3 corner, normal;
    struct orl_vec3 along[2]; /* unit vectors, perpendicular to each other */
    double low[2], high[2];   /* extent along these axes, from the corner */
};

/* Returns the rectangle around a facet, which is a polygon or a ring. */
struct orl_bounding_rect orl_bounding_rect_of(const struct orl_geometry *geometry, uint32_t facet);
/* Extends a rectangle to cover another one in the same plane. */
void orl_bounding_rect_widen(struct orl_bounding_rect *window,
                             const struct orl_bounding_rect *other);

/*
 * Returns true if a ray passes a window. slack is the sine of the largest angle by which the ray's
 * direction may be off. ret_distance may be NULL.
 */
bool orl_bounding_rect_passed(const struct orl_bounding_rect *window, struct orl_vec3 origin,
                              struct orl_vec3 direction, double slack, double *ret_distance);

/* Returns a cone that contains all directions from a point to a window. */
struct orl_cone orl_bounding_rect_cone(const struct orl_bounding_rect *window,
                                       struct orl_vec3 point);

/* Returns corner i, 0 to 3; 0 is opposite 3. */
static inline struct orl_vec3 orl_bounding_rect_corner(const struct orl_bounding_rect *w, int i)
{
    return orl_madd(orl_madd(w->corner, w->along[0], i & 1 ? w->high[0] : w->low[0]), w->along[1],
                    i & 2 ? w->high[1] : w->low[1]);
}

/*
 * Bounding-volume hierarchy (BVH) of rectangles around panes. It answers two questions in time
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

/* Builds a tree of n rectangles; strengths are above 0, or NULL: 1 each. Borrows both. Returns 0 or
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

/*
 * Bounding rectangles of a sealed building's ports. A ray from inside to the sun must pass one
 * whose pane transmits light straight. BSDF panes without a peak do not.
 *
 * Immutable once made.
 */

struct orl_port_rects {
    struct orl_bounding_rect *at; /* by port */
    size_t count;
    struct orl_bounding_rect *clear; /* the windows that rays pass straight through */
    size_t n_clear;
    struct orl_pane_bvh tree; /* searches the clear windows */
    bool all; /* true if light has other ways in, so that every ray must be traced */
};

/* Collects the windows of a sealed building. Returns 0 or ORL_ERR_NOMEM; orl_port_rects_done in
 * either case. */
int orl_port_rects_init(struct orl_port_rects *windows, const struct orl_lit_scene *lit_scene);
void orl_port_rects_done(struct orl_port_rects *windows);

/* Returns true if the ray passes a window nearer than `before`; slack as in
 * orl_bounding_rect_passed. */
bool orl_port_rects_passed(const struct orl_port_rects *windows, struct orl_vec3 origin,
                           struct orl_vec3 direction, double slack, double before);

#endif
