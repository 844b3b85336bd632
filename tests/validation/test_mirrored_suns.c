/*
 * The sun by way of several flat mirrors, compared with closed forms: shadow rays to its images
 * (light/virtual_suns.h), and photons on a surface.
 *
 * A shaft of 0.6 x 0.6 x 2 m, four mirrors of 0.95, over a dark room. Sunlight along (0, .6, -.8)
 * passes it with two reflections or three: rays that enter in the half nearer the sun leave
 * northwards, the others to the south. The shaft is open above, or has a pane.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/kinds.h"
#include "support/scene_fixture.h"
#include "support/scene_text.h"

static const struct orl_hit anywhere = {.normal = {0, 0, 1}, .front = true};

#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -.6 .8 .533\n"
#define PANE                                                                                       \
    "void glass g 0 0 3 .96 .96 .96\n"                                                             \
    "g polygon top 0 0 12 -.3 -.3 2 .3 -.3 2 .3 .3 2 -.3 .3 2\n"

/* In the middle of a beam, free and on the northern wall, and where there is no sun. */
enum { SENSORS = 4, IN_AIR = 3 };
static const struct orl_sensor sensors[SENSORS] = {
    {{0, 1.15, -1.33}, {0, 0, 1}},
    {{0, -0.85, -1.33}, {0, 0, 1}},
    {{1, 1.15, -1.33}, {0, 0, 1}},
    {{0, 2, -2.47}, {0, -1, 0}},
};
static const double reflections[SENSORS] = {2, 3, 0, 2}, cosines[SENSORS] = {0.8, 0.8, 0, 0.6};

static double expected_lx(int sensor, double pane)
{
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    const double sun = 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
    return ORL_EFFICACY_LM_PER_W * sun * cosines[sensor] * pow(0.95, reflections[sensor]) * pane;
}

static double transmittance_of_pane(void)
{
    struct orl_parsed_scene d = scene_parse_text(SUN PANE, NULL, NULL);
    for (size_t i = 0; i < d.n_materials; i++)
        if (d.materials[i].kind == ORL_MATERIAL_GLASS) {
            const double t = orl_glass_transmittance(&d.materials[i], &anywhere, 0.8).g;
            orl_parsed_scene_done(&d);
            return t;
        }
    fail_msg("no glass");
    return 0;
}

static void check_shaft(const char *scene, double pane, enum orl_technique technique, int n)
{
    struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                        .sensors = sensors,
                                                        .n_sensors = (size_t)n,
                                                        .technique = technique,
                                                        .samples = 256,
                                                        .caustic = 50000});
    for (int i = 0; i < n; i++) {
        const double expected = expected_lx(i, pane), lx = r.illuminance_lx[i];
        /* The upper bound of light reflected by the dark walls; and four of its own standard
         * errors. */
        if (!(r.standard_error_lx[i] < 0.02 * expected_lx(0, pane)) ||
            !(fabs(lx - expected) <= 4 * r.standard_error_lx[i] + 1e-3 * expected_lx(0, pane)))
            fail_msg("technique %d, sensor %d: %g +- %g lx, not %g", (int)technique, i, lx,
                     r.standard_error_lx[i], expected);
    }
    orl_result_done(&r);
}

/* Returns the room below the shaft in the sun, and what lies above, or "". */
static const char *shaft_scene(const char *top)
{
    return scene_join(SUN, scene_fixture("shaft_of_mirrors"), scene_fixture("room_below_shaft"),
                      top, NULL);
}

static void down_an_open_shaft(void **state)
{
    (void)state;
    check_shaft(shaft_scene(""), 1, ORL_TECHNIQUE_BACKWARD, SENSORS);
    check_shaft(shaft_scene(""), 1, ORL_TECHNIQUE_GATHER, IN_AIR);
}

static void down_a_glazed_shaft(void **state)
{
    const double pane = transmittance_of_pane();
    (void)state;
    check_shaft(shaft_scene(PANE), pane, ORL_TECHNIQUE_BACKWARD, SENSORS);
    check_shaft(shaft_scene(PANE), pane, ORL_TECHNIQUE_GATHER, IN_AIR);
}

/*
 * Two panes slightly misaligned, as files round them: they form one class of mirrors, and a sensor
 * that sees the sun in both is lit twice and not four times. A pane of 0.92 and n 1.52 behind
 * another at 60 degrees; both are free, over nothing.
 */
static void panes_a_little_askew(void **state)
{
    static const char *const texts[2] = {
        "g polygon near 0 0 12 -9 2 -9 9 2 -9 9 2 9 -9 2 9\n"
        "g polygon far 0 0 12 -9 2.1 -9 9 2.1 -9 9 2.1 9 -9 2.1 9\n",
        "g polygon near 0 0 12 -9 2 -9 9 2 -9 9 2.002 9 -9 2.002 9\n"
        "g polygon far 0 0 12 -9 2.1 -9 9 2.1 -9 9 2.102 9 -9 2.102 9\n",
    };
    static const struct orl_sensor sensor = {{0, 0, 0}, {0, 1, 0}};
    double lx[2];
    (void)state;
    for (int i = 0; i < 2; i++) {
        char scene[1024];
        snprintf(scene, sizeof scene, SUN "void glass g 0 0 3 .92 .92 .92\n%s", texts[i]);
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .sensors = &sensor,
                                         .n_sensors = 1,
                                         .technique = ORL_TECHNIQUE_BACKWARD,
                                         .samples = 64},
                     &lx[i]);
    }
    /* r + t^2 r / (1 - r^2): by the near pane, by the far one, and back and forth between them. */
    struct orl_parsed_scene d = scene_parse_text(SUN "void glass g 0 0 3 .92 .92 .92\n"
                                                     "g polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n",
                                                 NULL, NULL);
    const double r = orl_glass_reflectance(&d.materials[d.surfaces[0].material], &anywhere, 0.6).g;
    const double t =
        orl_glass_transmittance(&d.materials[d.surfaces[0].material], &anywhere, 0.6).g;
    orl_parsed_scene_done(&d);
    const double shown = expected_lx(3, 1) / (0.95 * 0.95) * (r + t * t * r / (1 - r * r));
    for (int i = 0; i < 2; i++)
        if (!(fabs(lx[i] - shown) < 2e-3 * shown))
            fail_msg("askew %d: %g lx, not %g", i, lx[i], shown);
}

/*
 * The tower's pane reflects R of the sun, the window transmits T, both at 0.6: 4.7 klx on a floor
 * that is dark in Radiance. Sensors in the patch, and beside it. Light reflected again by the dark
 * surfaces is a thousandth; four standard errors are added.
 */
static void a_tower_lights_a_northern_room(void **state)
{
    static const struct orl_sensor places[2] = {{{2, -1.3, 0}, {0, 0, 1}}, {{2, -3, 0}, {0, 0, 1}}};
    static const enum orl_technique techniques[2] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    const char *const tower = scene_join(SUN, scene_fixture("room_before_tower"), NULL);
    struct orl_parsed_scene d = scene_parse_text(tower, NULL, NULL);
    const struct orl_material *glass = &d.materials[d.surfaces[0].material];
    const double patch = expected_lx(0, 1) / (0.95 * 0.95) *
                         orl_glass_reflectance(glass, &anywhere, 0.6).g *
                         orl_glass_transmittance(glass, &anywhere, 0.6).g;
    orl_parsed_scene_done(&d);
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = tower,
                                                            .sensors = places,
                                                            .n_sensors = 2,
                                                            .technique = techniques[k],
                                                            .samples = 256,
                                                            .caustic = 50000});
        for (int i = 0; i < 2; i++) {
            const double expected = i == 0 ? patch : 0, error = r.standard_error_lx[i];
            if (!(error < 0.05 * patch) ||
                !(fabs(r.illuminance_lx[i] - expected) < 4 * error + 2e-3 * patch))
                fail_msg("technique %d, place %d: %g +- %g lx, not %g", k, i, r.illuminance_lx[i],
                         error, expected);
        }
        orl_result_done(&r);
    }
}

#define SITE                                                                                       \
    "void glass g 0 0 3 .88 .88 .88\nvoid plastic d 0 0 5 .001 .001 .001 0 0\n"                    \
    "g polygon pane 0 0 12 -.5 0 1 .5 0 1 .5 0 4 -.5 0 4\n"                                        \
    "d polygon ledge 0 0 12 -.5 -.3 1 .5 -.3 1 .5 0 1 -.5 0 1\n"                                   \
    "d polygon ground 0 0 12 -200 -200 0 200 -200 0 200 200 0 -200 200 0\n"

/* A ledge in front of the only pane of a wide site, where almost no photon lands: both suns shine
 * there, on it and so little above it that the sensor counts as on it. The dark ground adds a
 * thousandth at most. */
static void a_pane_on_a_wide_site(void **state)
{
    static const struct orl_sensor places[2] = {{{0, -.1, 1}, {0, 0, 1}},
                                                {{.1, -.1, 1.08}, {0, 0, 1}}};
    struct orl_parsed_scene d = scene_parse_text(SUN SITE, NULL, NULL);
    const struct orl_material *glass = &d.materials[d.surfaces[0].material];
    const double sun = expected_lx(0, 1) / (0.95 * 0.95);
    const double expected = sun * (1 + orl_glass_reflectance(glass, &anywhere, 0.6).g);
    orl_parsed_scene_done(&d);
    (void)state;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        double lx[2];
        scene_run_lx(&(struct scene_run){.scene = SUN SITE,
                                         .sensors = places,
                                         .n_sensors = 2,
                                         .technique = ORL_TECHNIQUE_GATHER,
                                         .samples = 256,
                                         .caustic = 20000,
                                         .seed = seed},
                     lx);
        for (int i = 0; i < 2; i++)
            if (!(fabs(lx[i] - expected) < 3e-3 * expected))
                fail_msg("seed %d, place %d: %g lx, not %g", (int)seed, i, lx[i], expected);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(down_an_open_shaft),    cmocka_unit_test(down_a_glazed_shaft),
        cmocka_unit_test(panes_a_little_askew),  cmocka_unit_test(a_tower_lights_a_northern_room),
        cmocka_unit_test(a_pane_on_a_wide_site),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
