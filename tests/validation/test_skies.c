/* A job under several skies equals that many jobs under one: the same bytes, maps and images
 * included. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <oriel/job/skies.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "support/cli.h"
#include "support/room.h"

enum { SKIES = 3, SENSORS = 2, DARK = 2 };

static char scene_file[] = "room.rad", weather_file[] = "place.wea", sensor_file[] = "s.txt";
static char *const scene_files[] = {scene_file};
static char overcast[] = "overcast", sunny[] = "sunny_1", night[] = "night-1";
static char view_name[] = "v", view_text[] = "-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vh 70 -vv 55";

/* Inputs and outputs of one run. */
struct fixture {
    char folder[64];
    struct orl_named_sky skies[SKIES];
    struct orl_sensor sensors[SENSORS];
    struct orl_view_request view;
    struct orl_job job;
    struct orl_thread_pool *pool;
    atomic_bool cancel;
    double lx[SKIES][SENSORS];
    bool dark[SKIES], done[SKIES], keep[SKIES];
    const char *sensor_text;       /* text of the sensor file; or NULL */
    double fraction;               /* fraction of the whole job, last reported */
    struct orl_result *sensors_of; /* stored results; or NULL */
    size_t n_sensors_done;
    struct orl_memory_cache *memory_cache;
    const char *files_id;
    int scene_reads; /* number of times that the scene's file was opened */
};

static double now_s(void *ctx)
{
    struct timespec t;
    (void)ctx;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void on_progress(void *ctx, enum orl_stage stage, double stage_fraction, double fraction,
                        double left_s)
{
    struct fixture *f = ctx;
    (void)stage, (void)stage_fraction, (void)left_s;
    assert_true(fraction >= f->fraction - 1e-9 && fraction < 1 + 1e-9);
    f->fraction = fraction;
}

static bool on_sensors_kept(void *ctx, struct orl_result *result)
{
    const struct fixture *f = ctx;
    const struct orl_result *kept = f->sensors_of;
    if (!kept)
        return false;
    assert_int_equal(result->n_sensors, kept->n_sensors);
    for (size_t i = 0; i < SENSORS; i++) {
        result->illuminance_lx[i] = kept->illuminance_lx[i];
        result->standard_error_lx[i] = kept->standard_error_lx[i];
        result->bias_estimate_lx[i] = kept->bias_estimate_lx[i];
        memcpy(result->interval_95_lx[i], kept->interval_95_lx[i], sizeof *kept->interval_95_lx);
    }
    return true;
}

static void on_sensors_done(void *ctx, const struct orl_result *result)
{
    struct fixture *f = ctx;
    assert_int_equal(result->n_sensors, SENSORS);
    f->n_sensors_done++;
}

static bool on_sky_kept(void *ctx, size_t index)
{
    return ((struct fixture *)ctx)->keep[index];
}

static int on_sky_done(void *ctx, size_t index, const struct orl_result *result,
                       struct orl_error *err)
{
    struct fixture *f = ctx;
    (void)err;
    assert_int_equal(result->n_sensors, SENSORS);
    assert_true(result->sky_given);
    memcpy(f->lx[index], result->illuminance_lx, sizeof f->lx[index]);
    f->dark[index] = result->sky_dark;
    f->done[index] = true;
    return 0;
}

static void fill_skies(struct orl_named_sky skies[SKIES])
{
    for (int i = 0; i < SKIES; i++)
        orl_sky_request_init(&skies[i].request);
    skies[0].name = overcast;
    skies[0].request.model = ORL_SKY_BY_CIE;
    skies[0].request.cie_type = ORL_SKY_OVERCAST;
    skies[0].request.input = ORL_SKY_DIFFUSE_LX;
    skies[0].request.first = 10000;
    skies[1].name = sunny;
    skies[1].request.model = ORL_SKY_BY_PEREZ;
    skies[1].request.sun_given = true;
    skies[1].request.sun_altitude_deg = 40;
    skies[1].request.first = 700;
    skies[1].request.second = 120;
    skies[DARK] = skies[1];
    skies[DARK].name = night;
    skies[DARK].request.sun_altitude_deg = -10;
}

static int setup(void **state)
{
    struct fixture *f = calloc(1, sizeof *f);
    cli_make_folder(f->folder);
    f->pool = orl_thread_pool_start(1);
    fill_skies(f->skies);
    f->sensors[0] = (struct orl_sensor){{2, 1, 0.8}, {0, 0, 1}};
    f->sensors[1] = (struct orl_sensor){{2, 4, 0.8}, {0, 0, 1}};
    f->view =
        (struct orl_view_request){.name = view_name, .view = view_text, .width = 24, .height = 18};
    orl_job_init(&f->job);
    f->job.scene_files = (char **)(uintptr_t)scene_files;
    f->job.n_scene_files = 1;
    f->job.technique = ORL_TECHNIQUE_GATHER;
    f->job.photons_global = 20000;
    f->job.photons_caustic = 0;
    f->job.gather_samples = 64;
    f->job.sensors = f->sensors;
    f->job.n_sensors = SENSORS;
    f->job.views = &f->view;
    f->job.n_views = 1;
    f->job.skies = f->skies;
    f->job.n_skies = SKIES;
    *state = f;
    return 0;
}

static int teardown(void **state)
{
    struct fixture *f = *state;
    orl_thread_pool_stop(f->pool);
    cli_remove_folder(f->folder);
    free(f);
    return 0;
}

/* A provider that counts how often the scene is read. */
struct counting {
    struct orl_files inner;
    struct fixture *f;
};

static int count_open(void *ctx, const char *name, struct orl_file *ret_file, struct orl_error *err)
{
    struct counting *c = ctx;
    c->f->scene_reads += strcmp(name, scene_file) == 0;
    return c->inner.open(c->inner.ctx, name, ret_file, err);
}

static void count_close(void *ctx, struct orl_file *file)
{
    struct counting *c = ctx;
    c->inner.close(c->inner.ctx, file);
}

/* Runs all skies, or, with ret_result, the job's only one. */
static int run_skies(struct fixture *f, struct orl_result *ret_result, struct orl_error *err)
{
    static const char scene[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    static const char weather[] = "place Test\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                                  "site_elevation 25\nweather_data_file_units 1\n"
                                  "3 22 11.5 800 120\n";
    static const char *const names[] = {scene_file, weather_file, sensor_file};
    const char *sensors = f->sensor_text ? f->sensor_text : "";
    const struct orl_file contents[] = {{scene, sizeof scene - 1, NULL},
                                        {weather, sizeof weather - 1, NULL},
                                        {sensors, strlen(sensors), NULL}};
    struct orl_memory_files memory = {names, contents, 3};
    struct counting counting = {orl_files_from_memory(&memory), f};
    const struct orl_files files = {.ctx = &counting, .open = count_open, .close = count_close};
    struct orl_folder_store maps;
    const struct orl_map_store store = orl_map_store_in_folder(&maps);
    const struct orl_skies_env skies = {.ctx = f, .kept = on_sky_kept, .done = on_sky_done};
    const struct orl_run_env env = {.pool = f->pool,
                                    .files = &files,
                                    .store = &store,
                                    .memory_cache = f->memory_cache,
                                    .files_id = f->files_id,
                                    .output_folder = f->folder,
                                    .cancel = &f->cancel,
                                    .now_s = now_s,
                                    .progress = on_progress,
                                    .sensors_kept = on_sensors_kept,
                                    .sensors_done = on_sensors_done,
                                    .ctx = f};
    snprintf(maps.folder, sizeof maps.folder, "%s", f->folder);
    f->fraction = 0;
    return ret_result ? orl_run(&f->job, &env, ret_result, err)
                      : orl_run_skies(&f->job, &env, &skies, err);
}

static unsigned char *read_image(const struct fixture *f, const char *name, size_t *ret_size)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    return scene_read_bytes(path, ret_size);
}

static void expect_same_image(const struct fixture *f, const char *sky, const char *ending)
{
    char under_sky[64], alone[32];
    size_t a, b;
    snprintf(under_sky, sizeof under_sky, "%s.v.%s", sky, ending);
    snprintf(alone, sizeof alone, "v.%s", ending);
    unsigned char *one = read_image(f, under_sky, &a), *other = read_image(f, alone, &b);
    assert_int_equal(a, b);
    assert_memory_equal(one, other, a);
    free(one);
    free(other);
}

static void test_same_as_one_by_one(void **state)
{
    struct fixture *f = *state;
    struct orl_error err;
    assert_int_equal(run_skies(f, NULL, &err), 0);
    assert_true(f->fraction > 0.999);
    assert_true(f->lx[0][0] > 100 && f->lx[1][0] > f->lx[0][0]);
    f->job.skies = NULL;
    f->job.n_skies = 0;
    for (int i = 0; i < SKIES; i++) {
        struct orl_result result;
        f->job.sky = f->skies[i].request;
        assert_int_equal(run_skies(f, &result, &err), 0);
        assert_memory_equal(result.illuminance_lx, f->lx[i], sizeof f->lx[i]);
        assert_int_equal(result.n_maps, i == DARK ? 0 : 1);
        assert_true(i == DARK || result.maps[0].cached);
        assert_true(f->dark[i] == (i == DARK) && result.sky_dark == f->dark[i]);
        orl_result_done(&result);
        expect_same_image(f, f->skies[i].name, "hdr");
        expect_same_image(f, f->skies[i].name, "error.hdr");
    }
}

/* A scene is parsed once for all skies of a job; and once for all jobs of a memory cache that
 * identify its files. The results are equal. */
static void test_one_scene_for_all(void **state)
{
    struct fixture *f = *state;
    double first[SKIES][SENSORS];
    f->job.n_views = 0;
    assert_int_equal(run_skies(f, NULL, NULL), 0);
    assert_int_equal(f->scene_reads, 1);
    memcpy(first, f->lx, sizeof first);
    f->memory_cache = orl_memory_cache_new(1 << 20);
    for (int i = 0; i < 3; i++) {
        memset(f->lx, 0, sizeof f->lx);
        f->files_id = i < 2 ? "these" : "others";
        assert_int_equal(run_skies(f, NULL, NULL), 0);
        assert_int_equal(f->scene_reads, i < 2 ? 2 : 3);
        assert_memory_equal(f->lx, first, sizeof first);
        assert_int_equal(orl_memory_cache_totals(f->memory_cache).shared, i < 2 ? 1 : 2);
    }
    f->files_id = NULL;
    assert_int_equal(run_skies(f, NULL, NULL), 0);
    assert_int_equal(f->scene_reads, 4);
    orl_memory_cache_free(f->memory_cache);
}

static void test_kept_skies_are_not_run(void **state)
{
    struct fixture *f = *state;
    f->keep[1] = true;
    assert_int_equal(run_skies(f, NULL, NULL), 0);
    assert_true(f->done[0] && !f->done[1] && f->done[2]);
    assert_true(f->fraction > 0.999);
    assert_int_equal(f->n_sensors_done, 2);
}

/* Sensors of an earlier run are taken unchanged, and the rest is equal. */
static void test_kept_sensors(void **state)
{
    struct fixture *f = *state;
    struct orl_result first, second;
    f->job.skies = NULL;
    f->job.n_skies = 0;
    f->job.sky = f->skies[0].request;
    assert_int_equal(run_skies(f, &first, NULL), 0);
    assert_int_equal(f->n_sensors_done, 1);
    size_t a, b;
    unsigned char *image = read_image(f, "v.hdr", &a);
    f->sensors_of = &first;
    assert_int_equal(run_skies(f, &second, NULL), 0);
    assert_int_equal(f->n_sensors_done, 1);
    unsigned char *again = read_image(f, "v.hdr", &b);
    assert_int_equal(a, b);
    assert_memory_equal(image, again, a);
    assert_memory_equal(first.illuminance_lx, second.illuminance_lx, SENSORS * sizeof(double));
    free(image);
    free(again);
    orl_result_done(&first);
    orl_result_done(&second);
}

static void expect_error(struct fixture *f, int code, const char *primitive)
{
    struct orl_error err = {0};
    assert_int_equal(run_skies(f, NULL, &err), code);
    assert_string_equal(err.primitive, primitive);
    assert_false(f->done[0]);
}

static void use_sensor_file(struct fixture *f, const char *text)
{
    f->sensor_text = text;
    f->job.sensors_file = sensor_file;
    f->job.sensors = NULL;
    f->job.n_sensors = 0;
}

static void test_file_of_sensors(void **state)
{
    struct fixture *f = *state;
    double lx[SKIES][SENSORS];
    assert_int_equal(run_skies(f, NULL, NULL), 0);
    memcpy(lx, f->lx, sizeof lx);
    use_sensor_file(f, "2 1 0.8 0 0 1\n2 4 0.8 0 0 1\n");
    memset(f->lx, 0, sizeof f->lx);
    assert_int_equal(run_skies(f, NULL, NULL), 0);
    assert_memory_equal(lx, f->lx, sizeof lx);
    assert_ptr_equal(f->job.sensors_file, sensor_file);
}

/* Sensors within the limit for one sky, but not for all: nothing is rendered. */
static void test_too_many_sensors(void **state)
{
    enum { COUNT = 4000000 / SKIES + 1 };
    static const char line[] = "1 1 1 0 0 1\n";
    struct fixture *f = *state;
    struct orl_error err = {0};
    char *text = malloc(COUNT * (sizeof line - 1) + 1);
    assert_non_null(text);
    for (size_t i = 0; i < COUNT; i++)
        memcpy(text + i * (sizeof line - 1), line, sizeof line);
    use_sensor_file(f, text);
    assert_int_equal(run_skies(f, NULL, &err), ORL_ERR_LIMIT);
    assert_string_equal(err.primitive, "skies");
    assert_false(f->done[0]);
    free(text);
}

/* Mistakes are found before anything is rendered. */
static void test_mistakes(void **state)
{
    struct fixture *f = *state;
    struct orl_sky_request *last = &f->skies[2].request;
    struct orl_result result;
    assert_int_equal(run_skies(f, &result, NULL), ORL_ERR_INVALID);
    last->model = ORL_SKY_BY_WEATHER;
    last->weather_file = weather_file;
    last->sun_given = false;
    last->time_given = true;
    last->month = 3;
    last->day = 22;
    last->hour = 15.5;
    expect_error(f, ORL_ERR_NOT_FOUND, "skies[2]");
    f->skies[2].name = overcast;
    expect_error(f, ORL_ERR_INVALID, "skies[2]");
    f->skies[1].request.first = 5000;
    expect_error(f, ORL_ERR_RANGE, "skies[1]");
    f->skies[0].name = view_text;
    expect_error(f, ORL_ERR_INVALID, "skies[0]");
    f->job.sky = f->skies[0].request;
    expect_error(f, ORL_ERR_INVALID, "skies");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_same_as_one_by_one, setup, teardown),
        cmocka_unit_test_setup_teardown(test_one_scene_for_all, setup, teardown),
        cmocka_unit_test_setup_teardown(test_kept_skies_are_not_run, setup, teardown),
        cmocka_unit_test_setup_teardown(test_kept_sensors, setup, teardown),
        cmocka_unit_test_setup_teardown(test_file_of_sensors, setup, teardown),
        cmocka_unit_test_setup_teardown(test_too_many_sensors, setup, teardown),
        cmocka_unit_test_setup_teardown(test_mistakes, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
