/*
 * Proxy BSDFs for geometry (a thickness): light hits the BSDF and not the hidden geometry, so the
 * room is lit as without it; views see the geometry.
 *
 * The room is lit by a sun and a uniform sky through a BSDF pane; behind it are a pane of glass and
 * slats. Photons start from the same points with the same random numbers with or without those;
 * they differ a little only because the scene's middle moves, and by rounding. So illuminances
 * agree far better than the 2 % by which 100 000 photons scatter.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/hdr.h"
#include "support/room.h"

/* The pane of ROOM_PANE, its front inside, as a proxy for geometry up to 20 cm behind it. */
#define THIN "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n" ROOM_PANE
#define THICK "void BSDF p 6 .2 pane.xml 0 0 1 . 0 0\n" ROOM_PANE
/* The proxy as a pane that faces out, with its geometry in front of it. */
#define TURNED                                                                                     \
    "void BSDF p 6 -.2 pane.xml 0 0 1 . 0 0\n"                                                     \
    "p polygon pane 0 0 12 1 0 1 3 0 1 3 0 2.5 1 0 2.5\n"
/* A second proxy, outside, for views of the slats from there. */
#define PARTNER                                                                                    \
    "void BSDF q 6 .2 pane.xml 0 0 1 . 0 0\n"                                                      \
    "q polygon partner 0 0 12 1 -.19 1 3 -.19 1 3 -.19 2.5 1 -.19 2.5\n"
#define GLASS                                                                                      \
    "void glass v 0 0 3 .7 .7 .7\n"                                                                \
    "v polygon glazing 0 0 12 1 -.17 1 1 -.17 2.5 3 -.17 2.5 3 -.17 1\n"
/* Three slats, 6 cm deep. */
#define SLATS(material)                                                                            \
    material " polygon s1 0 0 12 1 -.14 1.4 3 -.14 1.4 3 -.08 1.4 1 -.08 1.4\n" material           \
             " polygon s2 0 0 12 1 -.14 1.8 3 -.14 1.8 3 -.08 1.8 1 -.08 1.8\n" material           \
             " polygon s3 0 0 12 1 -.14 2.2 3 -.14 2.2 3 -.08 2.2 1 -.08 2.2\n"
#define LIGHT_AND_ROOM ROOM_SKY ROOM_SUN ROOM_GREY ROOM_SHELL

static void lux_of(const char *scene, double ret_lx[ROOM_SENSORS])
{
    char xml[2048];
    scene_uniform_bsdf(0.2, xml);
    scene_run_lx(&(struct scene_run){.scene = scene,
                                     .resource_name = "pane.xml",
                                     .resource_text = xml,
                                     .sensors = room_sensors,
                                     .n_sensors = ROOM_SENSORS,
                                     .global = 100000,
                                     .caustic = 100000,
                                     .samples = 4096},
                 ret_lx);
}

static void assert_lit_alike(const char *scene, double tolerance)
{
    double plain[ROOM_SENSORS], lx[ROOM_SENSORS];
    lux_of(LIGHT_AND_ROOM THIN, plain);
    lux_of(scene, lx);
    for (int i = 0; i < ROOM_SENSORS; i++) {
        assert_true(plain[i] > 100);
        if (fabs(lx[i] / plain[i] - 1) > tolerance)
            fail_msg("sensor %d: %g lx, without what is hidden %g", i, lx[i], plain[i]);
    }
}

static void what_a_proxy_stands_for_lights_nothing(void **state)
{
    (void)state;
    assert_lit_alike(LIGHT_AND_ROOM THICK GLASS "void plastic s 0 0 5 .8 .1 .1 0 0\n" SLATS("s"),
                     0.01);
}

/* Hidden lamps do not count either, and a pane that faces out works as well; listed in the opposite
 * order it is sampled at other points. */
static void either_side_may_be_the_hidden_one(void **state)
{
    (void)state;
    assert_lit_alike(LIGHT_AND_ROOM TURNED GLASS "void light s 0 0 3 9 9 9\n" SLATS("s"), 0.06);
}

/* Two proxies for the same slats, one on each side, count once for light. */
static void a_pair_dims_once(void **state)
{
    (void)state;
    assert_lit_alike(
        LIGHT_AND_ROOM THICK PARTNER GLASS "void plastic s 0 0 5 .8 .1 .1 0 0\n" SLATS("s"), 0.01);
}

/*
 * Such pairs lie a little further apart than either is thick, as files have them: they still count
 * once, whichever way the second is written, with a warning. Far apart they count twice; if they
 * are not far apart, a warning says so.
 */
static void a_pair_further_apart_than_thick_dims_once(void **state)
{
#define APART(thick, y)                                                                            \
    "void BSDF q 6 " thick " pane.xml 0 0 1 . 0 0\n"                                               \
    "q polygon partner 0 0 12 1 " y " 1 1 " y " 2.5 3 " y " 2.5 3 " y " 1\n"
    static const struct {
        const char *partner, *warned;
    } cases[] = {{APART("-.2", "-.205"), "scatter light once"},
                 {APART("-.2", "-.15"), NULL},
                 {APART("-.2", "-.45"), "one after the other"}};
    (void)state;
    assert_lit_alike(
        LIGHT_AND_ROOM THICK APART("-.2", "-.21") "void plastic s 0 0 5 .8 .1 .1 0 0\n" SLATS("s"),
        0.06);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char xml[2048], scene[8192];
        bool warned = false;
        scene_uniform_bsdf(0.2, xml);
        snprintf(scene, sizeof scene, "%s%svoid plastic s 0 0 5 .8 .1 .1 0 0\n%s",
                 LIGHT_AND_ROOM THICK, cases[i].partner, SLATS("s"));
        struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                                 .resource_name = "pane.xml",
                                                                 .resource_text = xml,
                                                                 .sensors = room_sensors,
                                                                 .n_sensors = 1,
                                                                 .global = 100,
                                                                 .samples = 16});
        for (size_t k = 0; k < result.n_warnings; k++)
            warned = warned || strstr(result.warnings[k],
                                      cases[i].warned ? cases[i].warned : "away from each other");
        assert_true(warned == (cases[i].warned != NULL));
        orl_result_done(&result);
    }
}

/* In a room open at the top of its north wall photons come from the sky: they hit the proxy as
 * well. The photons differ, so each room's illuminances scatter by 2 %. */
static void open_scenes_are_no_different(void **state)
{
    static const char whole[] = "4 5 3 0 5 3\n", open[] = "4 5 2 0 5 2\n";
    const char *shell = ROOM_SHELL, *north = strstr(shell, whole);
    char scenes[2][4096];
    double lx[2][ROOM_SENSORS];
    (void)state;
    assert_non_null(north);
    for (int k = 0; k < 2; k++) {
        snprintf(scenes[k], sizeof scenes[k], "%s%.*s%s%s%s", ROOM_SKY ROOM_SUN ROOM_GREY,
                 (int)(north - shell), shell, open, north + strlen(whole),
                 k ? THICK GLASS "void plastic s 0 0 5 .8 .1 .1 0 0\n" SLATS("s") : THIN);
        lux_of(scenes[k], lx[k]);
    }
    for (int i = 0; i < ROOM_SENSORS; i++)
        if (!(lx[0][i] > 100) || fabs(lx[1][i] / lx[0][i] - 1) > 0.06)
            fail_msg("sensor %d: %g lx, without what is hidden %g", i, lx[1][i], lx[0][i]);
}

/* ---- Views ----------------------------------------------------------------------------------- */

enum { SIDE = 64 };

/* Renders from inside, perpendicular, 1 m in front of the window: rows go from top to bottom. */
static void render_view(const char *scene, double (*ret_rgb)[3])
{
    char xml[2048], folder[64], path[128];
    scene_uniform_bsdf(0.2, xml);
    cli_make_folder(folder);
    struct orl_result result =
        scene_run(&(struct scene_run){.scene = scene,
                                      .resource_name = "pane.xml",
                                      .resource_text = xml,
                                      .view = "-vtv -vp 2 1 1.9 -vd 0 -1 0 -vu 0 0 1 -vh 50 -vv 50",
                                      .width = SIDE,
                                      .height = SIDE,
                                      .global = 20000,
                                      .folder = folder});
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, SIDE, SIDE, ret_rgb);
    orl_result_done(&result);
    cli_remove_folder(folder);
}

/* Returns the pixel that shows height z of the plane y. */
static const double *pixel_at(double (*rgb)[3], double y, double z)
{
    const double tangent = (z - 1.9) / (1 - y);
    const int row = (int)((0.5 - 0.5 * tangent / tan(25 * ORL_DEG_TO_RAD)) * SIDE);
    return rgb[row * SIDE + SIDE / 2];
}

/*
 * Upright slats 20 cm high that glow, and between them the sky of radiance 1 through glass, which
 * shows less than 0.7 of it. The BSDF alone would show the sky's mean, 0.2 pi.
 */
static void views_see_what_is_there(void **state)
{
    static double rgb[SIDE * SIDE][3];
    (void)state;
    render_view(ROOM_SKY ROOM_GREY ROOM_SHELL THICK GLASS
                "void glow s 0 0 4 5 1 .5 0\n"
                "s polygon upright 0 0 12 1 -.1 1.4 1 -.1 1.6 3 -.1 1.6 3 -.1 1.4\n",
                rgb);
    const double *slat = pixel_at(rgb, -0.1, 1.5), *gap = pixel_at(rgb, -0.1, 2.1);
    assert_true(fabs(slat[0] / 5 - 1) < 0.02 && fabs(slat[1] - 1) < 0.02);
    /* Glass of transmissivity 0.7, index 1.52, at 11 degrees: 0.64 (two passes of Fresnel). */
    assert_true(fabs(gap[1] - 0.643) < 0.01 && fabs(gap[0] - gap[2]) < 0.01);
    render_view(ROOM_SKY ROOM_GREY ROOM_SHELL THIN, rgb);
    gap = pixel_at(rgb, 0, 2.1);
    assert_true(gap[1] > 0.3 && gap[1] < 0.62);
}

/*
 * The top of a slat, lit by the sun at 45 degrees and seen from inside and above: its radiance is
 * albedo / pi times the sun's irradiance, plus 1 or 2 % reflected by the wall.
 */
static void hidden_surfaces_are_lit_as_they_are_seen(void **state)
{
    static double rgb[SIDE * SIDE][3];
    const double half = 0.5 * 0.533 * ORL_DEG_TO_RAD;
    const double normal_w = 1e6 * 4 * ORL_PI * sin(0.5 * half) * sin(0.5 * half);
    const double expected = 0.5 / ORL_PI * normal_w * sqrt(0.5);
    (void)state;
    render_view(ROOM_SUN ROOM_GREY ROOM_SHELL THICK
                "void plastic s 0 0 5 .5 .5 .5 0 0\n"
                "s polygon slat 0 0 12 1 -.19 1.5 3 -.19 1.5 3 -.02 1.5 1 -.02 1.5\n",
                rgb);
    const double *top = pixel_at(rgb, -0.1, 1.5);
    assert_true(fabs(top[1] / expected - 1) < 0.05);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_proxy_stands_for_lights_nothing),
        cmocka_unit_test(either_side_may_be_the_hidden_one),
        cmocka_unit_test(a_pair_dims_once),
        cmocka_unit_test(a_pair_further_apart_than_thick_dims_once),
        cmocka_unit_test(open_scenes_are_no_different),
        cmocka_unit_test(views_see_what_is_there),
        cmocka_unit_test(hidden_surfaces_are_lit_as_they_are_seen),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
