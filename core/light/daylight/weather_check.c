/* Faults of weather files that their own numbers show: a shift of all times, and radiation while
 * the sun is down. */
#include <math.h>
#include <stdio.h>

#include <oriel/base/vec.h>

#include "light/daylight/daylight.h"
#include "light/daylight/weather.h"

/* Returns true if a row has enough direct light to show where the sun is. */
static bool shows_sun(const struct orl_weather_row *row)
{
    static const double bright_w_m2 = 100;
    return !row->missing && row->direct >= bright_w_m2 && row->global > 0;
}

static double height_of(const struct orl_weather *weather, struct orl_weather_row row,
                        double shift_h)
{
    row.hour += shift_h;
    return fmax(0, sin(orl_daylight_altitude_of_row(weather, &row) * ORL_DEG_TO_RAD));
}

/* Returns the mean difference of global irradiance over every stride-th row for which shows_sun()
 * is true. */
static double mean_off(const struct orl_weather *weather, size_t stride, double shift_h)
{
    double sum = 0;
    size_t seen = 0, n = 0;
    for (size_t i = 0; i < weather->n_rows; i++) {
        const struct orl_weather_row *row = &weather->rows[i];
        if (!shows_sun(row) || seen++ % stride != 0)
            continue;
        sum += fabs(row->global - row->diffuse - row->direct * height_of(weather, *row, shift_h));
        n++;
    }
    return n > 0 ? sum / (double)n : 0;
}

/* Returns 1 minus the correlation (not centred) of global irradiance with the sine of the sun's
 * altitude. */
static double global_off(const struct orl_weather *weather, size_t stride, double shift_h)
{
    double products = 0, squares = 0, heights = 0;
    for (size_t i = 0; i < weather->n_rows; i += stride) {
        const struct orl_weather_row *row = &weather->rows[i];
        if (row->missing || !(row->global >= 0))
            continue;
        const double height = height_of(weather, *row, shift_h);
        products += row->global * height;
        squares += row->global * row->global;
        heights += height * height;
    }
    return squares > 0 && heights > 0 ? 1 - products / sqrt(squares * heights) : 0;
}

/* Returns the best of 2 n + 1 shifts around middle_h. */
static double best_shift(double (*off_by)(const struct orl_weather *, size_t, double),
                         const struct orl_weather *weather, size_t stride, double middle_h,
                         double step_h, int n, double *ret_off)
{
    double best_h = middle_h;
    *ret_off = INFINITY;
    for (int i = -n; i <= n; i++) {
        const double off = off_by(weather, stride, middle_h + i * step_h);
        if (off < *ret_off) {
            *ret_off = off;
            best_h = middle_h + i * step_h;
        }
    }
    return best_h;
}

enum { ENOUGH = 100, SAMPLE = 300, GLOBAL_SAMPLE = 2000 };
static const double coarse_h = 0.25, fine_h = 0.05;

static void find_means(const struct orl_weather *weather, struct orl_time_shift *shift)
{
    size_t n = 0;
    for (size_t i = 0; i < weather->n_rows; i++) {
        const struct orl_weather_row *row = &weather->rows[i];
        if (!shows_sun(row))
            continue;
        n++;
        shift->global_w_m2 += row->global;
        shift->diffuse_w_m2 += row->diffuse;
        shift->horizontal_w_m2 += fabs(row->global - row->diffuse - row->direct);
    }
    shift->global_w_m2 /= (double)n;
    shift->diffuse_w_m2 /= (double)n;
    shift->horizontal_w_m2 /= (double)n;
}

/* Returns true if the file's times are right although the shift makes the numbers agree. Global
 * irradiance then follows the sun at the file's times, and direct irradiance was derived from it
 * with a wrong sun. */
static bool is_doubtful(const struct orl_weather *weather, double shift_h)
{
    static const double closer = 0.7;
    const size_t stride = (weather->n_rows + GLOBAL_SAMPLE - 1) / GLOBAL_SAMPLE;
    double off;
    const double near_h = best_shift(global_off, weather, stride, 0, coarse_h, 8, &off);
    const double of_global_h = best_shift(global_off, weather, stride, near_h, fine_h, 4, &off);
    return fabs(shift_h - of_global_h) > closer * fabs(of_global_h);
}

struct orl_time_shift orl_time_shift_find(const struct orl_weather *weather)
{
    static const double usual_h = 0.19, clear = 0.5, usual_w_m2 = 5;
    struct orl_time_shift shift = {.file_time_zone_h = weather->time_zone_h};
    size_t n = 0;
    for (size_t i = 0; i < weather->n_rows; i++)
        n += shows_sun(&weather->rows[i]);
    if (weather->units != ORL_WEATHER_NORMAL_W || n < ENOUGH)
        return shift;
    const size_t stride = (n + SAMPLE - 1) / SAMPLE;
    find_means(weather, &shift);
    shift.off_w_m2 = mean_off(weather, stride, 0);
    const double near_h = best_shift(mean_off, weather, stride, 0, coarse_h, 8, &shift.least_w_m2);
    const double best_h =
        best_shift(mean_off, weather, stride, near_h, fine_h, 4, &shift.least_w_m2);
    if (fabs(best_h) < usual_h || shift.off_w_m2 < usual_w_m2 ||
        shift.least_w_m2 > clear * shift.off_w_m2)
        return shift;
    shift.shift_h = best_h;
    shift.time_zone_h = weather->time_zone_h - best_h;
    shift.doubtful = is_doubtful(weather, best_h);
    return shift;
}

/* ---- Words ----------------------------------------------------------------------------------- */

/* Describes numbers that agree for no shift. Returns false if they do agree. */
static bool describe_numbers(const struct orl_time_shift *shift, char *text, size_t size)
{
    static const double usual = 0.1, close = 0.02;
    const double least = fmin(shift->off_w_m2, shift->least_w_m2), global = shift->global_w_m2;
    if (!(least > usual * global))
        return false;
    snprintf(text, size,
             "the weather file's numbers contradict each other: at no time shift is its global "
             "irradiance diffuse plus direct normal times the sine of the sun's altitude (%.3g "
             "W/m2 off in rows with direct light, %.0f %% of it). %s. Its direct normal and "
             "diffuse irradiance are used",
             least, 100 * least / global,
             shift->diffuse_w_m2 < close * global ? "Its diffuse irradiance is 0 by day"
             : shift->horizontal_w_m2 < close * global
                 ? "It is diffuse plus direct: its direct irradiance seems to be horizontal, not "
                   "normal to the sun"
                 : "Look for a file from another source");
    return true;
}

bool orl_time_shift_describe(const struct orl_time_shift *shift, char *text, size_t size)
{
    const char *const way = shift->shift_h > 0 ? "later" : "earlier";
    if (shift->shift_h == 0)
        return describe_numbers(shift, text, size);
    if (shift->doubtful)
        snprintf(text, size,
                 "the weather file's direct irradiance fits a sun %.0f minutes %s than its times "
                 "(%.2g W/m2 off, and %.2g by the file's times), but its global irradiance does "
                 "not. The times are used unchanged; direct light is uncertain",
                 60 * fabs(shift->shift_h), way, shift->least_w_m2, shift->off_w_m2);
    else
        snprintf(
            text, size,
            "the weather file's times seem %.0f minutes too %s: its global irradiance is diffuse "
            "plus direct for a sun that much %s (%.2g W/m2 off, and %.2g by the file's times). If "
            "so, change the time zone in the file's LOCATION to %.4g, from %.4g",
            60 * fabs(shift->shift_h), shift->shift_h > 0 ? "early" : "late", way,
            shift->least_w_m2, shift->off_w_m2, shift->time_zone_h, shift->file_time_zone_h);
    return true;
}

/* The altitude of the centre at which the last of the disc sets. */
static const double set_deg = -0.5 * ORL_SUN_DIAMETER_DEG;

/* Sums up the rows with the sun below the horizon, with all times shifted by shift_h. */
static struct orl_night_light sum_night_light(const struct orl_weather *weather, double shift_h)
{
    struct orl_night_light night = {.units = weather->units, .shift_h = shift_h};
    for (size_t i = 0; i < weather->n_rows; i++) {
        struct orl_weather_row row = weather->rows[i];
        const double light =
            row.missing ? 0 : (fmax(row.direct, 0) + fmax(row.diffuse, 0)) * weather->interval_h;
        night.total += light;
        row.hour += shift_h;
        if (!(light > 0) || orl_daylight_altitude_of_row(weather, &row) > set_deg)
            continue;
        night.n_rows++;
        night.hours += weather->interval_h;
        night.lost += light;
    }
    return night;
}

/* Replaces *least if the cause leaves less radiation at night. */
static void try_cause(struct orl_night_light *least, enum orl_night_cause cause,
                      struct orl_night_light found)
{
    found.cause = cause;
    if (found.lost < least->lost)
        *least = found;
}

struct orl_night_light orl_night_light_find(const struct orl_weather *weather)
{
    static const double shifts_h[] = {-0.5, 0.5, -1, 1}, clear = 0.2;
    struct orl_night_light night = sum_night_light(weather, 0), least = night;
    struct orl_weather other = *weather;
    if (!(night.lost > 0))
        return night;
    other.longitude_deg = -weather->longitude_deg;
    try_cause(&least, ORL_NIGHT_LONGITUDE, sum_night_light(&other, 0));
    other.longitude_deg = weather->longitude_deg;
    other.time_zone_h = -weather->time_zone_h;
    try_cause(&least, ORL_NIGHT_TIME_ZONE, sum_night_light(&other, 0));
    for (size_t i = 0; i < sizeof shifts_h / sizeof *shifts_h; i++)
        try_cause(&least, ORL_NIGHT_SHIFT, sum_night_light(weather, shifts_h[i]));
    if (least.lost <= clear * night.lost) {
        night.cause = least.cause;
        night.shift_h = least.shift_h;
    }
    return night;
}

bool orl_night_light_describe(const struct orl_night_light *night, char *text, size_t size)
{
    static const double usual = 0.001;
    const char *unit = night->units == ORL_WEATHER_NORMAL_LX ? "lx h" : "Wh/m2";
    char why[200] = "Likely causes: the sign of longitude or time zone (EPW counts east, WEA "
                    "west), times shifted by half an hour, or PVGIS's irradiance offset";
    if (!(night->lost > usual * night->total))
        return false;
    if (night->cause == ORL_NIGHT_LONGITUDE || night->cause == ORL_NIGHT_TIME_ZONE)
        snprintf(why, sizeof why,
                 "Likely cause: the sign of the %s (EPW counts east, WEA west): with the opposite "
                 "sign the sun is up",
                 night->cause == ORL_NIGHT_LONGITUDE ? "longitude" : "time zone");
    else if (night->cause == ORL_NIGHT_SHIFT)
        snprintf(why, sizeof why,
                 "Likely cause: times are %g h too %s (times of the end or start of intervals, "
                 "summer time, or PVGIS's irradiance offset)",
                 fabs(night->shift_h), night->shift_h > 0 ? "early" : "late");
    snprintf(text, size,
             "in %zu %s of the weather file (%.4g h) there is light although the sun is below the "
             "horizon: %.4g %s of %.4g (%.2g %%) are left out. %s",
             night->n_rows, night->n_rows == 1 ? "row" : "rows", night->hours, night->lost, unit,
             night->total, 100 * night->lost / night->total, why);
    return true;
}
