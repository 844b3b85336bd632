/*
 * BRTDfunc as glazing: transmission and mirror reflection against rtrace's at 1 000 rays, samples
 * against pdfs and shares, both transport directions, and refusals.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

#include "scene/material/kinds.h"
#include "scene/parse/parse.h"
#include "support/subject.h"

static const char functions[] =
    "fall = exp(-6*abs(Rdot)) - exp(-6);\n"
    "back(r) = r + fall*(1 - r); ahead(t) = t*(1 - fall)*(1 + .1*RdotP);\n"
    "plain = arg(10) * Rdot; abs(x) : if(x,x,-x);\n"
    "sr_r = back(if(plain, arg(11), arg(14))); sr_g = back(if(plain, arg(12), arg(15)));\n"
    "sr_b = back(if(plain, arg(13), arg(16)));\n"
    "st_r = ahead(if(plain, .9, 1)*arg(17)); st_g = ahead(arg(18)); st_b = ahead(arg(19));\n";

#define GLAZING                                                                                    \
    "void BRTDfunc m 10 sr_r sr_g sr_b st_r st_g st_b 0 0 0 g.cal 0 19 .1 .08 .07 .05 .06 .07 "    \
    ".02 .02 .02 1 .09 .1 .11 .2 .25 .3 .6 .55 .5\n"

/* Most of the light is diffuse, so that bins of samples are full. */
#define FRITTED                                                                                    \
    "void BRTDfunc m 10 sr_r sr_g sr_b st_r st_g st_b 0 0 0 g.cal 0 19 .4 .38 .37 .35 .36 .37 "    \
    ".3 .3 .3 1 .05 .06 .07 .1 .12 .14 .1 .09 .08\n"

static const double angles[] = {0, 87, 130};
enum { ANGLES = sizeof angles / sizeof *angles };

static void test_draws(void **state)
{
    struct subject s = subject_of(FRITTED, "g.cal", functions);
    (void)state;
    assert_int_equal(s.material->kind, ORL_MATERIAL_GLAZING);
    for (int i = 0; i < ANGLES; i++) {
        const struct orl_vec3 from = subject_direction(&s, angles[i], 20 + 37 * i);
        for (int t = 0; t < 2; t++) {
            const enum orl_transport transport = t ? ORL_TRANSPORT_EYE : ORL_TRANSPORT_LIGHT;
            const struct orl_vec3 eye = t ? from : orl_neg(from);
            subject_check_lobe(&s, from, transport, 1e-3, (uint64_t)(10 + 2 * i + t));
            subject_check_pdf(&s, from, transport, ORL_LOBE_ALL, 1e-3, (uint64_t)(90 + 2 * i + t));
            const struct tally tally =
                subject_draw(&s, from, transport, ORL_LOBE_ALL, (uint64_t)(200 + i));
            const double noise = 4 * sqrt(1.0 / subject_draws());
            const struct orl_rgb straight = orl_material_straight(s.material, &s.hit, eye);
            const struct orl_rgb mirrored = orl_material_mirrored(s.material, &s.hit, from);
            assert_true(fabs(tally.straight.r - straight.r) < noise);
            assert_true(fabs(tally.mirror.b - mirrored.b) < noise);
            const struct orl_rgb all = orl_material_albedo(s.material, &s.hit, from, ORL_LOBE_ALL);
            assert_true(orl_rgb_max(all) <= 1);
        }
    }
    subject_check_reciprocity(&s, 400);
    subject_done(&s);
}

/* Light from the front is transmitted by the share that an eye behind sees of the front. */
static void test_ways(void **state)
{
    struct subject s = subject_of(GLAZING, "g.cal", functions);
    const struct orl_vec3 front = subject_direction(&s, 0, 0), back = orl_neg(front);
    const double fall = 0, ahead = 1.1; /* at the normal; the error is exp(-6), twice */
    (void)state;
    assert_true(fabs(orl_material_straight(s.material, &s.hit, front).r - .9 * .6 * ahead) < 1e-9);
    assert_true(fabs(orl_material_straight(s.material, &s.hit, back).r - .6 * ahead) < 1e-9);
    assert_true(fabs(orl_material_mirrored(s.material, &s.hit, front).r - (.09 + fall)) < 1e-9);
    assert_true(fabs(orl_material_mirrored(s.material, &s.hit, back).r - .2) < 1e-9);
    const struct tally light =
        subject_draw(&s, front, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, 300);
    assert_true(fabs(light.straight.r - .6 * ahead) < 4 * sqrt(1.0 / subject_draws()));
    subject_done(&s);
}

/* Sums, sums by cos(i) and sums of squares of rtrace's values: straight transmission and mirror
 * reflection seen from the front, and straight transmission seen from behind. */
static void test_rtrace(void **state)
{
    static const double expected[3][9] = {
        {585.44223, 596.283753, 542.076139, 0.581720427, 0.592492061, 0.538629665, 342.76694,
         355.579559, 293.867405},
        {92.8909679, 102.859199, 112.82743, 0.0897648665, 0.099499364, 0.109233957, 8.63310186,
         10.5842893, 12.734209},
        {650.491367, 596.283753, 542.076139, 0.646355443, 0.592492061, 0.538629665, 423.169063,
         355.579559, 293.867405}};
    static const double step[] = {0.8191725133961645, 0.6710436067037893};
    struct subject s = subject_of(GLAZING, "g.cal", functions);
    const struct orl_hit hit = {.normal = {0, 0, 1}, .front = true};
    (void)state;
    for (int way = 0; way < 3; way++) {
        double sums[9] = {0};
        for (int i = 0; i < 1000; i++) {
            const double x = (fmod(i * step[0], 1) - .5) * 1.4,
                         y = (fmod(i * step[1], 1) - .5) * 1.4;
            const struct orl_vec3 eye = orl_normalize(orl_v3(-x, -y, way == 2 ? -1 : 1));
            const struct orl_rgb value = way == 1 ? orl_material_mirrored(s.material, &hit, eye)
                                                  : orl_material_straight(s.material, &hit, eye);
            const double channels[] = {value.r, value.g, value.b};
            for (int c = 0; c < 3; c++) {
                sums[c] += channels[c];
                sums[3 + c] += channels[c] * cos(i);
                sums[6 + c] += channels[c] * channels[c];
            }
        }
        for (int k = 0; k < 9; k++)
            if (!(fabs(sums[k] - expected[way][k]) < 2e-6 * (10 + fabs(expected[way][k]))))
                fail_msg("way %d, sum %d: %.9g, not %.9g", way, k, sums[k], expected[way][k]);
    }
    subject_done(&s);
}

static void test_refused(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"void BRTDfunc m 10 .1 .1 .1 .5 .5 .5 f f f g.cal 0 9 0 0 0 0 0 0 0 0 0\n",
         "'f' is not defined"},
        {"void BRTDfunc m 10 .1 .1 .1 Px .5 .5 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n", "uses Px"},
        {"void BRTDfunc m 10 .4 .4 .4 .5 .5 .5 0 0 0 . 0 9 .2 0 0 0 0 0 0 0 0\n", "more than 1"},
        {"void BRTDfunc m 10 .1 .1 .1 .5 .5 1/(Rdot-Rdot) 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n",
         "have no value"},
        {"void BRTDfunc m 9 .1 .1 .1 .5 .5 .5 0 0 0 0 9 0 0 0 0 0 0 0 0 0\n", "nine functions"},
        {"void brightfunc p 2 Rdot . 0 0\n"
         "p BRTDfunc m 10 .1 .1 .1 .5 .5 .5 0 0 0 . 0 9 .1 .1 .1 0 0 0 0 0 0\n",
         "depends on the ray's direction"},
        {"void texfunc p 4 Px 0 0 . 0 0\n"
         "p BRTDfunc m 10 .1 .1 .1 .5 .5 .5 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n",
         "are not simulated on BRTDfunc"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static const char *const names[] = {"a.rad", "g.cal"};
        struct orl_parsed_scene parsed_scene = {0};
        struct orl_error err = {0};
        char text[512];
        snprintf(text, sizeof text, "%sm polygon q 0 0 9 0 0 0 1 0 0 0 1 0\n", cases[i].text);
        const struct orl_file contents[] = {{text, strlen(text), NULL},
                                            {functions, sizeof functions - 1, NULL}};
        struct orl_memory_files memory = {names, contents, 2};
        const struct orl_files files = orl_files_from_memory(&memory);
        const int code = orl_scene_parse(names, 1, &files, &parsed_scene, &err);
        if (code == 0 || !strstr(err.message, cases[i].message))
            fail_msg("case %zu: %d %s", i, code, err.message);
        orl_parsed_scene_done(&parsed_scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draws),
        cmocka_unit_test(test_ways),
        cmocka_unit_test(test_rtrace),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
