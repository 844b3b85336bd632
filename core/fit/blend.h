/*
 * The light that leaves a place between incident directions: lobes of each corner, moved as the
 * plans to the others say, and weighted.
 *
 * A lobe moves with its cluster, its offset from there and its width scaled as the clusters' widths
 * are. So at a corner the result is that corner's own shape, and it changes continuously between.
 * Beyond the border what stands out is turned with the straight direction; the rest stays.
 *
 * Ownership: of plans and lobes the caller's, by _done. Plans are read by many threads once made.
 */
#ifndef ORL_FIT_BLEND_H
#define ORL_FIT_BLEND_H

#include <oriel/crew.h>

#include "fit/mesh.h"
#include "fit/transport.h"

struct orl_fit_edge {
    uint32_t a, b; /* a < b */
    struct orl_fit_plan plans[ORL_FIT_KINDS];
    int code; /* of making it */
};

struct orl_fit_plans {
    struct orl_fit_edge *edges; /* by a, then b */
    size_t n, room;
};

/* Notes the edges that a place needs; in any order, and more than once. False: no memory. */
bool orl_fit_plans_want(struct orl_fit_plans *plans, const struct orl_fit_place *place);
/* Sorts them and makes their plans, by the crew or alone (NULL). 0 or a negative orl_err. */
int orl_fit_plans_make(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                       struct orl_crew *crew, const atomic_bool *cancel, struct orl_error *err);
void orl_fit_plans_done(struct orl_fit_plans *plans);

/* A Gaussian of light. */
struct orl_fit_ray {
    float x, y, z, mass, sigma_rad;
};

struct orl_fit_light {
    struct orl_fit_ray *rays; /* owned */
    size_t n, room;
    double floor; /* 1/sr, beside them */
};

/* Replaces what *light holds. False: no memory. */
bool orl_fit_blend(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                   const struct orl_fit_place *place, struct orl_fit_light *light);
void orl_fit_light_done(struct orl_fit_light *light);

#endif
