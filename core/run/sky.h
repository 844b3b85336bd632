/*
 * Skies that jobs ask for. Threads: the lead's only.
 */
#ifndef ORL_RUN_SKY_H
#define ORL_RUN_SKY_H

#include <oriel/files.h>

#include "light/daylight.h"

/* The weather file read last; all zeros: none. The name is borrowed. */
struct orl_run_weather {
    const char *file;
    int year; /* of its rows; 0: of all */
    struct orl_weather rows;
};
void orl_run_weather_done(struct orl_run_weather *weather);

/* The sky that the request, which has been checked, is about: not one of the scene's own. */
int orl_run_find_sky(const struct orl_files *files, const struct orl_sky_request *request,
                     struct orl_run_weather *weather, struct orl_daylight *ret_daylight,
                     struct orl_error *err);

#endif
