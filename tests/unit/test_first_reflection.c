/*
 * Photons whose first surface stores nothing are emitted in proportion to what that surface
 * reflects. They leave the same light on all others as photons that are emitted by flux and stored
 * everywhere, with fewer emissions.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "photon/map/map_layout.h"
#include "photon/strata/strata.h"
#include "photon/tracing/trace.h"
#include "support/room.h"

enum { EMISSIONS = 1 << 17 };

/* A sun on a dark floor and a bright block; a lamp above. */
#define LIGHTS                                                                                     \
    "void light solar 0 0 3 1e6 1e6 1e6\n"                                                         \
    "solar source a 0 0 4 0 -0.6 0.8 0.53\n"                                                       \
    "void light bulb 0 0 3 900 900 900\n"                                                          \
    "bulb sphere lamp 0 0 4 2 2 2.5 .05\n"
#define INSIDE                                                                                     \
    "void plastic dark 0 0 5 .1 .2 .1 0 0\n"                                                       \
    "void plastic bright 0 0 5 .8 .8 .8 0 0\n"                                                     \
    "dark polygon rug 0 0 12 .1 .1 .02 3.9 .1 .02 3.9 3.9 .02 .1 3.9 .02\n"                        \
    "!genbox bright block .5 .5 .4 | xform -t 1.7 .4 .03\n"

/* Photons that were reflected before: their flux per emission, its standard error, their number
 * per emission. */
struct harvest {
    double flux, error, photons;
};

static struct harvest harvest_of(const struct orl_lit_scene *lit_scene,
                                 struct orl_thread_pool *pool)
{
    struct orl_emission *emission = NULL;
    struct orl_deposits deposits = {0};
    struct orl_batches parts = {{0}};
    struct harvest harvest = {0};
    assert_int_equal(orl_emission_new(lit_scene, ORL_PHOTONS_FOR_MAPS, 1, pool, &emission, NULL),
                     0);
    for (uint64_t first = 0; first < EMISSIONS; first += ORL_EMISSIONS_AT_ONCE) {
        double points[ORL_EMISSIONS_AT_ONCE][ORL_SOBOL_DIMENSIONS];
        struct orl_random randoms[ORL_EMISSIONS_AT_ONCE];
        struct orl_photon_ray photon_rays[ORL_EMISSIONS_AT_ONCE];
        bool is_emitted[ORL_EMISSIONS_AT_ONCE];
        for (size_t i = 0; i < ORL_EMISSIONS_AT_ONCE; i++) {
            randoms[i] = orl_random_stream(7, ORL_PURPOSE_BENCH, first + i);
            for (int d = 0; d < ORL_SOBOL_DIMENSIONS; d++)
                points[i][d] = orl_random_uniform(&randoms[i]);
        }
        orl_emission_sample_many(emission, (const double(*)[ORL_SOBOL_DIMENSIONS])points,
                                 ORL_EMISSIONS_AT_ONCE, false, randoms, &deposits.health,
                                 photon_rays, is_emitted);
        orl_trace_many(lit_scene, photon_rays, is_emitted, ORL_EMISSIONS_AT_ONCE, false, randoms,
                       &deposits);
    }
    for (size_t i = 0; i < deposits.count; i++) {
        const struct orl_photon *p = &deposits.photons[i];
        const double flux =
            orl_luma((struct orl_rgb){p->flux[0], p->flux[1], p->flux[2]}) / EMISSIONS;
        if (p->tag != ORL_PHOTON_INDIRECT)
            continue;
        harvest.flux += flux;
        harvest.photons += 1.0 / EMISSIONS;
        parts.luma[p->batch] += flux;
    }
    harvest.error = sqrt(orl_batches_variance(&parts));
    free(deposits.photons);
    orl_emission_free(emission);
    return harvest;
}

/* Batches of 8192 independent emissions give the scatter of the sum. Tolerance: four standard
 * errors of the difference. */
static void test_same_light(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    struct orl_lit_scene *lit_scene =
        build_lit_scene(LIGHTS ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE INSIDE, NULL, NULL, pool);
    (void)state;
    const struct harvest all = harvest_of(lit_scene, pool);
    lit_scene->omit.counted_light = true;
    const struct harvest rest = harvest_of(lit_scene, pool);
    print_message("flux %g +- %g and %g +- %g, photons an emission %.3f and %.3f\n", all.flux,
                  all.error, rest.flux, rest.error, all.photons, rest.photons);
    assert_true(all.flux > 0);
    assert_true(fabs(all.flux - rest.flux) < 4 * hypot(all.error, rest.error));
    assert_true(rest.photons > 1.3 * all.photons);
    orl_lit_scene_free(lit_scene);
    orl_thread_pool_stop(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_light)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
