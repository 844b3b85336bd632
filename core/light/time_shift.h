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
    bool doubtful;  /* global irradiance alone says otherwise: direct was made for another sun */
    double time_zone_h; /* with which the sun stands there, the file's times as they are */
    double file_time_zone_h;
    double off_w_m2;   /* mean difference of global irradiance by the file's times */
    double least_w_m2; /* and by shifted ones */
    /* Of rows with direct light, means: */
    double global_w_m2;
    double horizontal_w_m2; /* difference, were direct irradiance that of the horizontal */
    double diffuse_w_m2;
};

/* Finds none if rows have no global irradiance, as those of WEA files. */
struct orl_time_shift orl_time_shift_find(const struct orl_weather *weather);

/* Writes a warning for the user: of a shift, or of numbers that do not agree by any. Returns false,
 * and does not write, if there is nothing to say. */
bool orl_time_shift_describe(const struct orl_time_shift *shift, char *text, size_t size);

#endif
