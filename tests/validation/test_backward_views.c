/*
 * Views by the backward technique, compared with closed forms if there are any, otherwise with
 * views from photon maps. Pixels are noisy, so the medians over parts of a picture are compared.
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
#include "support/hdr.h"
#include "support/room.h"

enum { SIDE = 32, PARTS = 4 };
typedef double picture[SIDE * SIDE][3];

struct look {
    const char *scene, *view;
    const char *pane;             /* BSDF, or NULL */
    enum orl_technique technique; /* AUTO means backward */
    uint32_t pixel_samples;
    uint64_t photons;
    const enum orl_effect_override *overrides;
};

static void render_view(const struct look *l, picture ret)
{
    char folder[64], path[128];
    cli_make_folder(folder);
    struct orl_result result = scene_run(&(struct scene_run){
        .scene = l->scene,
        .resource_name = l->pane ? "pane.xml" : NULL,
        .resource_text = l->pane,
        .view = l->view,
        .width = SIDE,
        .height = SIDE,
        .technique = l->technique == ORL_TECHNIQUE_AUTO ? ORL_TECHNIQUE_BACKWARD : l->technique,
        .global = l->photons ? l->photons : 100000,
        .caustic = l->technique == ORL_TECHNIQUE_GATHER ? l->photons : 0,
        .pixel_samples = l->pixel_samples ? l->pixel_samples : 16,
        .samples = (uint32_t)extent(1024, 4096),
        .overrides = l->overrides,
        .folder = folder});
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, SIDE, SIDE, ret);
    orl_result_done(&result);
    cli_remove_folder(folder);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the median of the pixels' ratios, green channel, in one of PARTS x PARTS parts of two
 * pictures. The median ignores edges of bright areas, where the techniques place their rays
 * differently. */
static double part_ratio(picture a, picture b, int column, int row)
{
    enum { SIZE = SIDE / PARTS };
    double ratios[SIZE * SIZE];
    for (int i = 0; i < SIZE * SIZE; i++) {
        const int pixel = (row * SIZE + i / SIZE) * SIDE + column * SIZE + i % SIZE;
        ratios[i] = a[pixel][1] == b[pixel][1] ? 1 : a[pixel][1] / b[pixel][1];
    }
    qsort(ratios, SIZE * SIZE, sizeof *ratios, compare_doubles);
    return ratios[SIZE * SIZE / 2];
}

static double mean(picture p)
{
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += p[i][1];
    return sum / (SIDE * SIDE);
}

/*
 * Asserts that the median ratio of both techniques in each part is 1 within a share. The gather's
 * bias is 2 or 3 % where photons are dense enough, more on small objects; the median of 64 pixels
 * that scatter by some 10 % at 64 rays each has an error of 1.6 %.
 */
static void assert_both_alike(const char *scene, const char *pane, const char *view, double share)
{
    static picture gathered, backward;
    render_view(&(struct look){.scene = scene,
                               .view = view,
                               .pane = pane,
                               .technique = ORL_TECHNIQUE_GATHER,
                               .photons = extent(100000, 300000)},
                gathered);
    render_view(&(struct look){.scene = scene, .view = view, .pane = pane, .pixel_samples = 64},
                backward);
    for (int row = 0; row < PARTS; row++)
        for (int column = 0; column < PARTS; column++) {
            const double ratio = part_ratio(backward, gathered, column, row);
            if (!(fabs(ratio - 1) <= share))
                fail_msg("part %d, %d: backward %g of gather", column, row, ratio);
        }
}

/*
 * A white furnace: a lamp of radiance L and radius a in a sphere of reflectance rho. Its wall shows
 * rho L a^2 / (1 - rho (1 - a^2)) everywhere, the lamp itself L. 16384 rays that scatter by about
 * half of their value: 0.4 %.
 */
static void test_furnace(void **state)
{
    static const double reflectances[3] = {0.2, 0.5, 0.9};
    static picture p;
    (void)state;
    for (int i = 0; i < 3; i++) {
        const double rho = reflectances[i], a = 0.1;
        const double wall = rho * 100 * a * a / (1 - rho * (1 - a * a));
        char scene[512];
        snprintf(scene, sizeof scene,
                 "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 0 0 0 .1\n"
                 "void plastic w 0 0 5 %g %g %g 0 0\nw bubble wall 0 0 4 0 0 0 1\n",
                 rho, rho, rho);
        render_view(
            &(struct look){.scene = scene, .view = "-vtv -vp 0 .3 -.5 -vd 0 1 0 -vh 90 -vv 90"}, p);
        if (!(fabs(mean(p) / wall - 1) < 0.012))
            fail_msg("wall of %g: %g, not %g", rho, mean(p), wall);
        render_view(
            &(struct look){.scene = scene, .view = "-vtv -vp 0 -.5 0 -vd 0 1 0 -vh 4 -vv 4"}, p);
        assert_true(fabs(mean(p) / 100 - 1) < 0.01);
    }
}

/*
 * Materials that mirror a part and scatter another show both: plates under a uniform sky of 1, seen
 * from above, show their albedo by either technique. 1024 pixels of 16 rays with two samples each,
 * which scatter by less than their value: 0.6 %.
 */
static void test_mirrors_that_scatter(void **state)
{
    static const struct {
        const char *material;
        double shown; /* green channel */
    } plates[] = {
        {"void BRTDfunc m 10 .1 .1 .1 0 0 0 0 0 0 . 0 9 .3 .2 .1 .05 .05 .05 0 0 0\n", .3},
        {"void BRTDfunc m 10 .1 .1 .1 .2 .2 .2 0 0 0 . 0 9 0 .3 0 0 0 0 .1 .1 .1\n", .7},
        /* Ward's formula loses .002 or less of the rough half's gloss, .3. */
        {"void metal a 0 0 5 .4 .4 .4 1 0\nvoid plastic b 0 0 5 .2 .2 .2 .3 .05\n"
         "void mixfunc m 4 a b .5 . 0 0\n",
         .42},
    };
    static picture p;
    (void)state;
    for (int i = 0; i < 6; i++) {
        const bool gathers = i & 1;
        char scene[512];
        snprintf(scene, sizeof scene,
                 "%sm polygon plate 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n"
                 "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n",
                 plates[i / 2].material);
        render_view(&(struct look){.scene = scene,
                                   .view = "-vtv -vp 0 0 1 -vd 0 0 -1 -vu 0 1 0 -vh 20 -vv 20",
                                   .technique = gathers ? ORL_TECHNIQUE_GATHER : ORL_TECHNIQUE_AUTO,
                                   .photons = gathers ? 100000 : 0},
                    p);
        if (!(fabs(mean(p) / plates[i / 2].shown - 1) < 0.018))
            fail_msg("plate %d shows %g, not %g", i, mean(p), plates[i / 2].shown);
    }
}

/* The furnace seen from outside with -bv-: the view passes the wall from behind, by both
 * techniques. Without -bv- it is black. */
static void test_through_backs(void **state)
{
    static const char scene[] = "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 0 0 0 .1\n"
                                "void plastic w 0 0 5 .5 .5 .5 0 0\nw bubble wall 0 0 4 0 0 0 1\n";
    static const char *const views[] = {"-vtv -vp 0 -5 .5 -vd 0 1 0 -vh 6 -vv 6 -bv-",
                                        "-vtl -vp 0 -5 .5 -vd 0 1 0 -vh .5 -vv .5 -bv -x 9 -y 9"};
    static const double wall = .5 * 100 * .01 / (1 - .5 * .99);
    static picture p;
    (void)state;
    for (int i = 0; i < 4; i++) {
        render_view(
            &(struct look){.scene = scene,
                           .view = views[i % 2],
                           .photons = 200000,
                           .technique = i < 2 ? ORL_TECHNIQUE_BACKWARD : ORL_TECHNIQUE_GATHER},
            p);
        if (!(fabs(mean(p) / wall - 1) < (i < 2 ? .012 : .03)))
            fail_msg("%d: %g, not %g", i, mean(p), wall);
    }
    render_view(&(struct look){.scene = scene, .view = "-vtv -vp 0 -5 .5 -vd 0 1 0 -vh 6 -vv 6"},
                p);
    assert_true(mean(p) == 0);
}

/* Returns the transmittance of thin glass of index 1.52 at that angle for both polarisations; t is
 * the share that one pass transmits. */
static double through_glass(double cosine, double transmissivity)
{
    const double n = 1.52, inside = sqrt(1 - (1 - cosine * cosine) / (n * n));
    const double t = pow(transmissivity, 1 / inside);
    const double s = (cosine - n * inside) / (cosine + n * inside);
    const double p = (n * cosine - inside) / (n * cosine + inside);
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        const double r = i == 0 ? s * s : p * p;
        sum += 0.5 * (1 - r) * (1 - r) * t / (1 - r * r * t * t);
    }
    return sum;
}

/* A view of 0.2 degrees into the middle of a disc of 0.533: direct, through a pane, in a mirror.
 * Panes and walls add some millionths of it. */
static void test_sun_disc(void **state)
{
    static const char up[] = "-vtv -vp 2 1.5 .3 -vd 0 -1 1 -vh .2 -vv .2";
    static const char mirror[] = "void mirror m 0 0 3 .8 .8 .8\n"
                                 "m polygon mirror 0 0 12 1.5 .5 .1 2.5 .5 .1 2.5 2 .1 1.5 2 .1\n";
    static const char down[] = "-vtv -vp 2 2 1.1 -vd 0 -1 -1 -vh .2 -vv .2";
    static picture p;
    char scene[2048];
    (void)state;
    snprintf(scene, sizeof scene, "%s", ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL);
    render_view(&(struct look){.scene = scene, .view = up, .photons = 2000}, p);
    assert_true(fabs(mean(p) / 1e6 - 1) < 0.005);
    snprintf(scene, sizeof scene, "%s",
             ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE);
    render_view(&(struct look){.scene = scene, .view = up, .photons = 2000}, p);
    assert_true(fabs(mean(p) / (1e6 * through_glass(sqrt(0.5), 0.9)) - 1) < 0.005);
    /* The mirror on the floor, seen from above, shows the sky. */
    snprintf(scene, sizeof scene, "%s%s", ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL, mirror);
    render_view(&(struct look){.scene = scene, .view = down, .photons = 2000}, p);
    assert_true(fabs(mean(p) / 0.8e6 - 1) < 0.005);
}

static void test_room_with_a_pane(void **state)
{
    (void)state;
    assert_both_alike(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE, NULL,
                      "-vtv -vp 2 .5 1.5 -vd 0 1 -.2 -vh 90 -vv 80", 0.06);
}

/* From outside, through the pane: the ground in front of it, the wall, and the interior. */
static void test_from_outside(void **state)
{
    (void)state;
    assert_both_alike(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE
                      "w polygon ground 0 0 12 -9 -9 -.1 13 -9 -.1 13 14 -.1 -9 14 -.1\n",
                      NULL, "-vtv -vp 1.5 -3 1.7 -vd .1 1 0 -vh 60 -vv 50", 0.06);
}

/* A glossy table under a clear window, and a lamp over it. */
static void test_gloss_and_lamps(void **state)
{
    (void)state;
    assert_both_alike(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE
                      "void plastic t 0 0 5 .3 .3 .3 .1 .1\n"
                      "t polygon table 0 0 12 1 1 .8 3 1 .8 3 3 .8 1 3 .8\n"
                      "void light b 0 0 3 20 20 20\n"
                      "b polygon bulb 0 0 12 1.8 2 2.9 1.8 2.4 2.9 2.2 2.4 2.9 2.2 2 2.9\n",
                      NULL, "-vtv -vp 2 4.5 1.6 -vd 0 -1 -.1 -vh 80 -vv 80", 0.08);
}

/* A visible BSDF in the window; a mirror shows the room again. */
static void test_lobes_and_mirrors(void **state)
{
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.2, xml);
    assert_both_alike(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_BSDF ROOM_PANE
                      "void mirror m 0 0 3 .8 .8 .8\n"
                      "m polygon mirror 0 0 12 .1 1 .5 .1 4 .5 .1 4 2.5 .1 1 2.5\n",
                      xml, "-vtv -vp 3 4.5 1.6 -vd -.4 -1 -.1 -vh 80 -vv 80", 0.08);
}

/* A polished table reflects the BSDF in the window, and the sun by way of both. */
static void test_lobes_in_lobes(void **state)
{
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.2, xml);
    assert_both_alike(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_BSDF ROOM_PANE
                      "void plastic t 0 0 5 .3 .3 .3 .2 .1\n"
                      "t polygon table 0 0 12 .2 .5 .8 3.8 .5 .8 3.8 4 .8 .2 4 .8\n",
                      xml, "-vtv -vp 2 4.5 1.6 -vd 0 -1 -.3 -vh 70 -vv 70", 0.08);
}

/* The geometry behind a proxy BSDF is visible, and lit as it is seen. */
static void test_what_stands_behind(void **state)
{
    char xml[2048];
    (void)state;
    scene_uniform_bsdf(0.2, xml);
    assert_both_alike(ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL
                      "void BSDF p 6 .2 pane.xml 0 0 1 . 0 0\n" ROOM_PANE
                      "void plastic s 0 0 5 .5 .5 .5 0 0\n"
                      "s polygon s1 0 0 12 1 -.14 1.4 3 -.14 1.4 3 -.02 1.4 1 -.02 1.4\n"
                      "s polygon s2 0 0 12 1 -.14 1.9 3 -.14 1.9 3 -.02 1.9 1 -.02 1.9\n",
                      xml, "-vtv -vp 2 .5 2.4 -vd 0 -1 -1 -vh 40 -vv 40", 0.08);
}

/* Pictures do not depend on the number of threads. */
static void test_threads(void **state)
{
    unsigned char *bytes[2];
    size_t sizes[2];
    (void)state;
    for (uint32_t i = 0; i < 2; i++) {
        char folder[64], path[128];
        cli_make_folder(folder);
        struct orl_result result = scene_run(&(struct scene_run){
            .scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL ROOM_CLEAR ROOM_PANE,
            .view = "-vtv -vp 2 4 1.5 -vd 0 -1 0 -vh 90 -vv 80",
            .width = 48,
            .height = 40,
            .technique = ORL_TECHNIQUE_BACKWARD,
            .pixel_samples = 4,
            .threads = 1 + 2 * i,
            .folder = folder});
        snprintf(path, sizeof path, "%s/view.hdr", folder);
        bytes[i] = scene_read_bytes(path, &sizes[i]);
        orl_result_done(&result);
        cli_remove_folder(folder);
    }
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    free(bytes[0]);
    free(bytes[1]);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_furnace),
        cmocka_unit_test(test_sun_disc),
        cmocka_unit_test(test_room_with_a_pane),
        cmocka_unit_test(test_from_outside),
        cmocka_unit_test(test_gloss_and_lamps),
        cmocka_unit_test(test_lobes_and_mirrors),
        cmocka_unit_test(test_lobes_in_lobes),
        cmocka_unit_test(test_what_stands_behind),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_through_backs),
        cmocka_unit_test(test_mirrors_that_scatter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
