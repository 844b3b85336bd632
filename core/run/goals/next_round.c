/* Decides what follows a round: by the job's goal, and within a deadline. */
#include "run/goals/rounds.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "run/estimate/round_cost.h"
#include "run/run_state.h"

/* Shares of the time left that a round fills, and that the last one fills. */
static const double fill = 0.7, last_fill = 0.93;
/* Multiples of the smallest round that must fit after a round. It is larger if views' rays follow
 * the samples, because that round is long and may take longer than estimated. */
static const double room = 1.075, room_of_views = 1.5;
/* Share of the deadline that is too short for a round; share by which exceeding it still counts as
 * kept. */
static const double too_short_share = 0.04, tolerance = 0.1;

/* Share for a first round that is expected to be the only one, before any measurement. */
static const double only_fill = 0.85;

double orl_deadline_first(const struct orl_work *work, double photons_s, double render_s,
                          double left_s)
{
    const double smallest = render_s + photons_s * work->least / ORL_DEFAULT_GATHER_SAMPLES;
    if (!orl_work_view_time_is_fixed(work) || 2 * smallest <= only_fill * left_s ||
        !(photons_s > 0))
        return work->least;
    const double samples = (only_fill * left_s - render_s) / photons_s * ORL_DEFAULT_GATHER_SAMPLES;
    return ORL_MAP_BATCHES * floor(fmin(fmax(samples, work->least), work->most) / ORL_MAP_BATCHES);
}

/* Returns the maximum samples of the next round. Views by maps begin with a quarter of the usual
 * photons. */
static double most_samples(const struct orl_throughput *throughput, const struct orl_work *work)
{
    const double growth = orl_work_view_time_is_fixed(work) ? 16 : 8;
    return growth * throughput->samples;
}

/*
 * Returns the number of rounds that fill a time. It is one, unless the largest possible round is
 * too short and more fit. It is also more if the next round would be the second of views whose rays
 * follow the samples: one round does not show how much of their time does.
 */
static double rounds_to_fill(const struct orl_throughput *throughput, const struct orl_work *work,
                             double seconds, double too_short_s)
{
    const double most = fmax(fmin(work->most, most_samples(throughput, work)), work->least);
    const bool unsure = work->ray_time_share > 0 && throughput->rounds < 2;
    const double longest = orl_throughput_round_s(throughput, work, most);
    const double rounds = fmax(ceil(seconds / longest), unsure ? 2 : 1);
    const bool fits = rounds * orl_throughput_round_s(throughput, work, work->least) <= seconds;
    return (unsure || seconds - longest > too_short_s) && fits ? rounds : 1;
}

struct orl_deadline_next orl_deadline_next(const struct orl_throughput *throughput,
                                           const struct orl_work *work, double deadline_s,
                                           double left_s)
{
    const double least = orl_throughput_round_s(throughput, work, work->least);
    const double margin = work->ray_time_share > 0 ? room_of_views : room;
    const double end = fmax(margin * least, too_short_share * deadline_s);
    struct orl_deadline_next next = {.step = ORL_DEADLINE_ROUND, .least_s = least};
    double seconds = fill * left_s;
    if (left_s < -tolerance * deadline_s)
        next.step = ORL_DEADLINE_TOO_LATE;
    else if (left_s < too_short_share * deadline_s)
        next.step = ORL_DEADLINE_USED_UP;
    else if (left_s < least)
        next.step = ORL_DEADLINE_NO_ROOM;
    if (next.step != ORL_DEADLINE_ROUND)
        return next;
    next.last = left_s - seconds < end;
    if (next.last) { /* or the first of several that together fill it */
        const double rounds =
            rounds_to_fill(throughput, work, last_fill * left_s, too_short_share * deadline_s);
        seconds = last_fill * left_s / rounds;
        next.last = rounds < 2;
    }
    next.samples = orl_throughput_samples(throughput, work, fmax(seconds, least),
                                          most_samples(throughput, work));
    return next;
}

double orl_deadline_left_s(double round_s, double until_s, double deadline_s)
{
    return until_s - round_s < too_short_share * deadline_s ? round_s : until_s;
}

/* Decides what follows a round: the size of the next one by the job's goal, and the remaining
 * work. */

/* A job ends early if it would need this multiple of the allowed work. */
static const double abandon_factor = 2;
/* For a goal of a DGP error. */
enum { LEAST_ROUNDS = 4 };

double orl_rounds_estimate_samples(const struct orl_rounds *r)
{
    const bool paths = orl_technique_facts(r->work.technique)->samples_paths;
    return r->planned > 0 ? r->planned * r->samples
                          : orl_goal_estimate_samples(&r->state->job->goal, paths, r->samples);
}

void orl_rounds_estimate(struct orl_rounds *r)
{
    struct orl_run_state *state = r->state;
    double *estimated = state->clock.cost_s;
    const double samples = r->samples, done = r->throughput.samples + samples;
    state->clock.after_s = 0;
    if (r->throughput.rounds > 0) {
        /* After its last progress report. */
        const double other_s_a_round = r->throughput.other_s / r->throughput.rounds;
        orl_throughput_stage_s(&r->throughput, &r->work, samples, estimated);
        estimated[ORL_STAGE_RENDER] -= other_s_a_round;
        state->clock.after_s = other_s_a_round;
        if (done < r->wanted)
            state->clock.after_s +=
                r->planned > 0
                    ? (r->wanted - done) / samples *
                          orl_throughput_round_s(&r->throughput, &r->work, samples)
                    : orl_throughput_remaining_s(&r->throughput, &r->work, done, r->wanted);
        return;
    }
    const double share = r->planned > 0 ? 1.0 / r->planned : samples / ORL_DEFAULT_GATHER_SAMPLES;
    const bool alike = r->work.of_views && !orl_technique_facts(r->work.technique)->samples_paths;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++) {
        estimated[i] = r->estimated_s[i] * (alike && i == ORL_STAGE_RENDER ? 1 : share);
        if (done < r->wanted)
            state->clock.after_s += estimated[i] * (r->wanted - done) / samples;
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
        end_rounds(r, false,
                   "the work limit of %.0f samples is reached at %.3g %%; for %.3g %%, average "
                   "several jobs with different seeds",
                   limit, 100 * r->error, 100 * target);
    else if (wanted > abandon_factor * limit && r->count > 1)
        end_rounds(
            r, false,
            "it would take the work of %.2g samples, but %.0f are allowed: ask for %.2g %% or more",
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
                   "%.2g is reached after %u rounds; %.2g would take the work of %.2g samples, but "
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
    const double left = r->state->clock.started_s + deadline - orl_rounds_now(r);
    const struct orl_deadline_next next =
        orl_deadline_next(&r->throughput, &r->work, deadline, left);
    const char *plural = r->count == 1 ? "" : "s";
    if (r->error <= 0) {
        end_rounds(r, true, "no further improvement is possible after %u round%s: the error is 0",
                   r->count, plural);
        return;
    }
    switch (next.step) {
    case ORL_DEADLINE_ROUND:
        r->samples = next.samples;
        if (next.last)
            r->state->clock.deadline_at_s = 0;
        break;
    case ORL_DEADLINE_USED_UP:
        end_rounds(r, true, "the time is used up: %u round%s took %.3g s of %.3g s", r->count,
                   plural, deadline - left, deadline);
        break;
    case ORL_DEADLINE_NO_ROOM:
        end_rounds(r, true,
                   "no other round fits: %u round%s took %.3g s of %.3g s, and one more takes %.2g "
                   "s; allow %.3g s, or use fewer pixels or sensors",
                   r->count, plural, deadline - left, deadline, next.least_s,
                   deadline - left + next.least_s);
        break;
    case ORL_DEADLINE_TOO_LATE:
        end_rounds(r, false,
                   r->count == 1 ? "%u round%s of the smallest size took %.3g s of %.3g s: use "
                                   "fewer pixels or sensors"
                                 : "%u round%s took %.3g s of %.3g s: the last round took longer "
                                   "than the earlier ones",
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
