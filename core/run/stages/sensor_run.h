/*
 * Sensors whose technique differs from the views' (orl_plan.sensor_technique) are rendered first.
 * Their run has its own plan and world, of the same scene. The job's run then continues with the
 * views alone, and both results are joined.
 */
#ifndef ORL_RUN_STAGES_SENSOR_RUN_H
#define ORL_RUN_STAGES_SENSOR_RUN_H

#include "run/run_state.h"

struct orl_sensor_run {
    bool is_separate;              /* false: sensors and views have the same technique */
    const struct orl_job *job;     /* the whole job */
    const struct orl_run_env *all; /* environment of the whole job */
    size_t n_sensors;              /* sensors of the whole job, while the state has none */
    struct orl_job views;          /* the job without its sensors */
    struct orl_run_env env;        /* for the views: their part of the run's progress */
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
 * leaves the technique to the planner. The technique is the other one of gather and backward. The
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
