/*
 * Hard cases of invariance: position of a scene, its unit, orientation of a wall's normal, mirror
 * images.
 *
 * Photons are named by index, and rounding moves a path by 1e-11 m, not onto another path. A moved
 * or scaled room therefore has the same paths, and its results differ by rounding, not by noise.
 * They differ a little more where rounding moves a photon from one leaf of the map to the next.
 * Turned walls and mirror images sample new paths: there the mean difference of many seeds is
 * compared with its own standard error.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/extent.h"
#include "support/room.h"
#include "support/stability.h"

/* Returns the largest relative difference. */
static double worst_of(const double *a, const double *b, size_t n)
{
    double worst = 0;
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, fabs(a[i] - b[i]) / fabs(b[i]));
    return worst;
}

/* ---- 26, 27: position and unit --------------------------------------------------------------- */

static double difference_by(const struct room_change *change)
{
    static const struct room_change none = {1, 0, {0, 0, 0}};
    const uint64_t photons = stability_full() ? 2000000 : extent(50000, 200000);
    double first[ROOM_SENSORS], second[ROOM_SENSORS];
    room_changed_lx(&none, photons, 1, first);
    room_changed_lx(change, photons, 1, second);
    return worst_of(second, first, ROOM_SENSORS);
}

/* The example's office as it is shipped: its files in a folder, moved by xform. */
struct office {
    char folder[64];
    const char *names[3];
};

/* The last four are moved; those before are read by the last four, or stay where they are. */
static const char *const office_files[7] = {"materials.rad",  "sky.rad",    "upper_pane.rad",
                                            "room.rad",       "ground.rad", "glazing.rad",
                                            "upper_glass.rad"};

static void copy_office(struct office *office, const char *xform, struct orl_vec3 shift)
{
    char moved[1024] = "", sensors[16384] = "";
    size_t at = 0;
    cli_make_folder(office->folder);
    for (int i = 0; i < 7; i++) {
        char *text = cli_read_file("client/examples/office", office_files[i]);
        assert_non_null(text);
        cli_write_file(office->folder, office_files[i], text);
        free(text);
        if (i >= 3)
            at += (size_t)snprintf(moved + at, sizeof moved - at, "!xform %s %s\n", xform,
                                   office_files[i]);
    }
    cli_write_file(office->folder, "moved.rad", moved);
    char *list = cli_read_file("client/examples/office", "sensors.txt"), *save = NULL;
    assert_non_null(list);
    at = 0;
    for (char *line = strtok_r(list, "\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
        double p[6];
        if (sscanf(line, "%lf %lf %lf %lf %lf %lf", p, p + 1, p + 2, p + 3, p + 4, p + 5) == 6)
            at +=
                (size_t)snprintf(sensors + at, sizeof sensors - at, "%.17g %.17g %.17g %g %g %g\n",
                                 p[0] + shift.x, p[1] + shift.y, p[2] + shift.z, p[3], p[4], p[5]);
    }
    assert_true(at > 0 && at < sizeof sensors);
    cli_write_file(office->folder, "sensors.txt", sensors);
    free(list);
    office->names[0] = "materials.rad";
    office->names[1] = "sky.rad";
    office->names[2] = "moved.rad";
}

static struct orl_result run_office(const char *xform, struct orl_vec3 shift)
{
    const uint64_t photons = stability_full() ? 2000000 : extent(50000, 100000);
    struct office office;
    copy_office(&office, xform, shift);
    struct orl_result result = scene_run(&(struct scene_run){.source = office.folder,
                                                             .names = office.names,
                                                             .n_names = 3,
                                                             .sensors_file = "sensors.txt",
                                                             .samples = 1024,
                                                             .global = photons,
                                                             .caustic = photons});
    cli_remove_folder(office.folder);
    return result;
}

static void test_place(void **state)
{
    (void)state;
    stability_row(26, "100 km from the origin", "sensors of a room: largest relative difference",
                  difference_by(&(struct room_change){1, 0, {1e5, -1e5, 1e3}}), 1e-3);
    struct orl_result here = run_office("", (struct orl_vec3){0, 0, 0});
    struct orl_result there = run_office("-t 1e5 -1e5 1e3", (struct orl_vec3){1e5, -1e5, 1e3});
    assert_int_equal(here.n_sensors, there.n_sensors);
    stability_row(26, "100 km from the origin",
                  "sensors of the office: largest relative difference",
                  worst_of(there.illuminance_lx, here.illuminance_lx, here.n_sensors), 1e-3);
    orl_result_done(&here);
    orl_result_done(&there);
}

/*
 * Powers of two change no bit. Other factors round photons to other cells of the map, so that a
 * difference remains: another sample of a noise of 1 %, in a few places. The bound is 0.2 %.
 */
static void test_unit(void **state)
{
    (void)state;
    const double exact = fmax(difference_by(&(struct room_change){0x1p-10, 0, {0, 0, 0}}),
                              difference_by(&(struct room_change){0x1p10, 0, {0, 0, 0}}));
    stability_row(27, "scene x 2^10 and 2^-10", "sensors of a room: largest relative difference",
                  exact, 1e-9);
    stability_row(27, "scene in km", "sensors of a room x 1e-3: largest relative difference",
                  difference_by(&(struct room_change){1e-3, 0, {0, 0, 0}}), 2e-3);
    stability_row(27, "scene in mm", "sensors of a room x 1e3: largest relative difference",
                  difference_by(&(struct room_change){1e3, 0, {0, 0, 0}}), 2e-3);
}

/* ---- 34, 46: sides --------------------------------------------------------------------------- */

enum { MOST_SEEDS = 64, MOST_PAIRS = 5 };

/* Returns the mean of n numbers divided by its standard error. */
static double t_of(const double *x, int n)
{
    double mean = 0, squares = 0;
    for (int i = 0; i < n; i++)
        mean += x[i] / n;
    for (int i = 0; i < n; i++)
        squares += (x[i] - mean) * (x[i] - mean);
    return fabs(mean) / sqrt(squares / (n - 1) / n);
}

/* Each pair has a row with the differences of all seeds. Returns the worst t of all pairs. */
static double worst_t(double differences[MOST_PAIRS][MOST_SEEDS], int pairs, int seeds)
{
    double worst = 0;
    for (int i = 0; i < pairs; i++)
        worst = fmax(worst, t_of(differences[i], seeds));
    return worst;
}

static int count_seeds(void)
{
    return stability_full() ? MOST_SEEDS : (int)extent(12, 24);
}

/* Returns samples and photons per seed; the short form has half of them. Noisy differences are
 * compared with their own standard error, for any number of samples. */
static uint32_t count_samples(void)
{
    return stability_full() ? 1024 : (uint32_t)extent(512, 1024);
}

static uint64_t count_photons(void)
{
    return stability_full() ? 50000 : extent(25000, 50000);
}

static void test_normals(void **state)
{
    static double differences[MOST_PAIRS][MOST_SEEDS];
    struct scene_run run = {.sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .samples = count_samples(),
                            .global = count_photons()};
    (void)state;
    for (int s = 0; s < count_seeds(); s++) {
        double a[ROOM_SENSORS], b[ROOM_SENSORS];
        run.seed = (uint64_t)s + 1;
        run.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
        scene_run_lx(&run, a);
        run.scene = room_flipped;
        scene_run_lx(&run, b);
        for (int i = 0; i < ROOM_SENSORS; i++)
            differences[i][s] = b[i] - a[i];
    }
    stability_row(34, "normals inverted", "two-sided walls: worst mean difference in sigma",
                  worst_t(differences, ROOM_SENSORS, count_seeds()), 3);
}

/* The room, the sky and the sun are their own mirror images about x = 2. */
static void test_mirror_image(void **state)
{
    static const struct orl_sensor pairs[6] = {{{0.5, 3, 0}, {0, 0, 1}}, {{3.5, 3, 0}, {0, 0, 1}},
                                               {{1, 4.5, 1}, {1, 0, 0}}, {{3, 4.5, 1}, {-1, 0, 0}},
                                               {{0, 4, 1.5}, {1, 0, 0}}, {{4, 4, 1.5}, {-1, 0, 0}}};
    static double differences[MOST_PAIRS][MOST_SEEDS];
    (void)state;
    for (int s = 0; s < count_seeds(); s++) {
        double lx[6];
        scene_run_lx(
            &(struct scene_run){.scene =
                                    ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                                .sensors = pairs,
                                .n_sensors = 6,
                                .seed = (uint64_t)s + 1,
                                .samples = count_samples(),
                                .global = count_photons()},
            lx);
        for (int i = 0; i < 3; i++)
            differences[i][s] = lx[2 * i + 1] - lx[2 * i];
    }
    stability_row(46, "mirror-symmetric room", "left against right: worst mean difference in sigma",
                  worst_t(differences, 3, count_seeds()), 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_place),
        cmocka_unit_test(test_unit),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_mirror_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
