/* Warnings in a run's result, and the checks of scene, sensors and results that add them. */
#ifndef ORL_RUN_DIAGNOSTICS_DIAGNOSTICS_H
#define ORL_RUN_DIAGNOSTICS_DIAGNOSTICS_H

#include <oriel/job/run.h>

#include "run/run_state.h"
#include "scene/built/scene.h"

/* Adds a warning to the run's result. */
void orl_run_warn(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Warns unless the result already has the same warning, such as from an earlier round. */
void orl_run_warn_once(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Checks of the places of sensors: in the plane of a surface, in a solid, outdoors. */

/* Describes sensors in the plane of a surface that they do not face: how many, the first of them,
 * that surface, and what to do. Returns false if there are none, or if cancelled. */
bool orl_run_describe_sensors_in_planes(const struct orl_scene *scene,
                                        const struct orl_sensor *sensors, size_t n,
                                        const struct orl_thread_pool *pool, char *ret_text,
                                        size_t size);

/* Sensors that belong together; name: NULL for a job without grids. */
struct orl_sensor_range {
    const char *name;
    size_t first, count;
};
/* A check for sensors outdoors, in solids or in other rooms than most of their range, and for
 * sensors below floors. */
struct orl_sensor_check {
    const struct orl_scene *scene;
    const struct orl_sensor *sensors;
    const struct orl_sensor_range *ranges;
    size_t n_ranges;
    struct orl_thread_pool *pool;
    /* Called at most 20 times with the numbers of such sensors. Called once more with the names of
     * ranges that are not checked in full because the limit of rays was reached. */
    void (*warn)(void *ctx, const char *text);
    void *ctx;
    /* Limit for the searches, besides some for each range and sensor; 0: the default. */
    uint64_t most_rays;
    uint64_t rays; /* out: rays traced by the searches */
};
/* Runs the check. The warnings do not depend on the size of the thread pool. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_run_check_sensor_spaces(struct orl_sensor_check *check);

/* Checks of a run's scene and results, which add warnings to the result. */

/* Adds the faults of the scene's files to the result's health. */
void orl_run_count_scene_faults(struct orl_run_state *state, const struct orl_scene *scene);

/* Warns of panes of the scene that lie on an opaque surface. */
void orl_run_warn_of_covered_panes(struct orl_run_state *state);
/* Warns of BSDF panes whose front is outdoors, if their data change when turned round. */
void orl_run_warn_of_turned_panes(struct orl_run_state *state);

/* Marks a sensor as unreliable. */
void orl_run_mark_unreliable(struct orl_run_state *state, size_t sensor, enum orl_doubt doubt);
/* Treats an accuracy as not met if sensors are unreliable; called after all checks. */
void orl_run_apply_unreliable(struct orl_run_state *state);

/* Returns true, and warns, if no light reaches any sensor or view of the job, so that tracing
 * photons is useless. */
bool orl_run_is_dark(struct orl_run_state *state);

/* In the plan stage: warns of eyes inside a solid, in a wall or on a surface. */
void orl_run_diagnose_views(struct orl_run_state *state);

/* At the end: warns of sensors and views without light if others have some. If none has any it
 * returns ORL_ERR_UNLIT, unless the job expects that or it is night. */
int orl_run_diagnose_dark(struct orl_run_state *state, struct orl_error *err);

/* At the end: warns of light that the backward technique has missed, because its paths hit it only
 * by chance. */
int orl_run_diagnose_missed_light(struct orl_run_state *state, struct orl_error *err);

/* At the end: compares sensors with plain path tracing, into result->cross_check. If they differ by
 * more than both errors it widens intervals and warns. */
int orl_run_cross_check(struct orl_run_state *state, struct orl_error *err);

/* At the end: issues the warnings that the result's health requires. */
void orl_run_diagnose_health(struct orl_run_state *state);

#endif
