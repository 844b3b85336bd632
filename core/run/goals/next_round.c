/* Decides what follows a round: the size of the next one by the job's goal, and the remaining
 * work. */
#include "run/goals/next_round.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "run/estimate/goal_samples.h"
#include "run/goals/deadline.h"
#include "run/run_state.h"

/* A job ends early if it would need this multiple of the allowed work. */
static const double abandon_factor = 2;
/* For a goal of a DGP error. */
enum { LEAST_ROUNDS = 4 };

double orl_rounds_estimate_samples(const struct orl_rounds *r)
{
    const bool backward = r->work.technique == ORL_TECHNIQUE_BACKWARD;
    return r->planned > 0 ? r->planned * r->samples
                          : orl_goal_estimate_samples(&r->state->job->goal, backward, r->samples);
}

void orl_rounds_estimate(struct orl_rounds *r)
{
    struct orl_run_state *state = r->state;
    double *estimated = state->cost_s;
    const double samples = r->samples, done = r->throughput.samples + samples;
    state->after_s = 0;
    if (r->throughput.rounds > 0) {
        /* After its last progress report. */
        const double other_s_a_round = r->throughput.other_s / r->throughput.rounds;
        orl_throughput_stage_s(&r->throughput, &r->work, samples, estimated);
        estimated[ORL_STAGE_RENDER] -= other_s_a_round;
        state->after_s = other_s_a_round;
        if (done < r->wanted)
            state->after_s +=
                r->planned > 0
                    ? (r->wanted - done) / samples *
                          orl_throughput_round_s(&r->throughput, &r->work, samples)
                    : orl_throughput_remaining_s(&r->throughput, &r->work, done, r->wanted);
        return;
    }
    const double share = r->planned > 0 ? 1.0 / r->planned : samples / ORL_DEFAULT_GATHER_SAMPLES;
    const bool alike = r->work.of_views && r->work.technique != ORL_TECHNIQUE_BACKWARD;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++) {
        estimated[i] = r->estimated_s[i] * (alike && i == ORL_STAGE_RENDER ? 1 : share);
        if (done < r->wanted)
            state->after_s += estimated[i] * (r->wanted - done) / samples;
    }
}

static void end_rounds(struct orl_rounds *r, bool met, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void end_rounds(struct orl_rounds *r, bool met, const char *format, ...)
{
    struct orl_outcome *outcome = &r->state->result->outcome;
    va_list args;
    va_start(args, format);
    vsnprintf(outcome->why, sizeof outcome->why, format, args);
    va_end(args);
    outcome->met = met;
    r->ended = true;
}

/* Handles the end of a round of a job for an accuracy. */
static void plan_for_error(struct orl_rounds *r, const struct orl_output_estimates *outputs)
{
    const double target = r->state->job->goal.relative_error, done = r->throughput.samples;
    const double limit = orl_work_limit();
    if (isnan(r->error)) {
        r->samples = r->work.least; /* two rounds have a spread */
        return;
    }
    if (r->error <= target) {
        end_rounds(r, true, "%.3g %% is reached after %u round%s", 100 * r->error, r->count,
                   r->count == 1 ? "" : "s");
        return;
    }
    const double wanted = done * orl_output_estimates_work(outputs, target);
    if (done >= limit)
        end_rounds(
            r, false,
            "the limit of %.0f samples' worth of work is reached at %.3g %%; %.3g %% may be had "
            "by several jobs of other seeds, averaged",
            limit, 100 * r->error, 100 * target);
    else if (wanted > abandon_factor * limit && r->count > 1)
        end_rounds(
            r, false,
            "it would take %.2g samples' worth of work, %.0f are allowed: ask for %.2g %% or more",
            wanted, limit, 100 * r->error * sqrt(done / limit) * 1.2);
    else
        r->samples = orl_work_next(&r->work, done, wanted);
    r->wanted = fmin(wanted, limit);
}

/* Returns half the widest DGP interval of the views with metrics; NaN if unknown. */
static double dgp_error(const struct orl_run_state *state)
{
    double widest = 0;
    for (size_t i = 0; i < state->result->n_views; i++) {
        const struct orl_glare *glare = state->result->views[i].glare;
        if (!glare)
            continue;
        const double *interval = glare->values[ORL_GLARE_DGP].interval_95;
        const double half = (interval[1] - interval[0]) / 2;
        if (isnan(half))
            return NAN;
        widest = fmax(widest, half);
    }
    return widest;
}

/* Handles the end of a round of a job for a DGP error. Rounds are equal until there are as many as
 * batches are kept. Pairs of batches are then merged, and rounds grow to that size. */
static void plan_for_dgp(struct orl_rounds *r)
{
    const double target = r->state->job->goal.dgp_error, limit = orl_work_limit();
    const double found = dgp_error(r->state), done = r->throughput.samples;
    r->state->result->outcome.achieved = found;
    const double wanted = done * (found / target) * (found / target);
    if (r->count >= LEAST_ROUNDS && found <= target)
        end_rounds(r, true, "%.2g is reached after %u rounds", found, r->count);
    else if (done >= limit || (r->count >= LEAST_ROUNDS && wanted > abandon_factor * limit))
        end_rounds(r, false,
                   "%.2g is reached after %u rounds; %.2g would take %.2g samples' worth of work, "
                   "%.0f are allowed",
                   found, r->count, target, wanted, limit);
    while (!r->ended && done >= ORL_VIEW_BATCHES * r->samples)
        r->samples *= 2;
    r->wanted = fmin(fmax(wanted, done + r->samples), limit);
    if (r->count < LEAST_ROUNDS)
        r->wanted = fmax(r->wanted, LEAST_ROUNDS * r->samples);
}

/* Handles the end of a round of a job for a deadline. */
static void plan_for_deadline(struct orl_rounds *r)
{
    const double deadline = r->state->job->goal.deadline_s;
    const double left = r->state->started_s + deadline - orl_rounds_now(r);
    const struct orl_deadline_next next =
        orl_deadline_next(&r->throughput, &r->work, deadline, left);
    const char *plural = r->count == 1 ? "" : "s";
    if (r->error <= 0) {
        end_rounds(r, true, "nothing is left to gain after %u round%s: no error is left", r->count,
                   plural);
        return;
    }
    switch (next.step) {
    case ORL_DEADLINE_ROUND:
        r->samples = next.samples;
        if (next.last)
            r->state->deadline_at_s = 0;
        break;
    case ORL_DEADLINE_USED_UP:
        end_rounds(r, true, "the time is used up: %u round%s took %.3g s of %.3g s", r->count,
                   plural, deadline - left, deadline);
        break;
    case ORL_DEADLINE_NO_ROOM:
        end_rounds(
            r, true,
            "no other round fits: %u round%s took %.3g s of %.3g s, and one more takes %.2g s; "
            "%.3g s hold it, or fewer pixels or sensors make it shorter",
            r->count, plural, deadline - left, deadline, next.least_s,
            deadline - left + next.least_s);
        break;
    case ORL_DEADLINE_TOO_LATE:
        end_rounds(r, false,
                   r->count == 1
                       ? "%u round%s, the smallest there is, took %.3g s of %.3g s: fewer "
                         "pixels or sensors are quicker"
                       : "%u round%s took %.3g s of %.3g s: the last one took longer than "
                         "those before",
                   r->count, plural, deadline - left, deadline);
        break;
    }
}

void orl_rounds_plan_next(struct orl_rounds *r, const struct orl_output_estimates *outputs)
{
    const struct orl_goal *goal = &r->state->job->goal;
    if (goal->deadline_s > 0)
        plan_for_deadline(r);
    else if (goal->dgp_error > 0)
        plan_for_dgp(r);
    else
        plan_for_error(r, outputs);
}
