/*
 * Transport plans: which share of one scan's light becomes which of another's, at the least cost,
 * as displacement interpolation has it (Bonneel, van de Panne, Paris and Heidrich 2011). The cost
 * of a unit of light is the square of the chord that it moves by, but no more than a bound: light
 * that would have to go farther fades here and appears there.
 *
 * By the transportation simplex (Dantzig 1951) over clusters (shape.h), exactly but for rounding.
 * Ownership: the caller's, orl_fit_plan_done.
 */
#ifndef ORL_FIT_TRANSPORT_H
#define ORL_FIT_TRANSPORT_H

#include "fit/shape.h"

/* How a cluster moves and widens as the light that comes turns, by radian along the two axes of
 * the frame about its direction (orl_frame_about). */
struct orl_fit_slope {
    float x[2], y[2], z[2], sigma[2];
    bool known;
};

/* What becomes of a cluster: shares of it, which add up to 1. Places that are close together, for
 * clusters of their width, are one: it moves as a whole, and is not torn to where its neighbours'
 * light goes, too. */
struct orl_fit_move {
    float x, y, z, sigma_rad; /* of the place that it goes to */
    float share;
    bool fades;                 /* it is too far away */
    uint32_t leg;               /* the heaviest of those that it was joined of */
    struct orl_fit_slope slope; /* of the clusters there; slopes.h sets it */
};

/* A share of a move, by the cluster that it goes to. */
struct orl_fit_leg {
    uint32_t to, move;
    float share;
};

/* By cluster of the one scan (way 0), or of the other (way 1): moves[first[i]] to first[i + 1]. */
struct orl_fit_moves {
    uint32_t *first;
    struct orl_fit_move *moves;
    struct orl_fit_leg *legs; /* in any order */
    size_t n_legs;
};

struct orl_fit_plan {
    struct orl_fit_moves ways[2];
};

/* Where one of them has no light, all fades: there are no moves. farthest: the chord from which on
 * light fades. 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_fit_plan_make(const struct orl_fit_part *from, const struct orl_fit_part *to,
                      double farthest, const atomic_bool *cancel, struct orl_fit_plan *ret_plan,
                      struct orl_error *err);
void orl_fit_plan_done(struct orl_fit_plan *plan);

/* ---- The problem itself ---------------------------------------------------------------------- */

struct orl_fit_flow {
    uint32_t from, to;
    double amount;
};

/*
 * supply and demand add up to the same; cost: [from][to]. *ret_flows: owned by the caller, from +
 * to - 1 of them, some of which may be 0. 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_fit_transport(const double *supply, size_t n_from, const double *demand, size_t n_to,
                      const float *cost, const atomic_bool *cancel, struct orl_fit_flow **ret_flows,
                      size_t *ret_n);

#endif
