/*
 * Dielectrics, interfaces and mirrors against closed forms: Fresnel at the normal, at Brewster's
 * angle, at total reflection; Snell; light and eye transport, which differ by n^2; Beer's law; and
 * two interfaces crossed in turn, which equal a thin pane.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "scene/material/scatter.h"
#include "support/subject.h"

#define BLOCK "void dielectric m 0 0 5 1 1 1 1.5 0\n"

static double mirrored(const struct subject *s, struct orl_vec3 from)
{
    return orl_material_mirrored(s->material, &s->hit, from).g;
}

/* theta is in radians; subject_direction takes degrees. */
static struct orl_vec3 towards(const struct subject *s, double theta)
{
    return subject_direction(s, theta / ORL_DEG_TO_RAD, 33);
}

static void test_fresnel(void **state)
{
    struct subject s = subject_of(BLOCK, NULL, NULL);
    const double brewster = atan(1.5), critical = asin(1 / 1.5);
    (void)state;
    /* Reflectance at the normal is equal from both sides: ((n - 1) / (n + 1))^2. */
    assert_true(fabs(mirrored(&s, towards(&s, 0)) - 0.04) < 1e-12);
    assert_true(fabs(mirrored(&s, towards(&s, ORL_PI)) - 0.04) < 1e-12);
    /* At Brewster's angle one polarisation is fully transmitted; the other reflects
     * ((n^2-1)/(n^2+1))^2. */
    const double half = 0.5 * pow((1.5 * 1.5 - 1) / (1.5 * 1.5 + 1), 2);
    assert_true(fabs(mirrored(&s, towards(&s, brewster)) - half) < 1e-12);
    /* Total reflection begins at Snell's critical angle, from inside only. */
    assert_true(mirrored(&s, towards(&s, ORL_PI - critical - 1e-6)) == 1);
    assert_true(mirrored(&s, towards(&s, ORL_PI - critical + 1e-6)) < 1);
    struct orl_surface_sample beyond;
    assert_false(orl_material_refract(s.material, &s.hit, towards(&s, ORL_PI - critical - 1e-6),
                                      ORL_TRANSPORT_LIGHT, &beyond));
    /* At all angles up to grazing, reflectance and transmittance sum to one. */
    for (int i = 0; i <= 1000; i++) {
        const struct orl_vec3 from = towards(&s, i * 0.0005 * ORL_PI);
        const double r = mirrored(&s, from);
        const double t = orl_material_albedo(s.material, &s.hit, from, ORL_LOBE_TRANSMITTED).g;
        assert_true(isfinite(r) && isfinite(t) && r >= 0 && t >= 0 && fabs(r + t - 1) < 1e-12);
    }
    subject_done(&s);
}

/* Snell's law: n sin is conserved, in the plane of incidence, on the other side; the path is
 * reversible. */
static void test_snell(void **state)
{
    struct subject s = subject_of("void interface m 0 0 8 1 1 1 1.7 1 1 1 1.33\n", NULL, NULL);
    (void)state;
    for (int i = 0; i < 100; i++) {
        const struct orl_vec3 from = towards(&s, i * 0.0049 * ORL_PI), n = s.hit.normal;
        struct orl_surface_sample in, back;
        assert_true(orl_material_refract(s.material, &s.hit, from, ORL_TRANSPORT_LIGHT, &in));
        assert_true(fabs(orl_length(in.direction) - 1) < 1e-12);
        assert_true(orl_dot(in.direction, n) < 0);
        const struct orl_vec3 off =
            orl_madd(orl_cross(from, n), orl_cross(in.direction, n), 1.7 / 1.33);
        assert_true(orl_length(off) < 1e-12);
        assert_true(
            orl_material_refract(s.material, &s.hit, in.direction, ORL_TRANSPORT_LIGHT, &back));
        assert_true(orl_length(orl_sub(back.direction, from)) < 1e-7);
        /* Shares are equal in both directions; light and eye transport differ by n^2. */
        assert_true(fabs(in.weight.g - back.weight.g) < 1e-12);
        struct orl_surface_sample eye;
        assert_true(orl_material_refract(s.material, &s.hit, from, ORL_TRANSPORT_EYE, &eye));
        assert_true(fabs(eye.weight.g / in.weight.g - pow(1.33 / 1.7, 2)) < 1e-12);
    }
    subject_done(&s);
}

static void test_draws(void **state)
{
    static const double angles[] = {0, 50, 85, 120, 150, 175};
    struct subject s = subject_of(BLOCK, NULL, NULL);
    (void)state;
    for (int i = 0; i < 6; i++) {
        const struct orl_vec3 from = subject_direction(&s, angles[i], 10);
        const double r = mirrored(&s, from), t = 1 - r;
        const double squeeze = angles[i] < 90 ? 1 / 2.25 : 2.25;
        const double noise = 4 * sqrt(r * t / subject_draws()) + 1e-9;
        const struct tally l =
            subject_draw(&s, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, (uint64_t)i);
        const struct tally e = subject_draw(&s, from, ORL_TRANSPORT_EYE, ORL_LOBE_ALL, (uint64_t)i);
        assert_true(fabs(l.mirror.g - r) <= noise && fabs(l.refracted.g - t) <= noise);
        assert_true(fabs(e.mirror.g - r) <= noise);
        assert_true(fabs(e.refracted.g - t * squeeze) <= noise * squeeze);
        const struct tally one =
            subject_draw(&s, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, (uint64_t)i);
        assert_true(fabs(one.refracted.g - t) < 1e-9 && orl_rgb_max(one.mirror) == 0);
        assert_true(orl_material_pdf(s.material, &s.hit, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL,
                                     orl_neg(from)) == 0);
    }
    subject_done(&s);
}

/*
 * Photons through a slab, one interface after the other, match the transmittance and reflectance
 * of thin glass; d is the transmittance of one pass. Light chooses at random at each interface;
 * the tolerance is 4 sigma of that.
 */
static void test_slab_is_glass(void **state)
{
    static const double angles[] = {0, 45, 70, 85};
    struct subject slab = subject_of("void dielectric m 0 0 5 .9 .5 .2 1.52 0\n", NULL, NULL);
    struct subject pane = subject_of("void glass m 0 0 4 .9 .5 .2 1.52\n", NULL, NULL);
    const struct orl_hit front = {.normal = {0, 0, 1}, .front = true};
    (void)state;
    for (int k = 0; k < 4; k++) {
        const double theta = angles[k] * ORL_DEG_TO_RAD;
        const struct orl_vec3 from = orl_v3(sin(theta), 0, cos(theta));
        struct orl_rgb through = orl_gray(0), back = orl_gray(0);
        for (int i = 0; i < subject_draws(); i++) {
            struct orl_random random =
                orl_random_stream(40 + (uint64_t)k, ORL_PURPOSE_BENCH, (uint64_t)i);
            struct orl_vec3 way = orl_neg(from);
            struct orl_rgb flux = orl_gray(1.0 / subject_draws()),
                           medium_transmissivity = orl_gray(1);
            /* The upper face's normal is up, the lower's is down: both point out of the slab. */
            bool upper = true, inside = false;
            for (;;) {
                struct orl_hit hit = {.normal = {0, 0, upper ? 1 : -1}, .front = !inside};
                hit.distance = inside ? 1 / fabs(way.z) : 3;
                flux = orl_rgb_mul(
                    flux, orl_hit_transmittance(slab.material, &hit, medium_transmissivity));
                const struct orl_surface_sample s = orl_material_sample(
                    slab.material, &hit, orl_neg(way), ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, &random);
                flux = orl_rgb_mul(flux, s.weight);
                medium_transmissivity =
                    orl_medium_after_sample(slab.material, &s, medium_transmissivity);
                way = s.direction;
                if (s.event == ORL_EVENT_REFRACTED)
                    inside = !inside;
                if (!inside)
                    break;
                upper = way.z > 0;
            }
            struct orl_rgb *sum = way.z < 0 ? &through : &back;
            *sum = orl_rgb_add(*sum, flux);
        }
        /* Light is unpolarised at each face, but glass keeps the polarisations apart, which
         * matters beyond Brewster's angle. The sum that mixes them: r + r t^2 d^2 / (1 - r^2 d^2),
         * and so on. */
        const double r = orl_material_mirrored(slab.material, &front, from).g, t = 1 - r;
        const double path = 1 / sqrt(1 - pow(sin(theta) / 1.52, 2));
        const double d[3] = {pow(.9, path), pow(.5, path), pow(.2, path)};
        const double t_is[3] = {through.r, through.g, through.b};
        const double r_is[3] = {back.r, back.g, back.b};
        for (int c = 0; c < 3; c++) {
            const double t_should = t * t * d[c] / (1 - r * r * d[c] * d[c]);
            const double r_should = r + r * t * t * d[c] * d[c] / (1 - r * r * d[c] * d[c]);
            const double noise = 4 * sqrt(0.25 / subject_draws());
            assert_true(fabs(t_is[c] - t_should) < noise);
            assert_true(fabs(r_is[c] - r_should) < noise);
        }
        /* Up to Brewster's angle both formulas agree. */
        if (k < 2) {
            const struct orl_rgb glass = orl_material_straight(pane.material, &front, from);
            assert_true(fabs(glass.r - through.r) < 0.006 && fabs(glass.b - through.b) < 0.006);
        }
    }
    subject_done(&slab);
    subject_done(&pane);
}

/* Transmissivity is per unit of length: x^distance, on either side of the path. */
static void test_beer(void **state)
{
    struct subject s =
        subject_of("void interface m 0 0 8 .5 .6 .7 1.5 .9 .8 .7 1.33\n", NULL, NULL);
    struct subject wall = subject_of("void plastic m 0 0 5 .5 .5 .5 0 0\n", NULL, NULL);
    struct orl_hit hit = s.hit;
    (void)state;
    hit.distance = 2.5;
    hit.front = false; /* the ray came from behind, through the first medium */
    assert_true(fabs(orl_hit_transmittance(s.material, &hit, orl_gray(1)).g - pow(.6, 2.5)) <
                1e-12);
    hit.front = true;
    assert_true(fabs(orl_hit_transmittance(s.material, &hit, orl_gray(1)).r - pow(.9, 2.5)) <
                1e-12);
    /* A wall uses the medium that the path remembers. */
    assert_true(orl_medium_is_clear(orl_hit_transmittance(wall.material, &hit, orl_gray(1))));
    assert_true(fabs(orl_hit_transmittance(wall.material, &hit, orl_gray(.3)).b - pow(.3, 2.5)) <
                1e-12);
    const struct orl_vec3 above = subject_direction(&s, 20, 0);
    struct orl_surface_sample in;
    assert_true(orl_material_refract(s.material, &s.hit, above, ORL_TRANSPORT_LIGHT, &in));
    assert_true(in.medium_transmissivity.r == .5 && in.medium_transmissivity.b == .7);
    /* An infinite distance transmits nothing; in air it transmits all. */
    assert_true(orl_rgb_max(orl_medium_transmittance(orl_gray(.999), INFINITY)) == 0);
    assert_true(orl_medium_is_clear(orl_medium_transmittance(orl_gray(1), INFINITY)));
    subject_done(&s);
    subject_done(&wall);
}

static void test_mirror(void **state)
{
    struct subject s = subject_of("void mirror m 0 0 3 .9 .8 .7\n", NULL, NULL);
    const struct orl_vec3 from = subject_direction(&s, 60, 40);
    const struct tally t = subject_draw(&s, from, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 1);
    const struct tally behind =
        subject_draw(&s, orl_neg(from), ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, 1);
    (void)state;
    assert_true(fabs(t.mirror.r - .9) < 1e-9 && fabs(t.mirror.b - .7) < 1e-9);
    assert_true(orl_rgb_max(behind.mirror) == 0 && behind.squares == 0);
    assert_true(orl_material_is_mirror(s.material) && !orl_material_is_window(s.material));
    assert_true(mirrored(&s, orl_neg(from)) == 0);
    subject_done(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fresnel), cmocka_unit_test(test_snell),
        cmocka_unit_test(test_draws),   cmocka_unit_test(test_slab_is_glass),
        cmocka_unit_test(test_beer),    cmocka_unit_test(test_mirror),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
