#include "run/estimate/remaining_time.h"

#include <math.h>

/* Fraction of a stage from which only its own progress counts. The last stage needs a larger one,
 * because its first sensors fill caches that later ones only read. */
static const double known_from = 0.05, render_known_from = 0.2;
/* Fraction of a phase from which only its own progress counts. */
static const double phase_known_from = 0.1;
/* Least remaining time of a stage that overruns, as a share of its time so far. */
static const double overrun = 0.1;
/* Weight of the estimate against measurements: seconds, or a share of the whole estimate, so that
 * little work does not scale much. Bounds of the ratio. */
static const double trust_s = 0.2, trust_share = 0.015, least_slowdown = 0.25, most_slowdown = 8;

/* Returns the time that the fraction took: in the first phase, the time since it began, without the
 * set-up before. */
static double worked_s(const struct orl_remaining_time *a)
{
    return a->phase_to > 0 && !(a->phase_from > 0) ? a->phase_elapsed_s : a->stage_elapsed_s;
}

/* Returns the ratio of actual to estimated time so far; stages before photons are left out. */
static double slowdown_of(const struct orl_remaining_time *a, double fraction)
{
    double all = 0;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++)
        all += a->estimated_s[i];
    const double trust = fmax(trust_s, trust_share * all);
    double estimated = trust, spent = trust;
    for (int i = ORL_STAGE_PHOTONS; i < (int)a->stage; i++) {
        estimated += a->estimated_s[i];
        spent += a->spent_s[i];
    }
    if (a->stage >= ORL_STAGE_PHOTONS && fraction > 0) {
        estimated += fraction * a->estimated_s[a->stage];
        spent += worked_s(a);
    }
    return fmin(fmax(spent / estimated, least_slowdown), most_slowdown);
}

/*
 * Returns the remaining time of the stage by its own and its phase's progress. The part of a
 * phase's first tenth that is missing counts at the stage's rate, because the first bits are not
 * representative.
 */
static double by_progress(const struct orl_remaining_time *a, double fraction)
{
    const double share = a->phase_to - a->phase_from;
    const double done = (fraction - a->phase_from) / fmax(share, 1e-9);
    const double all = worked_s(a) / fraction;
    if (!(a->phase_to > 0) || !(done > 0) || done > 1)
        return all * (1 - fraction);
    const double usual = fmax(phase_known_from - done, 0);
    const double phase = (a->phase_elapsed_s + usual * share * all) / (done + usual);
    const double of_phase = phase * (1 - done);
    return of_phase + (a->stage_elapsed_s + of_phase) * (1 - a->phase_to) / a->phase_to;
}

/* Returns the weight of a stage's own progress against its estimate. */
static double weight_of_progress(enum orl_stage stage, double fraction)
{
    const double late = fmin(fraction / render_known_from, 1);
    return stage == ORL_STAGE_RENDER ? late * late : fmin(fraction / known_from, 1);
}

double orl_remaining_time_s(const struct orl_remaining_time *a)
{
    const double fraction = fmin(fmax(a->fraction, 0), 1), slowdown = slowdown_of(a, fraction);
    const double estimated = slowdown * a->estimated_s[a->stage];
    const double weight = weight_of_progress(a->stage, fraction);
    double left = fmax(estimated - a->stage_elapsed_s, overrun * a->stage_elapsed_s);
    if (fraction > 0)
        left = (1 - weight) * left + weight * by_progress(a, fraction);
    for (int i = (int)a->stage + 1; i < ORL_STAGE_COUNT; i++)
        left += slowdown * a->estimated_s[i];
    return left;
}

double orl_remaining_time_share(double before, double since_s, double left_s)
{
    const double since = fmax(since_s, 0), all = since + fmax(left_s, 0);
    return all > 0 ? 1 - (1 - before) * (1 - since / all) : before;
}
