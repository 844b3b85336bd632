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

/* Where a run's jobs read, compute and write. */
struct place {
    char *weather, folder[64];
    const char *names[3];
    struct orl_file contents[3];
    struct orl_memory_files memory;
    struct orl_files files;
    struct orl_folder_store state;
    struct orl_map_store store;
    struct orl_crew *crew;
    atomic_bool cancel;
    struct orl_run_env env;
};

static struct orl_file file_of(const char *text)
{
    return (struct orl_file){text, strlen(text), NULL};
}

/* In place: it points into itself. */
static void open_place(struct place *p, const struct year_run *run)
{
    *p = (struct place){.weather = weather_of(run),
                        .crew = orl_crew_start(run->threads > 0 ? run->threads : 1)};
    p->names[0] = scene_name;
    p->names[1] = weather_name;
    p->names[2] = run->resource_name;
    p->contents[0] = file_of(run->scene);
    p->contents[1] = file_of(p->weather);
    if (run->resource_name)
        p->contents[2] = file_of(run->resource_text);
    p->memory = (struct orl_memory_files){p->names, p->contents, run->resource_name ? 3 : 2};
    p->files = orl_files_from_memory(&p->memory);
    cli_make_folder(p->folder);
    snprintf(p->state.folder, sizeof p->state.folder, "%s", p->folder);
    p->store = orl_map_store_in_folder(&p->state);
    p->env = (struct orl_run_env){.crew = p->crew,
                                  .files = &p->files,
                                  .store = &p->store,
                                  .output_folder = p->folder,
                                  .cancel = &p->cancel,
                                  .now_s = now_s};
}

static void close_place(struct place *p)
{
    orl_crew_stop(p->crew);
    cli_remove_folder(p->folder);
    free(p->weather);
}

static int run_it(const struct year_run *run, struct orl_annual_result *ret_year,
                  struct orl_error *ret_err)
{
    struct place place;
    open_place(&place, run);
    struct orl_annual_env annual = run->env ? *run->env : (struct orl_annual_env){.ctx = NULL};
    const struct orl_annual_request request = {
        .scene_files = (char **)(uintptr_t)scene_names,
        .n_scene_files = 1,
        .weather_file = weather_name,
        .north_deg = run->north_deg,
        .ground_reflectance = 0.2,
        .sensors = (struct orl_sensor *)(uintptr_t)run->sensors,
        .n_sensors = run->n_sensors,
        .grids = (struct orl_annual_grid *)(uintptr_t)run->grids,
        .n_grids = run->n_grids,
        .groups = (struct orl_window_group *)(uintptr_t)run->groups,
        .n_groups = run->n_groups,
        .seed = run->seed,
        .samples = run->samples,
        .coefficients = run->coefficients};
    annual.run = &place.env;
    annual.reuse = run->kept_in != NULL;
    if (run->kept_in)
        snprintf(place.state.folder, sizeof place.state.folder, "%s", run->kept_in);
    const int code = run->wishes ? orl_annual_run_until(&request, run->wishes, &annual, NULL, NULL,
                                                        ret_year, run->ret_refinement, ret_err)
                                 : orl_annual_run(&request, &annual, ret_year, ret_err);
    close_place(&place);
    return code;
}

static void fail_with(const struct orl_error *err)
{
    char text[2048];
    orl_error_format(err, text, sizeof text);
    fail_msg("%s", text);
}

struct orl_annual_result year_run(const struct year_run *run)
{
    struct orl_annual_result year = {0};
    struct orl_error err = {0};
    if (run_it(run, &year, &err) < 0)
        fail_with(&err);
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
    struct place place;
    struct orl_job job;
    struct orl_result result = {0};
    struct orl_error err = {0};
    open_place(&place, run);
    orl_job_init(&job);
    job.scene_files = (char **)(uintptr_t)scene_names;
    job.n_scene_files = 1;
    job.technique = ORL_TECHNIQUE_BACKWARD;
    job.gather_samples = samples;
    job.seed = 77 + run->seed + step->column;
    job.sensors = (struct orl_sensor *)(uintptr_t)run->sensors;
    job.n_sensors = run->n_sensors;
    job.dark_expected = true;
    job.sky.model = ORL_SKY_BY_WEATHER;
    job.sky.weather_file = weather_name;
    job.sky.time_given = true;
    job.sky.month = step->month;
    job.sky.day = step->day;
    job.sky.hour = step->hour;
    job.sky.ground_reflectance = 0.2;
    if (orl_run(&job, &place.env, &result, &err) < 0)
        fail_with(&err);
    memcpy(ret_lx, result.illuminance_lx, run->n_sensors * sizeof *ret_lx);
    memcpy(ret_se, result.standard_error_lx, run->n_sensors * sizeof *ret_se);
    orl_result_done(&result);
    close_place(&place);
}
