/*
 * Transport plans assign shares of one scan's light to another's at the least cost: displacement
 * interpolation (Bonneel, van de Panne, Paris and Heidrich 2011). The cost of a unit of light is
 * the squared chord of its move, up to a bound. Light that would have to move farther fades at one
 * place and appears at the other.
 *
 * Plans are solved by the transportation simplex (Dantzig 1951) over clusters (lobe_shape.h). The
 * solution is exact to 1e-7 of the largest cost, unless the limit on pivots is reached. Ownership:
 * the caller's, freed by orl_fit_plan_done.
 */
#ifndef ORL_BSDF_FIT_TRANSPORT_TRANSPORT_H
#define ORL_BSDF_FIT_TRANSPORT_TRANSPORT_H

#include "bsdf/fit/scan/lobe_shape.h"

/* Motion and widening of a cluster per radian of turn of the incident direction, along the two axes
 * of the frame about that direction (orl_frame_about). */
struct orl_fit_velocity {
    float x[2], y[2], z[2], sigma[2];
    bool known;
};

/* A part of a cluster and its destination; shares of a cluster add up to 1. Destinations that are
 * close compared with the clusters' widths are joined. The cluster then moves as a whole and is not
 * split towards its neighbours' destinations. */
struct orl_fit_move {
    float x, y, z, sigma_rad; /* destination */
    float share;
    bool fades;                       /* true if the destination is too far away */
    uint32_t submove;                 /* the first leg of the heaviest of the joined moves */
    struct orl_fit_velocity velocity; /* mean velocity of the clusters there; set by velocities.h */
};

/* Part of a move, by destination cluster. */
struct orl_fit_submove {
    uint32_t to, move;
    float share;
};

/* Moves by cluster of the one scan (way 0) or the other (way 1): moves[first[i]] to first[i +
 * 1]. */
struct orl_fit_moves {
    uint32_t *first;
    struct orl_fit_move *moves;
    struct orl_fit_submove *submoves; /* in any order */
    size_t n_submoves;
};

struct orl_fit_plan {
    struct orl_fit_moves directions[2];
};

/* Makes a plan. If one part has no light, all light fades and there are no moves. farthest: the
 * chord from which light fades. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_fit_plan_make(const struct orl_fit_part *from, const struct orl_fit_part *to,
                      double farthest, const atomic_bool *cancel, struct orl_fit_plan *ret_plan,
                      struct orl_error *err);
void orl_fit_plan_done(struct orl_fit_plan *plan);

/* ---- The transportation problem ------------------------------------------------------------- */

struct orl_fit_flow {
    uint32_t from, to;
    double amount;
};

/*
 * Solves a transportation problem; supply and demand must have equal sums. cost: [from][to].
 * *ret_flows: owned by the caller, n_from + n_to - 1 entries, some of which may be 0. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_fit_transport(const double *supply, size_t n_from, const double *demand, size_t n_to,
                      const float *cost, const atomic_bool *cancel, struct orl_fit_flow **ret_flows,
                      size_t *ret_n);

#endif
