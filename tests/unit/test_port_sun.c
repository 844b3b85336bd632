/*
 * Suns in ports: wherever on a pane a shadow ray is spared, it would have been unobstructed; and
 * rays are spared on most of the pane if few obstacles are near.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "photon/emission/port_emission.h"
#include "support/room.h"

/* A frame in front of the pane, a block and a ball beyond, the ground; suns high, low and oblique.
 */
#define SUNS                                                                                       \
    "void light solar 0 0 3 1e6 1e6 1e6\n"                                                         \
    "solar source a 0 0 4 0 -0.6 0.8 0.53\n"                                                       \
    "solar source b 0 0 4 0.5 -0.8 0.1 0.53\n"                                                     \
    "solar source c 0 0 4 -0.9 -0.3 0.5 2\n"                                                       \
    "solar source d 0 0 4 0.99 -0.02 0.2 0.53\n"                                                   \
    "solar source e 0 0 4 0 0.7 0.7 0.53\n"
#define OUTSIDE                                                                                    \
    "!genbox w sill 4 .2 .1 | xform -t 0 -.2 .9\n"                                                 \
    "!genbox w awning 3 .8 .05 | xform -t .5 -.8 2.6\n"                                            \
    "!genbox w house 3 3 6 | xform -t 4 -12 0\n"                                                   \
    "w sphere ball 0 0 4 0.5 -3 1.5 .6\n"                                                          \
    "w polygon ground 0 0 12 -50 -50 -.1 50 -50 -.1 50 50 -.1 -50 50 -.1\n"

static struct orl_lit_scene *open_lit_scene(const char *text, struct orl_thread_pool *pool)
{
    struct orl_lit_scene *lit_scene = build_lit_scene(text, NULL, NULL, pool);
    assert_true(lit_scene->n_ports > 0);
    return lit_scene;
}

/* Returns the share of the pane where rays are spared; checks each spared ray. */
static double spared(const struct orl_lit_scene *lit_scene, const struct orl_stratum *stratum)
{
    enum { POINTS = 20000 };
    const struct orl_geometry *g = lit_scene->geometry;
    const struct orl_port *port = &lit_scene->ports[stratum->port];
    struct orl_random random = orl_random_stream(stratum->sun, ORL_PURPOSE_BENCH, 0);
    int n = 0;
    for (int i = 0; i < POINTS && stratum->shadow_boxes; i++) {
        const double u[4] = {orl_random_uniform(&random), orl_random_uniform(&random),
                             orl_random_uniform(&random), orl_random_uniform(&random)};
        const struct orl_vec3 towards = orl_sun_sample(&lit_scene->suns[stratum->sun], u + 2);
        struct orl_vec3 point, normal;
        orl_facet_sample(g, port->facet, u, &point, &normal);
        if (orl_shadow_boxes_contain(stratum->shadow_boxes, point))
            continue;
        n++;
        assert_false(orl_geometry_occluded(
            g, orl_facet_ray_origin(g, port->facet, point, normal, port->outward), towards,
            INFINITY));
    }
    return (double)n / POINTS;
}

static void check_spared(const char *text, double least_spared)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene = open_lit_scene(text, pool);
    struct orl_emission *emission = NULL;
    double best = 0;
    assert_int_equal(orl_emission_new(lit_scene, ORL_PHOTONS_FOR_MAPS, 1, pool, &emission, NULL),
                     0);
    for (size_t i = 0; i < emission->n_strata; i++)
        if (emission->strata[i].kind == ORL_STRATUM_PORT_SUN)
            best = fmax(best, spared(lit_scene, &emission->strata[i]));
    assert_true(best > least_spared && best < 1);
    orl_emission_free(emission);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
}

static void test_spared_rays_meet_nothing(void **state)
{
    (void)state;
    check_spared(SUNS ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE OUTSIDE, 0.3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_spared_rays_meet_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
