/* Contribution photons: the light that they deposit on surfaces, compared with path tracing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support/year.h"

static const struct year_site izmir = {38.42, 27.14, 2};
static const struct orl_sensor sensors[] = {{{2, 1, .8}, {0, 0, 1}},
                                            {{1, 4, .8}, {0, 0, 1}},
                                            {{3, 2.6, 2.9}, {0, 0, -1}},
                                            {{2, 4.9, 1.5}, {0, -1, 0}}};
enum { SENSORS = sizeof sensors / sizeof *sensors };

#define GLASS ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND
#define PANEL ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE ROOM_GROUND

/*
 * Compares every hour of two days by both techniques, with different seeds. Differences are within
 * the stated errors of both, which are common to all hours of one sensor: for four sensors' hours
 * the rms of z must be below 1.6, the worst below 4.5. Direct sunlight is equal.
 */
static void compare_techniques(const char *scene, const char *panel)
{
    struct year_run run = {.scene = scene,
                           .resource_name = panel ? "pane.xml" : NULL,
                           .resource_text = panel,
                           .site = izmir,
                           .sensors = sensors,
                           .n_sensors = SENSORS,
                           .samples = 4096,
                           .threads = 2,
                           .seed = 3};
    struct orl_annual_result paths = year_run(&run);
    run.technique = ORL_ANNUAL_PRECOMPUTED;
    run.seed = 4;
    struct orl_annual_result photons = year_run(&run);
    double squares = 0, worst = 0, sums[2] = {0, 0}, errors[2] = {0, 0};
    assert_int_equal(paths.n_columns, photons.n_columns);
    const size_t n = SENSORS * paths.n_columns;
    for (size_t i = 0; i < n; i++) {
        const double off = (double)photons.total[i] - (double)paths.total[i];
        const double z = off / hypot((double)photons.se[i], (double)paths.se[i]);
        squares += z * z;
        worst = fmax(worst, fabs(z));
        sums[0] += (double)paths.total[i];
        sums[1] += (double)photons.total[i];
        errors[0] += pow((double)paths.se[i] / (double)paths.total[i], 2) / (double)n;
        errors[1] += pow((double)photons.se[i] / (double)photons.total[i], 2) / (double)n;
    }
    print_message("z rms %.2f, worst %.2f; sum %+.2f %%; errors %.2f %% by paths, %.2f %% by "
                  "photons\n",
                  sqrt(squares / (double)n), worst, 100 * (sums[1] / sums[0] - 1),
                  100 * sqrt(errors[0]), 100 * sqrt(errors[1]));
    assert_true(sqrt(squares / (double)n) < 1.6);
    assert_true(worst < 4.5);
    orl_annual_done(&paths);
    orl_annual_done(&photons);
}

static void test_glass(void **state)
{
    (void)state;
    compare_techniques(GLASS, NULL);
}

static void test_bsdf_surface(void **state)
{
    size_t size;
    char *panel = (char *)scene_read_bytes("tests/fixtures/bsdf_lcp8.xml", &size);
    (void)state;
    compare_techniques(PANEL, panel);
    free(panel);
}

/* Photons keyed by their index are the same for any number of threads. */
static void test_threads(void **state)
{
    struct orl_annual_result years[2];
    (void)state;
    for (uint32_t i = 0; i < 2; i++) {
        const struct year_run run = {.scene = GLASS,
                                     .site = izmir,
                                     .sensors = sensors,
                                     .n_sensors = SENSORS,
                                     .samples = 64,
                                     .photons = 20000,
                                     .technique = ORL_ANNUAL_PRECOMPUTED,
                                     .threads = 1 + 6 * i};
        years[i] = year_run(&run);
    }
    const size_t bytes = years[0].n_sensors * years[0].n_columns * sizeof(float);
    assert_memory_equal(years[0].total, years[1].total, bytes);
    assert_memory_equal(years[0].se, years[1].se, bytes);
    orl_annual_done(&years[0]);
    orl_annual_done(&years[1]);
}

static void test_refused(void **state)
{
    const struct year_run run = {.scene = ROOM_GREY ROOM_GROUND,
                                 .site = izmir,
                                 .sensors = sensors,
                                 .n_sensors = 1,
                                 .technique = ORL_ANNUAL_PRECOMPUTED};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "windows"));
    assert_non_null(strstr(err.hint, "technique"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_glass), cmocka_unit_test(test_bsdf_surface),
        cmocka_unit_test(test_threads), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
