/* Daylight coefficients: the order of the patches, and the illuminance that they give for a sky. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>

#include "support/year.h"

static const struct year_site izmir = {38.42, 27.14, 2};

/* Reinhart's sky MF:4: rows of equal height, columns as Tregenza's times 4, the last patch the
 * zenith. */
enum { ROWS = 29 };
static int columns_of(int row)
{
    static const int tregenza[7] = {30, 30, 24, 24, 18, 12, 6};
    return row == ROWS - 1 ? 1 : 4 * tregenza[row / 4];
}

static int patch_of(int row, int column)
{
    int patch = 1;
    for (int i = 0; i < row; i++)
        patch += columns_of(i);
    return patch + column;
}

static double edge_deg(int row)
{
    return row == ROWS ? 90 : 90 * row / 28.5;
}

/* Returns the middle of a patch: azimuth clockwise from north, y; x is east. */
static struct orl_vec3 middle_of(int row, int column)
{
    const double altitude = row == ROWS - 1 ? 90 : 0.5 * (edge_deg(row) + edge_deg(row + 1));
    const double up = altitude * ORL_DEG_TO_RAD, turn = 2 * ORL_PI * column / columns_of(row);
    return orl_v3(cos(up) * sin(turn), cos(up) * cos(turn), sin(up));
}

/* Writes a black screen perpendicular to n, with a square hole of that half width at distance 1. */
static void put_screen(struct orl_vec3 n, double half, char *scene, size_t size)
{
    const struct orl_frame frame = orl_frame_about(n);
    const double far = 1e4;
    const double sides[4][4] = {{-far, far, half, far},
                                {-far, far, -far, -half},
                                {-far, -half, -half, half},
                                {half, far, -half, half}};
    size_t used = (size_t)snprintf(scene, size, "void plastic b 0 0 5 0 0 0 0 0\n");
    for (int i = 0; i < 4; i++) {
        used += (size_t)snprintf(scene + used, size - used, "b polygon s%d 0 0 12", i);
        for (int k = 0; k < 4; k++) {
            const double u = sides[i][k == 1 || k == 2], v = sides[i][2 + (k > 1)];
            const struct orl_vec3 p = orl_madd(orl_madd(n, frame.u, u), frame.v, v);
            used += (size_t)snprintf(scene + used, size - used, " %.9g %.9g %.9g", p.x, p.y, p.z);
        }
        used += (size_t)snprintf(scene + used, size - used, "\n");
    }
}

/* Through a hole only the patch is seen in whose middle the hole is. The number of the 2^18
 * cosine-distributed rays through it is binomial: a share of 0.0005, 130 rays, 9 %; the bound is
 * four times that. */
static void test_patches(void **state)
{
    static const int patches[][2] = {{3, 0}, {3, 30}, {10, 77}, {14, 95}, {20, 17}, {28, 0}};
    const double half = 0.02, share = 4 * half * half;
    (void)state;
    for (size_t i = 0; i < sizeof patches / sizeof *patches; i++) {
        const int patch = patch_of(patches[i][0], patches[i][1]);
        const struct orl_vec3 n = middle_of(patches[i][0], patches[i][1]);
        const struct orl_sensor sensor = {{0, 0, 0}, n};
        char scene[2048];
        put_screen(n, half, scene, sizeof scene);
        const struct year_run run = {.scene = scene,
                                     .site = izmir,
                                     .sensors = &sensor,
                                     .n_sensors = 1,
                                     .samples = 1 << 18,
                                     .coefficients = true};
        struct orl_annual_result year = year_run(&run);
        double others = 0;
        for (int k = 0; k < ORL_ANNUAL_PATCHES; k++)
            others += k == patch ? 0 : (double)year.coefficients[k];
        print_message("patch %d: %.5f sr, others %.6f\n", patch, (double)year.coefficients[patch],
                      others);
        assert_true(fabs((double)year.coefficients[patch] / share - 1) < 0.36);
        assert_true(others < 1e-3 * share);
        orl_annual_done(&year);
    }
}

/* The CIE overcast sky, 10 000 lx on level ground, times a room's coefficients equals the annual
 * result for that sky: the same sums, in another order and with the ground as one patch. */
static void test_overcast(void **state)
{
    static const char room[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
    const struct year_run run = {.scene = room,
                                 .site = izmir,
                                 .sensors = room_sensors,
                                 .n_sensors = ROOM_SENSORS,
                                 .samples = 256,
                                 .coefficients = true};
    struct orl_annual_result year = year_run(&run);
    double sky[ORL_ANNUAL_PATCHES], level = 0;
    (void)state;
    for (int row = 0; row < ROWS; row++)
        for (int column = 0; column < columns_of(row); column++) {
            const double low = sin(edge_deg(row) * ORL_DEG_TO_RAD);
            const double high = sin(edge_deg(row + 1) * ORL_DEG_TO_RAD);
            const double luminance = 1 + low + high; /* the mean of 1 + 2 sin */
            sky[patch_of(row, column)] = luminance;
            level += luminance * ORL_PI * (high * high - low * low) / columns_of(row);
        }
    for (int k = 1; k < ORL_ANNUAL_PATCHES; k++)
        sky[k] *= 1e4 / level;
    sky[0] = 0.2 * 1e4 / ORL_PI;
    for (size_t s = 0; s < ROOM_SENSORS; s++) {
        double lx = 0;
        for (int k = 0; k < ORL_ANNUAL_PATCHES; k++)
            lx += sky[k] * (double)year.coefficients[s * ORL_ANNUAL_PATCHES + (size_t)k];
        assert_true(lx > 0);
        assert_true(fabs(lx / (double)year.overcast[s] - 1) < 1e-4);
    }
    orl_annual_done(&year);
}

/* Coefficients hold for one state only, so a request with window groups is refused. */
static void test_shades(void **state)
{
    static char name[] = "g", open_name[] = "open", pane_name[] = "pane";
    static char *windows[] = {pane_name};
    struct orl_shade_state states[] = {{.name = open_name}};
    const struct orl_window_group group = {
        .name = name, .windows = windows, .n_windows = 1, .states = states, .n_states = 1};
    const struct year_run run = {.scene = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                                 .site = izmir,
                                 .sensors = room_sensors,
                                 .n_sensors = ROOM_SENSORS,
                                 .groups = &group,
                                 .n_groups = 1,
                                 .samples = 16,
                                 .coefficients = true};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(year_run_fails(&run, &err), ORL_ERR_INVALID);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_patches),
        cmocka_unit_test(test_overcast),
        cmocka_unit_test(test_shades),
    };
    return cmocka_run_group_tests_name("annual_coefficients", tests, NULL, NULL);
}
