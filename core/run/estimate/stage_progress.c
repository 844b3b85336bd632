/* The current stage: its clock and progress; and the remaining time of a run. */
#include "run/estimate/progress.h"

#include <math.h>

#include "run/goals/rounds.h"

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

/* The clock and the progress of a run's stages. */

static double remaining_s(const struct orl_run_state *state, double fraction, double now)
{
    struct orl_remaining_time remaining = {.stage = state->clock.stage,
                                           .fraction = fraction,
                                           .stage_elapsed_s = now - state->clock.stage_started,
                                           .phase_from = state->progress->phase_from,
                                           .phase_to = state->progress->phase_to,
                                           .phase_elapsed_s = now - state->progress->phase_s};
    for (int i = 0; i < ORL_STAGE_COUNT; i++) {
        remaining.estimated_s[i] = state->clock.cost_s[i];
        remaining.spent_s[i] = state->result->timings_s[i];
    }
    const double left = orl_remaining_time_s(&remaining) + state->clock.after_s;
    return state->clock.deadline_at_s > 0
               ? orl_deadline_left_s(left, state->clock.deadline_at_s - now,
                                     state->job->goal.deadline_s)
               : left;
}

/* Returns the seconds after this run, if it is a part of something larger. */
static double after_s(const struct orl_run_env *env, const struct orl_progress_report *report)
{
    if (!(env->part > 0) || env->part_after_s > 0)
        return env->part_after_s;
    return (report->elapsed_s + report->left_s) * fmax(1 - env->part_from - env->part, 0) /
           env->part;
}

void orl_progress_report(const struct orl_run_env *env, enum orl_stage stage, double fraction,
                         const struct orl_progress_report *report)
{
    const double part = env->part > 0 ? env->part : 1;
    if (env->progress)
        env->progress(env->ctx, stage, fraction, env->part_from + part * report->share,
                      report->left_s + after_s(env, report));
}

void orl_run_report_progress(const struct orl_run_state *state, double fraction)
{
    if (!state->env->progress)
        return; /* without reading the clock */
    fraction = fmin(fmax(fraction, 0), 1);
    const double now = state->env->now_s(state->env->ctx);
    const double left = remaining_s(state, fraction, now);
    const double *spent = state->result->timings_s;
    struct orl_progress *progress = state->progress;
    /* If the number of rounds is unknown, as much work again is assumed. */
    const double unknown = progress->rounds_unknown ? now - state->clock.started_s + left : 0;
    progress->share =
        orl_remaining_time_share(progress->share, now - progress->at_s, left + unknown);
    progress->at_s = now;
    /* A larger task that the run is part of reads the scene only once. */
    const struct orl_progress_report report = {
        progress->share,
        now - state->clock.started_s - spent[ORL_STAGE_LOAD] - spent[ORL_STAGE_BVH], left};
    orl_progress_report(state->env, state->clock.stage, fraction, &report);
}

void orl_run_begin_phase(const struct orl_run_state *state, double from, double to)
{
    state->progress->phase_from = from;
    state->progress->phase_to = to;
    state->progress->phase_s = state->progress->at_s;
}

void orl_run_begin_work(const struct orl_run_state *state)
{
    orl_run_report_progress(state, 0);
    orl_run_begin_phase(state, 0, 1);
}

void orl_run_end_stage(struct orl_run_state *state)
{
    const double now = state->env->now_s(state->env->ctx);
    state->result->timings_s[state->clock.stage] += now - state->clock.stage_started;
    state->clock.stage_started = now;
}

void orl_run_move_time(struct orl_run_state *state, enum orl_stage stage, double seconds)
{
    state->result->timings_s[stage] += seconds;
    state->clock.stage_started += seconds;
}

void orl_run_begin_stage(struct orl_run_state *state, enum orl_stage stage)
{
    orl_run_end_stage(state);
    orl_run_begin_phase(state, 0, 0);
    state->clock.stage = stage;
    orl_run_report_progress(state, 0);
}
