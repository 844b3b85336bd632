#include "run/rounds.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "run/cost.h"
#include "run/curve.h"
#include "run/deadline.h"
#include "run/findings.h"
#include "run/sample_allocation.h"

/* Its smallest rounds of sensors are so much smaller than others: they fill the end. */
static const double short_round = 0.25;
/* Samples of one sensor in a round. */
static const double most_of_a_sensor = 1 << 20;
/* Before anything is known of errors: what 95 % of an office's sensors are within, by backward or
 * by maps, and the samples that it takes. */
static const double usual_error[] = {0.04, 0.02}, usual_samples[] = {4096, 2048};
/* Work is given up when this much more than what is allowed would be needed. */
static const double hopeless = 2;
/* Of a job for an error of DGP. */
enum { LEAST_ROUNDS = 4 };

struct rounds {
    struct orl_run_state *state;
    struct orl_work work;
    struct orl_pace pace;
    struct orl_findings findings;
    double error;    /* of the whole, as it stands */
    double samples;  /* of the round that runs; the mean over sensors */
    double *shares;  /* and those of each sensor; NULL: as many for all */
    uint32_t *spans; /* the same in whole numbers, then those of rounds before */
    struct orl_sensor_round sensor_round;
    double bandwidths[ORL_MAP_KINDS]; /* of the round */
    uint32_t count;
    uint32_t planned;                  /* of a job in one piece; 0: until its goal is met */
    double wanted;                     /* samples in all, as it is thought; NaN: until a deadline */
    double guessed_s[ORL_STAGE_COUNT]; /* of a job in one piece, before the first round */
    bool ended;
};

static double now_s(const struct rounds *r)
{
    const struct orl_run_env *env = r->state->env;
    return env->now_s(env->ctx);
}

static double guess_wanted(const struct rounds *r)
{
    const struct orl_goal *goal = &r->state->job->goal;
    const bool backward = r->work.technique == ORL_TECHNIQUE_BACKWARD;
    const double times = usual_error[backward] / goal->relative_error;
    if (r->planned > 0)
        return r->planned * r->samples;
    if (goal->dgp_error > 0)
        return LEAST_ROUNDS * r->samples;
    return goal->deadline_s > 0 ? (double)NAN
                                : fmin(times * times * usual_samples[backward], orl_work_limit());
}

/* What the next round and those after it are going to take: into the state, for what is told. */
static void foresee(struct rounds *r)
{
    struct orl_run_state *state = r->state;
    double *foreseen = state->cost_s;
    const double samples = r->samples, done = r->pace.samples + samples;
    state->after_s = 0;
    if (r->pace.rounds > 0) {
        orl_pace_foresee(&r->pace, &r->work, samples, foreseen);
        if (done < r->wanted)
            state->after_s = r->planned > 0 ? (r->wanted - done) / samples *
                                                  orl_pace_round_s(&r->pace, &r->work, samples)
                                            : orl_pace_rest_s(&r->pace, &r->work, done, r->wanted);
        return;
    }
    const double share = r->planned > 0 ? 1.0 / r->planned : samples / ORL_DEFAULT_GATHER_SAMPLES;
    const bool alike = r->work.of_views && r->work.technique != ORL_TECHNIQUE_BACKWARD;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++) {
        foreseen[i] = r->guessed_s[i] * (alike && i == ORL_STAGE_RENDER ? 1 : share);
        if (done < r->wanted)
            state->after_s += foreseen[i] * (r->wanted - done) / samples;
    }
}

static int rounds_init(struct rounds *r, struct orl_run_state *state, struct orl_error *err)
{
    *r = (struct rounds){.state = state, .error = NAN};
    r->work = orl_work_of(state);
    if (state->job->goal.deadline_s > 0 && !r->work.of_views)
        r->work.least *= short_round;
    r->samples = r->work.least;
    if (!orl_goal_is_set(&state->job->goal)) {
        r->planned = orl_run_batches(state);
        r->samples = ceil((double)ORL_DEFAULT_GATHER_SAMPLES / r->planned);
    }
    if (r->work.technique == ORL_TECHNIQUE_BACKWARD) { /* once a job, not with every photon */
        int code = orl_run_need_emission(state, err);
        if (code == 0)
            code = orl_run_need_backward(state, err);
        if (code < 0)
            return code;
    }
    r->pace.before_s = now_s(r) - state->started_s;
    r->wanted = guess_wanted(r);
    memcpy(r->guessed_s, state->cost_s, sizeof r->guessed_s);
    if (r->work.shares) {
        const size_t n = state->n_sensors;
        double *groups = calloc(n * ORL_MAP_BATCHES + 1, sizeof *groups);
        r->shares = malloc((n + 1) * sizeof *r->shares);
        r->spans = calloc(2 * n + 1, sizeof *r->spans);
        r->sensor_round =
            (struct orl_sensor_round){state->job->seed, r->spans, r->spans + n, groups};
        if (!r->shares || !r->spans || !groups)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", n);
    }
    return orl_findings_init(&r->findings, state, r->work.shares, err);
}

static void rounds_done(struct rounds *r)
{
    orl_findings_done(&r->findings);
    free(r->shares);
    free(r->spans);
    free(r->sensor_round.groups);
}

static int take_film(void *ctx, size_t index, const struct orl_film *film, struct orl_error *err)
{
    struct rounds *r = ctx;
    return orl_findings_add_film(&r->findings, index, film, r->samples, err);
}

/* ---- A round --------------------------------------------------------------------------------- */

static bool is_known(const struct orl_result *result, const char *warning)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strcmp(result->warnings[i], warning) == 0)
            return true;
    return false;
}

/* What the round's own result holds beside values. */
static void take_records(struct rounds *r, struct orl_result *found_by)
{
    struct orl_result *result = r->state->result;
    for (size_t i = 0; i < found_by->n_warnings; i++)
        if (!is_known(result, found_by->warnings[i]))
            orl_run_warn(r->state, "%s", found_by->warnings[i]);
    for (size_t i = 0; i < found_by->n_views; i++)
        result->views[i].seconds += found_by->views[i].seconds;
    if (r->count == 0) {
        memcpy(result->maps, found_by->maps, sizeof result->maps);
        result->n_maps = found_by->n_maps;
    }
}

/* What a round took, whatever became of it. */
static void take_spent(struct rounds *r, const struct orl_result *spent)
{
    struct orl_result *result = r->state->result;
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        result->timings_s[i] += spent->timings_s[i];
    orl_health_add(&result->health, &spent->health);
}

static void take_times(struct rounds *r, const struct orl_result *found_by, double all_s)
{
    const double photon_s =
        found_by->timings_s[ORL_STAGE_PHOTONS] + found_by->timings_s[ORL_STAGE_MAPS];
    const double render_s = found_by->timings_s[ORL_STAGE_RENDER];
    const struct orl_plan *plan = &found_by->plan;
    r->pace.photons += (double)(plan->photons_global + plan->photons_caustic);
    r->pace.photon_s += photon_s;
    for (size_t i = 0; i < found_by->n_maps; i++) /* what other rounds will have to take */
        r->pace.photon_s += found_by->maps[i].earlier_s;
    r->pace.samples += r->samples;
    r->state->samples = r->pace.samples;
    r->pace.render_s += render_s;
    r->pace.beside_s += fmax(all_s - photon_s - render_s, 0);
    r->pace.rounds++;
}

/* Samples of every sensor, from what is known of their noise; all alike in the first round. */
static void share_out(struct rounds *r)
{
    const double least = ORL_MAP_BATCHES; /* a sample of every group */
    const size_t n = r->state->n_sensors;
    double sum = 0;
    if (!r->shares)
        return;
    if (r->count > 0)
        orl_allocate_samples(&r->findings.estimates[0], r->samples, r->shares);
    for (size_t i = 0; i < n; i++) {
        const double wanted = r->count > 0 ? r->shares[i] : r->samples;
        const double samples = least * fmax(round(wanted / least), 1);
        r->spans[n + i] += r->count > 0 ? r->spans[i] : 0;
        r->spans[i] = (uint32_t)fmin(samples, most_of_a_sensor);
        r->shares[i] = r->spans[i];
        sum += r->shares[i];
    }
    r->samples = sum / (double)n;
}

/* One of so many shares of samples that differ by one at the most. */
static uint32_t share_of(uint32_t samples, uint32_t index, uint32_t shares)
{
    return samples / shares + (index < samples % shares);
}

/* The run's state as a round sees it: the same world, but a job, a plan and a result of its own. */
static void make_round(struct rounds *r, struct orl_job *job, struct orl_run_env *env,
                       struct orl_result *result, struct orl_run_state *ret_round)
{
    const struct orl_run_state *state = r->state;
    *job = *state->job;
    if (r->count > 0)
        job->seed = orl_mix64(job->seed ^ orl_mix64(r->count));
    job->gather_samples = (uint32_t)r->samples;
    job->pixel_samples = orl_work_pixel_samples(r->samples);
    if (r->planned > 0) {
        const uint32_t asked = state->job->gather_samples;
        job->gather_samples = (asked ? asked : ORL_DEFAULT_GATHER_SAMPLES) / r->planned;
        job->gather_samples += job->gather_samples == 0;
        job->pixel_samples = share_of(orl_run_pixel_samples(state), r->count, r->planned);
    }
    *result = (struct orl_result){.plan = state->result->plan};
    result->plan.photons_global = orl_work_photons(&r->work, ORL_MAP_GLOBAL, r->samples);
    result->plan.photons_caustic = orl_work_photons(&r->work, ORL_MAP_CAUSTIC, r->samples);
    *env = *state->env;
    env->map_ready = r->count == 0 ? env->map_ready : NULL;
    *ret_round = *state;
    ret_round->job = job;
    ret_round->env = env;
    ret_round->result = result;
    orl_work_bandwidths(r->samples, r->pace.samples, r->bandwidths);
    ret_round->bandwidths = r->bandwidths;
    ret_round->sensor_round = r->shares ? &r->sensor_round : NULL;
    ret_round->take_film = take_film;
    ret_round->take_ctx = r;
    ret_round->stage_started = state->env->now_s(state->env->ctx);
    for (uint32_t i = 0; i < orl_crew_size(env->crew); i++)
        memset(&state->searches[i].health, 0, sizeof state->searches[i].health);
}

/* Maps of all rounds but the first are of no use to other jobs: they go when the round is over. */
static void keep_maps_apart(struct orl_run_env *env, struct orl_folder_store *folder,
                            struct orl_map_store *store)
{
    snprintf(folder->folder, sizeof folder->folder, "%s", env->output_folder);
    *store = orl_map_store_in_folder(folder);
    store->release = store->abandon;
    env->store = store;
}

static int run_round(struct rounds *r, struct orl_error *err)
{
    struct orl_run_state *state = r->state, round;
    struct orl_folder_store folder;
    struct orl_map_store store;
    struct orl_run_env env;
    struct orl_result result;
    struct orl_job job;
    const double started = now_s(r);
    share_out(r);
    make_round(r, &job, &env, &result, &round);
    if (r->count > 0 && env.store)
        keep_maps_apart(&env, &folder, &store);
    int code = orl_run_technique(&round, err);
    if (code == 0)
        orl_run_enter(&round, ORL_STAGE_RENDER); /* books what is left of it */
    orl_run_release_maps(&round);
    state->emission = round.emission;
    take_spent(r, &result);
    if (code == 0) {
        orl_findings_add_sensors(&r->findings, &round, r->samples, r->shares,
                                 r->sensor_round.groups);
        take_records(r, &result);
        take_times(r, &result, now_s(r) - started);
        r->count++;
    }
    state->stage = ORL_STAGE_RENDER;
    state->stage_started = now_s(r);
    free(round.rays);
    orl_result_done(&result);
    return code;
}

/* ---- What comes next ---------------------------------------------------------------------------
 */

static void end(struct rounds *r, bool met, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static void end(struct rounds *r, bool met, const char *format, ...)
{
    struct orl_outcome *outcome = &r->state->result->outcome;
    va_list args;
    va_start(args, format);
    vsnprintf(outcome->why, sizeof outcome->why, format, args);
    va_end(args);
    outcome->met = met;
    r->ended = true;
}

/* After a round of a job for an accuracy: how large is the next one, if any. */
static void go_on_for_error(struct rounds *r, const struct orl_parts *parts)
{
    const double target = r->state->job->goal.relative_error, done = r->pace.samples;
    const double limit = orl_work_limit();
    if (isnan(r->error)) {
        r->samples = r->work.least; /* two rounds have a spread */
        return;
    }
    if (r->error <= target) {
        end(r, true, "%.3g %% is reached after %u round%s", 100 * r->error, r->count,
            r->count == 1 ? "" : "s");
        return;
    }
    const double wanted = done * orl_parts_work(parts, target);
    if (done >= limit)
        end(r, false,
            "the limit of %.0f samples' worth of work is reached at %.3g %%; %.3g %% may be had "
            "by several jobs of other seeds, averaged",
            limit, 100 * r->error, 100 * target);
    else if (wanted > hopeless * limit && r->count > 1)
        end(r, false,
            "it would take %.2g samples' worth of work, %.0f are allowed: ask for %.2g %% or more",
            wanted, limit, 100 * r->error * sqrt(done / limit) * 1.2);
    else
        r->samples = orl_work_next(&r->work, done, wanted);
    r->wanted = fmin(wanted, limit);
}

/* Half the widest interval of DGP of a view that asks for metrics; NaN: not known. */
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

/* After a round of a job for an error of DGP. Rounds are equal until there are as many as batches
 * are kept apart; then pairs of these are one, and rounds are as large as they. */
static void go_on_for_dgp(struct rounds *r)
{
    const double target = r->state->job->goal.dgp_error, limit = orl_work_limit();
    const double found = dgp_error(r->state), done = r->pace.samples;
    r->state->result->outcome.achieved = found;
    const double wanted = done * (found / target) * (found / target);
    if (r->count >= LEAST_ROUNDS && found <= target)
        end(r, true, "%.2g is reached after %u rounds", found, r->count);
    else if (done >= limit || (r->count >= LEAST_ROUNDS && wanted > hopeless * limit))
        end(r, false,
            "%.2g is reached after %u rounds; %.2g would take %.2g samples' worth of work, "
            "%.0f are allowed",
            found, r->count, target, wanted, limit);
    while (!r->ended && done >= ORL_VIEW_BATCHES * r->samples)
        r->samples *= 2;
    r->wanted = fmin(fmax(wanted, done + r->samples), limit);
    if (r->count < LEAST_ROUNDS)
        r->wanted = fmax(r->wanted, LEAST_ROUNDS * r->samples);
}

/* After a round of a job for a deadline. */
static void go_on_for_time(struct rounds *r)
{
    const double deadline = r->state->job->goal.deadline_s;
    const double left = r->state->started_s + deadline - now_s(r);
    const struct orl_deadline_next next = orl_deadline_next(&r->pace, &r->work, deadline, left);
    const char *plural = r->count == 1 ? "" : "s";
    if (r->error <= 0) {
        end(r, true, "nothing is left to gain after %u round%s: no error is left", r->count,
            plural);
        return;
    }
    switch (next.step) {
    case ORL_DEADLINE_ROUND:
        r->samples = next.samples;
        if (next.last)
            r->state->ends_s = 0;
        break;
    case ORL_DEADLINE_USED_UP:
        end(r, true, "the time is used up: %u round%s took %.3g s of %.3g s", r->count, plural,
            deadline - left, deadline);
        break;
    case ORL_DEADLINE_NO_ROOM:
        end(r, true,
            "no other round fits: %u round%s took %.3g s of %.3g s, and one more takes %.2g s; "
            "%.3g s hold it, or fewer pixels or sensors make it shorter",
            r->count, plural, deadline - left, deadline, next.least_s,
            deadline - left + next.least_s);
        break;
    case ORL_DEADLINE_TOO_LATE:
        end(r, false,
            r->count == 1 ? "%u round%s, the smallest there is, took %.3g s of %.3g s: fewer "
                            "pixels or sensors are quicker"
                          : "%u round%s took %.3g s of %.3g s: the last one took longer than "
                            "those before",
            r->count, plural, deadline - left, deadline);
        break;
    }
}

/* As of a job in one piece, which this is for all that others know. */
static int tell_of_views(struct orl_run_state *state)
{
    const struct orl_run_env *env = state->env;
    if (state->n_sensors > 0 && env->sensors_done)
        env->sensors_done(env->ctx, state->result);
    for (size_t i = 0; i < state->job->n_views && env->view_written; i++)
        env->view_written(env->ctx, i, &state->result->views[i]);
    return 0;
}

/* One more point of how the error fell. */
static void note_course(struct orl_outcome *outcome, double seconds)
{
    if (!isfinite(outcome->achieved))
        return;
    if (outcome->n_course == ORL_COURSE) {
        outcome->n_course = ORL_COURSE / 2;
        for (size_t i = 1; i < outcome->n_course; i++)
            outcome->course[i] = outcome->course[2 * i];
    }
    outcome->course[outcome->n_course].seconds = seconds;
    outcome->course[outcome->n_course++].error = outcome->achieved;
}

/* A round of a pilot: as small as the first, and what the whole job would take by it. */
static void settle_pilot(struct rounds *r, const struct orl_work *usual,
                         const struct orl_parts *parts)
{
    const struct orl_pilot *pilot = r->state->pilot;
    struct orl_pace pace = r->pace;
    double views_s = 0;
    for (size_t i = 0; i < r->state->result->n_views; i++)
        views_s += r->state->result->views[i].seconds;
    pace.render_s =
        fmax(pace.render_s - views_s, 0) * pilot->sensor_times + views_s * pilot->view_times;
    r->ended = r->count >= ORL_PILOT_ROUNDS;
    r->samples = r->work.least;
    orl_run_predict(r->state, &pace, usual, parts);
    orl_run_draw_curve(r->state, &pace, usual, parts, pilot->curve);
    foresee(r);
}

/* The outcome so far, and what comes next. */
static int settle(struct rounds *r, struct orl_error *err)
{
    struct orl_run_state *state = r->state;
    struct orl_result *result = state->result;
    const struct orl_parts parts = {r->findings.estimates, r->findings.n_parts,
                                    state->job->goal.at};
    const struct orl_work usual = orl_work_of(state);
    const double started = now_s(r);
    r->ended = r->planned > 0 && r->count >= r->planned;
    if (r->planned > 0 && !r->ended) {
        foresee(r);
        return 0;
    }
    orl_findings_judge(&r->findings);
    r->error = orl_parts_error(&parts);
    if (r->planned == 0) {
        result->outcome.rounds = r->count;
        result->outcome.achieved = r->error;
    }
    if (state->pilot) {
        settle_pilot(r, &usual, &parts);
        return 0;
    }
    orl_run_predict(state, &r->pace, &usual, &parts);
    const int code = orl_findings_show(&r->findings, state, err);
    r->pace.beside_s += now_s(r) - started;
    if (r->planned > 0)
        return code == 0 ? tell_of_views(state) : code;
    if (state->job->goal.deadline_s > 0)
        go_on_for_time(r);
    else if (state->job->goal.dgp_error > 0)
        go_on_for_dgp(r);
    else
        go_on_for_error(r, &parts);
    foresee(r);
    result->total_s = now_s(r) - state->started_s;
    note_course(&result->outcome, result->total_s);
    if (code == 0 && state->env->round_ready)
        state->env->round_ready(state->env->ctx, result);
    return code;
}

static void show_views_at_last(struct rounds *r)
{
    const struct orl_run_env *env = r->state->env;
    for (size_t i = 0; i < r->state->job->n_views && env->view_ready; i++) {
        const struct orl_film *film = &r->findings.parts[r->findings.first_view + i].film;
        env->view_ready(env->ctx, i, film->pixels,
                        orl_film_knows_errors(film) ? film->errors : NULL,
                        (size_t)film->width * film->height);
    }
}

int orl_run_rounds(struct orl_run_state *state, struct orl_error *err)
{
    struct rounds r;
    orl_run_enter(state, ORL_STAGE_PHOTONS);
    int code = rounds_init(&r, state, err);
    foresee(&r);
    state->result->outcome =
        (struct orl_outcome){.asked = r.planned == 0, .goal = state->job->goal, .achieved = NAN};
    while (code == 0 && !r.ended) {
        orl_run_enter(state, ORL_STAGE_PHOTONS);
        code = run_round(&r, err);
        if (code == 0)
            code = settle(&r, err);
    }
    if (code == 0)
        show_views_at_last(&r);
    rounds_done(&r);
    return code;
}
