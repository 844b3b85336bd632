/*
 * Surfaces described by a BSDF, with the material's additions: diffuse parts, and the straight
 * light of an aBSDF. Samples follow orl_material_pdf, their mean weight is the integral of f (and
 * of the straight share), light and eye transport agree, and nothing gains energy.
 *
 * The test is a chi-square over cells of equal projected solid angle on both sides; thresholds as
 * in test_bsdf_sampling.c: 1e-3 for the file, divided by its number of comparisons.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "fixtures/bsdf_make.h"
#include "scene/material/scatter.h"

enum {
    SIDE = 16,
    CELLS = 2 * SIDE * SIDE,
    FINE = 24,
    DRAWS = 40000,
    GIVEN = 3,
    PANELS = 6,
    COMPARISONS = PANELS * 2 * GIVEN,
};

struct panel {
    const char *what;
    struct orl_material material;
};

static const struct orl_hit hit = {.normal = {0, 0, 1}};

static struct panel panel_of(const char *what, struct text t, bool peak)
{
    return (struct panel){
        what,
        {.kind = ORL_MATERIAL_BSDF,
         .as.bsdf_surface = {.bsdf = load_text(t), .up = {0, 1, 0}, .peak = peak}}};
}

static int load_all(void **state)
{
    static struct panel panels[PANELS];
    const struct orl_rgb red = {0.3, 0.05, 0}, gray = {0.1, 0.1, 0.1}, pale = {0.05, 0.1, 0.15};
    panels[0] = panel_of("aBSDF of a clear pane", make_clear_file(4, 0.5, 0.2), true);
    panels[1] = panel_of("aBSDF, additions", make_clear_file(4, 0.5, 0.1), true);
    panels[1].material.as.bsdf_surface.diffuse.front = red;
    panels[1].material.as.bsdf_surface.diffuse.back = gray;
    panels[1].material.as.bsdf_surface.diffuse.through = pale;
    panels[2] = panel_of("BSDF, additions", read_fixture("tests/fixtures/bsdf_klems41.xml"), false);
    panels[2].material.as.bsdf_surface.diffuse.front = gray;
    panels[2].material.as.bsdf_surface.diffuse.through = pale;
    panels[3] = panel_of("BSDF that would gain", make_clear_file(3, 0.5, 0.4), true);
    panels[3].material.as.bsdf_surface.diffuse.front = red;
    panels[3].material.as.bsdf_surface.diffuse.back = red;
    panels[3].material.as.bsdf_surface.diffuse.through = gray;
    panels[4] = panel_of("aBSDF of rank 3", make_clear_iso_file(4, 0.4, 0.3), true);
    panels[4].material.as.bsdf_surface.diffuse.front = pale;
    panels[5] = panel_of("colour", make_tinted_file(4, 0.1, 0.1, 0.3, 0.5), true);
    panels[5].material.as.bsdf_surface.diffuse.front = red;
    *state = panels;
    for (int i = 0; i < PANELS; i++)
        if (!orl_material_bsdf(&panels[i].material))
            return -1;
    return 0;
}

static int unload_all(void **state)
{
    struct panel *panels = *state;
    for (int i = 0; i < PANELS; i++)
        orl_bsdf_unref(orl_material_bsdf(&panels[i].material));
    return 0;
}

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

static struct orl_vec3 square_to_direction(double u, double v, bool front)
{
    const double cosine = sqrt(1 - u), sine = sqrt(u), azimuth = 2 * ORL_PI * v;
    return orl_v3(sine * cos(azimuth), sine * sin(azimuth), front ? cosine : -cosine);
}

static struct orl_vec3 any_direction(struct orl_random *random)
{
    const double u = uniform(random), v = uniform(random);
    return square_to_direction(u, v, uniform(random) < 0.5);
}

static int cell_of(struct orl_vec3 d)
{
    double v = atan2(d.y, d.x) / (2 * ORL_PI);
    const int i = (int)((1 - d.z * d.z) * SIDE), j = (int)((v < 0 ? v + 1 : v) * SIDE);
    return ((d.z > 0) * SIDE + (i < SIDE ? i : SIDE - 1)) * SIDE + (j < SIDE ? j : SIDE - 1);
}

/* Returns the upper tail of chi-square, by Wilson and Hilferty. */
static double tail(double x, int degrees)
{
    const double k = degrees, z = (cbrt(x / k) - (1 - 2 / (9 * k))) / sqrt(2 / (9 * k));
    return 0.5 * erfc(z / sqrt(2));
}

/* Counts per cell, and light that went straight or nowhere, which the pdf leaves out. */
struct tally {
    double expected[CELLS], counted[CELLS];
    double integral;                  /* integral of the pdf */
    double straight;                  /* number of straight samples */
    struct orl_rgb scattered, passed; /* mean weights of scattered and of straight samples */
    struct orl_rgb f;                 /* integral of f |cos| */
};

static struct orl_rgb f_of(const struct orl_material *m, enum orl_transport transport,
                           struct orl_vec3 given, struct orl_vec3 other)
{
    return transport == ORL_TRANSPORT_LIGHT ? orl_material_eval_lobes(m, &hit, given, other)
                                            : orl_material_eval_lobes(m, &hit, other, given);
}

static void expect(const struct orl_material *m, enum orl_transport transport,
                   struct orl_vec3 given, struct orl_random *random, struct tally *t)
{
    const double share = ORL_PI / (SIDE * SIDE) / (FINE * FINE);
    for (int cell = 0; cell < CELLS; cell++) {
        double sum = 0;
        for (int k = 0; k < FINE * FINE; k++) {
            const double u = cell / SIDE % SIDE + (k / FINE + uniform(random)) / FINE;
            const double v = cell % SIDE + (k % FINE + uniform(random)) / FINE;
            const struct orl_vec3 d = square_to_direction(u / SIDE, v / SIDE, cell >= SIDE * SIDE);
            sum += orl_material_pdf(m, &hit, given, transport, ORL_LOBE_ALL, d) / fabs(d.z);
            t->f = orl_rgb_add(t->f, orl_rgb_scale(f_of(m, transport, given, d), share));
        }
        t->expected[cell] = sum * share;
        t->integral += sum * share;
    }
}

static void count_samples(const struct orl_material *m, enum orl_transport transport,
                          struct orl_vec3 given, struct orl_random *random, struct tally *t)
{
    for (int i = 0; i < DRAWS; i++) {
        const struct orl_surface_sample s =
            orl_material_sample(m, &hit, given, transport, ORL_LOBE_ALL, random);
        const struct orl_rgb share = orl_rgb_scale(s.weight, 1.0 / DRAWS);
        assert_true(s.event == ORL_EVENT_GLOSSY || s.event == ORL_EVENT_STRAIGHT);
        if (s.event == ORL_EVENT_STRAIGHT) {
            assert_true(s.transmitted && s.direction.z == -given.z);
            t->passed = orl_rgb_add(t->passed, share);
            t->straight++;
            continue;
        }
        assert_true(s.transmitted == ((s.direction.z > 0) != (given.z > 0)));
        t->scattered = orl_rgb_add(t->scattered, share);
        t->counted[cell_of(s.direction)]++;
    }
}

/* Cells with fewer than ten expected samples are pooled into one; straight samples form one cell.
 */
static double p_value(const struct tally *t)
{
    double expected = 0, counted = 0, x = 0;
    int cells = 0;
    for (int i = 0; i < CELLS; i++) {
        const double e = t->expected[i] * DRAWS, d = t->counted[i] - e;
        if (e < 10) {
            expected += e;
            counted += t->counted[i];
            continue;
        }
        x += d * d / e;
        cells++;
    }
    if (expected >= 10) {
        x += (counted - expected) * (counted - expected) / expected;
        cells++;
    }
    const double straight = (1 - t->integral) * DRAWS;
    if (straight >= 10) {
        x += (t->straight - straight) * (t->straight - straight) / straight;
        cells++;
    }
    return cells > 1 ? tail(x, cells - 1) : 1;
}

static void assert_near(const char *what, struct orl_rgb a, struct orl_rgb b, double tolerance)
{
    if (fabs(a.r - b.r) > tolerance || fabs(a.g - b.g) > tolerance || fabs(a.b - b.b) > tolerance)
        fail_msg("%s: (%g %g %g) against (%g %g %g)", what, a.r, a.g, a.b, b.r, b.g, b.b);
}

static void check_panel(const struct panel *panel, enum orl_transport transport,
                        struct orl_random *random)
{
    static struct tally t;
    for (int g = 0; g < GIVEN; g++) {
        const struct orl_vec3 given = any_direction(random);
        const struct orl_material *m = &panel->material;
        const bool light = transport == ORL_TRANSPORT_LIGHT;
        t = (struct tally){.integral = 0};
        expect(m, transport, given, random, &t);
        count_samples(m, transport, given, random, &t);
        const double p = p_value(&t);
        if (p < 1e-3 / COMPARISONS)
            fail_msg("%s, transport %d, direction %d: p = %g", panel->what, transport, g, p);
        /* Weights are constant in luma, except for data rescaled by direction. The slack is 4
         * sigma of a binomial, and half a percent for the jitter of the integral. */
        const double slack = 4 * 0.5 / sqrt(DRAWS) + 0.005;
        assert_near(panel->what, t.scattered, t.f, slack);
        const struct orl_rgb straight =
            orl_material_straight(m, &hit, light ? orl_neg(given) : given);
        assert_near(panel->what, t.passed, straight, slack);
        if (light)
            assert_near(panel->what, orl_rgb_add(t.f, straight),
                        orl_material_albedo(m, &hit, given, ORL_LOBE_ALL), 0.01);
    }
}

static void draws_follow_the_pdf(void **state)
{
    const struct panel *panels = *state;
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 7);
    for (int i = 0; i < PANELS; i++) {
        check_panel(&panels[i], ORL_TRANSPORT_LIGHT, &random);
        check_panel(&panels[i], ORL_TRANSPORT_EYE, &random);
    }
}

/* For light from any direction, no channel gains energy; data that would gain is rescaled to
 * exactly 1. */
static void nothing_gains(void **state)
{
    const struct panel *panels = *state;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 7);
    for (int i = 0; i < PANELS; i++)
        for (int k = 0; k < 2000; k++) {
            const struct orl_rgb a = orl_material_albedo(&panels[i].material, &hit,
                                                         any_direction(&random), ORL_LOBE_ALL);
            assert_true(orl_rgb_max(a) <= 1 + 1e-12);
            assert_true(i != 3 || fabs(orl_rgb_max(a) - 1) < 1e-12);
        }
}

/* Radiance's three colours are reflection of the front, of the back, and transmission. */
static void additions_are_on_their_sides(void **state)
{
    const struct panel *panels = *state;
    const struct orl_material *m = &panels[1].material;
    const struct orl_diffuse_parts *added = &orl_bsdf_surface_of(m)->diffuse;
    const struct orl_vec3 in = orl_v3(0.6, 0, 0.8), out = orl_v3(-0.48, 0.6, 0.64);
    const struct orl_vec3 below = orl_v3(in.x, in.y, -in.z), under = orl_v3(out.x, out.y, -out.z);
    const double even = 0.1 / ORL_PI;
    assert_near("front", orl_material_eval_lobes(m, &hit, in, out),
                orl_rgb_scale(added->front, 1 / ORL_PI), 1e-9);
    assert_near("back", orl_material_eval_lobes(m, &hit, below, under),
                orl_rgb_scale(added->back, 1 / ORL_PI), 1e-9);
    assert_near("through", orl_material_eval_lobes(m, &hit, in, under),
                orl_rgb_add(orl_rgb_scale(added->through, 1 / ORL_PI), orl_gray(even)), 1e-7);
    assert_near("back through", orl_material_eval_lobes(m, &hit, below, out),
                orl_rgb_add(orl_rgb_scale(added->through, 1 / ORL_PI), orl_gray(even)), 1e-7);
}

/* A BSDF that is not an aBSDF scatters its peak. */
static void without_the_a_nothing_goes_straight(void **state)
{
    const struct panel *panels = *state;
    struct orl_material m = panels[0].material;
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 7);
    m.as.bsdf_surface.peak = false;
    for (int i = 0; i < 1000; i++) {
        const struct orl_vec3 d = any_direction(&random);
        assert_true(orl_rgb_max(orl_material_straight(&m, &hit, d)) == 0);
        assert_int_equal(
            orl_material_sample(&m, &hit, d, ORL_TRANSPORT_LIGHT, ORL_LOBE_ALL, &random).event,
            ORL_EVENT_GLOSSY);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(draws_follow_the_pdf),
        cmocka_unit_test(nothing_gains),
        cmocka_unit_test(additions_are_on_their_sides),
        cmocka_unit_test(without_the_a_nothing_goes_straight),
    };
    return cmocka_run_group_tests(tests, load_all, unload_all);
}
