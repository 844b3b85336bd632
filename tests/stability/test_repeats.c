/*
 * Hard cases of chance: the same seed gives the same bytes on any number of threads, and seeds that
 * follow each other have nothing in common.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/random.h"
#include "support/room.h"
#include "support/stability.h"

/* ---- 40: threads ------------------------------------------------------------------------------
 */

static void test_threads(void **state)
{
    static const uint32_t threads[4] = {2, 7, 1, 7};
    const uint64_t seeds = stability_full() ? 4 : 1;
    bool same = true;
    (void)state;
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        struct room_bytes first = room_run_all(1, seed);
        for (int t = 0; t < 4; t++) {
            struct room_bytes other = room_run_all(threads[t], seed);
            same = same && room_same_bytes(&first, &other);
            room_free_bytes(&other);
        }
        room_free_bytes(&first);
    }
    stability_holds(40, "1, 2 and 7 threads, repeated",
                    "sensors, health, maps and image: same bytes", same);
}

/* ---- 41: seeds that follow each other ---------------------------------------------------------
 */

/* Correlation of n pairs, times sqrt(n): a standard normal when they are independent. */
static double correlation(const double *a, const double *b, size_t n)
{
    double mean_a = 0, mean_b = 0, ab = 0, aa = 0, bb = 0;
    for (size_t i = 0; i < n; i++) {
        mean_a += a[i] / (double)n;
        mean_b += b[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        ab += (a[i] - mean_a) * (b[i] - mean_b);
        aa += (a[i] - mean_a) * (a[i] - mean_a);
        bb += (b[i] - mean_b) * (b[i] - mean_b);
    }
    return fabs(ab) / sqrt(aa * bb) * sqrt((double)n);
}

/* First numbers of the streams of a million photons, seed 41 against 42. */
static void test_streams(void **state)
{
    enum { COUNT = 1000000 };
    double *a = malloc(COUNT * sizeof *a), *b = malloc(COUNT * sizeof *b);
    (void)state;
    assert_non_null(a);
    assert_non_null(b);
    for (size_t i = 0; i < COUNT; i++) {
        struct orl_random one = orl_random_stream(41, ORL_PURPOSE_PHOTON, i);
        struct orl_random two = orl_random_stream(42, ORL_PURPOSE_PHOTON, i);
        a[i] = orl_random_uniform(&one);
        b[i] = orl_random_uniform(&two);
    }
    stability_row(41, "seeds s and s + 1", "correlation of 1e6 photons' streams, in 1 / sqrt N",
                  correlation(a, b, COUNT), 3);
    free(a);
    free(b);
}

/* Whole results of seeds 1 to N, each against the next. */
static void test_results(void **state)
{
    enum { MOST = 1000 };
    const int n = stability_full() ? MOST : 64;
    static double lx[ROOM_SENSORS][MOST + 1];
    double worst = 0;
    (void)state;
    for (int s = 0; s <= n; s++) {
        double one[ROOM_SENSORS];
        scene_run_lx(
            &(struct scene_run){.scene =
                                    ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE,
                                .sensors = room_sensors,
                                .n_sensors = ROOM_SENSORS,
                                .seed = (uint64_t)s + 1,
                                .samples = 64,
                                .global = 4000},
            one);
        for (int i = 0; i < ROOM_SENSORS; i++)
            lx[i][s] = one[i];
    }
    for (int i = 0; i < ROOM_SENSORS; i++)
        worst = fmax(worst, correlation(lx[i], lx[i] + 1, (size_t)n));
    stability_row(41, "seeds s and s + 1", "correlation of a room's sensors, in 1 / sqrt N", worst,
                  3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_streams),
        cmocka_unit_test(test_results),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
