/*
 * Caustics at free sensors, where no photon lands, by every photon map technique: the sun through
 * two scattering panes, after two mirrors, off rough metal, and lamps in mirrors. Compared with
 * closed forms, integrals over panes, and the backward technique. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/extent.h"
#include "support/room.h"
#include "support/scene_fixture.h"

#define DARK "void plastic w 0 0 5 .001 .001 .001 0 0\n"
#define LIGHT "void light l 0 0 3 1e6 1e6 1e6\n"

static const enum orl_technique techniques[] = {ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_DIRECT,
                                                ORL_TECHNIQUE_PRECOMPUTED};
enum { TECHNIQUES = 3 };

/* Skips interreflection: that of walls of a thousandth takes many photons to find, and is
 * negligible. */
static const enum orl_effect_override dark[ORL_EFFECT_COUNT] = {[ORL_EFFECT_INTERREFLECTION] =
                                                                    ORL_OVERRIDE_SKIP};

/* Irradiance of a plane that faces the sun. */
static double sun_w(void)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    return 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

/*
 * Asserts within four standard errors, whose estimates are of at most sixteen batches, plus the
 * stated bias; both must be small.
 */
static void assert_near(const struct orl_result *result, size_t sensor, double watts, double most)
{
    const double lx = ORL_EFFICACY_LM_PER_W * watts, is = result->illuminance_lx[sensor];
    const double error =
        4 * result->standard_error_lx[sensor] + fabs(result->bias_estimate_lx[sensor]);
    if (!(fabs(is - lx) <= error + 0.002 * lx) || !(error <= most * lx))
        fail_msg("sensor %zu: %g lx, not %g within %g", sensor, is, lx, error);
}

/* ---- Two panes ------------------------------------------------------------------------------- */

static const double scattered = 0.2; /* 1/sr */

static struct orl_vec3 on_pane(int side, int i, double y)
{
    return orl_v3(1 + 2 * (i % side + 0.5) / side, y, 1 + 1.5 * (i / side + 0.5) / side);
}

/* One pane in the south wall, the other a tenth of a metre behind it, each scattering uniformly. */
static const char *panes_scene(void)
{
    return scene_join(LIGHT "l source sun 0 0 4 0 -1 1 .533\n" DARK,
                      scene_fixture("room_4x5_window"),
                      "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"
                      "p polygon outer 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
                      "p polygon inner 0 0 12 1 .1 1 1 .1 2.5 3 .1 2.5 3 .1 1\n",
                      NULL);
}

/* Returns the irradiance at a plane from a point of a pane with exitance 1 / (f area). */
static double brings(struct orl_vec3 from, struct orl_vec3 to, struct orl_vec3 normal)
{
    const struct orl_vec3 way = orl_sub(from, to);
    const double d2 = orl_dot(way, way);
    return fmax(orl_dot(way, normal), 0) * fabs(way.y) / (d2 * d2);
}

/* Returns true if the path from the outer pane passes beside the inner one. */
static bool goes_past(struct orl_vec3 from, struct orl_vec3 to)
{
    const double t = (0.1 - from.y) / (to.y - from.y);
    const double x = from.x + t * (to.x - from.x), z = from.z + t * (to.z - from.z);
    return x < 1 || x > 3 || z < 1 || z > 2.5;
}

static double through_panes(const struct orl_sensor *sensor)
{
    enum { OUTER = 80, INNER = 16 };
    const double on_outer = sun_w() * sqrt(0.5), each = scattered * 3.0 / (OUTER * OUTER);
    double sum = 0;
    for (int i = 0; i < OUTER * OUTER; i++) {
        const struct orl_vec3 from = on_pane(OUTER, i, 0);
        if (goes_past(from, sensor->position))
            sum += on_outer * each * brings(from, sensor->position, sensor->direction);
    }
    for (int k = 0; k < INNER * INNER; k++) {
        const struct orl_vec3 at = on_pane(INNER, k, 0.1);
        double on_inner = 0;
        for (int i = 0; i < OUTER * OUTER; i++)
            on_inner += on_outer * each * brings(on_pane(OUTER, i, 0), at, orl_v3(0, -1, 0));
        sum += on_inner * scattered * 3.0 / (INNER * INNER) *
               brings(at, sensor->position, sensor->direction);
    }
    return sum;
}

/* The last sensor is on the floor, where photons land. */
static void two_panes_scatter_one_after_the_other(void **state)
{
    static const struct orl_sensor sensors[] = {{{2, 1, 0.8}, {0, 0, 1}},
                                                {{2, 2.5, 1.2}, {0, -1, 0}},
                                                {{1, 3, 0.8}, {0, 0, 1}},
                                                {{2, 1, 0}, {0, 0, 1}}};
    double watts[4];
    char bsdf[2048];
    (void)state;
    scene_uniform_bsdf(scattered, bsdf);
    for (size_t i = 0; i < 4; i++)
        watts[i] = through_panes(&sensors[i]);
    for (int t = 0; t < TECHNIQUES; t++) {
        struct orl_result result = scene_run(&(struct scene_run){.scene = panes_scene(),
                                                                 .resource_name = "pane.xml",
                                                                 .resource_text = bsdf,
                                                                 .sensors = sensors,
                                                                 .n_sensors = 4,
                                                                 .technique = techniques[t],
                                                                 .overrides = dark,
                                                                 .caustic = 100000,
                                                                 .samples = 256});
        for (size_t i = 0; i < 4; i++)
            assert_near(&result, i, watts[i], 0.4);
        orl_result_done(&result);
    }
}

/* ---- Two mirrors ----------------------------------------------------------------------------- */

/*
 * The sun moves a metre sideways per 1.2 down: by one mirror onto 1.083 < y < 1.417 half a metre
 * below the ceiling, by two onto 3.333 < y < 4 on the desk, and on the floor past its edge.
 */
static void the_sun_comes_down_a_shaft(void **state)
{
    static const struct orl_sensor sensors[] = {
        {{2, 1.25, 2.5}, {0, 0, 1}}, {{2, 3.6, 0.8}, {0, 0, 1}}, {{2, 2.8, 0.8}, {0, 0, 1}}};
    const double down = sun_w() * 1.2 / sqrt(1 + 1.2 * 1.2);
    (void)state;
    for (int t = 0; t < TECHNIQUES; t++) {
        struct orl_result result =
            scene_run(&(struct scene_run){.scene = scene_fixture("room_mirror_shaft"),
                                          .sensors = sensors,
                                          .n_sensors = 3,
                                          .technique = techniques[t],
                                          .overrides = dark,
                                          .caustic = 100000,
                                          .samples = 256});
        assert_near(&result, 0, 0.9 * down, 0.2);
        assert_near(&result, 1, 0.81 * down, 0.2);
        assert_true(result.interval_95_lx[2][0] < 1 && result.illuminance_lx[2] < 20);
        orl_result_done(&result);
    }
}

/* ---- On a surface with few photons ----------------------------------------------------------- */

/* A mirror strip a tenth of a metre wide reflects the sun onto the floor, where a disc of photons
 * is wider than its light; directly, or by a distant mirror when the strip's back shades it. */
#define STRIP                                                                                      \
    DARK "w polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n"                                    \
         "void mirror m 0 0 3 .9 .9 .9\n"                                                          \
         "m polygon strip 0 0 12 2 -.05 1 2 -.05 3 2 .05 3 2 .05 1\n"

static void a_narrow_gleam_on_a_floor_is_caught(void **state)
{
    static const char *const scenes[] = {LIGHT "l source sun 0 0 4 -1 0 1 .533\n" STRIP, LIGHT
                                         "l source sun 0 0 4 1 0 1 .533\n" STRIP
                                         "m polygon far 0 0 12 -3 -1 5 -3 1 5 -3 1 9 -3 -1 9\n"};
    static const double shares[] = {1 + 0.9, 0.9 * 0.9};
    static const struct orl_sensor sensors[] = {{{0, 0, 0}, {0, 0, 1}}};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct orl_result result = scene_run(&(struct scene_run){.scene = scenes[i],
                                                                 .sensors = sensors,
                                                                 .n_sensors = 1,
                                                                 .global = extent(300000, 1000000),
                                                                 .caustic = ORL_PHOTONS_BY_PLAN,
                                                                 .samples = 256});
        assert_near(&result, 0, shares[i] * sun_w() * sqrt(0.5), 0.2);
        orl_result_done(&result);
    }
}

/* ---- Lamps ----------------------------------------------------------------------------------- */

/* A lamp of a tenth of a square metre, and a mirror at x = 2 in which it appears at x = 4. */
static void a_lamp_is_seen_in_a_mirror(void **state)
{
    enum { SIDE = 100 };
    static const char scene[] = "void light l 0 0 3 100 100 100\n"
                                "l polygon lamp 0 0 12 0 -.2 2 0 0 2 .5 0 2 .5 -.2 2\n" DARK
                                "void mirror m 0 0 3 .9 .9 .9\n"
                                "w polygon floor 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\n"
                                "m polygon mirror 0 0 12 2 -2 0 2 -2 3 2 2 3 2 2 0\n";
    static const struct orl_sensor sensors[] = {{{0.5, 0.3, 1}, {1, 0, 0}}};
    double form = 0;
    (void)state;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const struct orl_vec3 way =
            orl_sub(orl_v3(4 - 0.5 * (i % SIDE + 0.5) / SIDE, -0.2 * (i / SIDE + 0.5) / SIDE, 2),
                    sensors[0].position);
        const double d2 = orl_dot(way, way);
        form += way.x * way.z / (d2 * d2) * 0.1 / (SIDE * SIDE);
    }
    /* The lamp itself is behind the sensor. The value is equal for any number of threads. */
    double lx[2];
    for (uint32_t i = 0; i < 2; i++) {
        struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                                 .sensors = sensors,
                                                                 .n_sensors = 1,
                                                                 .overrides = dark,
                                                                 .caustic = extent(100000, 400000),
                                                                 .samples = 256,
                                                                 .threads = 1 + 2 * i});
        assert_near(&result, 0, 0.9 * 100 * form, 0.2);
        lx[i] = result.illuminance_lx[0];
        orl_result_done(&result);
    }
    assert_true(lx[0] == lx[1]);
}

/* ---- Rough metal ----------------------------------------------------------------------------- */

static void the_sun_glances_off_rough_metal(void **state)
{
    static const char scene[] = LIGHT "l source sun 0 0 4 0 -.6 .8 .533\n"
                                      "void plastic w 0 0 5 .2 .2 .2 0 0\n"
                                      "w polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n"
                                      "void metal m 0 0 5 .8 .8 .8 .9 .1\n"
                                      "m polygon plate 0 0 12 -3 3 0 3 3 0 3 3 5 -3 3 5\n";
    static const struct orl_sensor sensors[] = {{{0, 0, 1}, {0, 1, 0}}, {{1, 1, 2}, {0, 1, 0}}};
    (void)state;
    struct orl_result known = scene_run(&(struct scene_run){.scene = scene,
                                                            .sensors = sensors,
                                                            .n_sensors = 2,
                                                            .technique = ORL_TECHNIQUE_BACKWARD,
                                                            .global = 50000,
                                                            .samples = 16384});
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .sensors = sensors,
                                                             .n_sensors = 2,
                                                             .global = 100000,
                                                             .caustic = 400000,
                                                             .samples = 1024});
    for (size_t i = 0; i < 2; i++) {
        const double off = fabs(result.illuminance_lx[i] - known.illuminance_lx[i]);
        const double error = 4 * hypot(result.standard_error_lx[i], known.standard_error_lx[i]) +
                             fabs(result.bias_estimate_lx[i]);
        if (!(off <= error) || !(error < 0.35 * known.illuminance_lx[i]))
            fail_msg("sensor %zu: %g lx, not %g within %g", i, result.illuminance_lx[i],
                     known.illuminance_lx[i], error);
    }
    orl_result_done(&known);
    orl_result_done(&result);
}

/*
 * With few photons each run is noisy, but not all may be low: among the estimate's widths the one
 * with the least light must not count as the most certain. Seeds scatter by 9 % each, and a wide
 * disc blurs a lobe by some per cent. When widths were chosen by their own scatter the mean was 21
 * % low, and 9 of 24 intervals held. With a coverage of 88 % 17 or more of 24 hold in 99.8 of 100
 * runs, and as often 7 or more of 12, as in the short form.
 */
static void few_photons_are_not_read_low(void **state)
{
    const int seeds = (int)extent(12, 24), least_held = (int)extent(7, 17);
    static const char scene[] =
        "void glow sky 0 0 4 100 90 80 0\nsky source s 0 0 4 0 0 1 360\n"
        "void light sun 0 0 3 4e6 4e6 4e6\nsun source d 0 0 4 .2 -.7 .6 .533\n"
        "void plastic wall 0 0 5 .6 .6 .6 0 0\nvoid glass pane 0 0 3 .8 .8 .8\n"
        "void metal steel 0 0 5 .7 .7 .7 .8 .1\n"
        "wall polygon w 0 0 12 0 0 0 0 0 3 0 5 3 0 5 0\n"
        "wall polygon e 0 0 12 4 0 0 4 5 0 4 5 3 4 0 3\n"
        "wall polygon n 0 0 12 0 5 0 0 5 3 4 5 3 4 5 0\n"
        "wall polygon u 0 0 12 0 0 3 4 0 3 4 5 3 0 5 3\n"
        "pane polygon s 0 0 12 0 0 0 4 0 0 4 0 3 0 0 3\n"
        "wall polygon a 0 0 12 0 0 0 0 5 0 2 5 0 2 0 0\n"
        "steel polygon b 0 0 12 2 0 0 2 5 0 4 5 0 4 0 0\n";
    static const struct orl_sensor sensor[] = {{{2, 4, 1.5}, {0, -1, 0}}};
    struct scene_run job = {.scene = scene,
                            .sensors = sensor,
                            .n_sensors = 1,
                            .technique = ORL_TECHNIQUE_BACKWARD,
                            .samples = 16384};
    double sum = 0;
    int held = 0;
    (void)state;
    struct orl_result known = scene_run(&job);
    const double lx = known.illuminance_lx[0];
    job.technique = ORL_TECHNIQUE_GATHER;
    job.global = 50000;
    job.caustic = 20000;
    job.samples = 1024;
    for (int i = 0; i < seeds; i++) {
        job.seed = (uint64_t)i + 1;
        struct orl_result result = scene_run(&job);
        const double *interval = result.interval_95_lx[0];
        held += interval[0] <= lx && lx <= interval[1];
        sum += result.illuminance_lx[0] / seeds;
        orl_result_done(&result);
    }
    print_message("mean %g of %g lx, %d of %d held\n", sum, lx, held, seeds);
    assert_true(held >= least_held);
    assert_true(fabs(sum / lx - 1) < 0.06 + 3 * 0.09 / sqrt(seeds));
    orl_result_done(&known);
}

/* ---- Outside --------------------------------------------------------------------------------- */

/* A canopy beside a sealed room: rays find the light that it scatters, and photons do not count it
 * again. */
static void a_canopy_outside_counts_once(void **state)
{
    enum { SIDE = 200 };
    static const char scene[] =
        LIGHT "l source sun 0 0 4 0 0 1 .533\n" DARK "!genbox w room 4 4 3 | xform -t 10 0 0\n"
              "void glass g 0 0 3 .9 .9 .9\n"
              "void BSDF p 6 0 pane.xml 0 1 0 . 0 0\n"
              "p polygon canopy 0 0 12 0 0 2 2 0 2 2 2 2 0 2 2\n"
              "w polygon a 0 0 12 20 0 0 22 0 0 22 2 0 20 2 0\nw polygon b 0 0 12 20 0 0 20 2 0 20 "
              "2 2 20 "
              "0 2\nw polygon c 0 0 12 22 0 0 22 0 2 22 2 2 22 2 0\nw polygon d 0 0 12 20 0 0 20 0 "
              "2 22 0 "
              "2 22 0 0\nw polygon e 0 0 12 20 2 0 22 2 0 22 2 2 20 2 2\n"
              "g polygon top 0 0 12 20 0 2 22 0 2 22 2 2 20 2 2\n";
    static const struct orl_sensor sensors[] = {{{1, 1, 1}, {0, 0, 1}}};
    char bsdf[2048];
    double form = 0;
    (void)state;
    scene_uniform_bsdf(scattered, bsdf);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = 2 * (i % SIDE + 0.5) / SIDE - 1, y = 2 * (i / SIDE + 0.5) / SIDE - 1;
        const double d2 = x * x + y * y + 1;
        form += 4.0 / (SIDE * SIDE) / (d2 * d2);
    }
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .resource_name = "pane.xml",
                                                             .resource_text = bsdf,
                                                             .sensors = sensors,
                                                             .n_sensors = 1,
                                                             .caustic = 50000,
                                                             .samples = 4096});
    assert_near(&result, 0, sun_w() * scattered * form, 0.1);
    orl_result_done(&result);
}

/* ---- Cost ------------------------------------------------------------------------------------ */

/* A ball of glass in the sun: its light matters just behind it, and not in an upper corner. */
static double rays_of(const struct orl_sensor *sensor, bool bounded)
{
    static const char scene[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
        "void dielectric d 0 0 5 1 1 1 1.5 0\nd sphere ball 0 0 4 2 .6 1.2 .5\n";
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .sensors = sensor,
                                                             .n_sensors = 1,
                                                             .global = 100000,
                                                             .caustic = ORL_PHOTONS_BY_PLAN,
                                                             .bounded = bounded,
                                                             .samples = 4096});
    const double rays = (double)result.health.rays;
    print_message("%.0f rays, %g +- %g lx\n", rays, result.illuminance_lx[0],
                  result.standard_error_lx[0]);
    orl_result_done(&result);
    return rays;
}

static void flights_that_nobody_feels_are_few(void **state)
{
    const struct orl_sensor behind = {{2, 1.236, .564}, {0, -1, 1}},
                            corner = {{1, 4, 2.5}, {0, 0, -1}};
    (void)state;
    assert_true(rays_of(&behind, true) == rays_of(&behind, false));
    assert_true(rays_of(&corner, true) < rays_of(&corner, false));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_panes_scatter_one_after_the_other),
        cmocka_unit_test(the_sun_comes_down_a_shaft),
        cmocka_unit_test(a_narrow_gleam_on_a_floor_is_caught),
        cmocka_unit_test(a_lamp_is_seen_in_a_mirror),
        cmocka_unit_test(the_sun_glances_off_rough_metal),
        cmocka_unit_test(few_photons_are_not_read_low),
        cmocka_unit_test(a_canopy_outside_counts_once),
        cmocka_unit_test(flights_that_nobody_feels_are_few),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
