/*
 * Random sensor-hours of a year in four scenes, 960 (a thousand in the long suite), each compared
 * with a separate backward render job. A job's cost is its set-up, whatever the number of sensors:
 * the quick form has fewer hours and more sensors in each.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "support/extent.h"
#include "support/year.h"

enum { SENSORS_MOST = 20, SAMPLES = 2048, TRUTH_SAMPLES = 512, DAYS = 12, TEXT = 1 << 15 };

static const struct year_site izmir = {38.42, 27.14, 2};

/* Light grey slats in front of the window, so deep that the sun enters only by reflection from
 * them. */
#define SLATS                                                                                      \
    "void plastic s 0 0 5 .7 .7 .7 0 0\n"                                                          \
    "s polygon a 0 0 12 .8 -.3 1.0 3.2 -.3 1.0 3.2 -.02 1.1 .8 -.02 1.1\n"                         \
    "s polygon b 0 0 12 .8 -.3 1.3 3.2 -.3 1.3 3.2 -.02 1.4 .8 -.02 1.4\n"                         \
    "s polygon c 0 0 12 .8 -.3 1.6 3.2 -.3 1.6 3.2 -.02 1.7 .8 -.02 1.7\n"                         \
    "s polygon d 0 0 12 .8 -.3 1.9 3.2 -.3 1.9 3.2 -.02 2.0 .8 -.02 2.0\n"                         \
    "s polygon e 0 0 12 .8 -.3 2.2 3.2 -.3 2.2 3.2 -.02 2.3 .8 -.02 2.3\n"
#define WALL "w polygon wall 0 0 12 -9 -6 -.3 13 -6 -.3 13 -6 5 -9 -6 5\n"

static const struct {
    const char *name, *scene;
    bool panel;
} scenes[] = {{"glass", ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND, false},
              {"slats", ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND SLATS, false},
              {"facing a wall", ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND WALL, false},
              {"panel", ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE ROOM_GROUND, true}};
enum { SCENES = sizeof scenes / sizeof *scenes };

/* Writes a random day of each month. */
static void make_weather(struct orl_random *random, char text[TEXT])
{
    snprintf(text, TEXT,
             "place made_up\nlatitude %.4f\nlongitude %.4f\ntime_zone %.1f\nsite_elevation 0\n"
             "weather_data_file_units 1\n",
             izmir.latitude_deg, -izmir.longitude_deg, -15 * izmir.time_zone_h);
    for (int month = 1; month <= DAYS; month++)
        year_day(&izmir, month, 1 + (int)(28 * orl_random_uniform(random)), text, TEXT);
}

/*
 * Returns a sensor on a work plane, on walls or under the ceiling, half a foot from each surface.
 */
static struct orl_sensor random_sensor(struct orl_random *random)
{
    const double u[4] = {orl_random_uniform(random), orl_random_uniform(random),
                         orl_random_uniform(random), orl_random_uniform(random)};
    const struct orl_vec3 at = {0.15 + 3.7 * u[0], 0.15 + 4.7 * u[1], 0.15 + 0.7 * u[2]};
    static const struct orl_vec3 towards[4] = {{0, 0, 1}, {0, -1, 0.5}, {1, 0, 0.2}, {0, 0, 1}};
    return (struct orl_sensor){at, towards[(int)(4 * u[3])]};
}

static size_t count_hours(void)
{
    return extent(6, 25);
}
static size_t count_sensors(void)
{
    return extent(SENSORS_MOST, 10);
}

/* Differences in units of the joint stated errors. */
struct tally {
    size_t n, beyond;
    double squares, worst;
};

static void compare_hour(const struct year_run *run, const struct orl_annual_result *year, size_t c,
                         struct tally *tally)
{
    const struct orl_annual_step *step = &year->steps[year->step_of_column[c]];
    double lx[SENSORS_MOST], se[SENSORS_MOST];
    year_hour(run, step, TRUTH_SAMPLES, lx, se);
    for (size_t s = 0; s < run->n_sensors; s++) {
        const double found = (double)orl_annual_row(year, year->total, s)[c];
        const double own = (double)orl_annual_row(year, year->se, s)[c];
        const double z = (found - lx[s]) / hypot(own, se[s]);
        tally->n++;
        tally->beyond += fabs(z) > 3;
        tally->squares += z * z;
        tally->worst = fmax(tally->worst, fabs(z));
        if (fabs(z) > 3)
            print_message("  sensor %zu, %d/%d %.1f h: %.1f +- %.1f, alone %.1f +- %.1f\n", s,
                          step->month, step->day, step->hour, found, own, lx[s], se[s]);
    }
}

static void try_scene(size_t scene, struct tally *sum)
{
    struct orl_random random = orl_random_stream(5 + scene, ORL_PURPOSE_BENCH, scene);
    struct orl_sensor sensors[SENSORS_MOST];
    struct tally tally = {.n = 0};
    char weather[TEXT];
    size_t size;
    char *panel = scenes[scene].panel
                      ? (char *)scene_read_bytes("tests/fixtures/bsdf_lcp8.xml", &size)
                      : NULL;
    make_weather(&random, weather);
    for (size_t s = 0; s < count_sensors(); s++)
        sensors[s] = random_sensor(&random);
    const struct year_run run = {.scene = scenes[scene].scene,
                                 .resource_name = panel ? "pane.xml" : NULL,
                                 .resource_text = panel,
                                 .site = izmir,
                                 .weather = weather,
                                 .sensors = sensors,
                                 .n_sensors = count_sensors(),
                                 .samples = SAMPLES,
                                 .photons = extent_is_long() ? 0 : 50000,
                                 .threads = 2,
                                 .seed = 11 + scene};
    struct orl_annual_result year = year_run(&run);
    for (size_t h = 0; h < count_hours(); h++)
        compare_hour(&run, &year, (size_t)((double)year.n_columns * orl_random_uniform(&random)),
                     &tally);
    print_message("%-14s %zu sensor-hours: beyond 3 %zu, z rms %.2f, worst %.2f\n",
                  scenes[scene].name, tally.n, tally.beyond, sqrt(tally.squares / (double)tally.n),
                  tally.worst);
    sum->n += tally.n;
    sum->beyond += tally.beyond;
    sum->squares += tally.squares;
    sum->worst = fmax(sum->worst, tally.worst);
    orl_annual_done(&year);
    free(panel);
}

/* Student's t with 15 degrees of freedom puts nine of a thousand beyond 3, and one in 7 000
 * beyond 5. Hours of one sensor are correlated, some dozens of them about as one: 21 of a thousand
 * are allowed. */
static void test_random_hours(void **state)
{
    struct tally sum = {.n = 0};
    (void)state;
    for (size_t scene = 0; scene < SCENES; scene++)
        try_scene(scene, &sum);
    assert_int_equal(sum.n, SCENES * count_hours() * count_sensors());
    print_message("all: beyond 3 %zu of %zu, z rms %.2f\n", sum.beyond, sum.n,
                  sqrt(sum.squares / (double)sum.n));
    assert_true(sum.beyond * 48 <= sum.n);
    assert_true(sqrt(sum.squares / (double)sum.n) < 1.25);
    assert_true(sum.worst < 5.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_hours)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
