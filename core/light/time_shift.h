/*
 * A shift of an EPW file's times, found in its own numbers: global irradiance is diffuse irradiance
 * plus direct normal irradiance times the sine of the sun's altitude. If that holds for a sun which
 * is half an hour earlier than at the middle of each row's interval, and does not hold for the
 * right one, the file's times or its time zone are half an hour off.
 */
#ifndef ORL_LIGHT_TIME_SHIFT_H
#define ORL_LIGHT_TIME_SHIFT_H

#include "light/weather.h"

struct orl_time_shift {
    double shift_h; /* to be added to the file's times; 0: none was found */
    bool doubtful;  /* global irradiance follows the unshifted sun: direct was made for another */
    double time_zone_h; /* with which the sun stands there, the file's times as they are */
    double file_time_zone_h;
    double off_w_m2;   /* mean difference of global irradiance by the file's times */
    double least_w_m2; /* and by shifted ones */
    /* Means over the rows with direct light: */
    double global_w_m2, diffuse_w_m2;
    double horizontal_w_m2; /* |global - diffuse - direct|: 0 if direct is of the horizontal */
};

/* Finds none if rows have no global irradiance, as those of WEA files. */
struct orl_time_shift orl_time_shift_find(const struct orl_weather *weather);

/* Writes a warning for the user, about a shift or about numbers that contradict each other whatever
 * the shift. Returns false, and writes nothing, if there is neither. */
bool orl_time_shift_describe(const struct orl_time_shift *shift, char *text, size_t size);

#endif
