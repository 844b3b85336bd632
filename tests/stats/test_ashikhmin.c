/*
 * ashik2: samples against pdfs, weights against values in both transport directions, reciprocity,
 * energy, and values against rtrace's.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "support/subject.h"

/* The last number is the quadrature's error in a bin: see test_material_sample.c. */
static const struct kind {
    const char *text;
    double slack;
} kinds[] = {
    {"void ashik2 m 4 .3 .2 .9 . 0 8 .5 .4 .3 .2 .3 .1 40 10\n", 0.003},
    {"void ashik2 m 4 .3 .2 .9 . 0 8 0 0 0 .9 .8 .7 5 200\n", 0.006},
    {"void ashik2 m 4 .3 .2 .9 . 0 8 .8 .8 .8 .05 .05 .05 0 0\n", 0.002},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const double angles[] = {0, 40, 75, 87, 130, 178};
enum { ANGLES = sizeof angles / sizeof *angles };

static void test_draws(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct subject s = subject_of(kinds[k].text, NULL, NULL);
        for (int i = 0; i < ANGLES; i++) {
            const struct orl_vec3 from = subject_direction(&s, angles[i], 20 + 37 * i);
            const enum orl_transport transport = i & 1 ? ORL_TRANSPORT_EYE : ORL_TRANSPORT_LIGHT;
            const uint64_t seed = (uint64_t)(100 + 20 * k + 2 * i);
            subject_check_lobe(&s, from, transport, kinds[k].slack, seed);
            subject_check_pdf(&s, from, transport, ORL_LOBE_ALL, kinds[k].slack, seed + 1000);
            subject_check_pdf(&s, from, transport, ORL_LOBE_REFLECTED, kinds[k].slack, seed + 2000);
        }
        subject_check_reciprocity(&s, (uint64_t)(400 + k));
        subject_done(&s);
    }
}

/*
 * A white surface, diffuse and lobe together 0.998 at the normal, reflects no more than it
 * receives at any angle. The mean of n weights, none above 2, has an uncertainty of 2 sqrt(1 / n).
 */
static void test_energy(void **state)
{
    static const double powers[][2] = {{0, 0}, {3, 3}, {50, 50}, {2000, 10}, {1e5, 1e5}};
    static const double steep[] = {0, 30, 60, 80, 86, 89, 89.9};
    (void)state;
    for (size_t p = 0; p < sizeof powers / sizeof *powers; p++) {
        char text[160];
        snprintf(text, sizeof text,
                 "void ashik2 m 4 1 0 0 . 0 8 .599 .599 .599 .399 .399 .399 %g %g\n", powers[p][0],
                 powers[p][1]);
        struct subject s = subject_of(text, NULL, NULL);
        for (size_t i = 0; i < sizeof steep / sizeof *steep; i++) {
            const struct tally t = subject_draw(&s, subject_direction(&s, steep[i], 50 * (double)i),
                                                ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 500 + i);
            const double all = t.glossy.g + t.diffuse.g;
            assert_true(t.most <= 2);
            assert_true(all <= 1 + 4 * sqrt(t.squares / subject_draws()) && all > 0.6);
        }
        subject_done(&s);
    }
}

/*
 * Values of rtrace (-st 1 -ss 0) for a sun of 0.02 degrees seen from the normal, where rtrace has
 * no Fresnel term; ours is below 1e-6 there up to 40 degrees. The width of the sun adds an error
 * of 1e-4.
 */
static void test_values(void **state)
{
    static const double angles_deg[] = {0, 5, 12, 20, 30, 40}, azimuths_deg[] = {0, 50, 140};
    static const double expected[6][3] = {
        {0.560230462, 0.560230462, 0.560230462},  {0.545345295, 0.529695826, 0.554317414},
        {0.479623538, 0.405466271, 0.526966719},  {0.363367467, 0.227538171, 0.472368911},
        {0.210172922, 0.0728122413, 0.380709385}, {0.0964729598, 0.0144011090, 0.280120308}};
    struct subject s =
        subject_of("void ashik2 m 4 .6 .8 0 . 0 8 0 0 0 .5 .3 .1 60 12\n", NULL, NULL);
    const struct orl_hit hit = {.normal = {0, 0, 1}, .front = true};
    (void)state;
    for (int i = 0; i < 6; i++)
        for (int k = 0; k < 3; k++) {
            const double t = angles_deg[i] * ORL_DEG_TO_RAD, p = azimuths_deg[k] * ORL_DEG_TO_RAD;
            const struct orl_vec3 sun = orl_v3(sin(t) * cos(p), sin(t) * sin(p), cos(t));
            const struct orl_rgb f =
                orl_material_eval_lobes(s.material, &hit, sun, orl_v3(0, 0, 1));
            if (!(fabs(f.r / expected[i][k] - 1) < 1e-4))
                fail_msg("%g %g: %g, not %g", angles_deg[i], azimuths_deg[k], f.r, expected[i][k]);
        }
    subject_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draws),
        cmocka_unit_test(test_energy),
        cmocka_unit_test(test_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
