/*
 * Compares the errors of error maps with the scatter of pixels between seeds, for every technique.
 *
 * For seed k let q_k be the sum over pixels of their squared distances from the mean over all N
 * seeds, times N / (N - 1), and p_k the sum of the squared stated errors. Both have the same
 * expectation if errors are stated correctly, whatever the pixels share (photons, lamps) and
 * whatever bias they have. Seeds are independent (except for the mean that the q_k share, which the
 * factor corrects), so that mean(q) - mean(p) is known to sd(q - p) / sqrt(N): four times that is
 * the tolerance. Errors may be stated too large if samples are stratified, or rays lie on a grid:
 * by half at most, which is 2.25 in squares.
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
#include "support/hdr.h"
#include "support/room.h"

enum { SIDE = 8, PIXELS = SIDE * SIDE, SEEDS = 16 };
static const double most_stated = 2.25;

static const char sphere[] = "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 0 0 0 .1\n"
                             "void plastic w 0 0 5 .5 .5 .5 0 0\nw bubble wall 0 0 4 0 0 0 1\n";
static const char at_wall[] = "-vtv -vp 0 .3 -.5 -vd 0 1 0 -vh 60 -vv 60";
/* The sun through a scattering pane onto the floor: caustic photons. */
static const char room[] = ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE;
static const char at_floor[] = "-vtv -vp 2 4 2 -vd 0 -.1 -1 -vu 0 1 0 -vh 25 -vv 25";

struct errors {
    double values[SEEDS][PIXELS], stated[SEEDS][PIXELS]; /* W/sr/m2 */
};

static void read_values(const char *folder, const char *file, double ret_values[PIXELS])
{
    char path[128];
    double rgb[PIXELS][3];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    hdr_read(path, SIDE, SIDE, rgb);
    for (int i = 0; i < PIXELS; i++)
        ret_values[i] = rgb[i][1];
}

static void render(struct scene_run run, struct errors *ret)
{
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        char folder[64];
        cli_make_folder(folder);
        run.seed = seed + 1;
        run.width = run.height = SIDE;
        run.folder = folder;
        struct orl_result result = scene_run(&run);
        assert_string_equal(result.views[0].files[ORL_PICTURE_ERROR_HDR], "view.error.hdr");
        assert_string_equal(result.views[0].files[ORL_PICTURE_ERROR_PNG], "view.error.png");
        read_values(folder, "view.hdr", ret->values[seed]);
        read_values(folder, "view.error.hdr", ret->stated[seed]);
        orl_result_done(&result);
        cli_remove_folder(folder);
    }
}

static double mean_of(const double *values, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += values[i];
    return sum / n;
}

/* Sums over pixels for each seed: the squared scatter, and the squared stated errors. */
static void sum_up(const struct errors *e, double ret_done[SEEDS], double ret_stated[SEEDS])
{
    memset(ret_done, 0, SEEDS * sizeof *ret_done);
    memset(ret_stated, 0, SEEDS * sizeof *ret_stated);
    for (int i = 0; i < PIXELS; i++) {
        double mean = 0;
        for (int k = 0; k < SEEDS; k++)
            mean += e->values[k][i] / SEEDS;
        for (int k = 0; k < SEEDS; k++) {
            const double off = e->values[k][i] - mean;
            ret_done[k] += off * off * SEEDS / (SEEDS - 1);
            ret_stated[k] += e->stated[k][i] * e->stated[k][i];
        }
    }
}

/* Returns the tolerance of the mean of a - share * b, from its scatter between seeds. */
static double tolerance(const double a[SEEDS], const double b[SEEDS], double share)
{
    double differences[SEEDS], squares = 0;
    for (int k = 0; k < SEEDS; k++)
        differences[k] = a[k] - share * b[k];
    const double mean = mean_of(differences, SEEDS);
    for (int k = 0; k < SEEDS; k++)
        squares += (differences[k] - mean) * (differences[k] - mean);
    return 4 * sqrt(squares / (SEEDS - 1.0) / SEEDS);
}

static void check_errors(const char *name, struct scene_run run)
{
    static struct errors e;
    double done[SEEDS], stated[SEEDS];
    render(run, &e);
    sum_up(&e, done, stated);
    const double q = mean_of(done, SEEDS), p = mean_of(stated, SEEDS);
    print_message("%s: errors stated are %.2f of those made\n", name, sqrt(p / q));
    assert_true(q > 0 && p > 0);
    if (!(q - p <= tolerance(done, stated, 1)))
        fail_msg("%s: stated %g, made %g, known to %g (squares)", name, p, q,
                 tolerance(done, stated, 1));
    if (!(p - most_stated * q <= tolerance(stated, done, most_stated)))
        fail_msg("%s: stated %g, made but %g (squares)", name, p, q);
}

static void test_sphere(void **state)
{
    (void)state;
    check_errors("sphere, backward", (struct scene_run){.scene = sphere,
                                                        .view = at_wall,
                                                        .technique = ORL_TECHNIQUE_BACKWARD,
                                                        .pixel_samples = 16});
    check_errors("sphere, gather",
                 (struct scene_run){.scene = sphere, .view = at_wall, .global = 10000});
    check_errors("sphere, direct", (struct scene_run){.scene = sphere,
                                                      .view = at_wall,
                                                      .technique = ORL_TECHNIQUE_DIRECT,
                                                      .global = 10000});
    check_errors("sphere, precomputed", (struct scene_run){.scene = sphere,
                                                           .view = at_wall,
                                                           .technique = ORL_TECHNIQUE_PRECOMPUTED,
                                                           .global = 10000});
}

static void test_caustics(void **state)
{
    char pane[2048];
    (void)state;
    scene_uniform_bsdf(0.2, pane);
    check_errors("scattering pane, gather", (struct scene_run){.scene = room,
                                                               .resource_name = "pane.xml",
                                                               .resource_text = pane,
                                                               .view = at_floor,
                                                               .global = 10000,
                                                               .caustic = 10000});
    check_errors("scattering pane, backward",
                 (struct scene_run){.scene = room,
                                    .resource_name = "pane.xml",
                                    .resource_text = pane,
                                    .view = at_floor,
                                    .technique = ORL_TECHNIQUE_BACKWARD,
                                    .pixel_samples = 16});
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sphere),
                                       cmocka_unit_test(test_caustics)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
