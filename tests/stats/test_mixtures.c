/*
 * Mixtures of unlike materials, and sums of materials (WGMDfunc): samples against pdfs, weights
 * against values in both transport directions, reciprocity, and every component as the weighted
 * sum of both.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "scene/material/scatter.h"
#include "support/subject.h"

#define TWO                                                                                        \
    "void plastic p 0 0 5 .6 .5 .4 .1 .2\nvoid glass g 0 0 3 .9 .8 .7\n"                           \
    "void metal b 0 0 5 .9 .8 .7 .9 .15\nvoid trans t 0 0 7 .8 .8 .8 .05 .15 .6 .4\n"              \
    "void mirror r 0 0 3 .8 .8 .8\n"

/* The last number is the quadrature's error in a bin: see test_material_sample.c. */
static const struct kind {
    const char *text;
    double slack;
    bool directed; /* true if its shares depend on the eye's direction */
} kinds[] = {
    {TWO "void mixfunc m 4 p g .3 . 0 0\n", 0.003, false},
    {TWO "void mixfunc m 4 p b .6 . 0 0\n", 0.004, false},
    {TWO "void mixfunc m 4 t void .7 . 0 0\n", 0.004, false},
    {TWO "void mixfunc n 4 t r .5 . 0 0\nvoid mixfunc m 4 n b .4 . 0 0\n", 0.004, false},
    {TWO "void mixfunc m 4 p b abs(Rdot) . 0 0\n", 0.004, true},
    {TWO "void plastic q 0 0 5 .2 .3 .4 0 0\nvoid mixfunc m 4 r q (1-abs(Rdot))^2 . 0 0\n", 0.003,
     true},
    {"void WGMDfunc m 13 void .2 .15 .15 void .3 .1 .2 void 1 0 0 . 0 9 .2 .1 .1 .2 .1 .1 .1 .1 "
     ".2\n",
     0.004, false},
    {"void brightfunc half 2 .5 . 0 0\n"
     "void WGMDfunc m 13 half .4+.2 .2+Px-Px .1 void 0 0 0 void 1 1 0 . 0 9 .3 .3 .3 .3 .3 .3 0 0 "
     "0\n",
     0.004, false},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const double angles[] = {0, 40, 75, 87, 130, 178};
enum { ANGLES = sizeof angles / sizeof *angles };

static void test_draws(void **state)
{
    (void)state;
    for (int k = 0; k < KINDS; k++) {
        struct subject s = subject_of(kinds[k].text, NULL, NULL);
        assert_int_equal(s.material->kind, ORL_MATERIAL_MIXTURE);
        for (int i = 0; i < ANGLES; i++) {
            const struct orl_vec3 from = subject_direction(&s, angles[i], 20 + 37 * i);
            const enum orl_transport transport = i & 1 ? ORL_TRANSPORT_EYE : ORL_TRANSPORT_LIGHT;
            const uint64_t seed = (uint64_t)(100 + 20 * k + 2 * i);
            subject_check_lobe(&s, from, transport, kinds[k].slack, seed);
            subject_check_pdf(&s, from, transport, ORL_LOBE_ALL, kinds[k].slack, seed + 1000);
            if (!kinds[k].directed)
                subject_check_pdf(&s, from, transport, ORL_LOBE_DIFFUSE, kinds[k].slack,
                                  seed + 2000);
        }
        if (!kinds[k].directed)
            subject_check_reciprocity(&s, (uint64_t)(400 + k));
        subject_done(&s);
    }
}

/* 30 % plastic, 70 % glass: known values of each, and means of samples. */
static void test_shares(void **state)
{
    struct subject s = subject_of(kinds[0].text, NULL, NULL);
    struct subject glass = subject_of("void glass m 0 0 3 .9 .8 .7\n", NULL, NULL);
    const struct orl_vec3 from = subject_direction(&s, 50, 10);
    const struct orl_rgb straight = orl_material_straight(glass.material, &glass.hit, from);
    const struct orl_rgb mirrored = orl_material_mirrored(glass.material, &glass.hit, from);
    const struct tally t = subject_draw(&s, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 600);
    const double noise = 4 * sqrt(1.0 / subject_draws());
    (void)state;
    assert_true(fabs(orl_material_straight(s.material, &s.hit, from).b - .7 * straight.b) < 1e-12);
    assert_true(fabs(orl_material_mirrored(s.material, &s.hit, from).r - .7 * mirrored.r) < 1e-12);
    assert_true(fabs(orl_material_diffuse(s.material, &s.hit).g - .3 * .9 * .5) < 1e-12);
    assert_true(fabs(t.straight.g - .7 * straight.g) < noise);
    assert_true(fabs(t.mirror.g - .7 * mirrored.g) < noise);
    assert_true(fabs(t.diffuse.g - .3 * .9 * .5) < noise);
    const struct orl_rgb all = orl_material_albedo(s.material, &s.hit, from, ORL_LOBE_ALL);
    assert_true(orl_rgb_max(all) < 1);
    assert_true(orl_material_max_albedo(s.material, true, cos(.872664626), ORL_LOBE_ALL) >=
                orl_rgb_max(all) - 1e-12);
    assert_true(orl_material_is_window(s.material) && orl_material_has_lobes(s.material));
    assert_false(orl_material_transmits_lobes(s.material) || orl_material_is_matt(s.material));
    subject_done(&s);
    subject_done(&glass);
}

/* The mix depends on the eye's direction: at 60 degrees half is paint, half steel. Its diffuse
 * part is 0, so photon maps store none of it. */
static void test_directed(void **state)
{
    struct subject s = subject_of(kinds[4].text, NULL, NULL);
    const struct orl_vec3 eye = subject_direction(&s, 60, 10);
    const struct orl_vec3 light = subject_direction(&s, 20, 200);
    const struct orl_material *m = orl_mixture_of(s.material)->mixed;
    const double sum =
        .5 * (orl_material_eval_lobes(&m[0], &s.hit, light, eye).g +
              orl_material_eval_lobes(&m[1], &s.hit, light, eye).g) +
        .5 * (orl_material_diffuse(&m[0], &s.hit).g + orl_material_diffuse(&m[1], &s.hit).g) /
            ORL_PI;
    (void)state;
    assert_true(fabs(orl_material_eval_lobes(s.material, &s.hit, light, eye).g - sum) < 1e-12);
    assert_true(orl_rgb_max(orl_material_diffuse(s.material, &s.hit)) == 0);
    assert_true(orl_material_max_diffuse(s.material) == 0 && orl_material_has_lobes(s.material));
    assert_true(orl_material_max_lobes(s.material, true, .5) >=
                orl_rgb_max(orl_material_albedo(s.material, &s.hit, eye, ORL_LOBE_ALL)) - 1e-12);
    subject_done(&s);
}

/* WGMDfunc: every component equals that of its own material; the sides differ in their diffuse
 * part. */
static void test_sum(void **state)
{
    struct subject s = subject_of(
        "void WGMDfunc m 13 void .2 0 0 void .3 0 0 void 1 0 0 . 0 9 .2 .1 .1 .1 .3 .1 .1 .1 .2\n",
        NULL, NULL);
    const struct orl_vec3 from = subject_direction(&s, 50, 10);
    struct orl_hit behind = s.hit;
    (void)state;
    behind.front = !s.hit.front;
    const struct orl_hit *const front = s.hit.front ? &s.hit : &behind;
    const struct orl_hit *const back = s.hit.front ? &behind : &s.hit;
    assert_true(fabs(orl_material_diffuse(s.material, front).r - .2) < 1e-12);
    assert_true(fabs(orl_material_diffuse(s.material, back).g - .3) < 1e-12);
    assert_true(fabs(orl_material_mirrored(s.material, &s.hit, from).r - .2) < 1e-12);
    assert_true(fabs(orl_material_straight(s.material, &s.hit, from).r - .3) < 1e-12);
    const struct orl_rgb all = orl_material_albedo(s.material, front, from, ORL_LOBE_ALL);
    assert_true(fabs(all.b - (.1 + .2 + .3 + .2)) < 1e-12);
    assert_true(orl_material_max_albedo(s.material, true, .5, ORL_LOBE_ALL) >= orl_rgb_max(all));
    assert_true(orl_material_transmits_lobes(s.material) && orl_material_is_window(s.material));
    assert_false(orl_material_is_matt(s.material));
    subject_done(&s);
}

/* A mixture of void and void transmits all light and mirrors none. */
static void test_void(void **state)
{
    struct subject s = subject_of(TWO "void mixfunc m 4 p void 0 . 0 0\n", NULL, NULL);
    (void)state;
    for (int i = 0; i < 80; i += 10) {
        const struct orl_vec3 from = subject_direction(&s, i, 10);
        const struct orl_rgb through = orl_material_straight(s.material, &s.hit, from);
        const struct orl_rgb back = orl_material_mirrored(s.material, &s.hit, from);
        assert_true(fabs(through.r - 1) < 1e-12 && back.r < 1e-12);
        assert_true(orl_rgb_max(orl_material_diffuse(s.material, &s.hit)) == 0);
    }
    subject_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_draws),    cmocka_unit_test(test_shares),
        cmocka_unit_test(test_directed), cmocka_unit_test(test_sum),
        cmocka_unit_test(test_void),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
