#include "light/night_light.h"

#include <math.h>
#include <stdio.h>

#include "light/daylight.h"

/* The altitude of the centre at which the last of the disc sets. */
static const double set_deg = -0.5 * ORL_SUN_DIAMETER_DEG;

static double light_of(const struct orl_weather_row *row)
{
    return row->missing ? 0 : fmax(row->direct, 0) + fmax(row->diffuse, 0);
}

/* Sums up the rows with the sun below the horizon, with all times shifted by shift_h. */
static struct orl_night_light sum_night_light(const struct orl_weather *weather, double shift_h)
{
    struct orl_night_light night = {.units = weather->units, .shift_h = shift_h};
    for (size_t i = 0; i < weather->n_rows; i++) {
        struct orl_weather_row row = weather->rows[i];
        const double light = light_of(&row) * weather->interval_h;
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
                 "Likely cause: the sign of the %s (EPW counts east, WEA west): with the other "
                 "sign the sun is up",
                 night->cause == ORL_NIGHT_LONGITUDE ? "longitude" : "time zone");
    else if (night->cause == ORL_NIGHT_SHIFT)
        snprintf(why, sizeof why,
                 "Likely cause: times are %g h too %s (rows by the end or the beginning of their "
                 "interval, summer time, or PVGIS's irradiance offset)",
                 fabs(night->shift_h), night->shift_h > 0 ? "early" : "late");
    snprintf(text, size,
             "in %zu %s of the weather file (%.4g h) the sun is below the horizon, and there is "
             "light: %.4g %s of %.4g (%.2g %%) are left out. %s",
             night->n_rows, night->n_rows == 1 ? "row" : "rows", night->hours, night->lost, unit,
             night->total, 100 * night->lost / night->total, why);
    return true;
}
