/*
 * Lamps outside a sealed room, compared with closed forms: through a glass window, where shadow
 * rays and photons must not both count them, and through a BSDF pane, where only photons carry
 * their light. The room is black, so that only the direct path counts.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "support/scene_text.h"
#include "support/techniques.h"

#define ROOM                                                                                       \
    "void plastic w 0 0 5 .01 .01 .01 0 0\n"                                                       \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3\n"                                           \
    "w polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0\n"                                              \
    "w polygon north 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3\n"                                             \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n"
#define PANE(material) material " polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
#define LAMP "void light l 0 0 3 1e4 1e4 1e4\nl sphere lamp 0 0 4 2 -1.5 2.8 .1\n"
#define GLOW "void glow l 0 0 4 1e4 1e4 1e4 0\nl sphere lamp 0 0 4 2 -1.5 2.8 .1\n"

static const struct orl_vec3 lamp = {2, -1.5, 2.8};

/* On the floor, and free. */
enum { SENSORS = 2 };
static const struct orl_sensor sensors[SENSORS] = {{{2, 1.5, 1e-4}, {0, 0, 1}},
                                                   {{2, 1, 0.8}, {0, 0, 1}}};

/* Returns the irradiance of a fully visible sphere: pi L (r / d)^2 cos. */
static double of_lamp(struct orl_vec3 point, struct orl_vec3 normal)
{
    const struct orl_vec3 way = orl_sub(lamp, point);
    const double d2 = orl_dot(way, way);
    return ORL_PI * 1e4 * 0.01 / d2 * fmax(orl_dot(way, normal), 0) / sqrt(d2);
}

static void run_scene(void **state, const char *scene, double ret_lx[SENSORS],
                      double ret_se[SENSORS])
{
    char pane[2048];
    scene_uniform_bsdf(0.2, pane);
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .resource_name = "pane.xml",
                                                        .resource_text = pane,
                                                        .sensors = sensors,
                                                        .n_sensors = SENSORS,
                                                        .technique = of_technique(state),
                                                        .samples = 4096,
                                                        .global = 100000,
                                                        .caustic = 200000});
    for (int i = 0; i < SENSORS; i++) {
        ret_lx[i] = r.illuminance_lx[i];
        ret_se[i] = r.standard_error_lx[i];
    }
    orl_result_done(&r);
}

/*
 * Walls of .01 add less than 1 %; twice the light, by photons and shadow rays together, is far off.
 */
static void check_glass(void **state, const char *scene)
{
    struct orl_parsed_scene d = scene_parse_text(scene, NULL, NULL);
    double lx[SENSORS], se[SENSORS];
    run_scene(state, scene, lx, se);
    for (int i = 0; i < SENSORS; i++) {
        const struct orl_hit anywhere = {.normal = {0, -1, 0}, .front = true};
        const struct orl_vec3 way = orl_normalize(orl_sub(lamp, sensors[i].position));
        const double t =
            orl_glass_transmittance(&d.materials[d.surfaces[0].material], &anywhere, -way.y).g;
        const double expected =
            ORL_EFFICACY_LM_PER_W * t * of_lamp(sensors[i].position, sensors[i].direction);
        print_message("%.4f of %.1f lx\n", lx[i] / expected, expected);
        assert_true(lx[i] / expected > 0.995 && lx[i] / expected < 1.015);
    }
    orl_parsed_scene_done(&d);
}

static void test_glass(void **state)
{
    check_glass(state, "void glass g 0 0 3 .9 .9 .9\n" PANE("g") ROOM LAMP);
}

static void test_glow_behind_glass(void **state)
{
    check_glass(state, "void glass g 0 0 3 .9 .9 .9\n" PANE("g") ROOM GLOW);
}

/* Each point of the pane transmits .2/sr of its incident light. */
static double by_pane(const struct orl_sensor *sensor)
{
    enum { SIDE = 200 };
    const struct orl_vec3 out = {0, -1, 0};
    double sum = 0;
    for (int i = 0; i < SIDE; i++)
        for (int k = 0; k < SIDE; k++) {
            const struct orl_vec3 p = {1 + 2 * (i + 0.5) / SIDE, 0, 1 + 1.5 * (k + 0.5) / SIDE};
            const struct orl_vec3 way = orl_sub(p, sensor->position);
            const double d2 = orl_dot(way, way);
            sum += 0.2 * of_lamp(p, out) * fmax(orl_dot(way, sensor->direction), 0) * -way.y /
                   (d2 * d2);
        }
    return ORL_EFFICACY_LM_PER_W * sum * 3.0 / (SIDE * SIDE);
}

/* Within 3.5 standard errors, which are at most 8 %, and the 1 % that walls of .01 may add. */
static void test_bsdf(void **state)
{
    double lx[SENSORS], se[SENSORS];
    run_scene(state, "void BSDF g 6 0 pane.xml 0 0 1 . 0 0\n" PANE("g") ROOM LAMP, lx, se);
    for (int i = 0; i < SENSORS; i++) {
        const double expected = by_pane(&sensors[i]);
        print_message("%.4f of %.1f lx\n", lx[i] / expected, expected);
        assert_true(se[i] < 0.08 * expected);
        assert_true(fabs(lx[i] - expected) < 3.5 * se[i] + 0.01 * expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        OF_TECHNIQUE(test_glass, BACKWARD),
        OF_TECHNIQUE(test_glass, GATHER),
        OF_TECHNIQUE(test_glass, DIRECT),
        OF_TECHNIQUE(test_glass, PRECOMPUTED),
        OF_TECHNIQUE(test_glow_behind_glass, BACKWARD),
        OF_TECHNIQUE(test_glow_behind_glass, DIRECT),
        OF_TECHNIQUE(test_bsdf, BACKWARD),
        OF_TECHNIQUE(test_bsdf, GATHER),
        OF_TECHNIQUE(test_bsdf, DIRECT),
        OF_TECHNIQUE(test_bsdf, PRECOMPUTED),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
