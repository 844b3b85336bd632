/*
 * Search for the nearest knots by a kd-tree over their places (Friedman, Bentley and Finkel 1977).
 * The tree is an array in which the middle of every range divides it.
 */
#ifndef ORL_FIT_NEAR_H
#define ORL_FIT_NEAR_H

#include "fit/knots.h"

struct orl_fit_found {
    uint32_t knot[ORL_FIT_NEIGHBOURS];
    float away2[ORL_FIT_NEIGHBOURS]; /* squared chords, ascending */
    unsigned count;
};

/* Orders knots->tree and sets axes. */
void orl_fit_near_build(struct orl_fit_knots *knots);
void orl_fit_near_find(const struct orl_fit_knots *knots, struct orl_vec3 place,
                       struct orl_fit_found *ret_found);

#endif
