/*
 * Views of irradiance: a ground under a uniform sky receives pi times its radiance, whatever its
 * reflectance and specularity, also seen through glass; the sky itself is black. Within 2 %, of
 * which the sky's 4096 samples per record, or 64 per pixel, use less than half.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>
#include <math.h>

#include <oriel/base/vec.h>

#include "support/cli.h"
#include "support/hdr.h"
#include "support/scene_text.h"

enum { SIDE = 12, PIXELS = SIDE * SIDE };

/* A dark and a bright, glossy half of the ground, and a pane above the northern part. */
static const char ground[] = "void plastic dark 0 0 5 .05 .1 .02 0 0\n"
                             "void plastic bright 0 0 5 .7 .7 .7 .05 .1\n"
                             "void glass pane 0 0 3 .5 .5 .5\n"
                             "dark polygon west 0 0 12 -50 -50 0 0 -50 0 0 50 0 -50 50 0\n"
                             "bright polygon east 0 0 12 0 -50 0 50 -50 0 50 50 0 0 50 0\n"
                             "pane polygon over 0 0 12 -.2 .1 9.5 .2 .1 9.5 .2 .4 9.5 -.2 .4 9.5\n"
                             "void glow sky_glow 0 0 4 10 10 10 0\n"
                             "sky_glow source sky 0 0 4 0 0 1 180\n";

static void check_view(enum orl_technique technique)
{
    const struct scene_run run = {.scene = ground,
                                  .view = "-vtv -vp 0 0 10 -vd 0 0 -1 -vu 0 1 0 -vh 60 -vv 60",
                                  .width = SIDE,
                                  .height = SIDE,
                                  .irradiance = true,
                                  .technique = technique,
                                  .pixel_samples = 64};
    struct scene_run kept = run;
    char folder[64], path[96];
    double rgb[PIXELS][3];
    cli_make_folder(folder);
    kept.folder = folder;
    struct orl_result result = scene_run(&kept);
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, SIDE, SIDE, rgb);
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            if (fabs(rgb[i][c] / (10 * ORL_PI) - 1) > 0.02)
                fail_msg("pixel %d: %g W/m2 instead of %g", i, rgb[i][c], 10 * ORL_PI);
    orl_result_done(&result);
    cli_remove_folder(folder);
}

static void test_backward(void **state)
{
    (void)state;
    check_view(ORL_TECHNIQUE_BACKWARD);
}

static void test_gather(void **state)
{
    (void)state;
    check_view(ORL_TECHNIQUE_GATHER);
}

/* A view up shows only the sky, which receives nothing. */
static void test_sky(void **state)
{
    (void)state;
    const struct scene_run run = {.scene = ground,
                                  .view = "-vtv -vp 0 0 10 -vd 0 0 1 -vu 0 1 0",
                                  .width = 4,
                                  .height = 4,
                                  .irradiance = true,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .pixel_samples = 1};
    struct orl_result result = scene_run(&run);
    assert_true(result.views[0].black);
    orl_result_done(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_backward),
                                       cmocka_unit_test(test_gather), cmocka_unit_test(test_sky)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
