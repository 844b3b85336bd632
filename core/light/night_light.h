/*
 * Light that a weather file has while the sun is down: no sky can be made of it, so a year leaves
 * it out. A little is usual (twilight, and air that raises the sun by its own width at the
 * horizon); much of it tells that site and times do not belong together.
 */
#ifndef ORL_LIGHT_NIGHT_LIGHT_H
#define ORL_LIGHT_NIGHT_LIGHT_H

#include "light/weather.h"

/* What would put the sun back over the horizon. */
enum orl_night_cause {
    ORL_NIGHT_UNKNOWN,
    ORL_NIGHT_LONGITUDE, /* its sign */
    ORL_NIGHT_TIME_ZONE, /* its sign */
    ORL_NIGHT_SHIFT,     /* of all times */
};

/* Sums are of both measures of rows, as they stand in the file, times hours. */
struct orl_night_light {
    size_t n_rows;
    double hours, lost, total;
    enum orl_weather_units units;
    enum orl_night_cause cause;
    double shift_h; /* to be added to the file's times */
};

struct orl_night_light orl_night_light_find(const struct orl_weather *weather);

/* One sentence or two for a user. Returns false, and leaves text alone, where no more is lost than
 * a thousandth. */
bool orl_night_light_describe(const struct orl_night_light *night, char *text, size_t size);

#endif
