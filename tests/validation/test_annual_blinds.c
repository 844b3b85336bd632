/* Blinds as geometry: hours of an annual run compared with separate render jobs of these hours. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/year.h"

enum { SAMPLES = 4096, TRUTH_SAMPLES = 1024, SLATS = 40, SENSORS = 2, HOURS = 3 };

static const struct year_site izmir = {38.42, 27.14, 2};
/* Below the ceiling: facing up to it, and down to the slats. */
static const struct orl_sensor sensors[SENSORS] = {{{2, 1.5, 2.7}, {0, 0, 1}},
                                                   {{2, 2.5, 2.8}, {0, -1, -.4}}};

/* Slats behind the pane, as wide as their spacing, with the inner edges lower. */
static void put_blinds(char *scene, size_t size)
{
    const double step = 1.5 / SLATS;
    size_t used = (size_t)snprintf(
        scene, size, "%s",
        ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
        "void plastic e 0 0 5 .2 .2 .2 0 0\ne polygon ground 0 0 12 -40 -40 -.3 40 -40 -.3 "
        "40 40 -.3 -40 40 -.3\nvoid plastic s 0 0 5 .5 .5 .5 0 0\n");
    for (int i = 0; i <= SLATS; i++) {
        const double z = 1 + step * i;
        used += (size_t)snprintf(
            scene + used, size - used,
            "s polygon slat%d 0 0 12 .95 .02 %g 3.05 .02 %g 3.05 .056 %g .95 .056 %g\n", i, z, z,
            z - .012, z - .012);
    }
}

/*
 * High suns light the outer part of each slat, and the room sees the inner part. Compared with
 * backward jobs: the errors of both have 15 degrees of freedom. One per cent is allowed for
 * interpolation between sun nodes and squares of an eighth of a slat, beyond the year's stated
 * error.
 */
static void test_lit_slats(void **state)
{
    char scene[1 << 13];
    put_blinds(scene, sizeof scene);
    const struct year_run run = {
        .scene = scene,
        .site = izmir,
        .weather = "place made_up\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                   "site_elevation 0\nweather_data_file_units 1\n"
                   "6 21 12.5 850 100\n8 29 9.5 750 90\n8 29 15.5 750 90\n",
        .sensors = sensors,
        .n_sensors = SENSORS,
        .samples = SAMPLES,
        .seed = 3};
    struct orl_annual_result year = year_run(&run);
    double squares = 0, worst = 0;
    (void)state;
    assert_int_equal(year.n_columns, HOURS);
    for (size_t c = 0; c < HOURS; c++) {
        const struct orl_annual_step *step = &year.steps[year.step_of_column[c]];
        double lx[SENSORS], se[SENSORS];
        year_hour(&run, step, TRUTH_SAMPLES, lx, se);
        for (size_t s = 0; s < SENSORS; s++) {
            const double found = (double)orl_annual_row(&year, year.total, s)[c];
            const double own = (double)orl_annual_row(&year, year.se, s)[c];
            const double z = (found - lx[s]) / hypot(hypot(own, se[s]), 1e-2 * lx[s]);
            print_message("sensor %zu, %d/%d %.1f h: %.1f +- %.1f, alone %.1f +- %.1f z %.1f\n", s,
                          step->month, step->day, step->hour, found, own, lx[s], se[s], z);
            squares += z * z / (HOURS * SENSORS);
            worst = fmax(worst, fabs(z));
        }
    }
    print_message("z rms %.2f, worst %.2f\n", sqrt(squares), worst);
    assert_true(sqrt(squares) < 1.5);
    assert_true(worst < 4.5);
    orl_annual_done(&year);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lit_slats)};
    return cmocka_run_group_tests_name("annual_blinds", tests, NULL, NULL);
}
