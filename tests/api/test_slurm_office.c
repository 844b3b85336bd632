/*
 * The example's office by orield --runner slurm, on a real Slurm on loopback: sensors, two views
 * and photon maps; a day of 24 skies; sensors to 2 %; a year. Maps, pictures and numbers equal,
 * byte for byte, those of a daemon without Slurm. With $ORIEL_SLURM_LONG in the example's own size.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cluster.h"
#include "support/parted_daemon.h"

#define SCENE                                                                                      \
    "\"scene\": {\"files\": [\"materials.rad\", \"room.rad\", \"ground.rad\", \"glazing.rad\","    \
    " \"upper_glass.rad\"]}"
#define SUNNY                                                                                      \
    "\"sky\": {\"perez\": {\"month\": 3, \"day\": 22, \"hour\": 12, \"latitude\": 38.42,"          \
    " \"longitude\": 27.14, \"time_zone\": 2, \"direct_normal_w_m2\": 800,"                        \
    " \"diffuse_horizontal_w_m2\": 120}}"
#define SENSORS "\"sensors\": {\"file\": \"sensors.txt\"}"
#define VIEWS(SIZE)                                                                                \
    "\"views\": [{\"name\": \"room\", \"view\": \"-vtv -vp 0.35 5.6 1.5 -vd 0.25 -1 0.05 -vu 0 0"  \
    " 1 -vh 75.2 -vv 60\", " SIZE "}, {\"name\": \"desk\", \"view\": \"-vtv -vp 1.3 2 1.2 -vd 1"   \
    " -0.6 -0.1 -vu 0 0 1 -vh 90 -vv 73.74\", " SIZE "}]"
#define OFFICE(PHOTONS, SIZE)                                                                      \
    "{\"kind\": \"render\", " SCENE ", " SUNNY ", " SENSORS                                        \
    ", " VIEWS(SIZE) ", \"technique\": \"precomputed\", \"gather_samples\": 256, \"photons\": "    \
                     "{\"global\": " PHOTONS ", \"caustic\": " PHOTONS "}}"
#define HOURS(PHOTONS, SIZE)                                                                       \
    "{\"kind\": \"render\", " SCENE ", \"skies\": {\"weather\": {\"file\": \"place.epw\"},"        \
    " \"from\": {\"month\": 3, \"day\": 22, \"hour\": 0.5}, \"to\": {\"month\": 3, \"day\": 22,"   \
    " \"hour\": 23.5}, \"step_h\": 1}, " SENSORS ", " VIEWS(                                       \
        SIZE) ", \"dark\": \"expected\", \"technique\": \"precomputed\", \"gather_samples\": 16,"  \
              " \"photons\": {\"global\": " PHOTONS ", \"caustic\": 0}}"
#define GOAL(SENSORS)                                                                              \
    "{\"kind\": \"render\", " SCENE ", " SUNNY ", " SENSORS                                        \
    ", \"accuracy\": {\"relative_error\": 0.02}}"
#define YEAR(SAMPLES)                                                                              \
    "{\"kind\": \"annual\", " SCENE ", \"weather\": \"place.epw\", \"samples\": " SAMPLES          \
    ", \"grids\": [{\"name\": \"office\", \"sensors\": {\"file\": \"sensors.txt\"}},"              \
    " {\"name\": \"desks\", \"sensors\": {\"file\": \"some.pts\"}}],"                              \
    " \"targets\": [\"sDA300/50 >= 55 %\"]}"

/* Short form, and long form. */
static const struct {
    const char *name, *texts[2];
} documents[] = {
    {"office.json",
     {OFFICE("40000", "\"width\": 80, \"height\": 60"),
      OFFICE("2000000", "\"width\": 400, \"height\": 300")}},
    {"hours.json",
     {HOURS("4000", "\"width\": 20, \"height\": 15"),
      HOURS("200000", "\"width\": 200, \"height\": 150")}},
    {"goal.json",
     {GOAL("\"sensors\": [[2, 1, 0.8, 0, 0, 1], [2, 3, 0.8, 0, 0, 1]]"), GOAL(SENSORS)}},
    {"annual.json", {YEAR("16"), YEAR("512")}},
};

static int set_up(void **state)
{
    const int code = parted_daemon_set_up(state);
    const char *folder = ((struct parted_daemon *)*state)->desk->folder;
    char command[200];
    snprintf(command, sizeof command,
             "cp client/examples/office/*.rad client/examples/office/sensors.txt %s", folder);
    cluster_command(command);
    for (size_t i = 0; i < sizeof documents / sizeof *documents; i++)
        cli_write_file(folder, documents[i].name, documents[i].texts[cluster_long_form()]);
    return code;
}

static void compare_results(struct parted_daemon *f, const char *document)
{
    char path[80];
    parted_submit(f, document, path);
    parted_wait(f, path);
    parted_compare_daemons(f, document, path);
}

static void test_sensors_views_and_maps(void **state)
{
    compare_results(*state, documents[0].name);
}

static void test_a_day_of_24_skies(void **state)
{
    compare_results(*state, documents[1].name);
}

static void test_sensors_to_2_per_cent(void **state)
{
    compare_results(*state, documents[2].name);
}

static void test_a_year(void **state)
{
    compare_results(*state, documents[3].name);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_sensors_views_and_maps, set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_day_of_24_skies, set_up, parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_sensors_to_2_per_cent, set_up,
                                        parted_daemon_tear_down),
        cmocka_unit_test_setup_teardown(test_a_year, set_up, parted_daemon_tear_down),
    };
    return cmocka_run_group_tests(tests, cluster_start, cluster_stop);
}
