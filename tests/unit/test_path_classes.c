/*
 * The table of path classes: it is complete, the README shows it, the planner finds the classes of
 * a scene, and it chooses techniques that find all of them.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/job/paths.h>

#include "support/plan_query.h"
#include "support/scene_text.h"

#define SET(class) (1U << ORL_PATHS_##class)

/* Every technique finds every class, except that photons do not find mist. Light that is found by
 * chance has no other strategy. */
static void test_table_is_complete(void **state)
{
    (void)state;
    for (int t = 0; t < ORL_TECHNIQUE_COUNT; t++)
        for (int c = 0; c < ORL_PATH_CLASSES; c++)
            for (int r = 0; r < ORL_RECEIVERS; r++) {
                const unsigned found = orl_path_strategies(
                    (enum orl_technique)t, (enum orl_path_class)c, (enum orl_path_receiver)r);
                const bool photons = t > ORL_TECHNIQUE_BACKWARD;
                assert_int_equal(found == 0, c == ORL_PATHS_VOLUME && photons);
                assert_true(!(found & ORL_PATHS_BY_CHANCE) || found == ORL_PATHS_BY_CHANCE);
            }
}

/* Names are unique. */
static void test_names(void **state)
{
    (void)state;
    for (int a = 0; a < ORL_PATH_CLASSES; a++)
        for (int b = 0; b < a; b++) {
            const enum orl_path_class one = (enum orl_path_class)a, two = (enum orl_path_class)b;
            assert_string_not_equal(orl_path_class_name(one), orl_path_class_name(two));
            assert_string_not_equal(orl_path_class_words(one), orl_path_class_words(two));
        }
    for (unsigned i = 0; i < ORL_PATH_STRATEGIES; i++)
        assert_non_null(orl_path_strategy_name((enum orl_path_strategy)(1U << i)));
}

/* ---- The README ------------------------------------------------------------------------------ */

static void add_names(unsigned found, char *text, size_t size)
{
    bool first = true;
    if (found == 0)
        strncat(text, "none", size - strlen(text) - 1);
    for (unsigned i = 0; i < ORL_PATH_STRATEGIES; i++)
        if (found & 1U << i) {
            strncat(text, first ? "" : " ", size - strlen(text) - 1);
            strncat(text, orl_path_strategy_name((enum orl_path_strategy)(1U << i)),
                    size - strlen(text) - 1);
            first = false;
        }
}

/* Formats a row of the table: entries equal for both receivers are written once. */
static void format_row(enum orl_path_class class_of, char *text, size_t size)
{
    snprintf(text, size, "| `%s` | %s |", orl_path_class_name(class_of),
             orl_path_class_words(class_of));
    for (int t = 0; t < ORL_TECHNIQUE_COUNT; t++) {
        const enum orl_technique technique = (enum orl_technique)t;
        const unsigned air = orl_path_strategies(technique, class_of, ORL_RECEIVER_AIR);
        const unsigned surface = orl_path_strategies(technique, class_of, ORL_RECEIVER_SURFACE);
        strncat(text, " ", size - strlen(text) - 1);
        add_names(air, text, size);
        if (air != surface) {
            strncat(text, "; ", size - strlen(text) - 1);
            add_names(surface, text, size);
        }
        strncat(text, " |", size - strlen(text) - 1);
    }
}

static void test_readme_shows_the_table(void **state)
{
    size_t size;
    char *readme = (char *)scene_read_bytes("core/light/README.md", &size);
    (void)state;
    for (int c = 0; c < ORL_PATH_CLASSES; c++) {
        char row[512];
        format_row((enum orl_path_class)c, row, sizeof row);
        if (!strstr(readme, row))
            fail_msg("core/light/README.md lacks this row:\n%s", row);
    }
    free(readme);
}

/* ---- Classes that the planner finds ---------------------------------------------------------- */

#define ALL_SKY "void glow g 0 0 4 20 20 20 0\ng source sky 0 0 4 0 0 1 180\n"
#define SOUTH_SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 .5 .533\n"
#define LAMP "void light b 0 0 3 100 100 100\nb sphere lamp 0 0 4 0 1 2.5 .1\n"
#define WALL                                                                                       \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nw polygon floor 0 0 12 -3 -3 0 3 -3 0 3 3 0 -3 3 0\n"
#define MIRROR "void mirror m 0 0 3 .9 .9 .9\nm polygon mirror 0 0 12 -1 2 0 1 2 0 1 2 2 -1 2 2\n"
#define FACING MIRROR "m polygon other 0 0 12 -1 -2 0 -1 -2 2 1 -2 2 1 -2 0\n"
/* The lamp hides the middle of each mirror from the other; so does a pole beside it. */
#define MIDDLE_LAMP "void light b 0 0 3 100 100 100\nb sphere lamp 0 0 4 0 0 1 .1\n"
#define POLE "w cylinder pole 0 0 7 0 .5 0 0 .5 2 .1\n"
#define BETWEEN "void glass g 0 0 3 .9 .9 .9\ng polygon pane 0 0 12 -3 -1 0 3 -1 0 3 -1 3 -3 -1 3\n"
/* A periscope of mirrors of a decimetre. It gets little of the light, but may send it to a dark
 * place. Its lower mirror does not face the lamp. */
#define PERISCOPE                                                                                  \
    "void mirror m 0 0 3 .9 .9 .9\nm polygon upper 0 0 12 -.05 2 2.6 -.05 2.1 2.5 .05 2.1 2.5 "    \
    ".05 "                                                                                         \
    "2 2.6\nm polygon lower 0 0 12 -.05 2 1.1 .05 2 1.1 .05 2.1 1 -.05 2.1 1\n"
#define BALL "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere ball 0 0 4 0 .5 1 .3\n"
#define METAL_BALL "void metal s 0 0 5 .9 .9 .9 1 0\ns sphere dish 0 0 4 0 .5 1 .3\n"
#define ROUGH "void metal r 0 0 5 .9 .9 .9 1 .1\nr polygon rough 0 0 12 -1 2 0 1 2 0 1 2 2 -1 2 2\n"
#define MIST "void mist a 0 0 7 .1 .1 .1 .5 .5 .5 0\na sphere cloud 0 0 4 0 0 1 .5\n"

static const struct {
    const char *scene;
    uint32_t has, has_not;
    enum orl_technique of_sensors, of_views;
} scenes[] = {
    {ALL_SKY WALL, SET(SKY) | SET(DIFFUSE), SET(DIRECT) | SET(CURVED) | SET(VOLUME),
     ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER},
    {SOUTH_SUN WALL, SET(DIRECT) | SET(DIFFUSE), SET(SKY) | SET(FLAT_MIRRORS),
     ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER},
    {SOUTH_SUN WALL MIRROR, SET(DIRECT) | SET(FLAT_MIRRORS), SET(MANY_SUN_MIRRORS) | SET(CURVED),
     ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER},
    {LAMP WALL MIRROR, SET(DIRECT) | SET(FLAT_MIRRORS), SET(TWO_LAMP_MIRRORS),
     ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER},
    {LAMP WALL FACING, SET(FLAT_MIRRORS) | SET(TWO_LAMP_MIRRORS), SET(CURVED), ORL_TECHNIQUE_GATHER,
     ORL_TECHNIQUE_GATHER},
    {MIDDLE_LAMP WALL FACING POLE, SET(FLAT_MIRRORS) | SET(TWO_LAMP_MIRRORS), SET(CURVED),
     ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_GATHER},
    {MIDDLE_LAMP WALL FACING BETWEEN, SET(FLAT_MIRRORS) | SET(TWO_LAMP_MIRRORS), SET(CURVED),
     ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_GATHER},
    {LAMP WALL PERISCOPE, SET(TWO_LAMP_MIRRORS), SET(CURVED), ORL_TECHNIQUE_GATHER,
     ORL_TECHNIQUE_GATHER},
    {SOUTH_SUN WALL BALL, SET(CURVED), SET(FLAT_MIRRORS) | SET(SKY_CURVED), ORL_TECHNIQUE_GATHER,
     ORL_TECHNIQUE_GATHER},
    {SOUTH_SUN WALL METAL_BALL, SET(CURVED), SET(FLAT_MIRRORS), ORL_TECHNIQUE_GATHER,
     ORL_TECHNIQUE_GATHER},
    /* A lens lit only by a sky: rays find its light. */
    {ALL_SKY WALL BALL, SET(SKY) | SET(SKY_CURVED), SET(CURVED), ORL_TECHNIQUE_BACKWARD,
     ORL_TECHNIQUE_GATHER},
    {SOUTH_SUN WALL ROUGH, SET(LOBES), SET(NARROW_LOBES) | SET(CURVED), ORL_TECHNIQUE_BACKWARD,
     ORL_TECHNIQUE_GATHER},
    {SOUTH_SUN WALL MIST, SET(VOLUME), SET(CURVED), ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_BACKWARD},
};

static void check_scene(size_t i)
{
    static const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    const struct plan_query query = {.text = scenes[i].scene, .view = true, .sensor = &sensor};
    const struct orl_plan plan = plan_of(&query, NULL);
    if ((plan.paths & scenes[i].has) != scenes[i].has || (plan.paths & scenes[i].has_not) != 0)
        fail_msg("scene %zu: classes %x", i, plan.paths);
    assert_int_equal(plan.technique, scenes[i].of_views);
    assert_int_equal(plan.sensor_technique, scenes[i].of_sensors);
    assert_int_equal(orl_paths_missed(plan.sensor_technique, plan.paths), 0);
    assert_int_equal(orl_paths_missed(plan.technique, plan.paths), 0);
}

static void test_classes_of_scenes(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++)
        check_scene(i);
}

/* Adds mirrors that face 40 ways. */
static void add_mirrors(char *text, size_t size)
{
    for (int i = 0; i < 40; i++) {
        const double tilt = 0.002 * i * i, x = -2 + 0.1 * i;
        const size_t length = strlen(text);
        snprintf(text + length, size - length,
                 "m polygon mirror%d 0 0 9 %.3f 2 0 %.3f 2 0 %.3f %.4f 1\n", i, x, x + 0.08, x,
                 2 + tilt);
    }
}

/* In so many mirrors suns may have no virtual images; a scene without a sun lacks that class. */
static void test_many_mirrors(void **state)
{
    static const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    static const char *const lights[] = {SOUTH_SUN, LAMP};
    (void)state;
    for (int i = 0; i < 2; i++) {
        char text[8192];
        snprintf(text, sizeof text, "%s" WALL "void mirror m 0 0 3 .9 .9 .9\n", lights[i]);
        add_mirrors(text, sizeof text);
        const struct plan_query query = {.text = text, .view = true, .sensor = &sensor};
        const struct orl_plan plan = plan_of(&query, NULL);
        assert_int_equal((plan.paths & SET(MANY_SUN_MIRRORS)) != 0, i == 0);
    }
}

/* Adds a strip of mirror with that middle and half its sides: a x b faces the light. */
static int add_strip(char *text, size_t size, int index, struct orl_vec3 middle, struct orl_vec3 a,
                     struct orl_vec3 b)
{
    static const int corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    int at = snprintf(text, size, "m polygon strip%d 0 0 12", index);
    for (int i = 0; i < 4; i++) {
        const struct orl_vec3 p = orl_madd(orl_madd(middle, a, corners[i][0]), b, corners[i][1]);
        at += snprintf(text + at, size - (size_t)at, " %.9g %.9g %.9g", p.x, p.y, p.z);
    }
    return at + snprintf(text + at, size - (size_t)at, "\n");
}

/*
 * Sixteen mirrors on the ground send the sun up to mirrors that cross them. Sixteen of these show
 * it in 256 directions, more than there are images by two reflections; one shows it in sixteen.
 */
static void test_many_chains_of_few_mirrors(void **state)
{
    static const int crossing[] = {16, 1};
    (void)state;
    for (int i = 0; i < 2; i++) {
        char text[16384];
        int at = snprintf(text, sizeof text, "%s", SOUTH_SUN WALL "void mirror m 0 0 3 .9 .9 .9\n");
        for (int k = 0; k < 16 + crossing[i]; k++) {
            const double turn = ORL_DEG_TO_RAD * (k < 16 ? 22.5 + 0.5 * (k - 8) : 0.7 * (k - 24));
            const double off = 0.1 * (k % 16) - 0.75, c = cos(turn), s = sin(turn);
            at += k < 16 ? add_strip(text + at, sizeof text - (size_t)at, k, orl_v3(0, off, 1),
                                     orl_v3(1, 0, 0), orl_v3(0, .05 * c, .05 * s))
                         : add_strip(text + at, sizeof text - (size_t)at, k, orl_v3(off, 0, 4),
                                     orl_v3(0, 2, 0), orl_v3(.05 * c, 0, .05 * s));
        }
        const struct orl_plan plan = plan_of(&(struct plan_query){.text = text}, NULL);
        assert_int_equal((plan.paths & SET(MANY_SUN_MIRRORS)) != 0, i == 0);
    }
}

/*
 * A decimetre of mirror among many lamps and two large mirrors gets less than 2 % of the mirrored
 * light, so its pairs are left out; a dark place may have no other light. A pane does not count.
 */
static void test_a_small_mirror_among_many_lamps(void **state)
{
    static const char *const small[] = {"m", "g"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        char text[16384];
        int at =
            snprintf(text, sizeof text,
                     "void light b 0 0 3 100 100 100\nvoid glass g 0 0 3 .9 .9 .9\n" WALL FACING
                     "%s polygon small 0 0 12 -.05 2.5 1 .05 2.5 1 .05 2.5 1.1 -.05 2.5 1.1\n",
                     small[i]);
        for (int lamp = 0; lamp < 80; lamp++)
            at += snprintf(text + at, sizeof text - (size_t)at,
                           "b sphere lamp%d 0 0 4 %g %g 2.5 .02\n", lamp, -1 + .2 * (lamp % 10),
                           -1 + .25 * (lamp / 10));
        const struct orl_plan plan = plan_of(&(struct plan_query){.text = text}, NULL);
        assert_int_equal((plan.paths & SET(MANY_LAMP_MIRRORS)) != 0, i == 0);
    }
}

/* A job without mirrors has no light reflected by them. */
static void test_left_out_on_demand(void **state)
{
    const struct orl_plan plan = plan_of(&(struct plan_query){.text = SOUTH_SUN WALL BALL,
                                                              .effect = ORL_EFFECT_CAUSTICS_MIRROR,
                                                              .override = ORL_OVERRIDE_SKIP},
                                         NULL);
    (void)state;
    assert_int_equal(plan.paths & SET(CURVED), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table_is_complete),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_readme_shows_the_table),
        cmocka_unit_test(test_classes_of_scenes),
        cmocka_unit_test(test_left_out_on_demand),
        cmocka_unit_test(test_many_mirrors),
        cmocka_unit_test(test_many_chains_of_few_mirrors),
        cmocka_unit_test(test_a_small_mirror_among_many_lamps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
