#include "light/time_shift.h"

#include <math.h>
#include <stdio.h>

#include <oriel/units.h>

#include "light/daylight.h"

/* Rows without much direct light do not tell where the sun is. */
static bool tells(const struct orl_weather_row *row)
{
    static const double bright_w_m2 = 100;
    return !row->missing && row->direct >= bright_w_m2 && row->global > 0;
}

/* Returns the mean difference of global irradiance, of every stride-th of the rows that tell. */
static double mean_off(const struct orl_weather *weather, size_t stride, double shift_h)
{
    double sum = 0;
    size_t seen = 0, n = 0;
    for (size_t i = 0; i < weather->n_rows; i++) {
        struct orl_weather_row row = weather->rows[i];
        if (!tells(&row) || seen++ % stride != 0)
            continue;
        row.hour += shift_h;
        const double altitude_rad = orl_daylight_altitude_of_row(weather, &row) * ORL_DEG_TO_RAD;
        sum += fabs(row.global - row.diffuse - row.direct * fmax(0, sin(altitude_rad)));
        n++;
    }
    return n > 0 ? sum / (double)n : 0;
}

/* Returns the best of 2 n + 1 shifts about a middle. */
static double best_shift(const struct orl_weather *weather, size_t stride, double middle_h,
                         double step_h, int n, double *ret_off)
{
    double best_h = middle_h;
    *ret_off = INFINITY;
    for (int i = -n; i <= n; i++) {
        const double off = mean_off(weather, stride, middle_h + i * step_h);
        if (off < *ret_off) {
            *ret_off = off;
            best_h = middle_h + i * step_h;
        }
    }
    return best_h;
}

struct orl_time_shift orl_time_shift_find(const struct orl_weather *weather)
{
    enum { ENOUGH = 100, SAMPLE = 300 };
    static const double coarse_h = 0.25, fine_h = 0.05, usual_h = 0.19, clear = 0.5, usual_w_m2 = 5;
    struct orl_time_shift shift = {.file_time_zone_h = weather->time_zone_h};
    size_t n = 0;
    for (size_t i = 0; i < weather->n_rows; i++)
        n += tells(&weather->rows[i]);
    if (weather->units != ORL_WEATHER_NORMAL_W || n < ENOUGH)
        return shift;
    const size_t stride = (n + SAMPLE - 1) / SAMPLE;
    shift.off_w_m2 = mean_off(weather, stride, 0);
    const double near_h = best_shift(weather, stride, 0, coarse_h, 8, &shift.least_w_m2);
    const double best_h = best_shift(weather, stride, near_h, fine_h, 4, &shift.least_w_m2);
    if (fabs(best_h) < usual_h || shift.off_w_m2 < usual_w_m2 ||
        shift.least_w_m2 > clear * shift.off_w_m2)
        return shift;
    shift.shift_h = best_h;
    shift.time_zone_h = weather->time_zone_h - best_h;
    return shift;
}

bool orl_time_shift_describe(const struct orl_time_shift *shift, char *text, size_t size)
{
    if (shift->shift_h == 0)
        return false;
    snprintf(text, size,
             "the weather file's times seem %.0f minutes too %s: its global irradiance is diffuse "
             "plus direct for a sun that is so much %s (%.2g W/m2 off, and %.2g by the file's "
             "times). If so, write the time zone %.4g, not %.4g, into the file's LOCATION",
             60 * fabs(shift->shift_h), shift->shift_h > 0 ? "early" : "late",
             shift->shift_h > 0 ? "later" : "earlier", shift->least_w_m2, shift->off_w_m2,
             shift->time_zone_h, shift->file_time_zone_h);
    return true;
}
