/*
 * Small mirrors and lenses as targets of rays (render/gather/direction_sampling.h): which surfaces
 * are targets, how they are grouped, and that directions are drawn with the density that is stated.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "render/gather/direction_sampling.h"
#include "support/scene_text.h"

#define MATERIALS                                                                                  \
    "void plastic w 0 0 5 .4 .4 .4 0 0\nvoid dielectric crystal 0 0 5 1 1 1 1.5 0\n"               \
    "void metal smooth 0 0 5 .9 .9 .9 1 0\nvoid glass pane 0 0 3 .9 .9 .9\n"                       \
    "void mirror mirror 0 0 3 .9 .9 .9\n"                                                          \
    "w polygon floor 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
#define TETRAHEDRON                                                                                \
    "crystal polygon a 0 0 9 0 0 1 1 0 1 0 1 1\ncrystal polygon b 0 0 9 0 0 1 0 1 1 0 0 2\n"       \
    "crystal polygon c 0 0 9 0 0 1 0 0 2 1 0 1\ncrystal polygon d 0 0 9 1 0 1 0 0 2 0 1 1\n"
#define WATER                                                                                      \
    "crystal polygon top 0 0 12 0 0 1 1 0 1 1 1 1 0 1 1\n"                                         \
    "crystal polygon bottom 0 0 12 0 0 .5 0 1 .5 1 1 .5 1 0 .5\n"

static const struct {
    const char *scene;
    uint32_t targets;
} scenes[] = {
    {MATERIALS "crystal sphere ball 0 0 4 0 0 1 .3\n", 1},
    {MATERIALS "crystal sphere a 0 0 4 -3 0 1 .3\ncrystal sphere b 0 0 4 3 0 1 .3\n", 2},
    {MATERIALS "smooth sphere ball 0 0 4 0 0 1 .3\n", 1},
    {MATERIALS "mirror polygon m 0 0 12 0 0 1 1 0 1 1 0 2 0 0 2\n", 1},
    {MATERIALS TETRAHEDRON, 1},
    {MATERIALS WATER, 0}, /* only shifts light */
    {MATERIALS "pane polygon p 0 0 12 0 0 1 1 0 1 1 0 2 0 0 2\n", 0},
    {MATERIALS "mirror polygon m 0 0 12 -9 9 0 9 9 0 9 9 18 -9 9 18\n", 0}, /* large */
};

static void test_which_surfaces(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    (void)state;
    assert_non_null(pool);
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct orl_lit_scene *lit_scene = build_lit_scene(scenes[i].scene, NULL, NULL, pool);
        struct orl_targets targets;
        assert_int_equal(orl_targets_init(&targets, lit_scene), 0);
        if (targets.n != scenes[i].targets)
            fail_msg("scene %zu: %u targets", i, targets.n);
        assert_int_equal(orl_targets_of(&targets, lit_scene->geometry, 0),
                         ORL_NO_TARGET); /* floor */
        for (size_t facet = 1; facet < lit_scene->geometry->n_facets && targets.n == 1; facet++)
            assert_int_equal(orl_targets_of(&targets, lit_scene->geometry, (uint32_t)facet), 0);
        orl_targets_done(&targets);
        orl_lit_scene_free(lit_scene);
    }
    orl_thread_pool_stop(pool);
}

/* From beside the sphere, from its edge almost, from far away, from within and from its centre. */
static const struct orl_vec3 points[] = {
    {2, 0, 0}, {1.0001, 0, 0}, {0, 3e3, 4e3}, {0.2, 0.3, 0}, {0, 0, 0}};
enum { POINTS = sizeof points / sizeof *points, DRAWS = 20000 };
static const struct orl_target_sphere sphere = {{0, 0, 0}, 1};

/* Drawn directions meet the sphere, and 1 / density has the mean of the cone's solid angle, which
 * is its constant value: no tolerance but rounding. */
static void test_directions_lie_in_the_cone(void **state)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_SENSOR, 0);
    (void)state;
    for (int p = 0; p < POINTS; p++) {
        const double d2 = orl_dot(points[p], points[p]);
        const double sine2 = d2 > 1 ? 1 / d2 : 1;
        const double solid = d2 > 1 ? 2 * ORL_PI * sine2 / (1 + sqrt(1 - sine2)) : 4 * ORL_PI;
        for (int i = 0; i < DRAWS; i++) {
            const double u0 = orl_random_uniform(&random);
            const double u[2] = {u0, orl_random_uniform(&random)};
            const struct orl_vec3 towards = orl_target_sample(&sphere, points[p], u);
            const double density = orl_target_pdf(&sphere, points[p], towards);
            assert_true(fabs(orl_length(towards) - 1) < 1e-9);
            if (!(fabs(density * solid - 1) < 1e-6))
                fail_msg("point %d: density %g times %g sr", p, density, solid);
        }
    }
}

/* Directions uniform over the whole sphere: the mean of the density times 4 pi is 1. Of n draws, a
 * share q of which lies in the cone, the mean has a standard error of sqrt((1 - q) / (q n)); four
 * are allowed. */
static void test_density_integrates_to_one(void **state)
{
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_SENSOR, 0);
    (void)state;
    for (int p = 0; p < POINTS; p++) {
        double sum = 0;
        int inside = 0;
        if (orl_dot(points[p], points[p]) > 100)
            continue; /* no draw would meet it */
        for (int i = 0; i < DRAWS; i++) {
            const double z = 2 * orl_random_uniform(&random) - 1,
                         phi = 2 * ORL_PI * orl_random_uniform(&random), r = sqrt(1 - z * z);
            const double density =
                orl_target_pdf(&sphere, points[p], orl_v3(r * cos(phi), r * sin(phi), z));
            sum += density * 4 * ORL_PI;
            inside += density > 0;
        }
        const double q = (double)inside / DRAWS;
        assert_true(q > 0);
        assert_true(fabs(sum / DRAWS - 1) <= 4 * sqrt((1 - q) / (q * DRAWS)) + 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_which_surfaces),
        cmocka_unit_test(test_directions_lie_in_the_cone),
        cmocka_unit_test(test_density_integrates_to_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
