/*
 * Transport plans between the requested incident directions of a mesh, and velocities.
 *
 * Ownership: the caller's, freed by _done. Once made, plans may be read by many threads.
 */
#ifndef ORL_BSDF_FIT_TRANSPORT_TRANSPORT_PLANS_H
#define ORL_BSDF_FIT_TRANSPORT_TRANSPORT_PLANS_H

#include <oriel/base/thread_pool.h>

#include "bsdf/fit/transport/velocity.h"

struct orl_fit_plans {
    struct orl_fit_edge *edges; /* sorted by a, then b */
    size_t n, capacity;
    struct orl_fit_velocities *velocities; /* by direction of the mesh; owned */
    size_t n_directions;
};

/* Requests the edges that a place needs; any order, repeats are allowed. Returns false if out of
 * memory. */
bool orl_fit_plans_request(struct orl_fit_plans *plans, const struct orl_fit_location *location);
/* Sorts the edges and makes their plans, in parallel or serially (crew NULL). Returns 0 or a
 * negative enum orl_err. */
int orl_fit_plans_make(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                       struct orl_thread_pool *pool, const atomic_bool *cancel,
                       struct orl_error *err);
void orl_fit_plans_done(struct orl_fit_plans *plans);

/* Returns the moves of one direction's light to another's; NULL if there is no plan. */
const struct orl_fit_moves *orl_fit_plans_moves(const struct orl_fit_plans *plans, uint32_t from,
                                                uint32_t to, int kind);

#endif
