/* Checks of the places of sensors: in the plane of a surface, in a solid, outdoors. */
#ifndef ORL_RUN_DIAGNOSTICS_SENSOR_PLACES_H
#define ORL_RUN_DIAGNOSTICS_SENSOR_PLACES_H

#include <oriel/job/run.h>

#include "scene/built/scene.h"

/* Describes sensors in the plane of a surface that they do not face: how many, the first of them,
 * that surface, and what to do. Returns false if there are none, or if cancelled. */
bool orl_run_describe_sensors_in_planes(const struct orl_scene *scene,
                                        const struct orl_sensor *sensors, size_t n,
                                        const struct orl_thread_pool *pool, char *ret_text,
                                        size_t size);
bool orl_run_lies_in_plane(const struct orl_scene *scene, const struct orl_sensor *sensor);

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
/* Runs the check. The warnings do not depend on the crew's size. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_run_check_sensor_spaces(struct orl_sensor_check *check);

#endif
