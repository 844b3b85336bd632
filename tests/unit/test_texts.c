/*
 * Texts as patterns and mixtures: letters placed as by rtrace, at 1 000 rays, evenly, closely and
 * in steps; errors in fonts; and cache keys.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/built/scene.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"

#define FLOOR "floor polygon q 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
#define GLOW "t glow floor 0 0 4 1 2 3 0\n" FLOOR
#define PLACE ".1 3.8 0 .6 .1 0 -.1 -.9 0 "

static const char font[] =
    "# three letters and a space\n32 0\n65 10\n20 10 110 240 140 240 230 10 "
    "190 10 160 80 90 80 60 10 40 20 30 15\n66 8\n30 10 30 240 200 240 200 "
    "130 90 130 90 110 180 110 180 10\n67 4\n100 50 100 200 140 200 140 50\n";

static int parse(const char *text, const char *glyphs, struct orl_parsed_scene *ret,
                 struct orl_error *err)
{
    static const char *const names[] = {"a.rad", "t.fnt", "t.txt", "b.rad"};
    static const char words[] = "AB  BA\n\nC AAAAA    C\nACBA B";
    static const char moved[] = "void brighttext t 2 t.fnt t.txt 0 11 " PLACE ".9 .2\n" GLOW;
    const struct orl_file contents[] = {{text, strlen(text), NULL},
                                        {glyphs, strlen(glyphs), NULL},
                                        {words, sizeof words - 1, NULL},
                                        {moved, sizeof moved - 1, NULL}};
    struct orl_memory_files memory = {names, contents, sizeof names / sizeof *names};
    const struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse(names, 1, &files, ret, err);
}

static struct orl_scene *load(const char *text)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    if (parse(text, font, &parsed_scene, &err) < 0 ||
        orl_scene_new(&parsed_scene, &scene, &err) < 0)
        fail_msg("%s:%d %s: %s", err.file, err.line, err.primitive, err.message);
    return scene;
}

/* Returns the radiance that a ray sees of the floor: emitted, or transmitted of radiance 1. */
static struct orl_rgb seen(const struct orl_scene *scene, struct orl_vec3 origin,
                           struct orl_vec3 direction)
{
    struct orl_hit hit;
    const struct orl_vec3 back = orl_neg(direction);
    assert_true(orl_geometry_intersect(scene->geometry, orl_sub(origin, scene->geometry->center),
                                       direction, 100, &hit));
    const struct orl_material *const m = orl_scene_material(scene, hit.facet);
    return m->kind == ORL_MATERIAL_MIXTURE ? orl_material_straight(m, &hit, back)
                                           : orl_material_emission(m, &hit, back);
}

/*
 * Sums, sums by cos(i) and sums of squares of red, green and blue, by rtrace (-ov -ab 0). One ray
 * in a thousand on a letter's edge would change them by 0.7: there is none.
 */
static void test_rtrace(void **state)
{
    static const struct {
        const char *scene;
        double sums[9];
    } cases[] = {{"void brighttext t 2 t.fnt t.txt 0 11 " PLACE ".9 .2\n" GLOW,
                  {318.999998, 637.999997, 956.999987, -8.58654935, -17.1730987, -25.7596464,
                   170.899994, 683.599975, 1538.09985}},
                 {"void brighttext t 2 t.fnt t.txt 0 12 " PLACE ".9 .2 .2\n" GLOW,
                  {346.999997, 693.999995, 1040.99998, -7.49880274, -14.9976055, -22.4964067,
                   201.699992, 806.799968, 1815.29981}},
                 {"void brighttext t 2 t.fnt t.txt 0 12 " PLACE ".9 .2 -.2\n" GLOW,
                  {346.299997, 692.599995, 1038.89998, 0.0323175052, 0.0646350105, 0.0969525614,
                   200.929992, 803.719968, 1808.36981}},
                 {"void colortext t 5 t.fnt . AB C A 0 16 .1 3 0 .5 0 0 0 -2 0 .9 .2 .1 .3 .4 .5 "
                  "-.15\n" GLOW,
                  {373.200008, 751.200011, 1353.6, -2.22268314, 2.45739579, 6.49414102, 177.840001,
                   581.440017, 1986.48}},
                 {"void glass a 0 0 3 .8 .7 .9\nvoid mixtext floor 4 void a t.fnt t.txt 0 9 " PLACE
                  "\n" FLOOR,
                  {769.970507, 691.001308, 849.578139, -2.7859902, -4.07959029, -1.48083164,
                   603.734782, 497.102737, 726.439554}},
                 /* moved there and back */
                 {"!xform -t 0 0 1 -rz 90 -s 2 -s .5 -rz -90 -t 0 0 -1 b.rad\n",
                  {318.999998, 637.999997, 956.999987, -8.58654935, -17.1730987, -25.7596464,
                   170.899994, 683.599975, 1538.09985}}};
    static const double step[] = {0.7548776662466927, 0.5698402909980532, 0.8191725133961645,
                                  0.6710436067037893};
    (void)state;
    for (size_t s = 0; s < sizeof cases / sizeof *cases; s++) {
        struct orl_scene *const scene = load(cases[s].scene);
        double sums[9] = {0};
        for (int i = 0; i < 1000; i++) {
            double a[4];
            for (int k = 0; k < 4; k++)
                a[k] = fmod(i * step[k], 1);
            const struct orl_vec3 way = {(a[2] - .5) * 1.4, (a[3] - .5) * 1.4, -1};
            const struct orl_vec3 at = {.05 + 3.9 * a[0], .05 + 3.9 * a[1], 0};
            const struct orl_rgb value = seen(scene, orl_sub(at, way), orl_normalize(way));
            const double channels[] = {value.r, value.g, value.b};
            for (int c = 0; c < 3; c++) {
                sums[c] += channels[c];
                sums[3 + c] += channels[c] * cos(i);
                sums[6 + c] += channels[c] * channels[c];
            }
        }
        for (int k = 0; k < 9; k++)
            if (!(fabs(sums[k] - cases[s].sums[k]) < 2e-6 * (10 + fabs(cases[s].sums[k]))))
                fail_msg("scene %zu, sum %d: %.9g, not %.9g", s, k, sums[k], cases[s].sums[k]);
        orl_scene_release(scene);
    }
}

static void test_errors(void **state)
{
    static const struct {
        const char *text, *font, *message;
    } cases[] = {
        {"void brighttext t 2 x.fnt t.txt 0 11 " PLACE "1 0\n", "", "x.fnt"},
        {"void brighttext t 2 t.fnt x.txt 0 11 " PLACE "1 0\n", "65 0\n", "x.txt"},
        {"void brighttext t 1 t.fnt 0 11 " PLACE "1 0\n", "", "takes a font file"},
        {"void colortext t 2 t.fnt t.txt 0 11 " PLACE "1 0\n", "", "15 numbers"},
        {"void brighttext t 2 t.fnt t.txt 0 11 0 0 0 1 0 0 2 0 0 1 0\n", "", "do not span a plane"},
        {"void brighttext t 2 t.fnt t.txt 0 11 " PLACE "1 0\n", "65 2 0 0 256 0\n", "not a letter"},
        {"void brighttext t 2 t.fnt t.txt 0 11 " PLACE "1 0\n", "65 1 0 0 65 0\n", "not a letter"},
        {"void brighttext t 2 t.fnt t.txt 0 11 " PLACE "1 0\n", "A 1 0 0\n", "not a letter"},
        {"void brighttext t 2 t.fnt t.txt 0 11 " PLACE "1 0\n", "65 99999 0 0\n", "not a letter"},
        {"void brighttext t 2 t.fnt t.txt 0 11 " PLACE "1 0\n", "65 3 0 0\n", "not a letter"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_parsed_scene parsed_scene = {0};
        struct orl_error err = {0};
        char text[512];
        snprintf(text, sizeof text, "%s" GLOW, cases[i].text);
        const int code = parse(text, cases[i].font, &parsed_scene, &err);
        if (code == 0 || !strstr(err.message, cases[i].message))
            fail_msg("case %zu: %d %s", i, code, err.message);
        orl_parsed_scene_done(&parsed_scene);
    }
}

/* Every byte of a font changes the map key; a text used twice counts once. */
static void test_keys(void **state)
{
    static const char text[] = "!xform b.rad\n!xform b.rad\n";
    static const char *const fonts[] = {"65 0\n", "65 0 \n", "66 0\n"};
    struct orl_parsed_scene d[3] = {{0}};
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 3; i++)
        assert_int_equal(parse(text, fonts[i], &d[i], &err), 0);
    assert_int_equal(d[0].n_patterns, 1);
    assert_int_equal(d[0].n_materials, 1);
    assert_true(memcmp(d[0].digest, d[1].digest, sizeof d[0].digest) != 0);
    assert_true(memcmp(d[0].digest, d[2].digest, sizeof d[0].digest) != 0);
    for (int i = 0; i < 3; i++)
        orl_parsed_scene_done(&d[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rtrace),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
