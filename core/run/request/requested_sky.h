/* Skies that jobs request. Threads: only the lead's. */
#ifndef ORL_RUN_REQUEST_REQUESTED_SKY_H
#define ORL_RUN_REQUEST_REQUESTED_SKY_H

#include <oriel/base/files.h>

#include "light/daylight.h"

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
