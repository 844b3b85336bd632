/*
 * Searches for annual sunlight (annual/sun/direction_tree.h, annual/panes/bounding_rects.h). They
 * find the same as a loop over everything and sample without bias. Their work, counted in tree
 * nodes, grows with the logarithm of the number of suns, windows and mirrors.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "annual/panes/bounding_rects.h"
#include "annual/sun/direction_tree.h"

enum { MOST_PANES = 1024, MOST_SUNS = 8192 };

static struct orl_vec3 any_direction(struct orl_random *random)
{
    const double z = 2 * orl_random_uniform(random) - 1;
    const double turn = 2 * ORL_PI * orl_random_uniform(random), r = sqrt(1 - z * z);
    return orl_v3(r * cos(turn), r * sin(turn), z);
}

/* ---- Suns ------------------------------------------------------------------------------------ */

static void mark_sun(void *ctx, uint32_t index)
{
    ((unsigned char *)ctx)[index]++;
}

static struct orl_vec3 direction_at(const void *suns, uint32_t index)
{
    return ((const struct orl_vec3 *)suns)[index];
}

static struct orl_direction_tree make_suns(struct orl_vec3 *suns, size_t n)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_ANNUAL, n);
    struct orl_direction_tree tree;
    for (size_t i = 0; i < n; i++)
        suns[i] = any_direction(&random);
    assert_int_equal(orl_direction_tree_init(&tree, direction_at, suns, NULL, n), 0);
    return tree;
}

static void test_cones_hold_what_a_loop_finds(void **state)
{
    static struct orl_vec3 suns[500];
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_ANNUAL, 0);
    struct orl_direction_tree tree = make_suns(suns, 500);
    (void)state;
    for (int i = 0; i < 300; i++) {
        const double half = ORL_PI * pow(orl_random_uniform(&random), 2);
        const struct orl_cone cone = {any_direction(&random), cos(half)};
        unsigned char found[500] = {0};
        orl_direction_tree_find(&tree, &cone, mark_sun, found);
        for (size_t k = 0; k < 500; k++) {
            const double angle = acos(fmin(fmax(orl_dot(suns[k], cone.axis), -1), 1));
            if (fabs(angle - half) > 1e-6)
                assert_int_equal(found[k], angle < half);
        }
    }
    orl_direction_tree_done(&tree);
    assert_int_equal(orl_direction_tree_init(&tree, direction_at, suns, NULL, 0), 0);
    assert_int_equal(
        orl_direction_tree_find(&tree, &(struct orl_cone){{0, 0, 1}, -1}, mark_sun, NULL), 0);
    orl_direction_tree_done(&tree);
}

/* Returns the work of a cone that holds about eight suns, for any number of suns. */
static double work_of_cones(size_t n)
{
    static struct orl_vec3 suns[MOST_SUNS];
    static unsigned char found[MOST_SUNS];
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_ANNUAL, 0);
    struct orl_direction_tree tree = make_suns(suns, n);
    size_t tested = 0;
    for (int i = 0; i < 200; i++) {
        const struct orl_cone cone = {any_direction(&random), 1 - 16.0 / (double)n};
        tested += orl_direction_tree_find(&tree, &cone, mark_sun, found);
    }
    orl_direction_tree_done(&tree);
    return (double)tested / 200;
}

static void test_cones_cost_a_logarithm(void **state)
{
    const double few = work_of_cones(128), many = work_of_cones(MOST_SUNS);
    (void)state;
    print_message("# suns tested of a cone of eight: %.0f of 128, %.0f of %d\n", few, many,
                  MOST_SUNS);
    assert_true(many < few * log2(MOST_SUNS) / log2(128) * 1.2);
}

/* ---- Panes ----------------------------------------------------------------------------------- */

/* Distributes panes over a field of 40 m by 40 m, at random orientations. Their total area is
 * independent of their number. */
static void make_panes(struct orl_bounding_rect *panes, size_t n)
{
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_ANNUAL, n);
    const double half = 10 / sqrt((double)n);
    for (size_t i = 0; i < n; i++) {
        const struct orl_frame frame = orl_frame_about(any_direction(&random));
        panes[i] = (struct orl_bounding_rect){.facet = (uint32_t)i,
                                              .corner = {40 * orl_random_uniform(&random),
                                                         40 * orl_random_uniform(&random),
                                                         10 * orl_random_uniform(&random)},
                                              .normal = frame.n,
                                              .along = {frame.u, frame.v},
                                              .low = {-half, -half},
                                              .high = {half, half}};
    }
}

static struct orl_pane_bvh plant(struct orl_bounding_rect *panes, size_t n)
{
    struct orl_pane_bvh tree;
    make_panes(panes, n);
    assert_int_equal(orl_pane_bvh_init(&tree, panes, NULL, n), 0);
    return tree;
}

static bool is_passed_by_loop(const struct orl_bounding_rect *panes, size_t n, struct orl_vec3 from,
                              struct orl_vec3 towards, double slack, double before)
{
    for (size_t i = 0; i < n; i++) {
        double distance;
        if (orl_bounding_rect_passed(&panes[i], from, towards, slack, &distance) &&
            distance < before)
            return true;
    }
    return false;
}

static void test_rays_pass_what_a_loop_finds(void **state)
{
    static struct orl_bounding_rect panes[60];
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_ANNUAL, 0);
    struct orl_pane_bvh tree = plant(panes, 60);
    size_t passed = 0;
    (void)state;
    for (int i = 0; i < 20000; i++) {
        const struct orl_vec3 from = {40 * orl_random_uniform(&random),
                                      40 * orl_random_uniform(&random), 5};
        const struct orl_vec3 towards = any_direction(&random);
        const double before = i % 2 ? INFINITY : 20 * orl_random_uniform(&random);
        const bool found = is_passed_by_loop(panes, 60, from, towards, 0, before);
        assert_int_equal(orl_pane_bvh_passed(&tree, panes, from, towards, 0, before), found);
        /* With slack the loop's test is a little wider than the cone, never narrower. */
        if (is_passed_by_loop(panes, 60, from, towards, 0, INFINITY))
            assert_true(orl_pane_bvh_passed(&tree, panes, from, towards, 0.005, INFINITY));
        passed += found;
    }
    assert_true(passed > 1000 && passed < 19000);
    orl_pane_bvh_done(&tree);
}

struct drawn {
    double *weights;
    size_t count;
};

static void count_pane(void *ctx, uint32_t item, double probability)
{
    struct drawn *drawn = ctx;
    drawn->weights[item] += 1 / probability;
    drawn->count++;
}

/* The mean weight of each pane is 1; for panes behind the place, it may be 0. */
static void test_lots_have_no_bias(void **state)
{
    enum { N = 60, TRIALS = 40000 };
    static struct orl_bounding_rect panes[N];
    static double weights[N], squares[N];
    struct orl_random random = orl_random_stream(6, ORL_PURPOSE_ANNUAL, 0);
    struct orl_pane_bvh tree = plant(panes, N);
    const struct orl_vec3 point = {-30, 20, 5}, normal = orl_normalize(orl_v3(1, 1, 0));
    size_t by_lot = 0;
    (void)state;
    for (int i = 0; i < TRIALS; i++) {
        double once[N] = {0};
        struct drawn drawn = {.weights = once};
        orl_pane_bvh_sample(&tree, point, normal, &random, count_pane, &drawn);
        by_lot += drawn.count < N;
        for (int k = 0; k < N; k++) {
            weights[k] += once[k] / TRIALS;
            squares[k] += once[k] * once[k] / TRIALS;
        }
    }
    for (int k = 0; k < N; k++) {
        bool ahead = false;
        for (int i = 0; i < 4; i++)
            ahead = ahead ||
                    orl_dot(orl_sub(orl_bounding_rect_corner(&panes[k], i), point), normal) > 0;
        const double se = sqrt(fmax(squares[k] - weights[k] * weights[k], 0) / TRIALS);
        if (ahead)
            assert_true(fabs(weights[k] - 1) < 4.5 * se + 1e-9);
        else
            assert_true(weights[k] == 0 || fabs(weights[k] - 1) < 4.5 * se + 1e-9);
    }
    assert_true(by_lot > TRIALS / 2);
    orl_pane_bvh_done(&tree);
}

/* Returns mean numbers of visited nodes and sampled panes, at places all over the field and around
 * it. */
static void work_of_lots(size_t n, double *ret_looked, double *ret_drawn)
{
    static struct orl_bounding_rect panes[MOST_PANES];
    static double weights[MOST_PANES];
    enum { PLACES = 500 };
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_ANNUAL, 0);
    struct orl_pane_bvh tree = plant(panes, n);
    struct drawn drawn = {.weights = weights};
    size_t looked = 0;
    for (int i = 0; i < PLACES; i++) {
        const struct orl_vec3 point = {80 * orl_random_uniform(&random) - 20,
                                       80 * orl_random_uniform(&random) - 20,
                                       5 * orl_random_uniform(&random)};
        looked +=
            orl_pane_bvh_sample(&tree, point, any_direction(&random), &random, count_pane, &drawn);
    }
    *ret_looked = (double)looked / PLACES;
    *ret_drawn = (double)drawn.count / PLACES;
    orl_pane_bvh_done(&tree);
}

static void test_lots_cost_a_logarithm(void **state)
{
    static const size_t numbers[] = {1, 4, 16, 64, 256, 1024};
    double looked[6], drawn[6];
    (void)state;
    for (int i = 0; i < 6; i++) {
        work_of_lots(numbers[i], &looked[i], &drawn[i]);
        print_message("# of %4zu panes %5.1f are drawn, by %6.1f nodes\n", numbers[i], drawn[i],
                      looked[i]);
    }
    /* Four times as many panes add two tree levels per sampled or rejected pane, and hardly more
     * such panes. */
    for (int i = 3; i < 6; i++) {
        assert_true(looked[i] - looked[i - 1] < 4 * drawn[i]);
        assert_true(drawn[i] < 1.8 * drawn[i - 1]);
    }
    assert_true(looked[5] < 3.2 * looked[3]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cones_hold_what_a_loop_finds),
        cmocka_unit_test(test_cones_cost_a_logarithm),
        cmocka_unit_test(test_rays_pass_what_a_loop_finds),
        cmocka_unit_test(test_lots_have_no_bias),
        cmocka_unit_test(test_lots_cost_a_logarithm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
