#include "support/year.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "support/cli.h"

static char scene_name[] = "scene.rad", weather_name[] = "year.wea";
static char *const scene_names[] = {scene_name};
enum { TEXT = 1 << 16 };

static double now_s(void *ctx)
{
    struct timespec t;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int day_of_year(int month, int day)
{
    static const int before[12] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    return before[month - 1] + day;
}

/* Clear in the morning, veiled about noon, covered in the last third of the day. */
void year_day(const struct year_site *site, int month, int day, char *text, size_t size)
{
    const double declination = -0.4093 * cos(2 * ORL_PI * (day_of_year(month, day) + 10) / 365.25);
    const double latitude = site->latitude_deg * ORL_DEG_TO_RAD;
    for (int hour = 0; hour < 24; hour++) {
        const double solar = hour + 0.5 + site->longitude_deg / 15 - site->time_zone_h;
        const double up = sin(latitude) * sin(declination) +
                          cos(latitude) * cos(declination) * cos((solar - 12) * ORL_PI / 12);
        const double veil = solar < 11 ? 1 : solar < 14 ? 0.5 : 0;
        const size_t used = strlen(text);
        snprintf(text + used, size - used, "%d %d %.3f %.0f %.0f\n", month, day, hour + 0.5,
                 up > 0.02 ? 850 * veil * up / (up + 0.15) : 0,
                 up > 0 ? up * (340 - 220 * veil) + 5 : 0);
    }
}

/* The weather of a run; owned. */
static char *weather_of(const struct year_run *run)
{
    char *text = calloc(TEXT, 1);
    assert_non_null(text);
    if (run->weather) {
        snprintf(text, TEXT, "%s", run->weather);
        return text;
    }
    snprintf(text, TEXT,
             "place made_up\nlatitude %.4f\nlongitude %.4f\ntime_zone %.1f\nsite_elevation 0\n"
             "weather_data_file_units 1\n",
             run->site.latitude_deg, -run->site.longitude_deg, -15 * run->site.time_zone_h);
    year_day(&run->site, 3, 22, text, TEXT);
    year_day(&run->site, 12, 21, text, TEXT);
    return text;
}

static int run_it(const struct year_run *run, struct orl_annual_result *ret_year,
                  struct orl_error *ret_err)
{
    char *weather = weather_of(run), folder[64];
    const char *const names[] = {scene_name, weather_name};
    const struct orl_file contents[] = {{run->scene, strlen(run->scene), NULL},
                                        {weather, strlen(weather), NULL}};
    struct orl_memory_files memory = {names, contents, 2};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_folder_store state;
    cli_make_folder(folder);
    snprintf(state.folder, sizeof state.folder, "%s", folder);
    const struct orl_map_store store = orl_map_store_in_folder(&state);
    struct orl_crew *crew = orl_crew_start(run->threads > 0 ? run->threads : 1);
    const struct orl_run_env env = {.crew = crew, .files = &files, .store = &store, .now_s = now_s};
    const struct orl_annual_env annual = {.run = &env};
    const struct orl_annual_request request = {.scene_files = (char **)(uintptr_t)scene_names,
                                               .n_scene_files = 1,
                                               .weather_file = weather_name,
                                               .north_deg = run->north_deg,
                                               .ground_reflectance = 0.2,
                                               .sensors =
                                                   (struct orl_sensor *)(uintptr_t)run->sensors,
                                               .n_sensors = run->n_sensors,
                                               .seed = run->seed,
                                               .samples = run->samples};
    const int code = orl_annual_run(&request, &annual, ret_year, ret_err);
    orl_crew_stop(crew);
    cli_remove_folder(folder);
    free(weather);
    return code;
}

struct orl_annual_result year_run(const struct year_run *run)
{
    struct orl_annual_result year = {0};
    struct orl_error err = {0};
    if (run_it(run, &year, &err) < 0) {
        char text[2048];
        orl_error_format(&err, text, sizeof text);
        fail_msg("%s", text);
    }
    return year;
}

int year_run_fails(const struct year_run *run, struct orl_error *ret_err)
{
    struct orl_annual_result year = {0};
    const int code = run_it(run, &year, ret_err);
    assert_true(code < 0);
    return code;
}

void year_hour(const struct year_run *run, const struct orl_annual_step *step, uint32_t samples,
               double *ret_lx, double *ret_se)
{
    char *weather = weather_of(run);
    struct orl_sky_request sky;
    orl_sky_request_init(&sky);
    sky.model = ORL_SKY_BY_WEATHER;
    sky.weather_file = weather_name;
    sky.time_given = true;
    sky.month = step->month;
    sky.day = step->day;
    sky.hour = step->hour;
    sky.ground_reflectance = 0.2;
    const struct scene_run job = {.scene = run->scene,
                                  .resource_name = weather_name,
                                  .resource_text = weather,
                                  .sky = &sky,
                                  .sensors = run->sensors,
                                  .n_sensors = run->n_sensors,
                                  .seed = 77 + run->seed + step->column,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .samples = samples};
    struct orl_result result = scene_run(&job);
    memcpy(ret_lx, result.illuminance_lx, run->n_sensors * sizeof *ret_lx);
    memcpy(ret_se, result.standard_error_lx, run->n_sensors * sizeof *ret_se);
    orl_result_done(&result);
    free(weather);
}
