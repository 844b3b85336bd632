/*
 * What to say of the seconds that a job has left, going by what its run tells (oriel/run.h). Shared
 * by daemon and command line.
 *
 * Estimates waver: each report has another one. What is said follows them without wavering: between
 * two reports it goes down with the clock, the faster or slower the further it is from what was
 * told last, as a clock is slewed; only where the two are far apart it goes over at once.
 */
#ifndef ORIEL_ETA_H
#define ORIEL_ETA_H

#include <math.h>

/* By a steady clock. All zeros: nothing was told yet. */
struct orl_eta {
    double left_s; /* said when that was; NaN: not known */
    double told_s; /* when; 0: never */
    double rate;   /* by which it goes down, seconds a second */
};

/* What is said now; NaN: nothing is known. It never goes below a tenth of what was left. */
static inline double orl_eta_s(const struct orl_eta *eta, double now_s)
{
    const double least = 0.1, since = fmax(now_s - eta->told_s, 0);
    return eta->told_s > 0 ? fmax(eta->left_s - eta->rate * since, least * eta->left_s)
                           : (double)NAN;
}

/* A report: so many seconds are thought to be left. NaN is no news. */
static inline void orl_eta_take(struct orl_eta *eta, double left_s, double now_s)
{
    const double apart = 1.25, some_s = 0.3, steep = 4, slowest = 0.2, fastest = 3;
    double said = orl_eta_s(eta, now_s);
    const double high = fmax(said, left_s), low = fmin(said, left_s);
    if (!isfinite(left_s))
        return;
    if (isnan(said) || high > fmax(apart * low, low + some_s))
        said = left_s;
    eta->rate = left_s > 0 ? fmin(fmax(pow(said / left_s, steep), slowest), fastest) : 1;
    eta->left_s = said;
    eta->told_s = now_s;
}

#endif
