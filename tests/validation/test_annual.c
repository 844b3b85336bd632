/*
 * Hours of an annual run compared with separate render jobs of these hours, and with closed forms.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/extent.h"
#include "support/year.h"

enum { SAMPLES = 2048, TRUTH_SAMPLES = 1024, FEW = 512 };

/* The number of samples. Bounds follow from standard errors, which have the same number of batches
 * for any number of samples. */
static uint32_t year_samples(void)
{
    return (uint32_t)extent(SAMPLES / 2, SAMPLES);
}

/* The room of support/room.h with a pane in a wall, on ground. */
static const char glass_room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND;
static const char pool_room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND
    "void mirror m 0 0 3 .8 .8 .8\nm polygon pool 0 0 12 0 -4 -.2 4 -4 -.2 4 -.5 -.2 0 -.5 -.2\n";
static const char mirror_room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND
    "void mirror m 0 0 3 .9 .9 .9\nm polygon tray 0 0 12 1.8 1.2 .7 2.2 1.2 .7 2.2 1.5 .8 1.8 1.5 "
    ".8\n";
/* The glass room with a BSDF pane that deflects light, in place of the glass. */
static const char panel_room[] = ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE ROOM_GROUND;
/* Four walls of 6 m around a yard of 8 x 8 m, without glazing. */
static const char courtyard[] =
    ROOM_GREY "w polygon ground 0 0 12 -20 -20 0 20 -20 0 20 20 0 -20 20 0\n"
              "w polygon s 0 0 12 -4 -4 0 -4 -4 6 4 -4 6 4 -4 0\n"
              "w polygon n 0 0 12 -4 4 0 4 4 0 4 4 6 -4 4 6\n"
              "w polygon e 0 0 12 4 -4 0 4 -4 6 4 4 6 4 4 0\n"
              "w polygon o 0 0 12 -4 -4 0 -4 4 0 -4 4 6 -4 -4 6\n";
/* A stone far below the sensor, since a scene must not be empty. */
static const char nothing_near[] =
    "void plastic w 0 0 5 0 0 0 0 0\nw sphere stone 0 0 4 0 0 -50 .1\n";

/* Two days in spring and winter; hours of clear and overcast skies. */
static const struct year_site izmir = {38.42, 27.14, 2};

/*
 * Compares every fourth hour of the year's two days at each sensor (every other one in the long
 * suite) with a backward job. Both have a standard error of 15 degrees of freedom. Over some dozens
 * of differences, whose squares are correlated by sensor, the rms must be near 1, and none
 * beyond 4.5, which Student's t with 15 exceeds once in 2000. The interpolation error between sun
 * nodes is within that, even for a coarse BSDF under a low sun.
 */
static void check_hours(const struct year_run *asked)
{
    struct year_run run = *asked;
    const size_t n_sensors = asked->n_sensors;
    run.site = izmir;
    run.samples = year_samples();
    run.photons = extent_is_long() ? 0 : 50000;
    run.seed = 5;
    struct orl_annual_result year = year_run(&run);
    double squares = 0, worst = 0;
    size_t n = 0;
    assert_true(year.n_columns > 12);
    for (size_t c = 0; c < year.n_columns; c += extent(4, 2)) {
        const struct orl_annual_step *step = &year.steps[year.step_of_column[c]];
        double lx[16], se[16];
        year_hour(&run, step, (uint32_t)extent(FEW, TRUTH_SAMPLES), lx, se);
        for (size_t s = 0; s < n_sensors; s++, n++) {
            const double found = (double)orl_annual_row(&year, year.total, s)[c];
            const double own = (double)orl_annual_row(&year, year.se, s)[c];
            const double z = (found - lx[s]) / hypot(hypot(own, se[s]), 2e-3 * lx[s]);
            squares += z * z;
            worst = fmax(worst, fabs(z));
            if (fabs(z) > 4)
                print_message("sensor %zu, %d/%d %.1f h: %.1f +- %.1f, alone %.1f +- %.1f\n", s,
                              step->month, step->day, step->hour, found, own, lx[s], se[s]);
        }
    }
    print_message("%zu sensor-hours: z rms %.2f, worst %.2f\n", n, sqrt(squares / (double)n),
                  worst);
    assert_true(sqrt(squares / (double)n) < 1.5);
    assert_true(worst < 4.5);
    orl_annual_done(&year);
}

static void test_glass_room(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 1, .8}, {0, 0, 1}},
                                                {{1, 4, .8}, {0, 0, 1}},
                                                {{3, 2.6, 2.9}, {0, 0, -1}},
                                                {{2, 4.9, 1.5}, {0, -1, 0}}};
    (void)state;
    check_hours(&(struct year_run){.scene = glass_room, .sensors = sensors, .n_sensors = 4});
}

/* A pool of mirror in front of the window reflects the sun onto the ceiling: no photon map has this
 * light, but the annual run finds it. */
static void test_pool(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 1, .8}, {0, 0, 1}}, {{1, 4, .8}, {0, 0, 1}}};
    (void)state;
    check_hours(&(struct year_run){.scene = pool_room, .sensors = sensors, .n_sensors = 2});
}

/* A small tilted mirror indoors, below sensors that face down: rays are aimed at it. */
static void test_small_mirror(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 2.5, 1.5}, {0, 0, -1}},
                                                {{2.6, 2.5, 1}, {0, 0, -1}}};
    (void)state;
    check_hours(&(struct year_run){.scene = mirror_room, .sensors = sensors, .n_sensors = 2});
}

/* Coplanar mirrors count as one, however many: 320 tiles reflect as much light as the pool. */
static void test_tiles(void **state)
{
    static const struct orl_sensor sensor = {{2, 1, .8}, {0, 0, 1}};
    struct year_run run = {.scene = pool_room, .site = izmir, .sensors = &sensor, .n_sensors = 1};
    struct orl_annual_result whole = year_run(&run), tiled;
    char *text = malloc(1 << 16);
    (void)state;
    assert_non_null(text);
    int used = sprintf(text, "%svoid mirror m 0 0 3 .8 .8 .8\n", glass_room);
    for (int i = 0; i < 320; i++) {
        const double x = 0.2 * (i % 20), y = -4 + 3.5 / 16 * (i / 20);
        used +=
            sprintf(text + used, "m polygon t%d 0 0 12 %g %g -.2 %g %g -.2 %g %g -.2 %g %g -.2\n",
                    i, x, y, x + .2, y, x + .2, y + 3.5 / 16, x, y + 3.5 / 16);
    }
    run.scene = text;
    tiled = year_run(&run);
    assert_int_equal(tiled.n_columns, whole.n_columns);
    for (size_t c = 0; c < whole.n_columns; c++)
        assert_true(fabs((double)(tiled.total[c] - whole.total[c])) <
                    4 * hypot((double)tiled.se[c], (double)whole.se[c]) +
                        1e-3 * (double)whole.total[c]);
    orl_annual_done(&whole);
    orl_annual_done(&tiled);
    free(text);
}

/* Returns the panel's file as text; owned. */
static char *panel_text(void)
{
    size_t size;
    char *xml = (char *)scene_read_bytes("tests/fixtures/bsdf_lcp8.xml", &size);
    char *text = calloc(size + 1, 1);
    assert_non_null(text);
    memcpy(text, xml, size);
    free(xml);
    return text;
}

/* The panel's light is in the room through its photon map, and at sensors through points and BSDF
 * samples of the panel. */
static void test_panel_room(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 1, .8}, {0, 0, 1}},
                                                {{1, 4, .8}, {0, 0, 1}},
                                                {{3, 2.6, 2.9}, {0, -.5, -1}},
                                                {{2, 4.9, 1.5}, {0, -1, 0}}};
    char *text = panel_text();
    (void)state;
    check_hours(&(struct year_run){.scene = panel_room,
                                   .resource_name = "pane.xml",
                                   .resource_text = text,
                                   .sensors = sensors,
                                   .n_sensors = 4});
    free(text);
}

/* A screen in the room transmits light to a sensor behind it after a panel has scattered it. */
static void test_screen(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 3, 1.5}, {0, -1, 0}},
                                                {{1, 4, .8}, {0, -.3, 1}}};
    char scene[1 << 12], text[2048];
    (void)state;
    scene_uniform_bsdf(0.1, text);
    snprintf(scene, sizeof scene,
             "%svoid trans paper 0 0 7 .8 .8 .8 0 0 .7 0\n"
             "paper polygon screen 0 0 12 .1 1.5 .1 3.9 1.5 .1 3.9 1.5 2.8 .1 1.5 2.8\n",
             panel_room);
    check_hours(&(struct year_run){.scene = scene,
                                   .resource_name = "pane.xml",
                                   .resource_text = text,
                                   .sensors = sensors,
                                   .n_sensors = 2});
}

/* Eight slats in front of the panel: visibility of the sun is tested at each point of the panel. */
static void test_slats(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, .6, 1}, {0, -1, .3}},
                                                {{2, 4.9, 1.5}, {0, -1, 0}}};
    char scene[1 << 12], *text = panel_text();
    int used = snprintf(scene, sizeof scene, "%s", panel_room);
    (void)state;
    for (int i = 0; i <= 8; i++) {
        const double z = 1 + 1.5 / 8 * i;
        used += snprintf(scene + used, sizeof scene - (size_t)used,
                         "w polygon slat%d 0 0 12 .5 -.2 %g 3.5 -.2 %g 3.5 -.01 %g .5 -.01 %g\n", i,
                         z, z, z, z);
    }
    check_hours(&(struct year_run){.scene = scene,
                                   .resource_name = "pane.xml",
                                   .resource_text = text,
                                   .sensors = sensors,
                                   .n_sensors = 2});
    free(text);
}

static void test_courtyard(void **state)
{
    static const struct orl_sensor sensors[] = {
        {{0, 0, .1}, {0, 0, 1}}, {{3.5, 3.5, .1}, {0, 0, 1}}, {{0, 3.99, 2}, {0, -1, 0}}};
    (void)state;
    check_hours(&(struct year_run){.scene = courtyard, .sensors = sensors, .n_sensors = 3});
}

/*
 * Without obstructions a level sensor gets the illuminance of the weather file, to the rounding of
 * its numbers, and the sun's for its altitude. Patches that paths hit by chance are a sample of
 * 2048 of the sky: 3 standard errors are allowed.
 */
static void test_open_ground(void **state)
{
    static const struct orl_sensor sensors[] = {{{0, 0, 0}, {0, 0, 1}}, {{0, 0, 0}, {0, -1, 0}}};
    const struct year_run run = {.scene = nothing_near,
                                 .site = izmir,
                                 .sensors = sensors,
                                 .n_sensors = 2,
                                 .samples = SAMPLES};
    struct orl_annual_result year = year_run(&run);
    (void)state;
    for (size_t c = 0; c < year.n_columns; c++) {
        const struct orl_annual_step *s = &year.steps[year.step_of_column[c]];
        const double altitude = s->sun_altitude_deg * ORL_DEG_TO_RAD;
        const double azimuth = s->sun_azimuth_deg * ORL_DEG_TO_RAD;
        const double level = s->direct_normal_lx * sin(altitude);
        const double south = s->direct_normal_lx * fmax(0, cos(altitude) * cos(azimuth));
        const double total = (double)year.total[c], se = (double)year.se[c];
        assert_true(fabs(total - s->global_lx) <= 4 * se + 1e-3 * s->global_lx);
        if (s->sun_altitude_deg > 1) {
            assert_true(fabs((double)year.direct[c] - level) <= 1e-3 * level + 1e-3);
            assert_true(fabs((double)orl_annual_row(&year, year.direct, 1)[c] - south) <=
                        2e-3 * s->direct_normal_lx);
        }
    }
    orl_annual_done(&year);
}

/* The result has the same bytes for any number of threads. */
static void test_threads(void **state)
{
    static const uint32_t pools[] = {1, 2, 7};
    struct orl_annual_result years[3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        const struct year_run run = {.scene = glass_room,
                                     .site = izmir,
                                     .sensors = room_sensors,
                                     .n_sensors = ROOM_SENSORS,
                                     .samples = 64,
                                     .threads = pools[i]};
        years[i] = year_run(&run);
    }
    const size_t bytes = years[0].n_sensors * years[0].n_columns * sizeof(float);
    for (int i = 1; i < 3; i++) {
        assert_int_equal(years[i].n_columns, years[0].n_columns);
        assert_memory_equal(years[i].total, years[0].total, bytes);
        assert_memory_equal(years[i].direct, years[0].direct, bytes);
        assert_memory_equal(years[i].se, years[0].se, bytes);
    }
    for (int i = 0; i < 3; i++)
        orl_annual_done(&years[i]);
}

/* ---- Stored rows ----------------------------------------------------------------------------- */

enum { MANY = 70, MOST_CHUNKS = 64 };

/* Stored blocks of a run, as in a daemon; returns the blocks that exist. */
struct restored {
    struct orl_annual_chunk chunks[MOST_CHUNKS];
    float coherence[MOST_CHUNKS][MANY];
    size_t count, hits;
    uint32_t rounds;
};

static float *copy_rows(const struct orl_annual_chunk *chunk, const float *rows)
{
    const size_t bytes = chunk->count * chunk->n_columns * sizeof *rows;
    float *copy = malloc(bytes);
    assert_non_null(copy);
    memcpy(copy, rows, bytes);
    return copy;
}

static void on_done(void *ctx, const struct orl_annual_chunk *chunk)
{
    struct restored *restored = ctx;
    assert_true(restored->count < MOST_CHUNKS);
    struct orl_annual_chunk *own = &restored->chunks[restored->count++];
    *own = *chunk;
    own->total = copy_rows(chunk, chunk->total);
    own->direct = copy_rows(chunk, chunk->direct);
    own->se = copy_rows(chunk, chunk->se);
    memcpy(restored->coherence[restored->count - 1], chunk->coherence,
           chunk->count * sizeof *chunk->coherence);
    restored->rounds = chunk->round + 1;
}

static bool on_kept(void *ctx, struct orl_annual_chunk *chunk)
{
    struct restored *restored = ctx;
    for (size_t i = 0; i < restored->count; i++) {
        const struct orl_annual_chunk *own = &restored->chunks[i];
        const size_t bytes = own->count * own->n_columns * sizeof *own->total;
        if (own->round != chunk->round || own->first != chunk->first)
            continue;
        assert_true(own->count == chunk->count && own->n_columns == chunk->n_columns);
        memcpy(chunk->total, own->total, bytes);
        memcpy(chunk->direct, own->direct, bytes);
        memcpy(chunk->se, own->se, bytes);
        memcpy(chunk->coherence, restored->coherence[i], own->count * sizeof *chunk->coherence);
        restored->hits++;
        return true;
    }
    return false;
}

static void assert_same_years(const struct orl_annual_result *a, const struct orl_annual_result *b)
{
    const size_t bytes = a->n_sensors * a->n_columns * sizeof(float);
    assert_int_equal(a->n_columns, b->n_columns);
    assert_memory_equal(a->total, b->total, bytes);
    assert_memory_equal(a->direct, b->direct, bytes);
    assert_memory_equal(a->se, b->se, bytes);
}

/*
 * Several rounds for a verdict, with all blocks stored, half of them, or none, give the same bytes.
 */
static void test_kept_rows(void **state)
{
    struct orl_sensor sensors[MANY];
    struct restored restored = {.count = 0};
    const struct orl_annual_env env = {.restored = on_kept, .done = on_done, .ctx = &restored};
    struct orl_report_request report_request;
    struct orl_annual_refinement first, again;
    (void)state;
    for (int i = 0; i < MANY; i++)
        sensors[i] =
            (struct orl_sensor){{0.3 + 0.35 * (i % 10), 0.3 + 0.6 * (i / 10), 0.8}, {0, 0, 1}};
    struct year_run run = {.scene = glass_room,
                           .site = izmir,
                           .sensors = sensors,
                           .n_sensors = MANY,
                           .samples = 16,
                           .photons = (uint32_t)extent(5000, 0),
                           .env = &env,
                           .report_request = &report_request,
                           .ret_refinement = &first};
    assert_int_equal(orl_report_request_init(&report_request), 0);
    report_request.until = calloc(1, sizeof *report_request.until);
    assert_int_equal(orl_annual_target_parse("sDA500/50 >= 82 %", report_request.until, NULL), 0);
    struct orl_annual_result one = year_run(&run);
    assert_true(first.rounds >= 2 && restored.rounds == first.rounds && restored.hits == 0);
    const size_t chunks = restored.count;
    run.ret_refinement = &again;
    for (size_t left = chunks;; left /= 2) {
        for (size_t i = left; i < restored.count; i++) {
            free(restored.chunks[i].total);
            free(restored.chunks[i].direct);
            free(restored.chunks[i].se);
        }
        restored.count = left;
        restored.hits = 0;
        struct orl_annual_result other = year_run(&run);
        assert_int_equal(restored.hits, left);
        assert_int_equal(restored.count, chunks);
        assert_same_years(&one, &other);
        assert_true(again.rounds == first.rounds && again.most_samples == first.most_samples &&
                    again.area.value.value == first.area.value.value);
        orl_annual_done(&other);
        if (left == 0)
            break;
    }
    for (size_t i = 0; i < restored.count; i++) {
        free(restored.chunks[i].total);
        free(restored.chunks[i].direct);
        free(restored.chunks[i].se);
    }
    orl_annual_done(&one);
    orl_report_request_done(&report_request);
}

/* A scene that the annual run does not support is refused, and the error names the surface. */
static void test_refusals(void **state)
{
    static const char mirrors[] = ROOM_GREY "void mirror m 0 0 3 .9 .9 .9\n"
                                            "m polygon first 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
                                            "m polygon second 0 0 12 0 3 0 1 3 0 1 3 1 0 3 1\n";
    static const char crystal[] =
        "void dielectric d 0 0 5 .9 .9 .9 1.5 0\nd sphere ball 0 0 4 0 0 3 .5\n";
    static const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    struct year_run run = {.scene = mirrors, .site = izmir, .sensors = &sensor, .n_sensors = 1};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "'second'"));
    assert_string_equal(err.file, "scene.rad");
    assert_int_equal(err.line, 4);
    static const char loose[] =
        "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\np polygon sail 0 0 12 0 0 2 1 0 2 1 0 3 0 0 3\n";
    char xml[2048];
    scene_uniform_bsdf(0.1, xml);
    run.scene = loose;
    run.resource_name = "pane.xml";
    run.resource_text = xml;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "'sail'"));
    run.scene = crystal;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "'ball'"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_glass_room),  cmocka_unit_test(test_slats),
        cmocka_unit_test(test_screen),      cmocka_unit_test(test_panel_room),
        cmocka_unit_test(test_pool),        cmocka_unit_test(test_small_mirror),
        cmocka_unit_test(test_tiles),       cmocka_unit_test(test_courtyard),
        cmocka_unit_test(test_open_ground), cmocka_unit_test(test_threads),
        cmocka_unit_test(test_refusals),    cmocka_unit_test(test_kept_rows),
    };
    return cmocka_run_group_tests_name("annual", tests, NULL, NULL);
}
