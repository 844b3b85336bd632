/*
 * Suns that buildings opposite hide within minutes, between sun nodes. Hours of a year with few
 * nodes are compared with sixteen times as many nodes, and with separate jobs.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/extent.h"
#include "support/year.h"

#define ROOM ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND

static const struct year_site izmir = {38.42, 27.14, 2};
static const struct orl_sensor sensors[] = {{{1, .7, .8}, {0, 0, 1}},
                                            {{2, 1.5, .8}, {0, 0, 1}},
                                            {{3, 2.5, .8}, {0, 0, 1}},
                                            {{2, 4, .8}, {0, 0, 1}}};
enum {
    SENSORS = sizeof sensors / sizeof *sensors,
    TEXT = 1 << 15,
    TRUTH_SAMPLES = 4096,
    FEW = 1024
};

/* ---- Towers ---------------------------------------------------------------------------------- */

#define TOWERS                                                                                     \
    "w polygon a 0 0 12 -14 -12 -.3 -14 -12 14 -2 -12 14 -2 -12 -.3\n"                             \
    "w polygon b 0 0 12 1 -12 -.3 1 -12 9 7 -12 9 7 -12 -.3\n"                                     \
    "w polygon c 0 0 12 9 -12 -.3 9 -12 18 25 -12 18 25 -12 -.3\n"

/* Two days of each winter month, when the sun is low. */
static void write_winter(char text[TEXT])
{
    static const int months[] = {1, 2, 10, 11, 12};
    snprintf(text, TEXT,
             "place made_up\nlatitude %.4f\nlongitude %.4f\ntime_zone %.1f\nsite_elevation 0\n"
             "weather_data_file_units 1\n",
             izmir.latitude_deg, -izmir.longitude_deg, -15 * izmir.time_zone_h);
    for (size_t i = 0; i < sizeof months / sizeof *months; i++)
        for (int day = 7; day < 28; day += 13)
            year_day(&izmir, months[i], day, text, TEXT);
}

static struct orl_annual_result run_towers(const char *weather, uint32_t sun_halvings)
{
    const struct year_run run = {.scene = ROOM TOWERS,
                                 .site = izmir,
                                 .weather = weather,
                                 .sensors = sensors,
                                 .n_sensors = SENSORS,
                                 .samples = 2048,
                                 .threads = 2,
                                 .sun_halvings = sun_halvings,
                                 .seed = 3};
    return year_run(&run);
}

/* Both runs trace the same paths. Without shadows of photon ports the differences are 7.5 % rms and
 * up to 62 %. */
static void test_towers(void **state)
{
    char weather[TEXT];
    double squares = 0, worst = 0;
    size_t n = 0, within = 0;
    (void)state;
    write_winter(weather);
    struct orl_annual_result few = run_towers(weather, 0), many = run_towers(weather, 2);
    assert_int_equal(few.n_columns, many.n_columns);
    for (size_t i = 0; i < SENSORS * few.n_columns; i++) {
        const double truth = (double)many.total[i];
        if (truth - (double)many.direct[i] < 50)
            continue;
        const double off = ((double)few.total[i] - truth) / truth;
        n++;
        squares += off * off;
        worst = fmax(worst, fabs(off));
        within += fabs((double)few.total[i] - truth) < 1.96 * (double)few.se[i];
    }
    print_message("%zu hours: off by %.3f rms, %.3f at the most; %zu within their intervals\n", n,
                  sqrt(squares / (double)n), worst, within);
    assert_true(n > 200);
    assert_true(sqrt(squares / (double)n) < 0.03 && worst < 0.2);
    assert_true((double)within > 0.93 * (double)n);
    orl_annual_done(&few);
    orl_annual_done(&many);
}

/* ---- A slit ---------------------------------------------------------------------------------- */

/* Two high walls with a slit between them: no sun node lights the window through it. */
#define SLIT                                                                                       \
    "w polygon a 0 0 12 -90 -12 -.3 -90 -12 60 -4.7 -12 60 -4.7 -12 -.3\n"                         \
    "w polygon b 0 0 12 -4.1 -12 -.3 -4.1 -12 60 60 -12 60 60 -12 -.3\n"

static void test_slit(void **state)
{
    const struct year_run run = {.scene = ROOM SLIT,
                                 .site = izmir,
                                 .sensors = sensors,
                                 .n_sensors = SENSORS,
                                 .samples = (uint32_t)extent(2048, 8192),
                                 .threads = 2,
                                 .seed = 3};
    struct orl_annual_result year = year_run(&run);
    (void)state;
    size_t n = 0;
    for (size_t c = 0; c < year.n_columns; c++) {
        const struct orl_annual_step *step = &year.steps[year.step_of_column[c]];
        double lx[SENSORS], se[SENSORS];
        if (fabs(step->hour - 13.5) > 1)
            continue;
        year_hour(&run, step, (uint32_t)extent(FEW, TRUTH_SAMPLES), lx, se);
        for (size_t s = 0; s < SENSORS; s++, n++) {
            const size_t at = s * year.n_columns + c;
            const double off = (double)year.total[at] - lx[s];
            print_message("%d.%d. %.1f h, sensor %zu: %.1f +- %.1f, truth %.1f +- %.1f\n",
                          step->day, step->month, step->hour, s, (double)year.total[at],
                          (double)year.se[at], lx[s], se[s]);
            assert_true(fabs(off) < 4 * hypot((double)year.se[at], se[s]));
            assert_true(fabs(off) < 0.25 * lx[s]);
        }
    }
    assert_true(n >= (size_t)4 * SENSORS);
    orl_annual_done(&year);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_towers), cmocka_unit_test(test_slit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
