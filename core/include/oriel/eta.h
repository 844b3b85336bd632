/*
 * When a job ends, going by the share of it that is done: what a run tells as its progress
 * (oriel/run.h) is a share of time. Shared by daemon and command line.
 */
#ifndef ORIEL_ETA_H
#define ORIEL_ETA_H

#include <math.h>

/*
 * done: the share that was told last; first: what it began with. told_after_s: how long after the
 * start that was told; since_s: how long ago. Between two reports the rest goes down with the
 * clock, down to a tenth of itself. NaN: nothing is known yet. The first hundredth says little, but
 * that of a thousand skies is worth waiting for no more than some seconds.
 */
static inline double orl_eta_s(double done, double first, double told_after_s, double since_s)
{
    const double little = 0.01, some_seconds = 5, least = 0.1;
    const double made = done - fmax(first, 0);
    if (!(made > 0) || !(told_after_s > 0) ||
        (made < little && told_after_s + since_s < some_seconds))
        return NAN;
    const double left = told_after_s * fmax(1 - done, 0) / made;
    return fmax(left - fmax(since_s, 0), least * left);
}

#endif
