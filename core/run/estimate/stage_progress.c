/* The clock and the progress of a run's stages. */
#include <math.h>

#include "run/estimate/remaining_time.h"
#include "run/estimate/stage_progress.h"
#include "run/goals/deadline.h"

static double left_s(const struct orl_run_state *state, double fraction, double now)
{
    struct orl_remaining_time remaining = {.stage = state->stage,
                                           .fraction = fraction,
                                           .stage_elapsed_s = now - state->stage_started,
                                           .phase_from = state->progress->phase_from,
                                           .phase_to = state->progress->phase_to,
                                           .phase_elapsed_s = now - state->progress->phase_s};
    for (int i = 0; i < ORL_STAGE_COUNT; i++) {
        remaining.estimated_s[i] = state->cost_s[i];
        remaining.spent_s[i] = state->result->timings_s[i];
    }
    const double left = orl_remaining_time_s(&remaining) + state->after_s;
    return state->deadline_at_s > 0
               ? orl_deadline_left_s(left, state->deadline_at_s - now, state->job->goal.deadline_s)
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
    const double left = left_s(state, fraction, now);
    const double *spent = state->result->timings_s;
    struct orl_progress *progress = state->progress;
    /* If the number of rounds is unknown, as much work again is assumed. */
    const double unknown = progress->rounds_unknown ? now - state->started_s + left : 0;
    progress->share =
        orl_remaining_time_share(progress->share, now - progress->at_s, left + unknown);
    progress->at_s = now;
    /* A larger task that the run is part of reads the scene only once. */
    const struct orl_progress_report report = {
        progress->share, now - state->started_s - spent[ORL_STAGE_LOAD] - spent[ORL_STAGE_BVH],
        left};
    orl_progress_report(state->env, state->stage, fraction, &report);
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
    state->result->timings_s[state->stage] += now - state->stage_started;
    state->stage_started = now;
}

void orl_run_move_time(struct orl_run_state *state, enum orl_stage stage, double seconds)
{
    state->result->timings_s[stage] += seconds;
    state->stage_started += seconds;
}

void orl_run_begin_stage(struct orl_run_state *state, enum orl_stage stage)
{
    orl_run_end_stage(state);
    orl_run_begin_phase(state, 0, 0);
    state->stage = stage;
    orl_run_report_progress(state, 0);
}
