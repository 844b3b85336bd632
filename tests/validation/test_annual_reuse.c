/*
 * Reuse of a year's stored light: another weather file of the same place traces no ray, more
 * samples continue where fewer ended, and different inputs are never mixed. The bytes always equal
 * those without the cache.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "run/cache/word_file.h"
#include "support/cli.h"
#include "support/extent.h"
#include "support/year.h"

enum { SENSORS = 70 /* two blocks */, TEXT = 1 << 14 };

static const char glass_room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
    "void plastic e 0 0 5 .2 .2 .2 0 0\ne polygon ground "
    "0 0 12 -40 -40 -.3 40 -40 -.3 40 40 -.3 -40 40 -.3\n";
static const char panel_room[] = ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE;
static const char yard[] = ROOM_GREY "w polygon s 0 0 12 -4 -4 0 -4 -4 6 4 -4 6 4 -4 0\n";
static const struct year_site izmir = {38.42, 27.14, 2};

/* ---- The room's years ------------------------------------------------------------------------ */

static const char *panel_text(void)
{
    static char *text;
    size_t size;
    if (text)
        return text;
    char *xml = (char *)scene_read_bytes("tests/fixtures/bsdf_lcp8.xml", &size);
    text = calloc(size + 1, 1);
    assert_non_null(text);
    memcpy(text, xml, size);
    free(xml);
    return text;
}

static struct year_run run_of(const char *scene, const char *kept_in)
{
    static struct orl_sensor sensors[SENSORS];
    for (int i = 0; i < SENSORS; i++)
        sensors[i] =
            (struct orl_sensor){{0.3 + 0.35 * (i % 10), 0.3 + 0.6 * (i / 10), 0.8}, {0, 0, 1}};
    return (struct year_run){.scene = scene,
                             .resource_name = scene == panel_room ? "pane.xml" : NULL,
                             .resource_text = scene == panel_room ? panel_text() : NULL,
                             .site = izmir,
                             .sensors = sensors,
                             .n_sensors = SENSORS,
                             .samples = (uint32_t)extent(32, 128),
                             .photons = (uint32_t)extent(5000, 0),
                             .seed = 5,
                             .kept_in = kept_in};
}

/* Two days; other: those of another year, in which other hours are bright, some of them dark
 * before, and one is unknown. */
static const char *weather_of(bool other)
{
    static char text[TEXT], changed[TEXT];
    snprintf(text, TEXT,
             "place made_up\nlatitude %.4f\nlongitude %.4f\ntime_zone %.1f\nsite_elevation 0\n"
             "weather_data_file_units 1\n",
             izmir.latitude_deg, -izmir.longitude_deg, -15 * izmir.time_zone_h);
    const size_t head = strlen(text);
    year_day(&izmir, 3, 22, text, TEXT);
    year_day(&izmir, 12, 21, text, TEXT);
    snprintf(changed, TEXT, "%.*s", (int)head, text);
    size_t row = 0;
    for (char *line = text + head; other && *line; row++) {
        const size_t used = strlen(changed);
        int month, day;
        double hour, direct, diffuse;
        assert_int_equal(sscanf(line, "%d %d %lf %lf %lf", &month, &day, &hour, &direct, &diffuse),
                         5);
        const bool up = diffuse > 0;
        snprintf(changed + used, TEXT - used, "%d %d %.3f %.0f %.0f\n", month, day, hour,
                 row == 11            ? 9999
                 : up && row % 3 != 0 ? 20 + 31 * (double)(row % 7)
                                      : 0,
                 up ? 30 + 0.7 * diffuse : 0);
        line = strchr(line, '\n') + 1;
    }
    return other ? changed : text;
}

static void assert_same(const struct orl_annual_result *a, const struct orl_annual_result *b)
{
    const size_t bytes = a->n_sensors * a->n_columns * sizeof(float);
    assert_int_equal(a->n_columns, b->n_columns);
    assert_memory_equal(a->total, b->total, bytes);
    assert_memory_equal(a->direct, b->direct, bytes);
    assert_memory_equal(a->se, b->se, bytes);
}

static uint64_t count_made(const struct orl_annual_result *year)
{
    uint64_t made = 0;
    for (int i = 0; i < ORL_ANNUAL_CACHE_KINDS; i++)
        made += year->reuse.of[i].made + year->reuse.of[i].topped_up;
    return made;
}

/* Runs it as given and without the cache, and expects equal results. */
static struct orl_annual_result run_twice(const struct year_run *run)
{
    struct year_run plain = *run;
    plain.kept_in = NULL;
    struct orl_annual_result year = year_run(run), alone = year_run(&plain);
    assert_true(year.reuse.asked && !alone.reuse.asked);
    assert_same(&year, &alone);
    assert_int_equal(year.n_warnings, alone.n_warnings);
    for (size_t i = 0; i < year.n_warnings; i++)
        assert_string_equal(year.warnings[i], alone.warnings[i]);
    orl_annual_done(&alone);
    return year;
}

/* ---- Another weather file -------------------------------------------------------------------- */

static void check_weather(const char *scene, size_t maps)
{
    char folder[64];
    cli_make_folder(folder);
    struct year_run run = run_of(scene, folder);
    run.weather = weather_of(false);
    struct orl_annual_result first = run_twice(&run);
    assert_int_equal(count_made(&first), 1 + maps + 2 + 2);
    assert_true(first.health.rays > 0);
    run.weather = weather_of(true);
    run.threads = 2;
    struct orl_annual_result other = run_twice(&run);
    assert_int_equal(count_made(&other), 0);
    assert_int_equal(other.health.rays, 0);
    assert_int_equal(other.health.paths, 0);
    assert_int_equal(other.reuse.of[ORL_ANNUAL_CACHE_SUN_WEIGHTS].found, 1);
    assert_int_equal(other.reuse.of[ORL_ANNUAL_CACHE_PATHS].found, 2);
    assert_int_equal(other.reuse.of[ORL_ANNUAL_CACHE_SUNLIGHT].found, 2);
    assert_int_equal(other.reuse.of[ORL_ANNUAL_CACHE_PATHS].rays_saved, first.health.rays);
    orl_annual_done(&first);
    orl_annual_done(&other);
    cli_remove_folder(folder);
}

static void test_another_weather_file_casts_no_ray(void **state)
{
    (void)state;
    check_weather(glass_room, 1);
    check_weather(panel_room, 1);
    check_weather(yard, 0);
}

/* ---- More samples ---------------------------------------------------------------------------- */

static void test_more_samples_go_on(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct year_run run = run_of(panel_room, folder);
    struct orl_annual_result few = run_twice(&run);
    run.samples = (uint32_t)extent(128, 512);
    run.threads = 7;
    struct orl_annual_result many = run_twice(&run);
    assert_int_equal(many.reuse.of[ORL_ANNUAL_CACHE_PATHS].topped_up, 2);
    assert_int_equal(many.reuse.of[ORL_ANNUAL_CACHE_PATHS].rays_saved, few.health.rays);
    assert_int_equal(count_made(&many), 2);
    run.kept_in = NULL;
    struct orl_annual_result alone = year_run(&run);
    assert_int_equal(many.health.rays + few.health.rays, alone.health.rays);
    orl_annual_done(&few);
    orl_annual_done(&many);
    orl_annual_done(&alone);
    cli_remove_folder(folder);
}

/* ---- Keys ------------------------------------------------------------------------------------ */

static uint64_t made_by(const struct year_run *run)
{
    struct orl_annual_result year = run_twice(run);
    const uint64_t made = count_made(&year);
    orl_annual_done(&year);
    return made;
}

static void test_what_differs_is_made(void **state)
{
    static char darker[sizeof glass_room];
    struct orl_sensor moved[SENSORS];
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    const struct year_run first = run_of(glass_room, folder);
    assert_int_equal(made_by(&first), 6);
    struct year_run run = first;
    run.seed++;
    assert_int_equal(made_by(&run), 6);
    run = first;
    run.north_deg = 10;
    assert_int_equal(made_by(&run), 6);
    run = first;
    run.site.latitude_deg += 0.1;
    assert_int_equal(made_by(&run), 6);
    run = first;
    memcpy(darker, glass_room, sizeof darker);
    strstr(darker, ".2 .2 .2")[1] = '1';
    run.scene = darker;
    assert_int_equal(made_by(&run), 6);
    /* Another sensor in the second block invalidates only that block. */
    run = first;
    memcpy(moved, first.sensors, sizeof moved);
    moved[SENSORS - 1].position.x += 0.01;
    run.sensors = moved;
    assert_int_equal(made_by(&run), 2);
    run.n_sensors = 64;
    assert_int_equal(made_by(&run), 0);
    assert_int_equal(made_by(&first), 0);
    cli_remove_folder(folder);
}

/* ---- Damage ---------------------------------------------------------------------------------- */

enum damage { FLIPPED, CUT, EMPTY };

static size_t damage_all(const char *folder, enum damage damage)
{
    DIR *entries = opendir(folder);
    size_t n = 0;
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        char path[512];
        if (strncmp(entry->d_name, "annual-", 7) != 0)
            continue;
        assert_null(strstr(entry->d_name, ".part"));
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        FILE *file = fopen(path, "r+b");
        assert_non_null(file);
        assert_int_equal(fseek(file, 0, SEEK_END), 0);
        const long size = ftell(file), at = size - 1 - (long)(n * 131 % (size_t)size);
        assert_int_equal(fseek(file, at, SEEK_SET), 0);
        const int byte = fgetc(file);
        assert_int_equal(fseek(file, at, SEEK_SET), 0);
        if (damage == FLIPPED)
            fputc(byte ^ 4, file);
        fclose(file);
        if (damage != FLIPPED)
            assert_int_equal(truncate(path, damage == EMPTY ? 0 : at), 0);
        assert_true(orl_map_verify("annual", path, NULL) < 0);
        n++;
    }
    closedir(entries);
    return n;
}

static void test_damage_is_mended(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct year_run run = run_of(glass_room, folder), plain = run_of(glass_room, NULL);
    struct orl_annual_result alone = year_run(&plain), first = year_run(&run);
    for (int damage = FLIPPED; damage <= EMPTY; damage++) {
        assert_int_equal(damage_all(folder, (enum damage)damage), 6);
        struct orl_annual_result mended = year_run(&run);
        assert_same(&alone, &mended);
        assert_int_equal(count_made(&mended), 6);
        assert_true(mended.n_warnings > first.n_warnings);
        orl_annual_done(&mended);
        assert_int_equal(made_by(&run), 0);
    }
    orl_annual_done(&alone);
    orl_annual_done(&first);
    cli_remove_folder(folder);
}

/* A year of more sensors than the limit is not stored. */
static void test_large_years_are_left_out(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct year_run run = run_of(yard, folder);
    for (size_t most = SENSORS - 1; most <= SENSORS; most++) {
        const struct orl_annual_env env = {.reuse_most = most};
        run.env = &env;
        struct orl_annual_result year = year_run(&run);
        assert_int_equal(year.reuse.asked, most == SENSORS);
        assert_int_equal(count_made(&year), most == SENSORS ? 5 : 0);
        orl_annual_done(&year);
    }
    cli_remove_folder(folder);
}

/* A folder that cannot be written causes a warning. */
static void test_no_room_costs_nothing_but_time(void **state)
{
    struct year_run plain = run_of(glass_room, NULL), run = run_of(glass_room, "/dev/null/nowhere");
    (void)state;
    struct orl_annual_result alone = year_run(&plain), year = year_run(&run);
    assert_same(&alone, &year);
    assert_int_equal(year.n_warnings, alone.n_warnings + 1);
    assert_non_null(
        strstr(year.warnings[year.n_warnings - 1], "could not be cached for later jobs"));
    orl_annual_done(&alone);
    orl_annual_done(&year);
}

/* ---- The file -------------------------------------------------------------------------------- */

/* Any pattern of zeros is read back. */
static void test_words_come_back(void **state)
{
    char folder[64], path[128];
    uint32_t words[300];
    (void)state;
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/words", folder);
    for (uint32_t pattern = 0; pattern < 40; pattern++) {
        const size_t n = pattern * 7;
        struct orl_word_file_info file_info = {.key = "a key",
                                               .family = "a family",
                                               .target = 9,
                                               .rays = pattern},
                                  back;
        void *data = NULL;
        size_t size = 0;
        for (uint32_t i = 0; i < n; i++)
            words[i] = (i / (1 + pattern % 9)) % 2 == pattern % 2 ? 0 : i * 2654435761U + 1;
        assert_int_equal(orl_word_file_write(path, &file_info, words, n * sizeof *words, NULL), 0);
        assert_int_equal(orl_word_file_read(path, "a key", &back, &data, &size, NULL), 0);
        assert_int_equal(size, n * sizeof *words);
        assert_memory_equal(data, words, size);
        assert_string_equal(back.family, "a family");
        assert_true(back.target == 9 && back.rays == pattern && back.bytes == file_info.bytes);
        free(data);
        assert_int_equal(orl_word_file_read(path, "another", &back, &data, &size, NULL),
                         ORL_ERR_CORRUPT);
    }
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_another_weather_file_casts_no_ray),
        cmocka_unit_test(test_more_samples_go_on),
        cmocka_unit_test(test_what_differs_is_made),
        cmocka_unit_test(test_damage_is_mended),
        cmocka_unit_test(test_large_years_are_left_out),
        cmocka_unit_test(test_no_room_costs_nothing_but_time),
        cmocka_unit_test(test_words_come_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
