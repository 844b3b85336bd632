/*
 * A Lambertian pane: a uniform BSDF in the wall of a dark room, under a uniform sky and under the
 * sun.
 *
 * It transmits tau of its incident light into the room, uniformly, so that illuminances are a form
 * factor and the sum of photon fluxes is tau E A. The room reflects 0.1 %: enough for photons to be
 * stored, negligible otherwise. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/scene_fixture.h"
#include "support/scene_text.h"

#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"

/* Returns the almost black room in that light, with a pane in all of its low window. */
static const char *room_scene(const char *light)
{
    return scene_join(light, "void plastic w 0 0 5 .001 .001 .001 0 0\n",
                      scene_fixture("room_4x5_low_window"),
                      "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"
                      "p polygon pane 0 0 12 1 0 0 1 0 1.5 3 0 1.5 3 0 0\n",
                      NULL);
}

static const double f_per_sr = 0.2, pane_area = 3.0;

enum { SENSORS = 9, IN_AIR = 3 };

/* Nine on the floor and three free. */
static const struct orl_sensor sensors[SENSORS + IN_AIR] = {
    {{1, 1, 0}, {0, 0, 1}},   {{2, 1, 0}, {0, 0, 1}},     {{3, 1, 0}, {0, 0, 1}},
    {{1, 1.6, 0}, {0, 0, 1}}, {{2, 1.6, 0}, {0, 0, 1}},   {{3, 1.6, 0}, {0, 0, 1}},
    {{1, 2.2, 0}, {0, 0, 1}}, {{2, 2.2, 0}, {0, 0, 1}},   {{3, 2.2, 0}, {0, 0, 1}},
    {{2, 3, 1}, {0, -1, 0}},  {{1, 2, 2}, {0, -1, -0.5}}, {{2, 1.5, 0.75}, {0, 0, 1}}};

static double sun_normal_w(void)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    return 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
}

/* Returns the irradiance from the pane at radiance 1, by midpoints, accurate to 1e-4 at these
 * distances. */
static double form(const struct orl_sensor *sensor)
{
    enum { SIDE = 300 };
    const struct orl_vec3 n = orl_normalize(sensor->direction);
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const struct orl_vec3 at =
            orl_v3(1 + 2 * (i % SIDE + 0.5) / SIDE, 0, 1.5 * (i / SIDE + 0.5) / SIDE);
        const struct orl_vec3 way = orl_sub(at, sensor->position);
        const double d2 = orl_dot(way, way);
        sum += fmax(orl_dot(way, n), 0) * -way.y / (d2 * d2);
    }
    return sum * pane_area / (SIDE * SIDE);
}

static void assert_within(double value, double expected, double relative)
{
    if (!(fabs(value - expected) <= relative * fabs(expected)))
        fail_msg("%.6g is not within %.2g of %.6g", value, relative, expected);
}

struct outcome {
    double lx[SENSORS + IN_AIR], global_w, global_sigma, caustic_w, caustic_sigma;
};

static struct outcome run_pane(const char *scene, uint64_t caustic)
{
    char xml[2048], folder[64];
    struct outcome o;
    double squares;
    scene_uniform_bsdf(f_per_sr, xml);
    cli_make_folder(folder);
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .resource_name = "pane.xml",
                                                             .resource_text = xml,
                                                             .sensors = sensors,
                                                             .n_sensors = SENSORS + IN_AIR,
                                                             .global = 100000,
                                                             .caustic = caustic,
                                                             .samples = 16384,
                                                             .folder = folder});
    for (int i = 0; i < SENSORS + IN_AIR; i++)
        o.lx[i] = result.illuminance_lx[i];
    o.global_w = scene_map_flux(&result, folder, "global", &squares);
    o.global_sigma = sqrt(squares);
    o.caustic_w = o.caustic_sigma = 0;
    if (caustic) {
        o.caustic_w = scene_map_flux(&result, folder, "caustic", &squares);
        o.caustic_sigma = sqrt(squares);
    }
    orl_result_done(&result);
    cli_remove_folder(folder);
    return o;
}

/*
 * Under a sky of radiance 1 all around the pane shows tau: every incident direction has 1, and the
 * sum of f cos is tau. Sensors gather 16384 stratified rays: 0.5 %, and the walls' 0.1 %.
 */
static void test_even_sky(void **state)
{
    const double tau = ORL_PI * f_per_sr;
    const struct outcome o = run_pane(room_scene(SKY), 0);
    (void)state;
    for (int i = 0; i < SENSORS + IN_AIR; i++)
        assert_within(o.lx[i], ORL_EFFICACY_LM_PER_W * tau * form(&sensors[i]), 0.01);
    /* Light that lands a second time counts twice, at most 0.1 %; the rest is 3 sigma. */
    const double flux = tau * ORL_PI * pane_area;
    assert_true(fabs(o.global_w - flux) < 3 * o.global_sigma + 0.001 * flux);
}

/*
 * With only the sun it shows tau E / pi. Light that lands on the floor first is caustic, read as
 * density of some 300 photons: 6 % per sensor, 2 % for the mean of nine, so 6 % are 3 sigma. Free
 * sensors sample the panes: 1 %.
 */
static void test_sun(void **state)
{
    const double tau = ORL_PI * f_per_sr, arrives = sun_normal_w() * sqrt(0.5);
    const struct outcome o = run_pane(room_scene(SUN), 300000);
    double is = 0, should = 0;
    (void)state;
    for (int i = 0; i < SENSORS; i++) {
        const double expected = ORL_EFFICACY_LM_PER_W * tau * arrives / ORL_PI * form(&sensors[i]);
        is += o.lx[i];
        should += expected;
        assert_within(o.lx[i], expected, 0.25);
    }
    assert_within(is, should, 0.06);
    for (int i = SENSORS; i < SENSORS + IN_AIR; i++)
        assert_within(o.lx[i], ORL_EFFICACY_LM_PER_W * tau * arrives / ORL_PI * form(&sensors[i]),
                      0.01);
    const double flux = tau * arrives * pane_area;
    assert_true(fabs(o.caustic_w - flux) < 3 * o.caustic_sigma);
    assert_true(fabs(o.global_w - flux) < 3 * o.global_sigma + 0.001 * flux);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_even_sky),
        cmocka_unit_test(test_sun),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
