/*
 * The stages of a run: plan, photon maps and their keys, rendering by a technique, and sensors
 * by a technique of their own.
 */
#ifndef ORL_RUN_STAGES_RUN_STAGES_H
#define ORL_RUN_STAGES_RUN_STAGES_H

#include "run/run_state.h"

/*
 * Keys of photon maps. A key is the digest of all that determines a map. A family is the digest of
 * all but the number of photons, so that the larger of two maps of one family contains the smaller.
 */

struct orl_map_name {
    char key[ORL_DIGEST_HEX + 1];
    char family[ORL_DIGEST_HEX + 1]; /* "" for precomputed irradiance, which is made as a whole */
};

/* Returns the name of the job's map of a kind, after its lit scene and plan are made. */
struct orl_map_name orl_run_map_name(const struct orl_run_state *state, enum orl_map_kind kind,
                                     uint64_t target);

/* Makes the key of the photon pilot of the job's emission. */
void orl_run_pilot_key(const struct orl_run_state *state, enum orl_photon_use use,
                       char ret_key[ORL_DIGEST_HEX + 1]);

/* The stages of a run: plan, photon maps, rendering by a technique. */

/* Creates state->renderer, the plan's technique for the lit scene, unless it exists; all rounds of
 * a job use it. If the technique traces photons in every round, their emission is created as well.
 */
int orl_run_ensure_renderer(struct orl_run_state *state, struct orl_error *err);

/* Photons and maps stages: loads every map that the job needs into state->maps, or makes it. */
int orl_run_prepare_maps(struct orl_run_state *state, struct orl_error *err);
void orl_run_release_maps(struct orl_run_state *state);

/* Returns the paths per pixel of a job without rounds, by backward. */
uint32_t orl_run_pixel_samples(const struct orl_run_state *state);
/* Returns the number of equal rounds that a job without a goal is divided into to estimate the
 * errors of its glare; 1: none. */
uint32_t orl_run_count_batches(const struct orl_run_state *state);

/* Plan stage: stores technique and effects in the result's plan, and makes state->lit_scene without
 * the plan's omissions. */
int orl_run_plan(struct orl_run_state *state, struct orl_error *err);

/* Returns the limit of emissions for photons to sensors in mid-air. */
uint64_t orl_run_sensor_flux_limit(const struct orl_run_state *state);

/* Runs the photons, maps and render stages by the plan's technique. */
int orl_run_technique(struct orl_run_state *state, struct orl_error *err);

/*
 * Sensors whose technique differs from the views' (orl_plan.sensor_technique) are rendered first.
 * Their run has its own plan and lit scene, of the same scene. The job's run then continues with
 * the views alone, and both results are joined.
 */

struct orl_sensor_run {
    bool is_separate;              /* false: sensors and views have the same technique */
    const struct orl_job *job;     /* the whole job */
    const struct orl_run_env *all; /* environment of the whole job */
    size_t n_sensors;              /* sensors of the whole job, while the state has none */
    struct orl_job views;          /* the job without its sensors */
    struct orl_run_env env;        /* for the views: their share of the run's progress */
    /* Result of the sensors; their values are moved to the state's result. */
    struct orl_result result;
    double seconds; /* time that the sensors took */
};

/* Runs the sensors if they have a technique of their own. The state's result then has their values,
 * and its job is that of the views until orl_sensor_run_join. */
int orl_sensor_run_start(struct orl_run_state *state, struct orl_sensor_run *ret_run,
                         struct orl_error *err);
/* Restores the whole job after the views are rendered, or after an error. Adds the time, health,
 * warnings and outcome of the sensors' run to the result. Frees the contents of *run. */
void orl_sensor_run_join(struct orl_run_state *state, struct orl_sensor_run *run);

/*
 * After the cross-check: renders sensors that differ from plain path tracing again, if the job
 * leaves the technique to the planner. The technique is the alternative of the sensors' own. The
 * result has the values of the one that leaves fewer sensors unreliable. first_warning: the number
 * of the result's warnings before its checks, which are dropped with the values that they are
 * about.
 */
int orl_sensor_run_retry(struct orl_run_state *state, size_t first_warning, struct orl_error *err);

/* Plans and renders a job's sensors with a given scene, without writing files. Defined in run.c,
 * for orl_run_state.run_sensors. */
int orl_run_only_sensors(const struct orl_job *job, const struct orl_run_env *env,
                         struct orl_scene *scene, struct orl_result *ret_result,
                         struct orl_error *err);

#endif
