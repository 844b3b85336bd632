/* Weather files, EPW and WEA, and the skies of their rows. */
#include <oriel/annual/annual_report.h>

#include "fuzz/fuzz.h"
#include "light/daylight/daylight.h"

static void check_row(const struct orl_weather_row *row)
{
    FUZZ_PROMISE(row->month >= 1 && row->month <= 12 && row->day >= 1 && row->day <= 31);
    FUZZ_PROMISE(row->hour >= 0 && row->hour <= 24 && row->line > 0);
    FUZZ_PROMISE(isfinite(row->direct) && isfinite(row->diffuse));
}

/* Checks the sky of a row, computed as for a job. */
static void check_sky(const struct orl_weather *weather, const struct orl_weather_row *row,
                      enum orl_sky_normalise normalise)
{
    char name[] = "weather.epw";
    const struct orl_sky_request request = {.model = ORL_SKY_BY_WEATHER,
                                            .normalise = normalise,
                                            .time_given = true,
                                            .month = row->month,
                                            .day = row->day,
                                            .hour = row->hour,
                                            .ground_reflectance = 0.2,
                                            .weather_file = name};
    struct orl_daylight daylight;
    struct orl_error err = {0};
    int code = orl_daylight_check(&request, &err);
    if (code == 0)
        code = orl_daylight_from_request(&request, weather, &daylight, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    else
        fuzz_check_daylight(&daylight);
}

/* Reads the file as an annual run does: its rows become the steps of a year, or it is refused. */
static void check_year(const char *text, size_t size, const struct orl_weather *weather)
{
    struct orl_annual_steps steps = {0};
    struct orl_error err = {0};
    size_t rows = 0;
    const int code = orl_annual_weather_check("weather.epw", text, size, 0, &steps, &rows, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return;
    }
    FUZZ_PROMISE(rows == weather->n_rows && rows <= steps.count);
    FUZZ_PROMISE(orl_annual_steps_check(&steps, NULL) == 0);
    FUZZ_PROMISE(orl_occupancy_check("use.csv", "", 0, &steps, NULL) == ORL_ERR_RANGE);
}

/* Chooses the year of the first row and checks that all rows are of that year, each at its own
 * time. */
static void check_chosen_year(const char *text, size_t size, const struct orl_weather *all)
{
    struct orl_weather weather = {0};
    struct orl_error err = {0};
    const int year = all->rows[0].year;
    const int code = orl_weather_parse("weather.epw", text, size, year, &weather, &err);
    FUZZ_PROMISE(code == 0 && weather.n_rows > 0 && weather.n_rows <= all->n_rows);
    FUZZ_PROMISE(weather.n_moved < weather.n_rows && weather.first_weekday < 7);
    for (size_t i = 0; i < weather.n_rows; i++) {
        check_row(&weather.rows[i]);
        FUZZ_PROMISE(year == 0 || weather.rows[i].year == year);
    }
    orl_weather_done(&weather);
}

bool fuzz_weather(const uint8_t *data, size_t size)
{
    enum { SKIES = 4 };
    struct orl_weather weather = {0};
    struct orl_error err = {0};
    const int code = orl_weather_parse("weather.epw", (const char *)data, size, 0, &weather, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(weather.rows == NULL);
        return false;
    }
    FUZZ_PROMISE(weather.n_rows > 0);
    FUZZ_PROMISE(fabs(weather.latitude_deg) <= 90 && fabs(weather.longitude_deg) <= 180);
    FUZZ_PROMISE(isfinite(weather.time_zone_h));
    for (size_t i = 0; i < weather.n_rows; i++)
        check_row(&weather.rows[i]);
    for (size_t i = 0; i < weather.n_rows && i < SKIES; i++)
        check_sky(&weather, &weather.rows[i], i % 2 ? ORL_SKY_FLUX : ORL_SKY_GENDAYLIT);
    check_year((const char *)data, size, &weather);
    check_chosen_year((const char *)data, size, &weather);
    orl_weather_done(&weather);
    return true;
}
