/*
 * Stated errors of a view by irradiance records, under a uniform sky, compared with a converged
 * picture by backward: where light is smooth but curved the interpolation between records is most
 * of the error, and the stated error must include it.
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

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT };

static const char scene[] = ROOM_SKY ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE ROOM_GROUND;
static const char view[] = "-vtv -vp 2.2 4.7 1.6 -vd 0 -1 -.1 -vu 0 0 1 -vh 90 -vv 73.7";

struct picture {
    double values[PIXELS], errors[PIXELS]; /* W/(sr m2) */
};

static void read_picture(const char *folder, const char *file, double ret_values[PIXELS])
{
    static double rgb[PIXELS][3];
    char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    hdr_read(path, WIDTH, HEIGHT, rgb);
    for (int i = 0; i < PIXELS; i++)
        ret_values[i] = rgb[i][1];
}

static void render(enum orl_technique technique, uint32_t pixel_samples, struct picture *ret)
{
    char folder[64];
    cli_make_folder(folder);
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .view = view,
                                                             .width = WIDTH,
                                                             .height = HEIGHT,
                                                             .folder = folder,
                                                             .technique = technique,
                                                             .pixel_samples = pixel_samples,
                                                             .global = 100000});
    orl_result_done(&result);
    read_picture(folder, "view.hdr", ret->values);
    read_picture(folder, "view.error.hdr", ret->errors);
    cli_remove_folder(folder);
}

/*
 * With normal and known errors, 95 in 100 pixels would be within 1.96 joint errors. Errors are
 * estimated from a few records each, and neighbours are correlated: the test requires 85 in 100. 89
 * are; 79 were when the error included only the rays and photons of records.
 */
static void test_even_sky(void **state)
{
    static struct picture by_records, by_paths;
    size_t within = 0, lit = 0;
    (void)state;
    render(ORL_TECHNIQUE_GATHER, 0, &by_records);
    render(ORL_TECHNIQUE_BACKWARD, 128, &by_paths);
    for (int i = 0; i < PIXELS; i++) {
        const double error = hypot(by_records.errors[i], by_paths.errors[i]);
        lit += error > 0;
        within += error > 0 && fabs(by_records.values[i] - by_paths.values[i]) < 1.96 * error;
    }
    print_message("%zu of %zu pixels are within 1.96 joint errors\n", within, lit);
    assert_true(lit > PIXELS / 2);
    assert_true(100 * within >= 85 * lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_even_sky)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
