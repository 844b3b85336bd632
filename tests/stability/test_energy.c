/*
 * Hard cases of energy: closed rooms, very low absorption, light that cannot get out, sums of very
 * many very small fluxes; and viewpoints inside solids, walls and surfaces.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "base/statistics/numeric.h"
#include "photon/map/map.h"
#include "photon/map/quantization.h"
#include "support/cli.h"
#include "support/hdr.h"
#include "support/room.h"
#include "support/stability.h"

static bool warned(const struct orl_result *result, const char *words)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], words))
            return true;
    return false;
}

/* ---- 25: a room without a window ------------------------------------------------------------- */

/* Runs sensors in the closed room; the only lamp is in the room next door. */
static struct orl_result run_closed(const char *more, size_t n_sensors)
{
    static const struct orl_sensor sensors[2] = {{{1, 1, 1}, {0, 0, 1}}, {{1, 1, 0}, {0, 0, 1}}};
    char text[2048];
    snprintf(text, sizeof text, "%s%s",
             ROOM_SKY ROOM_SUN ROOM_GREY "!genbox w room 4 5 3 -i\n"
                                         "void light lamp 0 0 3 10 10 10\n"
                                         "lamp sphere bulb 0 0 4 12 2 1 .1\n"
                                         "!genbox w next 4 5 3 -i | xform -t 10 0 0\n",
             more);
    return scene_run(&(struct scene_run){
        .scene = text, .sensors = sensors, .n_sensors = n_sensors, .global = 2000000});
}

static void test_room_without_window(void **state)
{
    (void)state;
    struct orl_result result = run_closed("", 2);
    stability_row(25, "room without a window", "illuminance inside, lx",
                  result.illuminance_lx[0] + result.illuminance_lx[1], 0);
    stability_row(25, "room without a window", "photons traced, of 2e6 asked for",
                  (double)result.health.photons, 0);
    stability_holds(25, "room without a window", "and said so", warned(&result, "no light"));
    orl_result_done(&result);
}

/* ---- 35: albedo 0.9999 ----------------------------------------------------------------------- */

/* A lamp of radius 1e-4 in the middle of a sphere of radius 1: it absorbs 1e-8 of the light per
 * bounce. */
static void test_white_sphere(void **state)
{
    static const struct orl_sensor sensors[4] = {{{0, 0, -1}, {0, 0, 1}},
                                                 {{0, 0, 1}, {0, 0, -1}},
                                                 {{.6, -.8, 0}, {-.6, .8, 0}},
                                                 {{-.48, .64, .6}, {.48, -.64, -.6}}};
    const double rho = 0.9999, direct = ORL_EFFICACY_LM_PER_W * ORL_PI * 1e5 * 1e-8;
    double worst = 0;
    (void)state;
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = "void plastic w 0 0 5 .9999 .9999 .9999 0 0\n"
                                               "w bubble sphere 0 0 4 0 0 0 1\n"
                                               "void light lamp 0 0 3 1e5 1e5 1e5\n"
                                               "lamp sphere bulb 0 0 4 0 0 0 1e-4\n",
                                      .sensors = sensors,
                                      .n_sensors = 4,
                                      .global = stability_full() ? 20000000 : 2000000});
    for (int i = 0; i < 4; i++)
        worst = fmax(worst, fabs(result.illuminance_lx[i] / (direct / (1 - rho)) - 1));
    stability_row(35, "sphere of albedo 0.9999", "relative error of E = E0 / (1 - rho)", worst,
                  0.01);
    stability_row(35, "sphere of albedo 0.9999", "share of the light lost to the bounce limit",
                  result.health.flux_capped_w / result.health.flux_w, 1e-4);
    orl_result_done(&result);
}

/* ---- 38: viewpoints in solids, in walls, on surfaces ----------------------------------------- */

/* Renders the room with walls of 0.3 m on all sides and a solid block in it. */
static struct orl_result run_view(const char *view, uint64_t seed, double *ret_mean)
{
    static double pixels[18 * 24][3];
    char folder[64], path[128];
    cli_make_folder(folder);
    struct orl_result result = scene_run(
        &(struct scene_run){.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
                            "!genbox w block 1 1 1 | xform -t 1 3 0\n"
                            "!genbox w pier .5 .5 3 | xform -t -2 -2 0\n"
                            "w polygon f1 0 0 12 -.3 0 0 -.3 5 0 -.3 5 3 -.3 0 3\n"
                            "w polygon f2 0 0 12 -.3 0 0 0 0 0 0 5 0 -.3 5 0\n"
                            "w polygon f3 0 0 12 -.3 0 3 0 0 3 0 5 3 -.3 5 3\n"
                            "w polygon f4 0 0 12 -.3 0 0 0 0 0 0 0 3 -.3 0 3\n"
                            "w polygon f5 0 0 12 -.3 5 0 0 5 0 0 5 3 -.3 5 3\n",
                            .view = view,
                            .seed = seed,
                            .width = 24,
                            .height = 18,
                            .samples = 64,
                            .global = 5000,
                            .caustic = 5000,
                            .folder = folder});
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, 24, 18, pixels);
    *ret_mean = 0;
    for (int i = 0; i < 18 * 24; i++)
        for (int k = 0; k < 3; k++)
            *ret_mean += pixels[i][k] / (18 * 24 * 3);
    cli_remove_folder(folder);
    return result;
}

/*
 * A view from inside a solid is dark, except for rays that start within the surface thickness (a
 * millionth of the room) of an edge: 2e-5 of them, each with a few W/sr/m2, five at the most. One
 * such ray makes a whole pixel bright, so the bound is on the mean of all pixels and of several
 * seeds.
 */
static void test_views(void **state)
{
    static const struct {
        const char *view, *words, *invariant;
    } cases[3] = {
        {"-vtv -vp 1.5 3.5 .5 -vd 1 1 .2", "inside a solid or a wall", "eye in a block: flagged"},
        {"-vtv -vp -.15 2 1 -vd 0 1 .2", "inside a solid or a wall", "eye in a wall: flagged"},
        {"-vtv -vp 2 2 0 -vd 0 1 .2", "lies on a surface", "eye on the floor: flagged"}};
    enum { SEEDS = 4 };
    double mean, dark = 0;
    bool clean = true;
    (void)state;
    for (int i = 0; i < 3; i++) {
        double of_seeds = 0;
        for (uint64_t seed = 2; i < 2 && seed <= SEEDS; seed++) {
            struct orl_result another = run_view(cases[i].view, seed, &mean);
            of_seeds += mean / SEEDS;
            orl_result_done(&another);
        }
        struct orl_result result = run_view(cases[i].view, 1, &mean);
        dark = fmax(dark, i < 2 ? of_seeds + mean / SEEDS : 0);
        stability_holds(38, "view inside a solid, or in a wall", cases[i].invariant,
                        warned(&result, cases[i].words) && result.n_views == 1);
        clean = clean && result.health.non_finite == 0;
        orl_result_done(&result);
    }
    stability_row(38, "view inside a solid, or in a wall", "mean pixel in block and wall, W/sr/m2",
                  dark, 1e-4);
    struct orl_result result = run_view("-vtv -vp 3 1.5 1.2 -vd 0 1 0", 1, &mean);
    assert_true(mean > 0.1);
    stability_holds(38, "view inside a solid, or in a wall", "eye in the room: not flagged",
                    !warned(&result, "view '"));
    stability_holds(38, "view inside a solid, or in a wall", "nothing that is no number", clean);
    orl_result_done(&result);
}

/* ---- 39: sums -------------------------------------------------------------------------------- */

/* Fluxes of k 2^-60 W, k below 2^20: their sum is an integer multiple of 2^-60 W, and known
 * exactly. */
static void test_sum(void **state)
{
    const uint64_t count = stability_full() ? 1000000000 : 10000000;
    struct orl_random random = orl_random_stream(39, ORL_PURPOSE_BENCH, 0);
    struct orl_sum sum = {0, 0};
    uint64_t exact = 0;
    (void)state;
    for (uint64_t i = 0; i < count; i++) {
        const uint64_t k = orl_random_bits(&random) >> 44;
        exact += k;
        orl_sum_add(&sum, ldexp((double)k, -60));
    }
    stability_row(39, "many tiny fluxes summed", "relative error of the sum",
                  fabs(orl_sum_value(&sum) / ldexp((double)exact, -60) - 1), 1e-12);
}

/*
 * The mean flux that a map reports is the mean of its photons: multiples of 2^-70 W, so that their
 * sum is exact and known.
 * The map holds the fluxes that it was given, except for dither: a flux is rounded by a step of at
 * most 1/256 of it, with a variance of at most a quarter of the step's square. Five standard
 * errors of the sum of N are then 5 / 512 sqrt(N <f^2>) / (N <f>); for uniform fluxes <f^2> is 4/3
 * <f>^2.
 */
static void test_map_mean(void **state)
{
    const size_t count = stability_full() ? 4000000 : 500000;
    const struct orl_map_build build = {.kind = "global", .emitted = 1, .seed = 1};
    struct orl_photon *photons = calloc(count, sizeof *photons);
    struct orl_random random = orl_random_stream(39, ORL_PURPOSE_BENCH, 1);
    struct orl_photon_map *map = NULL;
    char folder[64], path[128];
    uint64_t exact = 0;
    (void)state;
    assert_non_null(photons);
    for (size_t i = 0; i < count; i++) {
        const uint64_t k = orl_random_bits(&random) >> 44;
        const float flux = ldexpf((float)k, -60);
        exact += k;
        photons[i] = (struct orl_photon){.position = {(float)(i % 1000), (float)(i / 1000), 0},
                                         .flux = {flux, 0, 0},
                                         .normal = orl_normal_encode(orl_v3(0, 0, 1))};
    }
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/map", folder);
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    assert_int_equal(orl_photon_map_write(path, photons, count, &build, pool, NULL), 0);
    orl_thread_pool_stop(pool);
    assert_int_equal(orl_photon_map_open(path, true, &map, NULL), 0);
    uint64_t held = 0;
    for (size_t i = 0; i < count; i++)
        held += (uint64_t)ldexp((double)orl_photon_map_get(map, i).flux[0], 70);
    const double mean = ldexp((double)held, -70) / (double)count;
    stability_row(39, "many tiny fluxes summed", "relative error of a photon map's mean flux",
                  fabs(orl_photon_map_header(map)->flux_mean / mean - 1), 1e-12);
    stability_row(39, "many tiny fluxes summed", "relative error of the light in a photon map",
                  fabs(ldexp((double)held, -10) / (double)exact - 1),
                  5.0 / 512 * sqrt(4.0 / 3 / (double)count));
    orl_photon_map_free(map);
    cli_remove_folder(folder);
    free(photons);
}

/* ---- 44: light that cannot get out ----------------------------------------------------------- */

/*
 * Mirrors of reflectance 0.999 on all sides, nothing diffuse: a share rho^1000 of the light
 * survives up to the limit of bounces, and no photon is stored. The run gives up after 16 M rays
 * without a photon.
 */
static void test_mirror_box(void **state)
{
    static const struct orl_sensor sensor = {{1, 1, 1}, {0, 0, 1}};
    const double expected = pow(0.999, 1000);
    (void)state;
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = "void metal m 0 0 5 .999 .999 .999 1 0\n"
                                               "!genbox m box 4 3 2 -i\n"
                                               "void light lamp 0 0 3 1e9 1e9 1e9\n"
                                               "lamp sphere bulb 0 0 4 2 1.4 1.1 1e-6\n",
                                      .sensors = &sensor,
                                      .n_sensors = 1,
                                      .samples = 64,
                                      .global = 1000000,
                                      .overrides = scene_wish_maps});
    stability_row(44, "mirror box", "rays until it ends", (double)result.health.rays, 3e7);
    stability_row(44, "mirror box", "light lost: relative to rho^1000",
                  fabs(result.health.flux_capped_w / result.health.flux_w / expected - 1), 0.02);
    stability_holds(44, "mirror box", "loss reported, illuminance finite",
                    warned(&result, "bounce limit") && isfinite(result.illuminance_lx[0]));
    orl_result_done(&result);
}

/*
 * A lamp in a cube of clear glass, n = 1.52. Light outside the six cones of the critical angle
 * never gets out: 1 - 6 (1 - cos t) / 2 of it, sin t = 1 / 1.52. Expected: 0.26 +- 0.006 of 5000
 * photons.
 */
static void test_total_internal_reflection(void **state)
{
    static const struct orl_sensor sensor = {{5, 5, 0.1}, {0, 0, 1}};
    const double expected = 1 - 3 * (1 - sqrt(1 - 1 / (1.52 * 1.52)));
    (void)state;
    struct orl_result result = scene_run(&(struct scene_run){
        .scene = "void plastic w 0 0 5 .2 .2 .2 0 0\n!genbox w room 10 10 4 -i\n"
                 "void dielectric d 0 0 5 1 1 1 1.52 0\n"
                 "!genbox d block 1 1 1 | xform -t 4 4 1\n"
                 "void light lamp 0 0 3 1e9 1e9 1e9\n"
                 "lamp sphere bulb 0 0 4 4.52 4.47 1.55 1e-6\n",
        .sensors = &sensor,
        .n_sensors = 1,
        .samples = 64,
        .global = 5000});
    stability_row(44, "total internal reflection", "light lost in a glass cube: off its share",
                  fabs(result.health.flux_capped_w / result.health.flux_w - expected), 0.02);
    stability_holds(44, "total internal reflection", "loss reported, illuminance finite",
                    warned(&result, "bounce limit") && isfinite(result.illuminance_lx[0]));
    orl_result_done(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_room_without_window),
        cmocka_unit_test(test_white_sphere),
        cmocka_unit_test(test_views),
        cmocka_unit_test(test_sum),
        cmocka_unit_test(test_map_mean),
        cmocka_unit_test(test_mirror_box),
        cmocka_unit_test(test_total_internal_reflection),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
