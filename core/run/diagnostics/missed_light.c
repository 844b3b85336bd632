/*
 * Light that the backward technique has missed. The technique is unbiased, but some suns are hit by
 * one path in a hundred thousand: those seen by a curved mirror, a lens, or mirrors that face very
 * many ways. With fewer samples the value lacks that light, and the error, which follows from what
 * was found, does not include it. Photons find such light easily. If the plan has such paths,
 * photons are traced past the sensors (render/gather/sensor_flux.h). Intervals are widened to
 * include the light that they carry. A warning names sensors that lack more than their intervals
 * allow, and gives the share of the light missing in views.
 */
#include <math.h>

#include <oriel/job/paths.h>

#include "base/sampling/sampling.h"
#include "photon/shooting/shoot.h"
#include "render/gather/sensor_flux.h"
#include "run/cache/emission_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/estimate/progress.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"
#include "run/stages/run_stages.h"

/* Seed salt: keeps these random streams distinct from those of maps. */
static const uint64_t unsampled_photons_salt = 0x6368616e6365;

/* Limits of emissions, and of rays while no sensor's estimate changes by more than its error. */
enum { MAX_EMISSIONS = 1 << 18, MAX_RAYS = 1 << 19 };

/* Number of hits from which light is in the value, and its scatter in the error. */
static const double enough_hits = 16;
/* Light counts as missed if it exceeds the sensor's interval by this many of its standard
 * errors. */
static const double certain = 3;
/* The 97.5th percentile of Student's t with the degrees of freedom of 16 batches. */
static const double bound_in_errors = 2.13;
/* It must also exceed this share of the sensor's light. For views, the share is weighted by the
 * brightness where the light lands. */
static const double tolerable = 2e-3, tolerable_of_view = 1e-3;

struct missed_light {
    size_t sensors, worst;
    double lx, share; /* lack of the worst sensor: illuminance, and share of its light */
};

static double brightest_sun(const struct orl_lit_scene *lit_scene)
{
    double most = 0;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        most = fmax(most, orl_luma(lit_scene->suns[i].radiance));
    return most;
}

static double brightest_lamp(const struct orl_lit_scene *lit_scene)
{
    double most = 0;
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        if (lit_scene->emitters[i].direct)
            most = fmax(most, orl_luma(lit_scene->emitters[i].most));
    return most;
}

/*
 * Returns the number of a sensor's paths, drawn by the cosine, that have hit this light. Light of
 * radiance L, attenuated or not, that causes an irradiance E fills at least E / L of a projected
 * solid angle of pi.
 */
static double count_hits(const struct orl_lit_scene *lit_scene, double of_suns, double of_lamps,
                         double samples)
{
    const double sun = brightest_sun(lit_scene), lamp = brightest_lamp(lit_scene);
    const double share = (sun > 0 ? of_suns / sun : 0) + (lamp > 0 ? of_lamps / lamp : 0);
    return samples * share / ORL_PI;
}

/* Widens the interval to the upper bound of the light that photons measured, if so few paths hit it
 * that their scatter does not show. It then includes the values with and without that light. */
static void widen_interval(double interval[2], double found_lx,
                           const struct orl_estimate *photon_estimate)
{
    const double most = orl_luma(photon_estimate->value) + fabs(photon_estimate->bias) +
                        photon_estimate->standard_error * bound_in_errors;
    interval[1] = fmax(interval[1], found_lx + ORL_EFFICACY_LM_PER_W * most);
}

static void diagnose_sensor(struct orl_run_state *state, const struct orl_sensor_flux *sensor_flux,
                            size_t i, struct missed_light *missed_light)
{
    struct orl_result *r = state->result;
    const double samples = state->samples > 0 ? state->samples : orl_run_sensor_samples(state, i);
    double lamps;
    const struct orl_estimate e = orl_sensor_flux_caustics(sensor_flux, i, &lamps);
    const double all = orl_luma(e.value), found = r->illuminance_lx[i];
    const double lx = ORL_EFFICACY_LM_PER_W * (all - fabs(e.bias));
    if (count_hits(state->lit_scene, all - lamps, lamps, samples) > enough_hits)
        return;
    const bool lacks = lx > certain * ORL_EFFICACY_LM_PER_W * e.standard_error &&
                       found + lx > r->interval_95_lx[i][1] && lx > tolerable * found;
    widen_interval(r->interval_95_lx[i], found, &e);
    if (!lacks)
        return;
    const double share = lx / (lx + found);
    orl_run_mark_unreliable(state, i, ORL_DOUBT_MISSED_LIGHT);
    missed_light->sensors++;
    if (share > missed_light->share)
        *missed_light =
            (struct missed_light){missed_light->sensors, i, ORL_EFFICACY_LM_PER_W * all, share};
}

static void add_sensors(const struct orl_run_state *state, struct orl_sensor_flux *sensor_flux)
{
    const struct orl_result *r = state->result;
    for (size_t i = 0; i < state->n_sensors; i++) {
        const struct orl_sensor *sensor = &state->sensors[i];
        const struct orl_shading_point place = {
            .point = orl_sub(sensor->position, state->lit_scene->geometry->center),
            .normal = orl_normalize(sensor->direction)};
        const struct orl_estimate rest = {
            .value = orl_gray(r->illuminance_lx[i] / ORL_EFFICACY_LM_PER_W),
            .standard_error = r->standard_error_lx[i] / ORL_EFFICACY_LM_PER_W};
        orl_sensor_flux_set_sensor(sensor_flux, i, &place, &rest);
    }
}

/* Returns the path classes that a technique without a caustic map finds only by chance. Returns 0
 * for techniques that read one. */
static uint32_t missed_by_paths(const struct orl_run_state *state)
{
    const struct orl_plan *plan = &state->result->plan;
    return orl_technique_facts(plan->technique)->reads_map[ORL_MAP_CAUSTIC]
               ? 0
               : orl_paths_missed(plan->technique, plan->paths);
}

static int diagnose_sensors(struct orl_run_state *state, const struct orl_shoot_env *env)
{
    const struct orl_sensor_flux_limits bounds = {MAX_EMISSIONS, MAX_RAYS};
    struct missed_light missed_light = {0};
    struct orl_sensor_flux *sensor_flux = NULL;
    char classes[ORL_PATH_CLASSES_TEXT];
    int code = orl_sensor_flux_new_unsampled(state->lit_scene, state->n_sensors, &sensor_flux);
    orl_path_classes_words(missed_by_paths(state), classes);
    if (code == 0) {
        add_sensors(state, sensor_flux);
        code = orl_sensor_flux_collect(sensor_flux, env, &bounds, &state->result->health);
    }
    for (size_t i = 0; i < state->n_sensors && code == 0; i++)
        diagnose_sensor(state, sensor_flux, i, &missed_light);
    orl_sensor_flux_free(sensor_flux);
    if (code == 0 && missed_light.sensors > 0)
        orl_run_warn(
            state,
            "%zu of %zu sensors lack light of %s, which the backward technique finds by chance "
            "only; sensors[%zu] lacks about %.3g lx, %.2g %% of its light. Intervals are widened "
            "to include it. Photons find this light: use technique gather, or let the plan choose",
            missed_light.sensors, state->n_sensors, classes, missed_light.worst, missed_light.lx,
            100 * missed_light.share);
    return code;
}

static int diagnose_views(struct orl_run_state *state, const struct orl_shoot_env *env,
                          struct orl_error *err)
{
    struct orl_photon_pilot pilot;
    char classes[ORL_PATH_CLASSES_TEXT];
    const int code = orl_photon_pilot_run(env, NULL, NULL, &pilot, err);
    orl_path_classes_words(missed_by_paths(state), classes);
    if (code == 0 && pilot.share * pilot.contrast > tolerable_of_view)
        orl_run_warn(state,
                     "views lack light of %s, which the backward technique finds by chance only; "
                     "this is %.2g %% of all light, and %.2g %% where it falls. Photons find this "
                     "light: use technique gather, or let the plan choose",
                     classes, 100 * pilot.share, 100 * pilot.contrast);
    return code;
}

int orl_run_diagnose_missed_light(struct orl_run_state *state, struct orl_error *err)
{
    if (missed_by_paths(state) == 0)
        return 0;
    int code = orl_run_ensure_emission(state, err);
    if (code < 0)
        return code;
    orl_run_begin_stage(state, ORL_STAGE_PHOTONS);
    const struct orl_shoot_env env = {.emission = state->emission,
                                      .seed = orl_mix64(state->job->seed ^ unsampled_photons_salt),
                                      .pool = state->env->pool,
                                      .cancel = state->env->cancel,
                                      .unsampled_only = true};
    if (state->n_sensors > 0)
        code = diagnose_sensors(state, &env);
    if (code < 0)
        return orl_error_set(err, code, "%s looking for light that paths miss",
                             code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    return state->job->n_views > 0 ? diagnose_views(state, &env, err) : 0;
}
