/* Inputs of a job that come from files: sensors, grids, views, and the sky. */
#ifndef ORL_RUN_REQUEST_JOB_INPUTS_H
#define ORL_RUN_REQUEST_JOB_INPUTS_H

#include <oriel/base/files.h>
#include <oriel/job/run.h>

#include "light/daylight/daylight.h"
#include "run/run_state.h"

/* Files of sensors: a point and a direction a line. */

/* Parses a file of sensors, like orl_sensors_read, into an array that the caller frees. */
int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);
/* Reads the sensors of a file. Polls cancel, which may be NULL; returns ORL_ERR_CANCELLED then. */
int orl_sensors_load(const struct orl_files *files, const char *name, const atomic_bool *cancel,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

/* Sensors of a job in named grids. */

/* Checks the names, and that sensors and grids agree. */
int orl_grids_validate(const struct orl_job *job, struct orl_error *err);

/* Reads the job's sensors and those of its grids' files. *ret_grids has no file names any more; its
 * names borrow from the job. The caller owns both arrays. */
int orl_grids_read(const struct orl_job *job, const struct orl_files *files,
                   const atomic_bool *cancel, struct orl_grid_request **ret_grids,
                   struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

/* Loads the sensors of all grids into the state, and each grid's name and range into the result. */
int orl_run_load_grids(struct orl_run_state *state, struct orl_error *err);

void orl_grid_results_done(struct orl_result *result);

/* A job's views, with those read from files. */

/* Resolves the job's views: those in files are read, and sizes follow the pixel aspect. *ret_views
 * has as many as the job and owns what differs; free it by orl_run_views_done. */
int orl_run_resolve_views(const struct orl_job *job, const struct orl_files *files,
                          struct orl_view_request **ret_views, struct orl_error *err);
void orl_run_views_done(const struct orl_job *job, struct orl_view_request *views);

/* Skies that jobs request. Threads: the lead thread. */

/* The weather file read last; all zeros if none. The name is borrowed. */
struct orl_weather_cache {
    const char *file;
    int year; /* year of its rows; 0: all years */
    struct orl_weather rows;
};
void orl_weather_cache_done(struct orl_weather_cache *weather);

/* Returns the sky of a validated request, which must not be for the scene's own sky. */
int orl_run_find_sky(const struct orl_files *files, const struct orl_sky_request *request,
                     struct orl_weather_cache *weather, struct orl_daylight *ret_daylight,
                     struct orl_error *err);

/* Load stage: returns the sky that the job requests, if any; sets result->sky_given. Returns
 * ORL_ERR_INVALID if the scene then has distant sources of its own. */
int orl_run_load_sky(struct orl_run_state *state, const struct orl_parsed_scene *parsed_scene,
                     struct orl_daylight *ret_daylight, struct orl_error *err);

#endif
