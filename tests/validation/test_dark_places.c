/*
 * Dark places beside lit ones, in views by irradiance records. The records are too wide to resolve
 * them, so the view uses final gathering there.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/hdr.h"
#include "support/room.h"

enum { SIDE = 32, SEEDS = 3 };

/* A black plate 5 cm above a floor under an even sky; the view is of the floor, from under it. */
static const char scene[] =
    ROOM_SKY ROOM_GREY "void plastic k 0 0 5 0 0 0 0 0\n"
                       "w polygon floor 0 0 12 0 0 0 .8 0 0 .8 4 0 0 4 0\n"
                       "k polygon plate 0 0 12 -2 -1 .05 -2 5 .05 .4 5 .05 .4 -1 .05\n";
static const char down[] = "-vtl -vp .28 2 .04 -vd 0 0 -1 -vu 0 1 0 -vh .24 -vv .24";
static const double height = 0.05, edge = 0.4, left = 0.16, width = 0.24;

/* Returns the share of the sky that the floor sees at that distance from the shade's edge, for an
 * endless plate edge. */
static double sky_seen(double out)
{
    return 0.5 * (1 + out / sqrt(out * out + height * height));
}

/* Returns the mean over pixels, between two places, of their radiance over the true one. */
static double ratio_between(double (*rgb)[3], double from, double to)
{
    double sum = 0, n = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double out = left + (i % SIDE + 0.5) / SIDE * width - edge;
        if (out < from || out > to)
            continue;
        sum += rgb[i][1] / (0.5 * sky_seen(out));
        n++;
    }
    return sum / n;
}

/*
 * A tenth to a fortieth of the sky is visible 5 to 15 cm into the shade. Of the 243 rays of a
 * record in so small a picture some 12 get out, which scatter by 29 %; the view has at least 10
 * records there, and three maps 30: 5 %. The interpolation between records is allowed twice that,
 * chance three times.
 */
static void test_under_a_plate(void **state)
{
    double sum = 0;
    (void)state;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        char folder[64], path[128];
        double rgb[SIDE * SIDE][3];
        cli_make_folder(folder);
        struct orl_result result =
            scene_run(&(struct scene_run){.scene = scene,
                                          .view = down,
                                          .width = SIDE,
                                          .height = SIDE,
                                          .folder = folder,
                                          .seed = seed,
                                          .technique = ORL_TECHNIQUE_PRECOMPUTED,
                                          .global = 20000});
        snprintf(path, sizeof path, "%s/view.hdr", folder);
        hdr_read(path, SIDE, SIDE, rgb);
        const double ratio = ratio_between(rgb, -0.15, -0.05);
        print_message("seed %d: %.3f of the true radiance\n", (int)seed, ratio);
        sum += ratio / SEEDS;
        orl_result_done(&result);
        cli_remove_folder(folder);
    }
    assert_true(fabs(sum - 1) < 6 * 0.05);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_under_a_plate)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
