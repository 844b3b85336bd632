/*
 * Jobs in a scene that has trees in several places stored once as instances, compared with the
 * scene that has copies of the surfaces: in a hall with lamps among the trees, and behind a window
 * with trees outside. Every sample is equal in both, except for rounding, so the two use different
 * seeds. Values then agree within three joint standard errors, plus the bandwidth's bias.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/extent.h"
#include "support/grove.h"
#include "support/hdr.h"
#include "support/scene_text.h"
#include "support/scratch.h"

enum { SENSORS = 6, WIDTH_MOST = 40, HEIGHT_MOST = 30 };

/* The size of images in pixels: 24 by 18, and 40 by 30 in the long suite. The short form has a
 * quarter of that where only bytes, or sums of differences, are compared. */
static uint32_t width, height;

static void set_size(bool whole)
{
    width = (uint32_t)extent(whole ? 24 : 12, WIDTH_MOST);
    height = (uint32_t)extent(whole ? 18 : 9, HEIGHT_MOST);
}

static const struct orl_sensor hall_sensors[SENSORS] = {
    {{1, 0.3, -1.9}, {0, 0, 1}},    {{5, -0.6, -1.9}, {0, 0, 1}}, {{9, 1, 0}, {0, 0, 1}},
    {{14, -1.5, 1}, {0, 0.6, 0.8}}, {{20, 0, -1.9}, {0, 0, 1}},   {{31, 2, 1}, {0, -1, 0}}};

/* A hall around the trees, long in x, with two lamps under its ceiling. */
static const char hall[] = "void plastic wall 0 0 5 .6 .6 .6 0 0\n"
                           "void light lamp 0 0 3 40 40 40\n"
                           "!genbox wall hall 84 7 8 -i | xform -t -4 -3.5 -2\n"
                           "lamp polygon one 0 0 12 3 -1 5.9 3 1 5.9 8 1 5.9 8 -1 5.9\n"
                           "lamp polygon two 0 0 12 20 -1 5.9 20 1 5.9 25 1 5.9 25 -1 5.9\n";

static const struct orl_sensor room_sensors[SENSORS] = {
    {{10, -10, 0.8}, {0, 0, 1}}, {{12, -8, 0.8}, {0, 0, 1}},  {{14, -12, 0.8}, {0, 0, 1}},
    {{11, -6, 1.5}, {0, 1, 0}},  {{13, -9, 2.5}, {0, 0, -1}}, {{9, -7, 0.8}, {0, 0, 1}}};

/* A room with a window toward the trees, sky and sun. */
static const char room[] =
    "void plastic wall 0 0 5 .6 .6 .6 0 0\nvoid glass pane 0 0 3 .9 .9 .9\n"
    "void light sun 0 0 3 4e6 4e6 4e6\nsun source s 0 0 4 0.3 0.8 0.6 0.533\n"
    "void glow sky 0 0 4 20 20 20 0\nsky source d 0 0 4 0 0 1 180\n"
    "wall polygon floor 0 0 12 8 -14 0 16 -14 0 16 -5 0 8 -5 0\n"
    "wall polygon roof 0 0 12 8 -14 3 8 -5 3 16 -5 3 16 -14 3\n"
    "wall polygon west 0 0 12 8 -14 0 8 -5 0 8 -5 3 8 -14 3\n"
    "wall polygon east 0 0 12 16 -14 0 16 -14 3 16 -5 3 16 -5 0\n"
    "wall polygon back 0 0 12 8 -14 0 8 -14 3 16 -14 3 16 -14 0\n"
    "wall polygon sill 0 0 12 8 -5 0 16 -5 0 16 -5 .5 8 -5 .5\n"
    "pane polygon window 0 0 12 8 -5 .5 16 -5 .5 16 -5 3 8 -5 3\n";

struct set_up {
    const char *around;
    const struct orl_sensor *sensors;
    const char *view;
    enum grove_leaves leaves; /* copied blades that face the sky would be windows */
};

static const struct set_up set_ups[] = {
    {hall, hall_sensors, "-vtv -vp 2 -3 0 -vd 1 0.6 0.1 -vu 0 0 1 -vh 80 -vv 64", GROVE_BLADES},
    {room, room_sensors, "-vtv -vp 12 -12 1.5 -vd 0 1 0 -vu 0 0 1 -vh 80 -vv 64", GROVE_MATT},
    {hall, hall_sensors, "-vtv -vp 2 -3 0 -vd 1 0.6 0.1 -vu 0 0 1 -vh 80 -vv 64", GROVE_GLOSSY},
    {room, room_sensors, "-vtv -vp 12 -12 1.5 -vd 0 1 0 -vu 0 0 1 -vh 80 -vv 64", GROVE_GLOSSY},
    {hall, hall_sensors, "-vtv -vp 2 -3 0 -vd 1 0.6 0.1 -vu 0 0 1 -vh 80 -vv 64", GROVE_VARIED}};

static void write_set_up(const struct set_up *set_up)
{
    struct grove grove;
    grove_init_with(&grove, GROVE_TRIANGLES, GROVE_ROUND, GROVE_PLACES, set_up->leaves);
    grove_write(&grove, scratch_path(""));
    cli_write_file(scratch_path(""), "around.rad", set_up->around);
    grove_done(&grove);
}

static struct orl_result run_one(const struct set_up *set_up, bool shared,
                                 enum orl_technique technique, uint64_t seed, uint32_t threads,
                                 bool view, const char *folder)
{
    static const char *const names[2][2] = {{"around.rad", "expanded.rad"},
                                            {"around.rad", "shared.rad"}};
    return scene_run(&(struct scene_run){.source = scratch_path(""),
                                         .names = names[shared],
                                         .n_names = 2,
                                         .sensors = set_up->sensors,
                                         .n_sensors = SENSORS,
                                         .view = view ? set_up->view : NULL,
                                         .width = width,
                                         .height = height,
                                         .technique = technique,
                                         .overrides = scene_wish_maps,
                                         .global = extent(20000, 100000),
                                         .samples = (uint32_t)extent(512, 0),
                                         .seed = seed,
                                         .threads = threads,
                                         .folder = folder});
}

/* Two intervals of 95 % are four standard errors: of the 150 compared pairs (half in the short
 * form) 1 % would be further apart, if errors were not estimated with few degrees of freedom. */
static const double most_apart = 2;

/* Returns the joint width of the part of both intervals that lies between the values. */
static double joint_width(const struct orl_result *high, const struct orl_result *low, size_t i)
{
    return hypot(high->illuminance_lx[i] - high->interval_95_lx[i][0],
                 low->interval_95_lx[i][1] - low->illuminance_lx[i]);
}

static void expect_alike(const struct set_up *set_up, enum orl_technique technique)
{
    struct orl_result a = run_one(set_up, true, technique, 1, 2, false, NULL);
    struct orl_result b = run_one(set_up, false, technique, 2, 2, false, NULL);
    assert_int_equal(a.health.surfaces, b.health.surfaces);
    assert_int_equal(a.health.non_finite, 0);
    for (size_t i = 0; i < SENSORS; i++) {
        const double apart = a.illuminance_lx[i] - b.illuminance_lx[i];
        const double joint = apart > 0 ? joint_width(&a, &b, i) : joint_width(&b, &a, i);
        print_message("%s, sensor %zu: %.1f lx, %.1f expanded; %.1f joint intervals apart\n",
                      orl_technique_name(technique), i, a.illuminance_lx[i], b.illuminance_lx[i],
                      apart / joint);
        assert_true(a.illuminance_lx[i] > 0);
        assert_true(fabs(apart) <= most_apart * joint);
    }
    orl_result_done(&a);
    orl_result_done(&b);
}

/* The short form tests two techniques of each set-up, in turn: each has two or three kinds of
 * leaves, in the hall or in the room. */
static void test_alike(void **state)
{
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER,
                                                    ORL_TECHNIQUE_DIRECT,
                                                    ORL_TECHNIQUE_PRECOMPUTED};
    (void)state;
    for (size_t s = 0; s < sizeof set_ups / sizeof *set_ups; s++) {
        write_set_up(&set_ups[s]);
        for (size_t t = 0; t < sizeof techniques / sizeof *techniques; t++)
            if (extent_is_long() || t % 2 == s % 2)
                expect_alike(&set_ups[s], techniques[t]);
    }
}

/* Renders a view of one of the forms, by paths only. */
static void show(const struct set_up *set_up, bool shared, double (*ret_rgb)[3])
{
    char folder[64], path[128];
    cli_make_folder(folder);
    struct orl_result r = run_one(set_up, shared, ORL_TECHNIQUE_BACKWARD, 1, 2, true, folder);
    assert_int_equal(r.health.non_finite, 0);
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, (int)width, (int)height, ret_rgb);
    orl_result_done(&r);
    cli_remove_folder(folder);
}

/*
 * With one seed equal paths are sampled in both forms. They diverge where a ray passes an edge
 * within the 1e-4 by which ray origins above leaves differ, whose offset is that of their tree: as
 * in test_instances of unit, with a probability of 6.5e-3, so that 6 % of paths of ten rays
 * diverge. Those differ by no more than independent paths, so that most pixels, of a hundred paths,
 * agree to 2 %. Differences are unbiased: their sum is within three of its standard deviations.
 * Glossy or varied leaves are only tested for that: a path that ends at a lamp by way of a leaf has
 * forty times the light of the others.
 */
static void test_view(void **state)
{
    static double pictures[2][WIDTH_MOST * HEIGHT_MOST][3];
    (void)state;
    for (size_t s = 0; s < sizeof set_ups / sizeof *set_ups; s++) {
        set_size(set_ups[s].leaves < GROVE_GLOSSY);
        const unsigned pixels = width * height;
        double sum = 0, squares = 0;
        unsigned other = 0;
        write_set_up(&set_ups[s]);
        for (int shared = 0; shared < 2; shared++)
            show(&set_ups[s], shared, pictures[shared]);
        for (unsigned i = 0; i < pixels; i++) {
            const double a = pictures[0][i][1], b = pictures[1][i][1];
            sum += b - a;
            squares += (b - a) * (b - a);
            other += fabs(a - b) > 0.02 * fmax(a, b);
        }
        print_message("%u of %u pixels differ by more than 2 %%; in sum by %.2f deviations\n",
                      other, pixels, sum / sqrt(squares));
        assert_true(set_ups[s].leaves >= GROVE_GLOSSY || other < pixels / 10);
        assert_true(fabs(sum) < 3 * sqrt(squares));
    }
}

/* Equal seeds give equal bytes, for any number of threads. */
static void test_threads(void **state)
{
    static const uint32_t threads[] = {1, 7, 2};
    const size_t n_threads = extent(2, 3);
    (void)state;
    set_size(false);
    for (size_t s = 0; s < sizeof set_ups / sizeof *set_ups; s++) {
        unsigned char *first = NULL;
        double lx[SENSORS];
        size_t first_size = 0;
        write_set_up(&set_ups[s]);
        for (size_t i = 0; i < n_threads; i++) {
            char folder[64], path[128];
            size_t size = 0;
            cli_make_folder(folder);
            struct orl_result r =
                run_one(&set_ups[s], true, ORL_TECHNIQUE_GATHER, 1, threads[i], true, folder);
            snprintf(path, sizeof path, "%s/view.hdr", folder);
            unsigned char *const picture = scene_read_bytes(path, &size);
            if (i == 0) {
                memcpy(lx, r.illuminance_lx, sizeof lx);
                first = picture;
                first_size = size;
            } else {
                assert_memory_equal(lx, r.illuminance_lx, sizeof lx);
                assert_int_equal(size, first_size);
                assert_memory_equal(picture, first, size);
                free(picture);
            }
            orl_result_done(&r);
            cli_remove_folder(folder);
        }
        free(first);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_alike, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_view, scratch_set_up, scratch_tear_down),
        cmocka_unit_test_setup_teardown(test_threads, scratch_set_up, scratch_tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
