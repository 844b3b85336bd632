/*
 * Sensors whose technique is not the views' (orl_plan.sensor_technique): they are rendered first,
 * by a run of their own with a plan and a world of their own, of the same scene. The job's run then
 * goes on with the views alone, and both results are joined.
 */
#ifndef ORL_RUN_SENSOR_RUN_H
#define ORL_RUN_SENSOR_RUN_H

#include "run/stages.h"

struct orl_sensor_run {
    bool made;                     /* false: sensors and views have the same technique */
    const struct orl_job *job;     /* the whole job, and its */
    const struct orl_run_env *all; /* environment; */
    size_t n_sensors;              /* while the state has those of the views */
    struct orl_job views;          /* the job without its sensors */
    struct orl_run_env env;        /* of the views: their part of the run's progress */
    struct orl_result result;      /* of the sensors; their values are in the state's result */
    double seconds;                /* that the sensors took */
};

/* Runs the sensors if they have a technique of their own; the state's result has their values then,
 * and its job is that of the views until orl_sensor_run_join. */
int orl_sensor_run_make(struct orl_run_state *state, struct orl_sensor_run *ret_run,
                        struct orl_error *err);
/* Once the views are rendered, or an error occurred: the state has the whole job again, and its
 * result the time, health, warnings and outcome of the sensors' run, too. Frees what is in *run. */
void orl_sensor_run_join(struct orl_run_state *state, struct orl_sensor_run *run);

/*
 * After the cross-check: sensors that differ from plain path tracing are rendered again by the
 * other of the techniques gather and backward, if the job leaves the technique to the planner. The
 * result has the values of the one that leaves fewer sensors unreliable. first_warning: the number
 * of the result's warnings before its checks, which are dropped with the values that they are
 * about.
 */
int orl_sensor_run_again(struct orl_run_state *state, size_t first_warning, struct orl_error *err);

/* In run.c, for orl_run_state.run_sensors: plans and renders a job's sensors, without writing
 * files. scene: the one to use. */
int orl_run_only_sensors(const struct orl_job *job, const struct orl_run_env *env,
                         struct orl_scene *scene, struct orl_result *ret_result,
                         struct orl_error *err);

#endif
