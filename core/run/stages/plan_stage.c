/*
 * The plan stage: stores the planner's findings in the result, and predicts the time by the
 * photon pilot. Warns of requests against the planner's advice.
 */
#include <math.h>
#include <stdlib.h>

#include "plan/plan.h"
#include "render/technique/technique.h"
#include "run/cache/emission_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

/* Largest effect of an omission that causes no warning. */
static const double tolerable_lx = 0.01, tolerable_share = 1e-3;

static void warn_of_skip(struct orl_run_state *state, const char *name,
                         const struct orl_decision *d)
{
    if (d->simulated)
        orl_run_warn(state, "%s cannot be skipped: %s", name, d->why);
    else if (d->unit == ORL_BOUND_LX && d->bound > tolerable_lx)
        orl_run_warn(state, "skipping %s may cost up to %.3g lx, as asked", name, d->bound);
    else if (d->unit == ORL_BOUND_RELATIVE && d->bound > tolerable_share)
        orl_run_warn(state, "skipping %s may cost up to %.3g %% of the light, as asked", name,
                     100 * d->bound);
}

/* Warns if the scene has no light left. */
static void warn_of_no_light(struct orl_run_state *state)
{
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    if (lit_scene->n_suns + lit_scene->n_domes + lit_scene->n_emitters == 0)
        orl_run_warn(state,
                     "no light: the simulated suns, skies and lamps give less than %g lx: "
                     "everything is black",
                     tolerable_lx);
}

/* Warns if caustic photons are so rare that the requested number would take very long, or was
 * reduced. */
static void warn_of_budget(struct orl_run_state *state, const struct orl_plan *plan)
{
    const double many_times = 4;
    const struct orl_photon_forecast *f = &plan->forecast;
    const uint64_t asked = state->job->photons_caustic;
    if (asked != ORL_PHOTONS_BY_PLAN && asked > plan->photons_caustic && plan->photons_caustic > 0)
        orl_run_warn(state,
                     "of %llu requested caustic photons %llu are traced: all would take %.2g times "
                     "as long, and caustics are %.2g %% of the light; to trace all, set \"exact\": "
                     "true beside photons.caustic",
                     (unsigned long long)asked, (unsigned long long)plan->photons_caustic,
                     (double)asked / (double)plan->photons_caustic, 100 * f->caustic_share);
    if (!f->known || !((double)plan->photons_caustic > many_times * (double)f->enough_caustic) ||
        !(f->emitted[1] > many_times * f->emitted[0]))
        return;
    orl_run_warn(state,
                 "%llu caustic photons take about %.2g million emissions, but %llu of them are "
                 "enough: leave out photons.caustic to let the plan choose",
                 (unsigned long long)plan->photons_caustic, 1e-6 * f->emitted[1],
                 (unsigned long long)f->enough_caustic);
}

/* Runs a photon pilot if it can change a decision. Runs that request few caustic photons, or an
 * exact number, or need none, do without. */
static int run_photon_pilot(struct orl_run_state *state, struct orl_plan *plan,
                            struct orl_error *err)
{
    const bool decides =
        plan->photons_caustic > 0 && (state->job->photons_caustic == ORL_PHOTONS_BY_PLAN ||
                                      orl_plan_bounds_caustics(state->job));
    struct orl_photon_pilot pilot;
    if (!decides && state->mode != ORL_RUN_PLAN)
        return 0;
    const int code = orl_run_photon_pilot(state, &pilot, err);
    if (code < 0)
        return code;
    orl_plan_budget(state->job, &pilot, plan);
    warn_of_budget(state, plan);
    return 0;
}

static void warn_once(void *ctx, const char *text)
{
    orl_run_warn_once(ctx, "%s", text);
}

/* Checks the sensors of each grid, or all sensors of a job without grids. */
static int check_spaces(struct orl_run_state *state)
{
    const struct orl_result *result = state->result;
    const size_t n = result->n_grids > 0 ? result->n_grids : 1;
    struct orl_sensor_range *const ranges = malloc(n * sizeof *ranges);
    if (!ranges)
        return ORL_ERR_NOMEM;
    ranges[0] = (struct orl_sensor_range){NULL, 0, state->n_sensors};
    for (size_t i = 0; i < result->n_grids; i++)
        ranges[i] = (struct orl_sensor_range){result->grids[i].name, result->grids[i].first,
                                              result->grids[i].count};
    struct orl_sensor_check check = {.scene = state->lit_scene->scene,
                                     .sensors = state->sensors,
                                     .ranges = ranges,
                                     .n_ranges = n,
                                     .pool = state->env->pool,
                                     .warn = warn_once,
                                     .ctx = state};
    const int code = orl_run_check_sensor_spaces(&check);
    free(ranges);
    return code;
}

static int check_sensors(struct orl_run_state *state, struct orl_error *err)
{
    char text[480];
    if (orl_run_describe_sensors_in_planes(state->lit_scene->scene, state->sensors,
                                           state->n_sensors, state->env->pool, text, sizeof text))
        orl_run_warn_once(state, "%s", text);
    const int code = check_spaces(state);
    if (code < 0)
        orl_error_set(err, code, "%s while checking the sensors",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    return code;
}

/* Returns an upper bound of the time for photons to sensors in mid-air; their number is only known
 * at run time. */
static double sensor_flux_limit_s(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    const struct orl_photon_forecast *f = &plan->forecast;
    if (state->n_sensors == 0 || !(f->emitted[1] > 0) ||
        !orl_sensor_flux_may_exist(state->lit_scene))
        return 0;
    return (double)orl_run_sensor_flux_limit(state) * f->seconds[1] / f->emitted[1];
}

/*
 * Predicts the time of the whole job, into the forecast of its plan. It stays unknown for pixels
 * and paths, and for photons if a pilot found too few. It is also unknown if the early end of
 * photons to sensors in mid-air makes too large a difference.
 */
static void orl_run_estimate_from_pilot(struct orl_run_state *state)
{
    const double max_ratio = 3.5;
    struct orl_plan *plan = &state->result->plan;
    struct orl_photon_forecast *f = &plan->forecast;
    const bool gathers =
        orl_technique_facts(plan->technique)->final_gather == ORL_GATHER_EVERYWHERE;
    const bool known =
        f->known && gathers && state->job->n_views == 0 && !orl_goal_is_set(&state->job->goal);
    double least = known ? state->env->now_s(state->env->ctx) - state->clock.started_s : NAN;
    for (int i = ORL_STAGE_PHOTONS; i < ORL_STAGE_COUNT; i++)
        least += state->clock.cost_s[i];
    const double most = least + sensor_flux_limit_s(state);
    f->job_s = most <= max_ratio * least ? sqrt(least * most) : NAN;
    if (isfinite(f->job_s) && !orl_run_is_measured(state))
        state->clock.cost_s[ORL_STAGE_RENDER] += f->job_s - least;
}

int orl_run_plan(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_plan_request request = {.job = state->job,
                                             .sensors = state->sensors,
                                             .n_sensors = state->n_sensors,
                                             .pool = state->env->pool,
                                             .now_s = state->env->now_s,
                                             .ctx = state->env->ctx};
    struct orl_plan *plan = &state->result->plan;
    int code = orl_plan_make(&request, state->lights, plan, &state->lit_scene, err);
    if (code == 0)
        code = run_photon_pilot(state, plan, err);
    for (int i = 0; i < ORL_EFFECT_COUNT && code == 0; i++)
        if (plan->effects[i].override == ORL_OVERRIDE_SKIP)
            warn_of_skip(state, orl_effect_name((enum orl_effect)i), &plan->effects[i]);
    if (code == 0) {
        warn_of_no_light(state);
        orl_run_diagnose_views(state);
        if (state->mode != ORL_RUN_SENSORS) /* the whole job checks their places */
            code = check_sensors(state, err);
    }
    orl_run_estimate_stages(state);
    if (code == 0 && plan->forecast.made)
        orl_run_estimate_from_pilot(state);
    if (code == 0 && state->env->plan_ready)
        state->env->plan_ready(state->env->ctx, plan);
    return code;
}
