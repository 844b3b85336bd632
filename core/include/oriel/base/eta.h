/*
 * Displayed time to completion of a job, from the estimates of its run (oriel/job/run.h). Shared by
 * daemon and command line.
 *
 * Estimates fluctuate from report to report. The displayed time follows them smoothly, as a clock
 * is slewed. Between two reports it counts down; the rate depends on its distance to the last
 * estimate. It jumps only if the two are far apart.
 */
#ifndef ORIEL_BASE_ETA_H
#define ORIEL_BASE_ETA_H

#include <math.h>

/* State of the display, by a monotonic clock. All zeros: no report yet. */
struct orl_eta {
    double left_s;     /* displayed value at reported_s; NaN: not known */
    double reported_s; /* time of the last report; 0: none yet */
    double rate;       /* count-down rate, seconds per second */
};

/* Returns the seconds to display now; NaN: not known. The result never goes below a tenth of
 * left_s. */
static inline double orl_eta_s(const struct orl_eta *eta, double now_s)
{
    const double least = 0.1, since = fmax(now_s - eta->reported_s, 0);
    return eta->reported_s > 0 ? fmax(eta->left_s - eta->rate * since, least * eta->left_s)
                               : (double)NAN;
}

/* Updates the display by a report of the estimated seconds left. NaN is ignored. */
static inline void orl_eta_update(struct orl_eta *eta, double left_s, double now_s)
{
    const double apart = 1.25, some_s = 0.3, steep = 4, slowest = 0.2, fastest = 3;
    double displayed_s = orl_eta_s(eta, now_s);
    const double high = fmax(displayed_s, left_s), low = fmin(displayed_s, left_s);
    if (!isfinite(left_s))
        return;
    if (isnan(displayed_s) || high > fmax(apart * low, low + some_s))
        displayed_s = left_s;
    eta->rate = left_s > 0 ? fmin(fmax(pow(displayed_s / left_s, steep), slowest), fastest) : 1;
    eta->left_s = displayed_s;
    eta->reported_s = now_s;
}

#endif
