/* The current stage: its clock, progress and warnings; and helpers for several stages. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/goals/deadline.h"
#include "run/progress/remaining_time.h"
#include "run/stages.h"

static double left_s(const struct orl_run_state *state, double fraction, double now)
{
    struct orl_ahead ahead = {.stage = state->stage,
                              .fraction = fraction,
                              .in_stage_s = now - state->stage_started,
                              .phase_from = state->told->phase_from,
                              .phase_to = state->told->phase_to,
                              .in_phase_s = now - state->told->phase_s};
    for (int i = 0; i < ORL_STAGE_COUNT; i++) {
        ahead.foreseen_s[i] = state->cost_s[i];
        ahead.spent_s[i] = state->result->timings_s[i];
    }
    const double left = orl_ahead_left_s(&ahead) + state->after_s;
    return state->ends_s > 0
               ? orl_deadline_left_s(left, state->ends_s - now, state->job->goal.deadline_s)
               : left;
}

/* Returns the seconds after this run, if it is a part of something larger. */
static double after_s(const struct orl_run_env *env, const struct orl_run_report *report)
{
    if (!(env->part > 0) || env->part_after_s > 0)
        return env->part_after_s;
    return (report->elapsed_s + report->left_s) * fmax(1 - env->part_from - env->part, 0) /
           env->part;
}

void orl_run_report(const struct orl_run_env *env, enum orl_stage stage, double fraction,
                    const struct orl_run_report *report)
{
    const double part = env->part > 0 ? env->part : 1;
    if (env->progress)
        env->progress(env->ctx, stage, fraction, env->part_from + part * report->share,
                      report->left_s + after_s(env, report));
}

void orl_run_progress(const struct orl_run_state *state, double fraction)
{
    if (!state->env->progress)
        return; /* without reading the clock */
    fraction = fmin(fmax(fraction, 0), 1);
    const double now = state->env->now_s(state->env->ctx);
    const double left = left_s(state, fraction, now);
    const double *spent = state->result->timings_s;
    struct orl_told *told = state->told;
    /* If the number of rounds is unknown, as much work again is assumed. */
    const double unknown = told->open ? now - state->started_s + left : 0;
    told->share = orl_ahead_share(told->share, now - told->at_s, left + unknown);
    told->at_s = now;
    /* A larger task that the run is part of reads the scene only once. */
    const struct orl_run_report report = {
        told->share, now - state->started_s - spent[ORL_STAGE_LOAD] - spent[ORL_STAGE_BVH], left};
    orl_run_report(state->env, state->stage, fraction, &report);
}

void orl_run_phase(const struct orl_run_state *state, double from, double to)
{
    state->told->phase_from = from;
    state->told->phase_to = to;
    state->told->phase_s = state->told->at_s;
}

void orl_run_begin_work(const struct orl_run_state *state)
{
    orl_run_progress(state, 0);
    orl_run_phase(state, 0, 1);
}

void orl_run_leave(struct orl_run_state *state)
{
    const double now = state->env->now_s(state->env->ctx);
    state->result->timings_s[state->stage] += now - state->stage_started;
    state->stage_started = now;
}

void orl_run_book(struct orl_run_state *state, enum orl_stage stage, double seconds)
{
    state->result->timings_s[stage] += seconds;
    state->stage_started += seconds;
}

void orl_run_enter(struct orl_run_state *state, enum orl_stage stage)
{
    orl_run_leave(state);
    orl_run_phase(state, 0, 0);
    state->stage = stage;
    orl_run_progress(state, 0);
}

enum { WARNING_SIZE = 1024 };

static void add_warning(struct orl_run_state *state, const char *text)
{
    struct orl_result *r = state->result;
    if (state->env->warned)
        state->env->warned(state->env->ctx, text);
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    if (!grown)
        return;
    r->warnings = grown;
    grown[r->n_warnings] = strdup(text);
    if (grown[r->n_warnings])
        r->n_warnings++;
}

void orl_run_warn(struct orl_run_state *state, const char *format, ...)
{
    char text[WARNING_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    add_warning(state, text);
}

void orl_run_warn_once(struct orl_run_state *state, const char *format, ...)
{
    char text[WARNING_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (size_t i = 0; i < state->result->n_warnings; i++)
        if (strcmp(state->result->warnings[i], text) == 0)
            return;
    add_warning(state, text);
}

int orl_run_need_emission(struct orl_run_state *state, struct orl_error *err)
{
    const enum orl_photon_use use = state->result->plan.technique == ORL_TECHNIQUE_BACKWARD
                                        ? ORL_PHOTONS_FOR_LAMPS
                                        : ORL_PHOTONS_FOR_MAPS;
    return state->emission ? 0
                           : orl_emission_new(state->world, use, state->job->seed, state->env->crew,
                                              &state->emission, err);
}
