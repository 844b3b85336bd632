/*
 * Materials: glass by Fresnel, energy, and samples against evaluated values (support/subject.h).
 * Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "scene/material/kinds.h"
#include "support/scene_text.h"
#include "support/subject.h"

static const struct orl_hit anywhere = {.normal = {0, 0, 1}, .front = true};

/* ---- Glass ------------------------------------------------------------------------------------
 */

#define CLEAR "void glass m 0 0 4 1 1 1 1.52\n"
#define TINTED "void glass m 0 0 4 .96 .96 .96 1.52\n"

/* Returns the transmittance of a pane at the incidence angle of this cosine. */
static struct orl_rgb straight_at(const struct orl_material *pane, double cosine)
{
    const struct orl_hit hit = {.normal = {0, 0, 1}};
    return orl_material_straight(pane, &hit, orl_v3(sqrt(1 - cosine * cosine), 0, cosine));
}

static struct orl_rgb mirrored_at(const struct orl_material *pane, double cosine)
{
    const struct orl_hit hit = {.normal = {0, 0, 1}};
    return orl_material_mirrored(pane, &hit, orl_v3(sqrt(1 - cosine * cosine), 0, cosine));
}

/* Fresnel at two surfaces, all passes summed, polarisations averaged: expected values have six
 * digits. */
static void test_slab(void **state)
{
    static const double angle[6] = {0, 30, 45, 60, 75, 85};
    static const double expected[6] = {.918318, .915957, .902528, .843471, .614805, .245646};
    struct subject clear = subject_of(CLEAR, NULL, NULL), tinted = subject_of(TINTED, NULL, NULL);
    (void)state;
    for (int i = 0; i < 6; i++) {
        const struct orl_rgb t = straight_at(clear.material, cos(angle[i] * ORL_DEG_TO_RAD));
        assert_true(fabs(t.g - expected[i]) < 1e-6);
    }
    assert_true(fabs(straight_at(tinted.material, 1).r - .881460) < 1e-6);
    subject_done(&clear);
    subject_done(&tinted);
}

/* Up to and at 90 degrees: T falls to 0, R rises to 1, nothing is gained, all is finite. */
static void test_glass_to_grazing(void **state)
{
    struct subject clear = subject_of(CLEAR, NULL, NULL), tinted = subject_of(TINTED, NULL, NULL);
    double before = 1;
    (void)state;
    for (int i = 10000; i >= 0; i--) {
        const double c = i > 100 ? i / 10000.0 : i == 0 ? 0 : pow(10, (i - 100) / 8.0 - 2);
        const double t = straight_at(clear.material, c).g;
        const double r = mirrored_at(clear.material, c).g;
        const double tt = straight_at(tinted.material, c).g;
        const double tr = mirrored_at(tinted.material, c).g;
        assert_true(isfinite(t) && isfinite(r) && isfinite(tt) && isfinite(tr));
        assert_true(t >= 0 && t <= before + 1e-12);
        assert_true(fabs(t + r - 1) < 1e-12);
        assert_true(tt >= 0 && tr >= 0 && tt <= t && tt + tr <= 1 + 1e-12);
        before = t;
    }
    assert_true(before < 1e-12);
    subject_done(&clear);
    subject_done(&tinted);
}

/* A choice of probability p and weight a/p has standard error a sqrt((1-p)/p/n); the tolerance is
 * 4 of these. */
static void assert_share(double mean, double share, double p)
{
    assert_true(fabs(mean - share) <= 4 * share * sqrt((1 - p) / p / subject_draws()) + 1e-12);
}

static void test_glass_draws(void **state)
{
    static const double angles[] = {0, 45, 80, 89.9};
    struct subject s = subject_of("void glass m 0 0 4 .9 .6 .3 1.52\n", NULL, NULL);
    (void)state;
    for (int i = 0; i < 4; i++) {
        const struct orl_vec3 from = subject_direction(&s, angles[i], 40);
        const double c = orl_dot(from, s.hit.normal);
        const struct orl_rgb t = straight_at(s.material, c);
        const struct orl_rgb r = mirrored_at(s.material, c);
        const double p = orl_luma(t) / (orl_luma(t) + orl_luma(r));
        const struct tally drawn = subject_draw(&s, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 1);
        assert_share(drawn.straight.r, t.r, p);
        assert_share(drawn.straight.b, t.b, p);
        assert_share(drawn.mirror.r, r.r, 1 - p);
        assert_share(drawn.mirror.b, r.b, 1 - p);
        /* Only one choice, so there is no noise. */
        const struct tally back = subject_draw(&s, from, ORL_TRANSPORT_EYE, ORL_LOBE_REFLECTED, 2);
        assert_true(fabs(back.mirror.g - r.g) < 1e-9 && orl_rgb_max(back.straight) == 0);
    }
    subject_done(&s);
}

/* ---- Plastic and metal ------------------------------------------------------------------------
 */

static void test_diffuse_and_mirror(void **state)
{
    struct subject plastic = subject_of("void plastic m 0 0 5 .6 .4 .2 .1 0\n", NULL, NULL);
    struct subject metal = subject_of("void metal m 0 0 5 .8 .6 .4 .7 0\n", NULL, NULL);
    const struct subject *const subjects[2] = {&plastic, &metal};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const struct subject *s = subjects[k];
        const struct orl_rgb d = orl_material_diffuse(s->material, &anywhere);
        const struct orl_rgb m = orl_reflector_specular(s->material, &anywhere);
        const struct orl_vec3 from = subject_direction(s, 70, 10);
        const double p = orl_luma(d) / (orl_luma(d) + orl_luma(m));
        const struct tally t = subject_draw(s, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 3);
        assert_share(t.diffuse.r, d.r, p);
        assert_share(t.diffuse.b, d.b, p);
        assert_share(t.mirror.r, m.r, 1 - p);
        assert_share(t.mirror.b, m.b, 1 - p);
    }
    /* Radiance's rule: plastic's highlight is white, metal's is coloured. */
    assert_true(fabs(orl_material_diffuse(plastic.material, &anywhere).r - .54) < 1e-12);
    assert_true(fabs(orl_reflector_specular(plastic.material, &anywhere).b - .1) < 1e-12);
    assert_true(fabs(orl_material_diffuse(metal.material, &anywhere).b - .12) < 1e-12);
    assert_true(fabs(orl_reflector_specular(metal.material, &anywhere).b - .28) < 1e-12);
    subject_done(&plastic);
    subject_done(&metal);
}

/* Diffuse samples follow the cosine: mean cosine 2/3 (variance 1/18), none below the surface, both
 * sides alike. */
static void test_cosine_law(void **state)
{
    struct subject s = subject_of("void plastic m 0 0 5 .5 .5 .5 0 0\n", NULL, NULL);
    (void)state;
    for (int side = 0; side < 2; side++) {
        const struct orl_vec3 from = subject_direction(&s, side ? 150 : 30, 0);
        double sum = 0;
        for (int i = 0; i < subject_draws(); i++) {
            struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, (uint64_t)i);
            const struct orl_surface_sample d = orl_material_sample(
                s.material, &s.hit, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, &random);
            const double c = orl_dot(d.direction, s.hit.normal) * (side ? -1 : 1);
            assert_int_equal(d.event, ORL_EVENT_DIFFUSE);
            assert_true(c >= 0);
            sum += c / subject_draws();
        }
        assert_true(fabs(sum - 2.0 / 3) < 4 * sqrt(1.0 / 18 / subject_draws()));
    }
    subject_done(&s);
}

static void test_absorbers(void **state)
{
    struct subject black = subject_of("void plastic m 0 0 5 0 0 0 0 0\n", NULL, NULL);
    struct subject light = subject_of("void light m 0 0 3 1 1 1\n", NULL, NULL);
    struct subject white = subject_of("void plastic m 0 0 5 .9 .9 .9 0 0\n", NULL, NULL);
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_BENCH, 0);
    (void)state;
    assert_int_equal(orl_material_sample(black.material, &black.hit, black.hit.normal,
                                         ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, &random)
                         .event,
                     ORL_EVENT_ABSORBED);
    assert_int_equal(orl_material_sample(light.material, &light.hit, light.hit.normal,
                                         ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, &random)
                         .event,
                     ORL_EVENT_ABSORBED);
    assert_int_equal(orl_material_sample(white.material, &white.hit, white.hit.normal,
                                         ORL_TRANSPORT_EYE, ORL_LOBE_TRANSMITTED, &random)
                         .event,
                     ORL_EVENT_ABSORBED);
    subject_done(&black);
    subject_done(&light);
    subject_done(&white);
}

/* ---- Lobes ----------------------------------------------------------------------------------- */

/* Ward's lobe, narrow and wide, from the normal to grazing, on a surface that mirrors nearly all
 * light. */
static void test_ward(void **state)
{
    static const double angles[] = {0, 45, 80, 88};
    static const char *const texts[2] = {"void metal m 0 0 5 .999 .999 .999 1 .05\n",
                                         "void metal m 0 0 5 .999 .999 .999 1 .2\n"};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct subject s = subject_of(texts[k], NULL, NULL);
        /* The narrow lobe at 88 degrees is thinner than the quadrature's steps. */
        for (int i = 0; i < (k == 0 ? 3 : 4); i++)
            subject_check_lobe(&s, subject_direction(&s, angles[i], 25), ORL_TRANSPORT_LIGHT, 0.004,
                               (uint64_t)(10 * k + i));
        subject_done(&s);
    }
}

/* Weights of samples of rough surfaces are bounded, to avoid fireflies. */
static void test_ward_weights(void **state)
{
    struct subject s = subject_of("void metal m 0 0 5 .9 .9 .9 1 .2\n", NULL, NULL);
    (void)state;
    for (int i = 0; i < subject_draws(); i++) {
        struct orl_random random = orl_random_stream(6, ORL_PURPOSE_BENCH, (uint64_t)i);
        const struct orl_vec3 from = subject_direction(&s, 90 * orl_random_uniform(&random), 0);
        const struct orl_surface_sample d =
            orl_material_sample(s.material, &s.hit, from, ORL_TRANSPORT_EYE, ORL_LOBE_ALL, &random);
        assert_true(d.event == ORL_EVENT_ABSORBED || d.weight.g <= 1.8);
    }
    subject_done(&s);
}

static void test_reciprocity(void **state)
{
    struct subject s = subject_of("void plastic m 0 0 5 .5 .5 .5 .1 .1\n", NULL, NULL);
    (void)state;
    subject_check_reciprocity(&s, 7);
    subject_done(&s);
}

/* ---- BSDFs, in both transport directions ----------------------------------------------------- */

/*
 * Light and eye transport follow the same f: one evaluates it forwards, the other samples it
 * backwards. The data is piecewise constant with steps inside bins: 2 % of a bin is allowed for
 * the quadrature.
 */
static void test_bsdf_transport(void **state)
{
    static const char *const names[2] = {"tests/fixtures/bsdf_lcp8.xml",
                                         "tests/fixtures/bsdf_klems41.xml"};
    static const double angles[] = {20, 60, 130};
    (void)state;
    for (int k = 0; k < 2; k++) {
        size_t size;
        unsigned char *xml = scene_read_bytes(names[k], &size);
        xml[size] = '\0';
        struct subject s =
            subject_of("void BSDF m 6 0 made.xml 0 1 0 . 0 0\n", "made.xml", (const char *)xml);
        for (int i = 0; i < 3; i++) {
            const struct orl_vec3 from = subject_direction(&s, angles[i], 75);
            subject_check_lobe(&s, from, ORL_TRANSPORT_LIGHT, 0.02, (uint64_t)(40 + 10 * k + i));
            subject_check_lobe(&s, from, ORL_TRANSPORT_EYE, 0.02, (uint64_t)(60 + 10 * k + i));
        }
        subject_done(&s);
        free(xml);
    }
}

/* A uniform pane is reciprocal: sampled from either end the mean weight is pi f, without noise. */
static void test_uniform_bsdf(void **state)
{
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.2, xml);
    struct subject s = subject_of("void BSDF m 6 0 made.xml 0 1 0 . 0 0\n", "made.xml", xml);
    for (int i = 0; i < 4; i++) {
        const struct orl_vec3 from = subject_direction(&s, i & 1 ? 35 : 140, 0);
        const struct tally t = subject_draw(
            &s, from, i & 2 ? ORL_TRANSPORT_EYE : ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 8);
        assert_true(fabs(t.glossy.g - 0.2 * ORL_PI) < 1e-6);
    }
    subject_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slab),         cmocka_unit_test(test_glass_to_grazing),
        cmocka_unit_test(test_glass_draws),  cmocka_unit_test(test_diffuse_and_mirror),
        cmocka_unit_test(test_cosine_law),   cmocka_unit_test(test_absorbers),
        cmocka_unit_test(test_ward),         cmocka_unit_test(test_ward_weights),
        cmocka_unit_test(test_reciprocity),  cmocka_unit_test(test_bsdf_transport),
        cmocka_unit_test(test_uniform_bsdf),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
