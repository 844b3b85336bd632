/*
 * Panes of very low transmittance provide all the light of a black room under a uniform sky: a
 * tinted glass, a shade and a BSDF. With Russian roulette few rays would pass them, each with a
 * large weight; without any, a sensor would state certain darkness. Every ray that hits such a pane
 * must get its share.
 *
 * The sky has radiance 1 all around, so that a pane shows its transmittance, and a sensor is an
 * integral over the pane. Seeds are fixed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scene/material/scatter.h"
#include "support/scene_fixture.h"
#include "support/scene_text.h"

#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
#define GLASS "void glass p 0 0 3 .011 .011 .011\n"
#define SHADE "void trans p 0 0 7 .5 .5 .5 0 0 .06 0\n"
#define BSDF "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"

enum { SENSORS = 4, SEEDS = 10, PANES = 3, SIDE = 100 };

/* Free sensors, at which every technique uses final gathering. */
static const struct orl_sensor sensors[SENSORS] = {{{2, 1.5, .8}, {0, 0, 1}},
                                                   {{1, 2.5, 1.2}, {0, -1, 0}},
                                                   {{3, 3.5, 1}, {0, -1, .5}},
                                                   {{2, 4, .5}, {-.5, -.5, .5}}};

static const char *const panes[PANES] = {GLASS, SHADE, BSDF};

/* Returns the irradiance by midpoints, accurate to 1e-3 at these distances. */
static double truth(const struct orl_material *pane, const struct orl_sensor *sensor)
{
    const struct orl_vec3 n = orl_normalize(sensor->direction);
    const struct orl_hit hit = {.normal = {0, 1, 0}, .front = true};
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const struct orl_vec3 at =
            orl_v3(1 + 2 * (i % SIDE + 0.5) / SIDE, 0, 1 + 1.5 * (i / SIDE + 0.5) / SIDE);
        const struct orl_vec3 way = orl_sub(at, sensor->position);
        const double d2 = orl_dot(way, way);
        const struct orl_vec3 to = orl_scale(way, 1 / sqrt(d2));
        const double shows =
            orl_luma(orl_material_albedo(pane, &hit, orl_neg(to), ORL_LOBE_TRANSMITTED));
        sum += shows * fmax(orl_dot(to, n), 0) * -to.y / d2;
    }
    return ORL_EFFICACY_LM_PER_W * sum * 2 * 1.5 / (SIDE * SIDE);
}

/*
 * About 100 to 400 of 4096 stratified rays hit the pane. The remaining error comes from the pane's
 * outline and is at most 2 % of such a count; the bound on the root mean square, 5 %, is twice
 * that. With roulette only 4 to 40 rays would pass, for an error of 15 to 50 %. The truth lies in
 * 95 % of 40 intervals, with a binomial scatter of 1.4; the bound, 32, is four times that below.
 */
static void check_pane(enum orl_technique technique, const char *pane)
{
    char scene[4096], xml[2048];
    scene_uniform_bsdf(0.01, xml);
    snprintf(scene, sizeof scene,
             SKY "%svoid plastic w 0 0 5 .001 .001 .001 0 0\n%s"
                 "p polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n",
             pane, scene_fixture("room_4x5_window"));
    struct orl_parsed_scene parsed_scene = scene_parse_text(scene, "pane.xml", xml);
    const struct orl_material *m = NULL;
    for (size_t i = 0; i < parsed_scene.n_materials; i++)
        if (parsed_scene.materials[i].name[0] == 'p')
            m = &parsed_scene.materials[i];
    double squares = 0;
    int covered = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = scene,
                                                            .resource_name = "pane.xml",
                                                            .resource_text = xml,
                                                            .sensors = sensors,
                                                            .n_sensors = SENSORS,
                                                            .technique = technique,
                                                            .seed = seed,
                                                            .global = 2000,
                                                            .samples = 4096});
        for (size_t i = 0; i < SENSORS; i++) {
            const double should = truth(m, &sensors[i]);
            const double off = r.illuminance_lx[i] / should - 1;
            squares += off * off / (SENSORS * SEEDS);
            covered += r.interval_95_lx[i][0] <= should && should <= r.interval_95_lx[i][1];
        }
        orl_result_done(&r);
    }
    print_message("%s, %.11s: rms %.4f, covered %d of %d\n", orl_technique_name(technique), pane,
                  sqrt(squares), covered, SENSORS * SEEDS);
    orl_parsed_scene_done(&parsed_scene);
    assert_true(sqrt(squares) < 0.05);
    assert_true(covered >= 32);
}

static void test_dim_panes(void **state)
{
    (void)state;
    for (int p = 0; p < PANES; p++)
        check_pane(ORL_TECHNIQUE_GATHER, panes[p]);
    check_pane(ORL_TECHNIQUE_PRECOMPUTED, panes[0]);
    check_pane(ORL_TECHNIQUE_DIRECT, panes[0]);
    check_pane(ORL_TECHNIQUE_BACKWARD, panes[0]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_dim_panes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
