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

/* Appends a day: clear in the morning, veiled about noon, overcast in the last third. */
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

/* Returns the weather of a run; owned. */
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

/* Input, computation and output folders of a run's jobs. */
struct place {
    char *weather, folder[64];
    const char *names[3];
    struct orl_file contents[3];
    struct orl_memory_files memory;
    struct orl_files files;
    struct orl_folder_store state;
    struct orl_map_store store;
    struct orl_thread_pool *pool;
    atomic_bool cancel;
    struct orl_run_env env;
};

static struct orl_file file_of(const char *text)
{
    return (struct orl_file){text, strlen(text), NULL};
}

static void note_progress(void *ctx, enum orl_stage stage, double stage_fraction,
                          double job_fraction, double left_s)
{
    struct year_progress *progress = ctx;
    (void)left_s;
    if (stage == ORL_STAGE_LOAD && stage_fraction == 0 && progress->last > 0 &&
        ++progress->runs == 1)
        progress->after_first_run = progress->last;
    progress->falls += job_fraction < progress->last - 1e-9;
    progress->last = job_fraction;
}

/* Initialises in place, since it points into itself. */
static void open_place(struct place *p, const struct year_run *run)
{
    *p = (struct place){.weather = weather_of(run),
                        .pool = orl_thread_pool_start(run->threads > 0 ? run->threads : 1)};
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
    p->env = (struct orl_run_env){.pool = p->pool,
                                  .files = &p->files,
                                  .store = &p->store,
                                  .output_folder = p->folder,
                                  .cancel = &p->cancel,
                                  .now_s = now_s};
    if (run->progress) {
        p->env.ctx = run->progress;
        p->env.progress = note_progress;
    }
}

static void close_place(struct place *p)
{
    orl_thread_pool_stop(p->pool);
    cli_remove_folder(p->folder);
    free(p->weather);
}

static struct orl_annual_request request_of(const struct year_run *run)
{
    return (struct orl_annual_request){.scene_files = (char **)(uintptr_t)scene_names,
                                       .n_scene_files = 1,
                                       .weather_file = weather_name,
                                       .north_deg = run->north_deg,
                                       .ground_reflectance = 0.2,
                                       .sun_method = run->sun_method,
                                       .sensors = (struct orl_sensor *)(uintptr_t)run->sensors,
                                       .n_sensors = run->n_sensors,
                                       .grids = (struct orl_annual_grid *)(uintptr_t)run->grids,
                                       .n_grids = run->n_grids,
                                       .groups = (struct orl_window_group *)(uintptr_t)run->groups,
                                       .n_groups = run->n_groups,
                                       .seed = run->seed,
                                       .samples = run->samples,
                                       .sun_halvings = run->sun_halvings,
                                       .technique = run->technique,
                                       .photons = run->photons,
                                       .coefficients = run->coefficients};
}

static int run_it(const struct year_run *run, struct orl_annual_result *ret_year,
                  struct orl_error *ret_err)
{
    struct place place;
    open_place(&place, run);
    struct orl_annual_env annual = run->env ? *run->env : (struct orl_annual_env){.ctx = NULL};
    const struct orl_annual_request request = request_of(run);
    annual.run = &place.env;
    annual.reuse = run->kept_in != NULL;
    place.env.tasks = run->tasks;
    if (run->kept_in)
        snprintf(place.state.folder, sizeof place.state.folder, "%s", run->kept_in);
    const int code = run->report_request
                         ? orl_annual_run_until(&request, run->report_request, &annual, NULL, NULL,
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

struct orl_annual_refinement year_refine(const struct year_run *asked, const char *target)
{
    struct orl_report_request report_request;
    struct orl_annual_refinement found;
    struct year_run run = *asked;
    assert_int_equal(orl_report_request_init(&report_request), 0);
    report_request.until = calloc(1, sizeof *report_request.until);
    assert_non_null(report_request.until);
    assert_int_equal(orl_annual_target_parse(target, report_request.until, NULL), 0);
    run.report_request = &report_request;
    run.ret_refinement = &found;
    struct orl_annual_result year = year_run(&run);
    orl_annual_done(&year);
    orl_report_request_done(&report_request);
    return found;
}

int year_run_fails(const struct year_run *run, struct orl_error *ret_err)
{
    struct orl_annual_result year = {0};
    const int code = run_it(run, &year, ret_err);
    assert_true(code < 0);
    return code;
}

struct orl_viewpoint_hours *year_glare(const struct year_run *run,
                                       const struct orl_annual_result *year,
                                       const struct orl_viewpoint_request *viewpoint_request,
                                       const unsigned char *wanted)
{
    const struct orl_annual_request request = request_of(run);
    struct orl_viewpoint_hours *hours = NULL;
    struct orl_error err = {0};
    struct place place;
    open_place(&place, run);
    if (orl_annual_glare_compute(viewpoint_request, &request, year, wanted, &place.env, &hours,
                                 &err) < 0)
        fail_with(&err);
    close_place(&place);
    return hours;
}

/* ---- Single hours ---------------------------------------------------------------------------- */

static void job_of(const struct year_run *run, const struct orl_annual_step *step,
                   struct orl_job *ret_job)
{
    orl_job_init(ret_job);
    ret_job->scene_files = (char **)(uintptr_t)scene_names;
    ret_job->n_scene_files = 1;
    ret_job->technique = ORL_TECHNIQUE_BACKWARD;
    ret_job->seed = 77 + run->seed + step->column;
    ret_job->dark_expected = true;
    ret_job->sky.model = ORL_SKY_BY_WEATHER;
    ret_job->sky.weather_file = weather_name;
    ret_job->sky.time_given = true;
    ret_job->sky.month = step->month;
    ret_job->sky.day = step->day;
    ret_job->sky.hour = step->hour;
    ret_job->sky.ground_reflectance = 0.2;
    ret_job->sky.sun_method = run->sun_method;
}

double year_dgp(const struct year_run *run, const struct orl_annual_step *step,
                const struct orl_viewpoint *viewpoint, uint32_t side, uint32_t samples,
                double *ret_eye_lx)
{
    char name[] = "eye", text[256];
    struct orl_view_request view = {.name = name,
                                    .view = text,
                                    .width = side,
                                    .height = side,
                                    .metrics = 1U << ORL_GLARE_DGP | 1U << ORL_GLARE_ILLUMINANCE};
    struct orl_result result = {0};
    struct orl_error err = {0};
    struct place place;
    struct orl_job job;
    open_place(&place, run);
    job_of(run, step, &job);
    snprintf(text, sizeof text, "-vta -vp %.9g %.9g %.9g -vd %.9g %.9g %.9g -vh 180 -vv 180",
             viewpoint->at.x, viewpoint->at.y, viewpoint->at.z, viewpoint->towards.x,
             viewpoint->towards.y, viewpoint->towards.z);
    job.pixel_samples = samples;
    job.views = &view;
    job.n_views = 1;
    if (orl_run(&job, &place.env, &result, &err) < 0)
        fail_with(&err);
    const struct orl_glare *glare = result.views[0].glare;
    assert_non_null(glare);
    const double dgp = glare->values[ORL_GLARE_DGP].value;
    *ret_eye_lx = glare->values[ORL_GLARE_ILLUMINANCE].value;
    orl_result_done(&result);
    close_place(&place);
    return dgp;
}

struct orl_result year_hour_result(const struct year_run *run, const struct orl_annual_step *step,
                                   uint32_t samples)
{
    struct place place;
    struct orl_job job;
    struct orl_result result = {0};
    struct orl_error err = {0};
    open_place(&place, run);
    job_of(run, step, &job);
    job.gather_samples = samples;
    job.sensors = (struct orl_sensor *)(uintptr_t)run->sensors;
    job.n_sensors = run->n_sensors;
    if (orl_run(&job, &place.env, &result, &err) < 0)
        fail_with(&err);
    close_place(&place);
    return result;
}

void year_hour(const struct year_run *run, const struct orl_annual_step *step, uint32_t samples,
               double *ret_lx, double *ret_se)
{
    struct orl_result result = year_hour_result(run, step, samples);
    memcpy(ret_lx, result.illuminance_lx, run->n_sensors * sizeof *ret_lx);
    memcpy(ret_se, result.standard_error_lx, run->n_sensors * sizeof *ret_se);
    orl_result_done(&result);
}
