/*
 * A property of plans, over 50 random rooms, 200 in the long suite: skipped light is at most the
 * plan's bound. The unbiased technique checks this with its standard errors.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>
#include <math.h>

#include "support/extent.h"
#include "support/random_scene.h"
#include "support/scene_text.h"

struct tally {
    int compared, beyond_3, skipped[ORL_EFFECT_COUNT];
    uint64_t rays_planned, rays_forced;
};

/* Returns the total light that may be missing at a sensor by the plan, in lux. */
static double bounds_lx(const struct orl_plan *plan, double lx)
{
    double sum = 0;
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        const struct orl_decision *d = &plan->effects[i];
        if (d->simulated)
            continue;
        sum += d->unit == ORL_BOUND_LX         ? d->bound
               : d->unit == ORL_BOUND_RELATIVE ? d->bound * lx
                                               : 0;
    }
    return sum;
}

static struct orl_result run_room(const struct random_scene *room, const char *bsdf,
                                  enum orl_effect_override override, uint64_t seed)
{
    enum orl_effect_override overrides[ORL_EFFECT_COUNT];
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        overrides[i] = override;
    return scene_run(&(struct scene_run){.scene = room->text,
                                         .resource_name = room->bsdf ? "pane.xml" : NULL,
                                         .resource_text = room->bsdf ? bsdf : NULL,
                                         .sensors = room->sensors,
                                         .n_sensors = RANDOM_SENSORS,
                                         .technique = ORL_TECHNIQUE_BACKWARD,
                                         .overrides = overrides,
                                         .seed = seed,
                                         .global = 10000,
                                         .samples = 256});
}

static void compare_room(uint32_t index, const char *bsdf, struct tally *tally)
{
    struct random_scene room;
    random_scene(index, &room);
    struct orl_result planned = run_room(&room, bsdf, ORL_OVERRIDE_AUTO, 1);
    struct orl_result forced = run_room(&room, bsdf, ORL_OVERRIDE_FORCE, 2);
    for (int i = 0; i < RANDOM_SENSORS; i++) {
        const double off = fabs(planned.illuminance_lx[i] - forced.illuminance_lx[i]);
        const double se = hypot(planned.standard_error_lx[i], forced.standard_error_lx[i]);
        const double excess = off - bounds_lx(&planned.plan, forced.illuminance_lx[i]);
        tally->compared++;
        tally->beyond_3 += excess > 3 * se + 1e-9;
        /* For two means of 16 batches: once in a hundred thousand. */
        if (excess > 6 * se + 1e-9)
            fail_msg("room %u, sensor %d: planned %g, forced %g, error %g\n%s", index, i,
                     planned.illuminance_lx[i], forced.illuminance_lx[i], se, room.text);
    }
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        tally->skipped[i] += !planned.plan.effects[i].simulated;
    tally->rays_planned += planned.health.rays;
    tally->rays_forced += forced.health.rays;
    orl_result_done(&planned);
    orl_result_done(&forced);
}

static void test_skipped_is_within_bounds(void **state)
{
    char bsdf[2048];
    struct tally tally = {0};
    (void)state;
    scene_uniform_bsdf(0.2, bsdf);
    for (uint32_t i = 0; i < extent(24, 200); i++)
        compare_room(i, bsdf, &tally);
    print_message("%d comparisons, %d beyond 3 standard errors; rays planned / forced: %.3f\n",
                  tally.compared, tally.beyond_3,
                  (double)tally.rays_planned / (double)tally.rays_forced);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        print_message("  %-16s skipped in %3d rooms\n", orl_effect_name((enum orl_effect)i),
                      tally.skipped[i]);
    /* Student's t with 15 to 30 degrees of freedom exceeds 3 in 0.5 to 0.9 %: of n at most 0.9 %,
     * and five standard deviations more; 8 of 200, 20 of 800. */
    const double expected = 0.009 * tally.compared;
    assert_true(tally.beyond_3 <= expected + 5 * sqrt(expected));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_skipped_is_within_bounds)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
