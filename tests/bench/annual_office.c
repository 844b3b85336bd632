#include "bench/annual.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/checked_file.h"
#include "run/request/job_inputs.h"

static char materials[] = "materials.rad", room[] = "room.rad", ground[] = "ground.rad",
            glazing[] = "glazing.rad", glass[] = "upper_glass.rad", panel[] = "panel.rad",
            weather_name[] = "year.wea";
enum { NAMES = 5 };
static char *const names[ANNUAL_SCENES][NAMES] = {
    [ANNUAL_GLASS] = {materials, room, ground, glazing, glass},
    [ANNUAL_PANEL] = {materials, room, ground, glazing, panel}};
static const double ground_reflectance = 0.2;

/* ---- Files ----------------------------------------------------------------------------------- */

static int open_file(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err)
{
    struct annual_bench *bench = ctx;
    if (strcmp(name, weather_name) != 0)
        return bench->office.files.open(bench->office.files.ctx, name, ret_file, err);
    *ret_file = bench->weather;
    return 0;
}

static void close_file(void *ctx, struct orl_file *file)
{
    struct annual_bench *bench = ctx;
    if (file->data != bench->weather.data)
        bench->office.files.close(bench->office.files.ctx, file);
}

/* Builds a made-up year at 38 degrees north: the sun by its declination, clouds by day and hour. */
static char *make_year(size_t *ret_size)
{
    char *text = NULL;
    FILE *file = open_memstream(&text, ret_size);
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int day_of_year = 0;
    if (!file)
        bench_fail("out of memory", NULL);
    fprintf(file, "place made_up\nlatitude 38.0\nlongitude 0.0\ntime_zone 0\nsite_elevation 0\n"
                  "weather_data_file_units 1\n");
    for (int month = 0; month < 12; month++)
        for (int day = 0; day < days[month]; day++, day_of_year++)
            for (int hour = 0; hour < 24; hour++) {
                const double d = -0.4093 * cos(2 * ORL_PI * (day_of_year + 10) / 365.0);
                const double w = (hour + 0.5 - 12) * ORL_PI / 12, l = 38 * ORL_DEG_TO_RAD;
                const double s = sin(l) * sin(d) + cos(l) * cos(d) * cos(w);
                const double cloud = 0.5 + 0.5 * sin(day_of_year * 2.4) * cos(hour * 0.7 + day);
                const double up = fmax(s, 0);
                const double direct = up > 0 ? 900 * pow(0.7, 0.6 / (up + 0.1)) * (1 - cloud) : 0;
                fprintf(file, "%d %d %.3f %.0f %.0f\n", month + 1, day + 1, hour + 0.5, direct,
                        up * (90 + 260 * cloud * (1.2 - cloud)));
            }
    fclose(file);
    return text;
}

static char *read_year(const char *path, size_t *ret_size)
{
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    if (!file || fseek(file, 0, SEEK_END) != 0)
        bench_fail("ORIEL_ANNUAL_WEATHER cannot be read", NULL);
    const long size = ftell(file);
    rewind(file);
    text = malloc((size_t)size + 1);
    if (!text || fread(text, 1, (size_t)size, file) != (size_t)size)
        bench_fail("ORIEL_ANNUAL_WEATHER cannot be read", NULL);
    fclose(file);
    *ret_size = (size_t)size;
    return text;
}

void annual_open(struct annual_bench *bench)
{
    const char *path = getenv("ORIEL_ANNUAL_WEATHER");
    struct orl_error err = {0};
    size_t size = 0, n = 0;
    *bench = (struct annual_bench){.pool = orl_thread_pool_start(1)};
    office_open(&bench->office, NULL);
    bench->files = (struct orl_files){
        .ctx = bench, .open = open_file, .close = close_file, .passed = orl_files_release_pages};
    bench->weather.data = path ? read_year(path, &size) : make_year(&size);
    bench->weather.size = size;
    if (orl_sensors_load(&bench->files, office_sensors, NULL, &bench->sensors, &n, &err) < 0 ||
        n != OFFICE_SENSORS)
        bench_fail("the office's sensors", &err);
}

void annual_close(struct annual_bench *bench)
{
    free((char *)(uintptr_t)bench->weather.data);
    free(bench->sensors);
    annual_forget_truth(bench);
    orl_thread_pool_stop(bench->pool);
    office_close(&bench->office);
}

/* ---- A year ---------------------------------------------------------------------------------- */

struct orl_annual_request annual_request(const struct annual_bench *bench, uint32_t samples,
                                         struct orl_sensor *sensors, size_t n_sensors)
{
    return (struct orl_annual_request){.scene_files = (char **)(uintptr_t)names[bench->scene],
                                       .n_scene_files = NAMES,
                                       .weather_file = weather_name,
                                       .ground_reflectance = ground_reflectance,
                                       .sensors = sensors,
                                       .n_sensors = n_sensors,
                                       .seed = bench_number("ORIEL_ANNUAL_SEED", 1),
                                       .samples = samples,
                                       .technique = bench->technique};
}

struct orl_run_env annual_run_env(struct annual_bench *bench, const struct orl_map_store *store)
{
    return (struct orl_run_env){
        .pool = bench->pool, .files = &bench->files, .store = store, .now_s = bench_own_s};
}

double annual_run(struct annual_bench *bench, uint32_t samples, struct orl_annual_result *ret_year)
{
    struct orl_folder_store folder;
    struct orl_error err = {0};
    snprintf(folder.folder, sizeof folder.folder, "%s", bench->office.folder);
    const struct orl_map_store store = orl_map_store_in_folder(&folder);
    const struct orl_run_env run = annual_run_env(bench, &store);
    const struct orl_annual_env env = {.run = &run};
    const struct orl_annual_request request =
        annual_request(bench, samples, bench->sensors, OFFICE_SENSORS);
    const double started = bench_own_s(NULL);
    if (orl_annual_run(&request, &env, ret_year, &err) < 0)
        bench_fail("the year did not run", &err);
    return bench_own_s(NULL) - started;
}

/* ---- An hour --------------------------------------------------------------------------------- */

void annual_job(const struct annual_bench *bench, const struct orl_annual_step *step,
                struct orl_job *ret_job)
{
    orl_job_init(ret_job);
    ret_job->technique = ORL_TECHNIQUE_BACKWARD;
    ret_job->scene_files = (char **)(uintptr_t)names[bench->scene];
    ret_job->n_scene_files = NAMES;
    orl_sky_request_init(&ret_job->sky);
    ret_job->sky.model = ORL_SKY_BY_WEATHER;
    ret_job->sky.weather_file = weather_name;
    ret_job->sky.time_given = true;
    ret_job->sky.month = step->month;
    ret_job->sky.day = step->day;
    ret_job->sky.hour = step->hour;
    ret_job->sky.ground_reflectance = ground_reflectance;
}

void annual_run_job(struct annual_bench *bench, const struct orl_job *job,
                    struct orl_result *ret_result)
{
    const struct bench_env env = {.files = &bench->files,
                                  .pool = bench->pool,
                                  .maps = bench->office.folder,
                                  .output = bench->office.folder,
                                  .now_s = bench_own_s};
    bench_run(&env, job, ret_result);
}

/* ---- The truth ------------------------------------------------------------------------------- */

/* Selects bright hours and dull hours, two of three bright; each is the middle of its class. */
void annual_choose_hours(struct annual_truth *truth, const struct orl_annual_result *year, size_t n)
{
    const size_t bright = n * 2 / 3;
    size_t counts[2] = {0, 0}, seen[2] = {0, 0}, taken[2] = {0, 0};
    const size_t wanted[2] = {n - bright, bright};
    truth->steps = calloc(n, sizeof *truth->steps);
    if (!truth->steps)
        bench_fail("out of memory", NULL);
    for (size_t i = 0; i < year->n_steps; i++)
        if (year->steps[i].column != ORL_ANNUAL_DARK && year->steps[i].global_lx > 1000)
            counts[year->steps[i].direct_normal_lx > 20000]++;
    for (size_t i = 0; i < year->n_steps; i++) {
        const struct orl_annual_step *s = &year->steps[i];
        if (s->column == ORL_ANNUAL_DARK || !(s->global_lx > 1000))
            continue;
        const int k = s->direct_normal_lx > 20000;
        const double at = ((double)taken[k] + 0.5) / (double)wanted[k] * (double)counts[k];
        if (taken[k] < wanted[k] && (double)seen[k] >= floor(at)) {
            truth->steps[truth->n_hours++] = i;
            taken[k]++;
        }
        seen[k]++;
    }
}

static bool read_kept(const char *path, struct annual_truth *truth)
{
    FILE *file = fopen(path, "r");
    size_t n = 0;
    if (!file)
        return false;
    while (n < truth->n_hours * OFFICE_SENSORS &&
           fscanf(file, "%lf %lf", &truth->lx[n], &truth->error_lx[n]) == 2)
        n++;
    fclose(file);
    return n == truth->n_hours * OFFICE_SENSORS;
}

static void store_truth(const char *path, const struct annual_truth *truth)
{
    char part[BENCH_PATH + 8];
    snprintf(part, sizeof part, "%s.part", path);
    FILE *file = fopen(part, "w");
    if (!file)
        bench_fail("what backward says cannot be kept", NULL);
    for (size_t i = 0; i < truth->n_hours * OFFICE_SENSORS; i++)
        fprintf(file, "%.9g %.9g\n", truth->lx[i], truth->error_lx[i]);
    if (fclose(file) != 0 || rename(part, path) != 0)
        bench_fail("what backward says cannot be kept", NULL);
}

static void run_hour(struct annual_bench *bench, const struct orl_annual_step *step, size_t hour)
{
    struct orl_job job;
    struct orl_result result;
    annual_job(bench, step, &job);
    job.gather_samples = (uint32_t)bench_number("ORIEL_ANNUAL_TRUTH_SAMPLES", 8192);
    job.seed = 1000 + hour;
    job.sensors = bench->sensors;
    job.n_sensors = OFFICE_SENSORS;
    annual_run_job(bench, &job, &result);
    for (size_t i = 0; i < OFFICE_SENSORS; i++) {
        bench->truth.lx[hour * OFFICE_SENSORS + i] = result.illuminance_lx[i];
        bench->truth.error_lx[hour * OFFICE_SENSORS + i] = result.standard_error_lx[i];
    }
    orl_result_done(&result);
}

void annual_name_weather(const struct annual_bench *bench, char ret_word[ANNUAL_WORD])
{
    unsigned char sum[ORL_CHECKSUM_BYTES];
    orl_checksum_of(bench->weather.data, bench->weather.size, sum);
    snprintf(ret_word, ANNUAL_WORD, "%02x%02x%02x%02x", sum[0], sum[1], sum[2], sum[3]);
}

void annual_forget_truth(struct annual_bench *bench)
{
    free(bench->truth.steps);
    free(bench->truth.lx);
    free(bench->truth.error_lx);
    bench->truth = (struct annual_truth){.steps = NULL};
}

void annual_need_truth(struct annual_bench *bench, const struct orl_annual_result *year)
{
    struct annual_truth *truth = &bench->truth;
    char name[96], path[BENCH_PATH], weather[ANNUAL_WORD];
    if (truth->n_hours > 0)
        return;
    annual_choose_hours(truth, year, (size_t)bench_number("ORIEL_ANNUAL_TRUTH_HOURS", 24));
    truth->lx = calloc(truth->n_hours * OFFICE_SENSORS, sizeof *truth->lx);
    truth->error_lx = calloc(truth->n_hours * OFFICE_SENSORS, sizeof *truth->error_lx);
    if (!truth->lx || !truth->error_lx)
        bench_fail("out of memory", NULL);
    annual_name_weather(bench, weather);
    snprintf(name, sizeof name, "annual-%d-%s-%zu-%llu.txt", (int)bench->scene, weather,
             truth->n_hours, (unsigned long long)bench_number("ORIEL_ANNUAL_TRUTH_SAMPLES", 8192));
    bench_kept(name, path);
    if (read_kept(path, truth))
        return;
    fprintf(stderr, "  %zu hours by backward are computed, once\n", truth->n_hours);
    for (size_t i = 0; i < truth->n_hours; i++)
        run_hour(bench, &year->steps[truth->steps[i]], i);
    store_truth(path, truth);
}
