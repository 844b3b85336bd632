/*
 * The transport plans between the incident directions of a mesh that are asked for, and slopes.
 *
 * Ownership: the caller's, by _done. Plans are read by many threads once made.
 */
#ifndef ORL_FIT_PLANS_H
#define ORL_FIT_PLANS_H

#include <oriel/crew.h>

#include "fit/slopes.h"

struct orl_fit_plans {
    struct orl_fit_edge *edges; /* by a, then b */
    size_t n, room;
    struct orl_fit_slopes *slopes; /* by direction of the mesh; owned */
    size_t n_directions;
};

/* Notes the edges that a place needs; in any order, and more than once. False: no memory. */
bool orl_fit_plans_want(struct orl_fit_plans *plans, const struct orl_fit_place *place);
/* Sorts them and makes their plans, by the crew or alone (NULL). 0 or a negative orl_err. */
int orl_fit_plans_make(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                       struct orl_crew *crew, const atomic_bool *cancel, struct orl_error *err);
void orl_fit_plans_done(struct orl_fit_plans *plans);

/* Of the light of one direction to another's; NULL: there is no plan. */
const struct orl_fit_moves *orl_fit_plans_moves(const struct orl_fit_plans *plans, uint32_t from,
                                                uint32_t to, int kind);

#endif
