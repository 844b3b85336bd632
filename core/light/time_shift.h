/*
 * Detection of a time shift in an EPW file from its own numbers. Global irradiance is diffuse
 * irradiance plus direct normal irradiance times the sine of the sun's altitude. That should hold
 * for the sun at the middle of each row's interval. If instead it holds for a sun half an hour
 * earlier, the file's times or its time zone are half an hour off.
 */
#ifndef ORL_LIGHT_TIME_SHIFT_H
#define ORL_LIGHT_TIME_SHIFT_H

#include "light/weather.h"

struct orl_time_shift {
    double shift_h; /* to be added to the file's times; 0: no shift was found */
    /* global irradiance matches the unshifted sun: direct irradiance was computed for another
     * position */
    bool doubtful;
    /* the time zone that would explain the shift, with the file's times unchanged */
    double time_zone_h;
    double file_time_zone_h;
    double off_w_m2;   /* mean difference of global irradiance with the file's times */
    double least_w_m2; /* mean difference with shifted times */
    /* Means over the rows with direct light. */
    double global_w_m2, diffuse_w_m2;
    /* |global - diffuse - direct|: 0 if the file's direct irradiance is on the horizontal */
    double horizontal_w_m2;
};

/* Finds the shift. Finds none if rows have no global irradiance, as in WEA files. */
struct orl_time_shift orl_time_shift_find(const struct orl_weather *weather);

/* Writes a warning for the user about a shift, or about numbers that contradict each other for
 * any shift. Returns false, and writes nothing, if there is neither. */
bool orl_time_shift_describe(const struct orl_time_shift *shift, char *text, size_t size);

#endif
