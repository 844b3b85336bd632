/*
 * The verdict of the cross-check (cross_check.c): compares groups of sensors by plain paths with
 * the technique's results. The two differ if
 * - a group's sums do, by more than both errors and a tenth of its light; or
 * - the differences of all groups together resemble the light of one class, at least a quarter of
 *   it, by more than their errors. This is a matched filter (North 1943), with each group weighed
 *   by its variance. A class that is missing everywhere shows so before any single group does.
 * Then intervals are widened to include both, sensors are marked as unreliable, and a warning names
 * the class that the differences resemble most.
 *
 * Groups are not compared if their estimate by paths rests on few of them (the effective number of
 * samples, Kish 1965: (sum x)^2 / sum x^2), such as in rooms with one small window.
 *
 * Reference: North 1943, An analysis of the factors which determine signal/noise discrimination
 * (reprinted in Proceedings of the IEEE 51, 1963, 1016).
 */
#ifndef ORL_RUN_DIAGNOSTICS_CROSS_CHECK_VERDICT_H
#define ORL_RUN_DIAGNOSTICS_CROSS_CHECK_VERDICT_H

#include "run/run_state.h"

/* Neighbouring sensors, of which every stride-th was traced by paths. */
struct orl_plain_group {
    size_t first, count;
    size_t traced;                     /* sensors that paths were traced for */
    double sum, variance;              /* lx, of these sensors' means by paths */
    double classes[ORL_LIGHT_CLASSES]; /* parts of the sum, by class */
    double effective;                  /* effective number of samples */
};

struct orl_plain_groups {
    const struct orl_plain_group *groups;
    size_t count, stride;
    uint32_t paths; /* paths per traced sensor */
    bool find_all;  /* true if paths find all light, with a sufficient probability */
};

/* Sets the result's cross_check, widens intervals, marks sensors and warns. */
void orl_cross_check_evaluate(struct orl_run_state *state, const struct orl_plain_groups *groups);

#endif
