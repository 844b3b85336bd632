/*
 * Radiation that a weather file has while the sun is below the horizon. No sky model takes it, so a
 * year omits it. A small amount is usual: twilight, and refraction, which raises the sun by its own
 * width at the horizon. A large amount shows that the site and the times of the file do not match.
 */
#ifndef ORL_LIGHT_NIGHT_LIGHT_H
#define ORL_LIGHT_NIGHT_LIGHT_H

#include "light/weather.h"

/* The change to the file that would put the sun above the horizon. */
enum orl_night_cause {
    ORL_NIGHT_UNKNOWN,
    ORL_NIGHT_LONGITUDE, /* the other sign of the longitude */
    ORL_NIGHT_TIME_ZONE, /* the other sign of the time zone */
    ORL_NIGHT_SHIFT,     /* a shift of all times */
};

/* Sums of direct and diffuse radiation, in the units of the file, times hours. */
struct orl_night_light {
    size_t n_rows;
    double hours, lost, total;
    enum orl_weather_units units;
    enum orl_night_cause cause;
    double shift_h; /* to be added to the file's times */
};

struct orl_night_light orl_night_light_find(const struct orl_weather *weather);

/* Writes a warning for the user. Returns false, and does not write, if at most a thousandth of the
 * radiation is lost. */
bool orl_night_light_describe(const struct orl_night_light *night, char *text, size_t size);

#endif
