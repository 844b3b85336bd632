/*
 * Mist: a furnace without absorption, for sensors and for a view; the sun through a slab, and
 * single backscattering of a slab of low albedo, compared with their integrals; phase functions; a
 * lamp attenuated by mist; and warnings of techniques that do not follow light through mist.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "scene/built/scene.h"
#include "support/hdr.h"
#include "support/scene_text.h"
#include "support/scratch.h"

#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
#define SUN "void light sun 0 0 3 1e6 1e6 1e6\nsun source d 0 0 4 0 .6 .8 .533\n"
/* A slab from z = 0 to 2, wide enough. */
#define SLAB(numbers)                                                                              \
    "void mist fog " numbers "\n!genbox fog f 4000 4000 2 | xform -t -2000 -2000 0\n"

static const double lumens = 179, weights[3] = {.265, .670, .065};

static double sun_on_plane(void)
{
    return 1e6 * 2 * ORL_PI * (1 - cos(.533 / 2 * ORL_PI / 180));
}

static struct orl_estimate_lx {
    double lx, error;
} run(const char *scene, struct orl_sensor sensor, uint32_t samples, uint32_t threads)
{
    const struct scene_run job = {.scene = scene,
                                  .sensors = &sensor,
                                  .n_sensors = 1,
                                  .by_plan = true,
                                  .samples = samples,
                                  .threads = threads};
    struct orl_result result = scene_run(&job);
    assert_int_equal(result.plan.technique, ORL_TECHNIQUE_BACKWARD);
    const struct orl_estimate_lx e = {result.illuminance_lx[0], result.standard_error_lx[0]};
    orl_result_done(&result);
    return e;
}

/*
 * ---- Furnaces ---------------------------------------------------------------------------------
 */

/* Two overlapping volumes with different parameters; a white plate in them. */
#define CLOUDS                                                                                     \
    SKY "void mist fog 0 0 7 .5 1 2 1 1 1 .6\nfog sphere f 0 0 4 0 0 0 2\n"                        \
        "void mist haze 0 0 7 .3 .2 .1 1 1 1 -.3\n!genbox haze h 3 3 3 | xform -t -1.5 -1.5 -1\n"  \
        "void plastic white 0 0 5 .999 .999 .999 0 0\n"                                            \
        "white polygon p 0 0 12 -.5 -.5 -.5 .5 -.5 -.5 .5 .5 -.5 -.5 .5 -.5\n"

static void test_furnace(void **state)
{
    static const struct orl_sensor sensors[] = {
        {{0, 0, .5}, {0, 0, 1}}, {{0, 0, -.3}, {0, 0, 1}}, {{0, 0, 3}, {0, 0, -1}}};
    (void)state;
    for (size_t i = 0; i < sizeof sensors / sizeof *sensors; i++) {
        const struct orl_estimate_lx e = run(CLOUDS, sensors[i], 16384, 2);
        if (!(fabs(e.lx - ORL_PI * lumens) < 4 * e.error + .002 * e.lx && e.error < .02 * e.lx))
            fail_msg("sensor %zu: %g +- %g lx, not %g", i, e.lx, e.error, ORL_PI * lumens);
    }
}

/* Views see the furnace from within, and from outside through all of it. */
static void test_view(void **state)
{
    enum { SIDE = 24 };
    static double pixels[SIDE * SIDE][3];
    const struct scene_run job = {.scene = CLOUDS,
                                  .view = "-vtv -vp -1 0 .2 -vd 1 0 0 -vu 0 0 1 -vh 60 -vv 60",
                                  .width = SIDE,
                                  .height = SIDE,
                                  .by_plan = true,
                                  .pixel_samples = 256,
                                  .threads = 2,
                                  .folder = scratch_path("")};
    (void)state;
    struct orl_result result = scene_run(&job);
    hdr_read(scratch_path("view.hdr"), SIDE, SIDE, pixels);
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += weights[0] * pixels[i][0] + weights[1] * pixels[i][1] + weights[2] * pixels[i][2];
    /* 147 456 paths, whose weights' sigma is below 2: 0.5 %; and the bytes' rounding. */
    if (!(fabs(sum / (SIDE * SIDE) - 1) < .02))
        fail_msg("the view shows %g, not 1", sum / (SIDE * SIDE));
    orl_result_done(&result);
}

/*
 * ---- Closed forms ----------------------------------------------------------------------------
 */

/* Half a metre above the ground, under 1.5 m of fog with separate coefficients for each channel. */
static void test_sun_through(void **state)
{
    const struct orl_sensor sensor = {{0, 0, .5}, {0, 0, 1}};
    const double extinction[3] = {.1, .2, .4};
    const struct orl_estimate_lx e = run(SUN SLAB("0 0 3 .1 .2 .4"), sensor, 64, 1);
    double expected = 0;
    (void)state;
    for (int c = 0; c < 3; c++)
        expected += weights[c] * exp(-extinction[c] * 1.5 / .8);
    expected *= lumens * .8 * sun_on_plane();
    if (!(fabs(e.lx / expected - 1) < 1e-3))
        fail_msg("%g lx, not %g", e.lx, expected);
}

/* Light scattered once through the top by an isotropic phase function: by exp(-s z (1 / mu0 + 1 /
 * mu)). */
static double scattered_back(double extinction, double albedo, double depth)
{
    enum { STEPS = 20000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        const double mu = (i + .5) / STEPS, k = extinction * (1 / .8 + 1 / mu);
        sum += extinction * albedo / (4 * ORL_PI) * (1 - exp(-k * depth)) / (k * mu) * mu;
    }
    return 2 * ORL_PI * sum / STEPS * sun_on_plane();
}

/* With an albedo of 1 %, double scattering is below 1 % of single scattering. */
static void test_scattered_once(void **state)
{
    const struct orl_sensor sensor = {{0, 0, 2.001}, {0, 0, -1}};
    const struct orl_estimate_lx e =
        run(SUN SLAB("0 0 7 .5 .5 .5 .01 .01 .01 0"), sensor, 32768, 2);
    const double expected = lumens * scattered_back(.5, .01, 2);
    (void)state;
    if (!(fabs(e.lx - expected) < 4 * e.error + .01 * expected && e.error < .02 * expected))
        fail_msg("%g +- %g lx, not %g", e.lx, e.error, expected);
}

/* Compares sampled directions with their density: cosines in twenty bins, by chi-square. */
static void test_phase(void **state)
{
    enum { BINS = 20, DRAWS = 200000, STEPS = 2000 };
    static const double forward[] = {0, .6, -.4, .95};
    (void)state;
    for (size_t k = 0; k < sizeof forward / sizeof *forward; k++) {
        double seen[BINS] = {0}, chi2 = 0, whole = 0;
        struct orl_random random = orl_random_stream(7, ORL_PURPOSE_BENCH, k);
        const struct orl_vec3 along = orl_normalize(orl_v3(.3, -.2, .7));
        for (int i = 0; i < DRAWS; i++) {
            const double u0 = orl_random_uniform(&random), u[2] = {u0, orl_random_uniform(&random)};
            const double cosine = orl_dot(orl_phase_function_sample(forward[k], along, u), along);
            seen[(int)fmin((cosine + 1) / 2 * BINS, BINS - 1)]++;
        }
        for (int b = 0; b < BINS; b++) {
            double expected = 0;
            for (int i = 0; i < STEPS; i++)
                expected += 2 * ORL_PI * 2 / BINS / STEPS *
                            orl_phase_function(forward[k], -1 + 2. / BINS * (b + (i + .5) / STEPS));
            whole += expected;
            chi2 += (seen[b] - expected * DRAWS) * (seen[b] - expected * DRAWS) /
                    fmax(expected * DRAWS, 1);
        }
        assert_true(fabs(whole - 1) < 1e-3);
        assert_true(chi2 < 48); /* 19 degrees of freedom: 3.7 sigma */
    }
}

/*
 * ---- The rest --------------------------------------------------------------------------------
 */

static void test_same_bytes(void **state)
{
    const struct orl_sensor sensor = {{0, 0, .5}, {0, 0, 1}};
    const struct orl_estimate_lx one = run(CLOUDS, sensor, 256, 1);
    (void)state;
    assert_true(one.lx == run(CLOUDS, sensor, 256, 2).lx);
    assert_true(one.lx == run(CLOUDS, sensor, 256, 7).lx);
}

static void test_refused(void **state)
{
    static const struct {
        const char *scene;
        enum orl_technique technique;
        const char *message;
    } cases[] = {
        {SUN SLAB("0 0 3 .1 .1 .1"), ORL_TECHNIQUE_GATHER, "does not simulate mist"},
        {SUN SLAB("0 0 2 .1 .1"), ORL_TECHNIQUE_BACKWARD, "not 2"},
        {SUN SLAB("0 0 3 -.1 .1 .1"), ORL_TECHNIQUE_BACKWARD, "extinction"},
        {SUN SLAB("0 0 6 .1 .1 .1 2 1 1"), ORL_TECHNIQUE_BACKWARD, "albedo"},
        {SUN SLAB("0 0 7 .1 .1 .1 1 1 1 1"), ORL_TECHNIQUE_BACKWARD, "eccentricity"},
        {"void brightfunc p 2 .5 . 0 0\np mist fog 0 0 3 .1 .1 .1\nfog sphere f 0 0 4 0 0 0 1\n",
         ORL_TECHNIQUE_BACKWARD, "patterns"},
    };
    const struct orl_sensor sensor = {{0, 0, .5}, {0, 0, 1}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_error err = {0};
        const struct scene_run job = {.scene = cases[i].scene,
                                      .sensors = &sensor,
                                      .n_sensors = 1,
                                      .technique = cases[i].technique};
        scene_run_fails(&job, &err);
        if (!strstr(err.message, cases[i].message) || err.line == 0)
            fail_msg("case %zu: line %d: %s", i, err.line, err.message);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_furnace),
        cmocka_unit_test_setup_teardown(test_view, scratch_set_up, scratch_tear_down),
        cmocka_unit_test(test_sun_through),
        cmocka_unit_test(test_scattered_once),
        cmocka_unit_test(test_phase),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
