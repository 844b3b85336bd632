/*
 * The verdict of the cross-check (cross_check.c): groups of sensors by plain paths, against what
 * the technique found. The two differ where
 *   - a group's sums do, by more than both errors and a tenth of its light; or
 *   - the differences of all groups together are like the light of one class, a quarter of it or
 *     more, by more than their errors: a matched filter (North 1943), with each group weighed by
 *     its variance. A class that is missing everywhere shows so before any single group does.
 * Then intervals are widened to include both, sensors are marked as unreliable, and a warning names
 * the class that the differences are most like.
 *
 * Nothing is said of groups whose estimate by paths rests on few of them (the effective number of
 * samples, Kish 1965: (sum x)^2 / sum x^2), such as in rooms with one small window.
 *
 * Reference: North 1943, An analysis of the factors which determine signal/noise discrimination
 * (reprinted in Proceedings of the IEEE 51, 1963, 1016).
 */
#ifndef ORL_RUN_CROSS_CHECK_JUDGE_H
#define ORL_RUN_CROSS_CHECK_JUDGE_H

#include "run/stages.h"

/* Neighbouring sensors, of which every stride-th was traced by paths. */
struct orl_plain_group {
    size_t first, count;
    size_t traced;                     /* sensors that paths were traced for */
    double sum, variance;              /* lx, of these sensors' means by paths */
    double classes[ORL_LIGHT_CLASSES]; /* of that sum */
    double effective;                  /* samples */
};

struct orl_plain_groups {
    const struct orl_plain_group *groups;
    size_t count, stride;
    uint32_t paths; /* of each sensor that was traced */
    bool find_all;  /* true if paths find all light, with a sufficient probability */
};

/* Sets the result's cross_check, widens intervals, marks sensors and warns. */
void orl_cross_check_judge(struct orl_run_state *state, const struct orl_plain_groups *groups);

#endif
