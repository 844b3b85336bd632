/*
 * gensky and gendaylit, read natively: the numbers that Radiance 6.1's programs print for the same
 * words. Special cases: the sun near the zenith (altitude clamped at 87 degrees), sunrise within
 * an interval, night, high summer in the north, the southern hemisphere.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "scene/parse/parse.h"

struct expected {
    const char *command;
    double sun; /* radiance; -1: no sun is written */
    int n_args;
    double a[10];
};

static const struct expected expected[] = {
    {"gendaylit 3 22 12 -a 38.42 -o -27.14 -m -30 -W 800 120",
     6776000.0,
     10,
     {36.81, 28.19, -0.968251, -0.21475, 15.621716, -3.920319, 0.628189, 0.080798, -0.61939,
      0.780915}},
    {"gendaylit 6 21 14.5 -a 48.2 -o -16.4 -m -15 -W 0 250",
     0,
     10,
     {23.7, 9.413, 0.871201, -0.476826, 1.091681, -0.710907, -0.023294, -0.571714, -0.269603,
      0.774891}},
    {"gendaylit 12 21 +10 -a 42 -o 71 -m 75 -G 150 90",
     3149000.0,
     10,
     {28.88, 7.085, -0.965508, -0.324051, 12.568014, -3.312607, 0.053008, 0.458701, -0.827364,
      0.324133}},
    {"gendaylit 7 1 18.25 -a 60.2 -o -25 -m -30 -L 35000 12000 -g .1",
     2877000.0,
     10,
     {25.6, 3.486, -0.969366, -0.338925, 12.686027, -3.309914, 0.051203, -0.919049, 0.165762,
      0.357591}},
    {"gendaylit 9 10 9 -a -33.9 -o -151.2 -m -150 -E 420",
     2623000.0,
     10,
     {33.59, 13.82, -1.068076, -0.818288, 12.061746, -3.123248, 0.109481, 0.681685, 0.467023,
      0.563201}},
    {"gendaylit 1 15 12 -a 1.3 -o -103.8 -m -105 -W 600 300 -O 1",
     8828000.0,
     10,
     {63.71, 52.21, -0.801217, -0.501076, 12.650754, -3.546314, 0.117827, 0.057148, -0.383781,
      0.921654}},
    {"gendaylit 4 2 8 -y 2021 -a 51.5 -o 0 -m 0 -W 300 150 -d 5",
     2194000.0,
     10,
     {27.47, 7.658, -1.170421, -0.766108, 11.477303, -3.1238, 0.03608, 0.870278, -0.324381,
      0.370666}},
    {"gendaylit -ang 25 -60 -P 1.35 .25",
     982200,
     10,
     {27.68, 6.054, -1.157093, -0.718662, 10.33901, -3.036035, 0.112802, 0.784886, -0.453154,
      0.422618}},
    {"gendaylit -ang 70 20 -P 8.5 .08 -s",
     -1,
     10,
     {32.34, 4.879, -0.995807, -0.22233, 23.858223, -6.00442, 1.439941, -0.116978, -0.321394,
      0.939693}},
    {"gendaylit -ang 89 0 -W 900 90 -O 2",
     1375000000.0,
     10,
     {4161, 7390, -1.020169, -0.269402, 27.552033, -6.358006, 1.586417, 0, -0.052336, 0.99863}},
    {"gendaylit 5 5 4.4 -a 47 -o -8 -m -15 -i 60 -W 20 15",
     -1,
     10,
     {0, 0, 0, 0, 0, 0, 0, 0.830731, 0.542193, -0.126144}},
    {"gendaylit 11 3 22 -a 47 -o -8 -m -15 -W 0 0",
     -1,
     10,
     {0, 0, 0, 0, 0, 0, 0, -0.522015, 0.402891, -0.751784}},
    {"gensky 6 21 12 +s -a 40 -o 105 -m 105",
     7166000.0,
     7,
     {1, 27.75, 29.71, 1.514, 0.005614, -0.284825, 0.958563}},
    {"gensky 3 21 14:30MST -a 40 -o 105 +i",
     983400,
     7,
     {4, 17.35, 6.699, 0.9927, -0.582809, -0.527712, 0.617942}},
    {"gensky 12 21 10 -c -a 52 -o -13 -m -15 -g .3", -1, 3, {2, 7.761, 1.811}},
    {"gensky 9 21 15.5 -u -a 52 -o -13 -m -15", -1, 3, {3, 16.48, 3.296}},
    {"gensky 7 4 9 -s -a 38 -o 122 -m 120 -t 3.5",
     -1,
     7,
     {1, 17.47, 24.07, 0.5949, 0.684636, -0.073029, 0.725217}},
    {"gensky 10 31 13 -i -a 60 -o -11 -m -15",
     -1,
     7,
     {4, 7.303, 2.29, 1.217, -0.251615, -0.937295, 0.241181}},
    {"gensky 2 2 +12 +s -a 10 -o 0 -r 5e6",
     5000000.0,
     7,
     {1, 16.81, 20.1, 1.005, 0, -0.457818, 0.889046}},
    {"gensky 8 8 16CEST +s -a 45 -o -9 -R 400 -B 80",
     9120000.0,
     7,
     {1, 17.38, 30.64, 0.6067, -0.586073, -0.344429, 0.733407}},
    {"gensky 5 20 11 -y 1999 -a 35 -o -139 -m -135 +s",
     7160000.0,
     7,
     {1, 26.15, 29.48, 1.453, 0.165165, -0.252848, 0.953304}},
    {"gensky -ang 88 45 +s", 7210000.0, 7, {1, 148.6, 37.99, 2.714, -0.037007, -0.037007, 0.99863}},
    {"gensky -ang -3 90 +s", -1, 7, {1, 1.469, 0.6311, 0.2707, -0.99863, 0, -0.052336}},
    {"gensky -ang 15 -45 -c -b 20", -1, 3, {2, 20, 3.111}},
};

static struct orl_parsed_scene generate(const char *command)
{
    char text[256];
    const char *const names[] = {"sky.rad"};
    struct orl_file file = {text, (size_t)snprintf(text, sizeof text, "!%s\n", command), NULL};
    struct orl_memory_files memory = {names, &file, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    if (orl_scene_parse(names, 1, &files, &parsed_scene, &err) < 0)
        fail_msg("%s: %s", command, err.message);
    return parsed_scene;
}

static bool same(double value, double wanted)
{
    return fabs(value - wanted) <= 1e-9 * fabs(wanted);
}

static void test_printed_numbers(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const struct expected *e = expected + i;
        struct orl_parsed_scene d = generate(e->command);
        assert_int_equal(d.n_skies, 1);
        assert_int_equal(d.n_distant_sources, e->sun < 0 ? 0 : 1);
        assert_int_equal(d.skies[0].n_args, e->n_args);
        assert_int_equal(d.skies[0].kind, e->n_args == 10 ? ORL_SKY_PEREZ : ORL_SKY_CIE);
        for (int k = 0; k < e->n_args; k++)
            if (!same(d.skies[0].a[k], e->a[k]))
                fail_msg("%s: A%d is %.9g, not %.9g", e->command, k + 1, d.skies[0].a[k], e->a[k]);
        if (e->sun >= 0 && !same(d.materials[0].color.g, e->sun))
            fail_msg("%s: the sun's radiance is %.9g, not %.9g", e->command, d.materials[0].color.g,
                     e->sun);
        orl_parsed_scene_done(&d);
    }
}

/* The source is where the sky's own sun is, with the program's angular size. */
static void test_sun_and_sky_agree(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const struct expected *e = expected + i;
        struct orl_parsed_scene d = generate(e->command);
        if (e->sun >= 0) {
            const double *at = d.skies[0].a + (e->n_args == 10 ? 7 : 4);
            const struct orl_vec3 sun = orl_v3(at[0], at[1], at[2]);
            assert_int_equal(d.materials[d.distant_sources[0].material].kind, ORL_MATERIAL_LIGHT);
            assert_true(orl_dot(sun, d.distant_sources[0].direction) > 1.0 - 1e-5);
            assert_true(d.distant_sources[0].angle_deg == (e->n_args == 10 ? 0.533 : 0.5));
        }
        orl_parsed_scene_done(&d);
    }
}

/* gendaylit reads "12:30" as 12: the same sky here, with a warning. */
static void test_minutes_are_warned_about(void **state)
{
    struct orl_parsed_scene with = generate("gendaylit 3 22 12:30 -a 38 -o -27 -m -30 -W 800 120");
    struct orl_parsed_scene without = generate("gendaylit 3 22 12 -a 38 -o -27 -m -30 -W 800 120");
    (void)state;
    assert_memory_equal(with.skies[0].a, without.skies[0].a, sizeof with.skies[0].a);
    assert_int_equal(with.n_warnings, 1);
    assert_non_null(strstr(with.warnings[0], "minutes"));
    assert_int_equal(without.n_warnings, 0);
    orl_parsed_scene_done(&with);
    orl_parsed_scene_done(&without);
}

/* A border of the model's bins, no diffuse light, polar night and day: results are defined and
 * finite. */
static void test_edges_are_finite(void **state)
{
    static const char *const commands[] = {
        "gendaylit -ang 40 0 -P 1.065 .2",
        "gendaylit -ang 40 0 -P 6.2 .2",
        "gendaylit -ang 40 0 -P 12.01 .2",
        "gendaylit -ang 40 0 -W 800 0",
        "gendaylit -ang 0 0 -W 10 5",
        "gendaylit -ang -5 0 -W 0 5",
        "gendaylit 12 21 12 -a 80 -o 0 -m 0 -W 0 0",
        "gendaylit 6 21 0 -a 80 -o 0 -m 0 -W 100 50",
        "gendaylit 6 21 12 -a 90 -o 0 -m 0 -W 300 100",
        "gensky 12 21 12 -a 80 -o 0 -m 0",
        "gensky 6 21 0 -a 90 -o 0 -m 0 +i",
        "gensky -ang 90 0 -c",
    };
    (void)state;
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        struct orl_parsed_scene d = generate(commands[i]);
        assert_int_equal(d.n_skies, 1);
        for (int k = 0; k < d.skies[0].n_args; k++)
            assert_true(isfinite(d.skies[0].a[k]));
        orl_parsed_scene_done(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_printed_numbers),
        cmocka_unit_test(test_sun_and_sky_agree),
        cmocka_unit_test(test_minutes_are_warned_about),
        cmocka_unit_test(test_edges_are_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
