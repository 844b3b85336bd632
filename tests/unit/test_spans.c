/* Sensor samples in consecutive spans: together they equal those of one span. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "render/backward/backward.h"
#include "support/room.h"

#define SCENE ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE

/* Computes the groups' means of a sensor on the floor, in luma. */
static void sample(const struct orl_backward *backward, uint32_t first, uint32_t samples,
                   double ret_groups[ORL_MAP_BATCHES])
{
    const struct orl_sample_range range = {
        .seed = 7, .index = 3, .first = first, .samples = samples};
    const struct orl_vec3 place = orl_sub(orl_v3(2, 2, 0), backward->lit_scene->geometry->center);
    struct orl_rgb groups[ORL_MAP_BATCHES];
    struct orl_health health = {0};
    orl_backward_irradiance(backward, place, orl_v3(0, 0, 1), &range, &health, groups);
    for (int k = 0; k < ORL_MAP_BATCHES; k++)
        ret_groups[k] = orl_luma(groups[k]);
}

/* Without virtual lamps, which each round has of its own: 4 and 9 samples of a group, and 13. */
static void test_spans_that_follow(void **state)
{
    double whole[ORL_MAP_BATCHES], first[ORL_MAP_BATCHES], second[ORL_MAP_BATCHES], sum = 0;
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene = build_lit_scene(SCENE, NULL, NULL, pool);
    struct orl_backward backward;
    (void)state;
    assert_int_equal(orl_backward_init(&backward, lit_scene, NULL), 0);
    assert_int_equal(orl_backward_set_vpls(&backward, pool, 1, NULL, 0, 1), 0);
    sample(&backward, 0, 13 * ORL_MAP_BATCHES, whole);
    sample(&backward, 0, 4 * ORL_MAP_BATCHES, first);
    sample(&backward, 4 * ORL_MAP_BATCHES, 9 * ORL_MAP_BATCHES, second);
    for (int k = 0; k < ORL_MAP_BATCHES; k++) {
        const double together = (4 * first[k] + 9 * second[k]) / 13;
        assert_true(fabs(together - whole[k]) <= 1e-12 * whole[k]);
        assert_true(first[k] != second[k]);
        sum += whole[k];
    }
    assert_true(sum > 0);
    orl_backward_done(&backward);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_spans_that_follow)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
