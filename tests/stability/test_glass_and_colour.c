/*
 * Hard cases of materials and numbers: surfaces that reflect all light, saturated colour, glass at
 * grazing incidence, neighbouring seeds, glare in the dark.
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
#include "metrics/indices.h"
#include "photon/map/map.h"
#include "scene/material/kinds.h"
#include "support/cli.h"
#include "support/hdr.h"
#include "support/scene_text.h"
#include "support/stability.h"

static const struct orl_hit anywhere = {.normal = {0, 0, 1}, .front = true};

static const double efficacy = ORL_EFFICACY_LM_PER_W;

static double sun_sr(void)
{
    const double s = sin(0.25 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD);
    return 4 * ORL_PI * s * s;
}

/* ---- 36: albedo of 1 and more ---------------------------------------------------------------- */

/* Material lines (line 2 of a scene) that must be refused: each reflects more than it receives, by
 * more than rounding, or has a parameter that is not a share. */
static const char *const shameless[] = {
    "plastic m 0 0 5 .5 1.02 .5 0 0",
    "plastic m 0 0 5 .5 .5 .5 2 .1",
    "plastic m 0 0 5 1e300 0 0 0 0",
    "plastic m 0 0 5 -.1 .5 .5 0 0",
    "metal m 0 0 5 .9 .9 1.5 .9 .1",
    "metal m 0 0 5 .9 .9 .9 1.1 .1",
    "glass m 0 0 3 1.1 1 1",
    "glass m 0 0 3 -1 1 1",
    "glass m 0 0 4 1 1 1 .5",
    "BSDF m 6 0 pane.xml 0 1 0 . 0 3 1 1 1",
    "BSDF m 6 0 pane.xml 0 1 0 . 0 6 0 0 0 1.5 0 0",
};
/* Material lines that are accepted with a warning: the white of exporters, and rounding. */
static const char *const white[] = {
    "plastic m 0 0 5 1 1 1 0 0",        "plastic m 0 0 5 .5 1.0000001 .5 0 0",
    "plastic m 0 0 5 .5 .5 .5 1 0",     "plastic2 m 4 1 0 0 . 0 6 1 1 1 .1 .1 .1",
    "metal m 0 0 5 1 .5 .5 .9 0",       "metal m 0 0 5 1 1 1 1 0",
    "metal m 0 0 5 .9 .9 .9 1.0001 .1", "trans m 0 0 7 1 1 1 0 0 0 0",
    "trans m 0 0 7 1 1 1 0 0 1 .5",     "trans m 0 0 7 1.001 1 1 0 0 1 1",
    "glass m 0 0 3 1.001 1 1",          "mirror m 0 0 3 1.001 1 1",
};
/* Material lines just below the limits: accepted without a warning. */
static const char *const modest[] = {
    "plastic m 0 0 5 .999999 .999999 .999999 .999999 0",
    "metal m 0 0 5 .999999 .999999 .999999 1 0",
    "trans m 0 0 7 1 1 1 0 0 1 1",
    "glass m 0 0 3 1 1 1",
    "mirror m 0 0 3 1 1 1",
    "BSDF m 6 0 pane.xml 0 1 0 . 0 0",
};

/* Returns true if a warning with these words names the material and line 2. */
static bool has_warning(const char *material, const char *words)
{
    char scene[512], xml[2048];
    bool told = false;
    scene_uniform_bsdf(0.1, xml);
    snprintf(scene, sizeof scene, "# one material\nvoid %s\nm polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n",
             material);
    struct orl_parsed_scene d = scene_parse_text(scene, "pane.xml", xml);
    for (size_t i = 0; i < d.n_warnings; i++)
        told |= strstr(d.warnings[i], " m at ") && strstr(d.warnings[i], ":2") &&
                strstr(d.warnings[i], words);
    orl_parsed_scene_done(&d);
    return told;
}

static int try_material(const char *material, struct orl_error *err)
{
    static const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    char scene[512], xml[2048];
    struct scene_run run = {.scene = scene,
                            .resource_name = "pane.xml",
                            .resource_text = xml,
                            .sensors = &sensor,
                            .n_sensors = 1,
                            .samples = 16,
                            .global = 1};
    scene_uniform_bsdf(0.1, xml);
    snprintf(scene, sizeof scene, "# one material\nvoid %s\nm polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n",
             material);
    return scene_run_try(&run, err);
}

/* Colours converted from spectra may be slightly below 0, which gives a warning; further below
 * they are refused. */
static void test_a_little_below_zero(void **state)
{
    static const char *const below[] = {"plastic m 0 0 5 -.0013 .2092 .2601 0 0",
                                        "metal m 0 0 5 .9 .9 -.01 .8 0",
                                        "glass m 0 0 3 -.004 .5 .5", "mirror m 0 0 3 .5 -.001 .5"};
    struct orl_error err = {0};
    (void)state;
    for (size_t i = 0; i < sizeof below / sizeof *below; i++) {
        assert_true(has_warning(below[i], "slightly below 0"));
        assert_int_equal(try_material(below[i], &err), 0);
    }
    assert_false(has_warning("plastic m 0 0 5 0 .2 .3 0 0", "slightly below 0"));
    assert_int_equal(try_material("plastic m 0 0 5 -.02 .2 .3 0 0", &err), ORL_ERR_RANGE);
    assert_non_null(strstr(err.hint, "write 0 instead?"));
}

static void test_36_albedo(void **state)
{
    int passed = 0, refused = 0, untold = 0;
    (void)state;
    for (size_t i = 0; i < sizeof shameless / sizeof *shameless; i++) {
        struct orl_error err = {0};
        const int code = try_material(shameless[i], &err);
        const bool told = code == ORL_ERR_RANGE && err.line == 2 && strstr(err.primitive, " m");
        if (!told)
            print_message("# %s: %d, line %d, %s: %s\n", shameless[i], code, err.line,
                          err.primitive, err.message);
        passed += !told;
    }
    for (size_t i = 0; i < sizeof modest / sizeof *modest; i++) {
        struct orl_error err = {0};
        refused += try_material(modest[i], &err) < 0;
        untold += has_warning(modest[i], "all incident light");
    }
    for (size_t i = 0; i < sizeof white / sizeof *white; i++) {
        struct orl_error err = {0};
        refused += try_material(white[i], &err) < 0;
        untold += !has_warning(white[i], "all incident light");
    }
    stability_row(36, "albedo >= 1", "far above: not refused with file, line and name", passed, 0);
    stability_row(36, "albedo >= 1", "of 1 or just below: refused", refused, 0);
    stability_row(36, "albedo >= 1", "of 1: not warned of by name, or below it warned of", untold,
                  0);
}

/* ---- 42: saturated red ----------------------------------------------------------------------- */

enum { SIDE = 48 };

/* Returns the maximum of green and blue in the image; counts lit pixels. */
static int stray_colour(const char *folder, int *lit)
{
    static double rgb[SIDE * SIDE][3];
    int stray = 0;
    char path[128];
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    hdr_read(path, SIDE, SIDE, rgb);
    for (int i = 0; i < SIDE * SIDE; i++) {
        *lit += rgb[i][0] > 0;
        stray += rgb[i][1] != 0 || rgb[i][2] != 0;
    }
    return stray;
}

static long stray_photons(const struct orl_result *result, const char *folder, const char *kind,
                          uint64_t *count)
{
    struct orl_photon_map *map = NULL;
    char path[512];
    long stray = 0;
    scene_map_path(result, folder, kind, path);
    assert_int_equal(orl_photon_map_open(path, true, &map, NULL), 0);
    *count += orl_photon_map_header(map)->count;
    for (uint64_t i = 0; i < orl_photon_map_header(map)->count; i++) {
        const struct orl_photon photon = orl_photon_map_get(map, i);
        stray += photon.flux[1] != 0 || photon.flux[2] != 0 || !(photon.flux[0] > 0);
    }
    orl_photon_map_free(map);
    return stray;
}

/* Red sun, sky and lamp in a white room with a clear pane: photon maps, final gathering, pictures.
 */
static void test_42_saturated(void **state)
{
    static const char scene[] =
        "void glow g 0 0 4 1 0 0 0\ng source sky 0 0 4 0 0 1 360\n"
        "void light l 0 0 3 1e5 0 0\nl source sun 0 0 4 0 -1 1 .533\n"
        "void light k 0 0 3 5 0 0\nk polygon lamp 0 0 12 1 4 2.9 1 4.2 2.9 1.2 4.2 2.9 1.2 4 2.9\n"
        "void plastic w 0 0 5 .7 .7 .7 .05 .1\nvoid glass p 0 0 3 .96 .95 .94\n"
        "void metal s 0 0 5 .9 .9 .9 .95 0\n"
        "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
        "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
        "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
        "s polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
        "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
        "p polygon pane 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n";
    static const struct orl_sensor sensor = {{2, 3, 0}, {0, 0, 1}};
    char folder[64];
    int lit = 0;
    uint64_t photons = 0;
    (void)state;
    cli_make_folder(folder);
    struct orl_result result = scene_run(
        &(struct scene_run){.scene = scene,
                            .sensors = &sensor,
                            .n_sensors = 1,
                            .samples = 256,
                            .view = "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 90 -vv 90",
                            .width = SIDE,
                            .height = SIDE,
                            .global = 20000,
                            .caustic = 20000,
                            .folder = folder});
    const long stray = stray_photons(&result, folder, "global", &photons) +
                       stray_photons(&result, folder, "caustic", &photons);
    assert_true(result.illuminance_lx[0] > 0 && photons > 30000);
    const int pixels = stray_colour(folder, &lit);
    assert_true(lit > SIDE * SIDE / 2);
    stability_row(42, "saturated red light", "photons with green or blue in them, or without red",
                  (double)stray, 0);
    stability_row(42, "saturated red light", "pixels with green or blue in them", pixels, 0);
    orl_result_done(&result);
    cli_remove_folder(folder);
}

/* ---- 43: glass at 90 degrees ----------------------------------------------------------------- */

/*
 * Returns the ratio of E behind a large pane to E without it. The sensor faces the sun, which is
 * at theta from the pane's normal. The disc is half a degree wide.
 */
static double through_pane(double theta_deg, double transmissivity)
{
    const double t = theta_deg * ORL_DEG_TO_RAD;
    const struct orl_sensor sensor = {{0, 0.01, 0}, {0, -cos(t), sin(t)}};
    char scene[512];
    double lx;
    snprintf(scene, sizeof scene,
             "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 %.15g %.15g .533\n"
             "void glass p 0 0 3 %g %g %g\n"
             "p polygon pane 0 0 12 -100 0 -100 -100 0 100 100 0 100 100 0 -100\n",
             -cos(t), sin(t), transmissivity, transmissivity, transmissivity);
    scene_run_lx(
        &(struct scene_run){
            .scene = scene, .sensors = &sensor, .n_sensors = 1, .samples = 16, .global = 1},
        &lx);
    return lx / (efficacy * 1e6 * sun_sr());
}

/* The transmittance of a slab by Fresnel's formulas, both surfaces and all passes, as tabulated
 * outside this project's code. */
static void test_43_known_angles(void **state)
{
    static const double known[][2] = {{0, .918318},  {30, .915957}, {45, .902528},
                                      {60, .843471}, {75, .614805}, {85, .245646}};
    double worst = fabs(through_pane(0, 0.96) / .881460 - 1);
    (void)state;
    for (int i = 0; i < 6; i++)
        worst = fmax(worst, fabs(through_pane(known[i][0], 1) / known[i][1] - 1));
    stability_row(43, "glass at 90 deg", "|T / closed form - 1| at 0 to 85 degrees", worst, 1e-3);
}

/* From 85 degrees to where the disc's rim passes the pane's plane. */
static void test_43_to_grazing(void **state)
{
    const double step = stability_full() ? 0.05 : 0.4;
    double before = 1;
    int rises = 0;
    (void)state;
    for (int i = 0; i * step <= 4.7; i++) {
        const double share = through_pane(85 + step * i, 1);
        rises += !(share < before) || !(share > 0);
        before = share;
    }
    stability_row(43, "glass at 90 deg", "steps at which T does not fall, 85 to 89.7", rises, 0);
}

/* The formulas alone, down to tiny cosines: T is proportional to the cosine. */
static void test_43_at_grazing(void **state)
{
    static const char *const panes[] = {"1 1 1", ".96 .5 .01", "0 0 0", "1 1 1 1", "1 1 1 10"};
    double worst = 0, excess = 0;
    int odd = 0;
    (void)state;
    for (int k = 0; k < 5; k++) {
        char text[128];
        snprintf(text, sizeof text, "void glass p 0 0 %d %s\n", k < 3 ? 3 : 4, panes[k]);
        struct orl_parsed_scene d = scene_parse_text(text, NULL, NULL);
        for (int i = 0; i <= 3300; i++) {
            const double cosine = i == 3300 ? 0 : pow(10, -0.1 * i);
            const struct orl_rgb t = orl_glass_transmittance(&d.materials[0], &anywhere, cosine);
            const struct orl_rgb r = orl_glass_reflectance(&d.materials[0], &anywhere, cosine);
            odd += !orl_rgb_is_finite(t) || !orl_rgb_is_finite(r) || t.g < 0 || r.g < 0;
            excess = fmax(excess, orl_rgb_max(orl_rgb_add(t, r)) - 1);
            if (k != 3) /* index 1 has no reflecting surface */
                worst = fmax(worst, cosine <= 1e-3 ? t.r / (4 * fmax(cosine, 1e-150)) : 0);
            if (cosine == 0 && k != 3)
                odd += orl_rgb_max(t) > 1e-100 || r.r != 1 || r.g != 1 || r.b != 1;
        }
        orl_parsed_scene_done(&d);
    }
    stability_row(43, "glass at 90 deg", "T, R not finite or below 0; T not 0, R not 1 at 90 deg",
                  odd, 0);
    stability_row(43, "glass at 90 deg", "T + R - 1, cosines 1 to 1e-330", excess, 1e-12);
    stability_row(43, "glass at 90 deg", "T over 4 cos, cosines from 1e-3 down, n of 1.52 and 10",
                  worst, 10);
}

/* ---- 41: neighbouring seeds ------------------------------------------------------------------ */

static double correlation(const double *x, const double *y, size_t n)
{
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0;
    for (size_t i = 0; i < n; i++) {
        sx += x[i];
        sy += y[i];
    }
    for (size_t i = 0; i < n; i++) {
        const double a = x[i] - sx / (double)n, b = y[i] - sy / (double)n;
        sxx += a * a;
        syy += b * b;
        sxy += a * b;
    }
    return sxy / sqrt(sxx * syy);
}

/* Correlation of the first numbers of streams: photon i under seeds s and s + 1, and with photon i
 * + 1. Unit: 1/sqrt(N). */
static void test_41_streams(void **state)
{
    const size_t n = stability_full() ? 4000000 : 200000;
    double *x = malloc(n * sizeof *x), *y = malloc(n * sizeof *y);
    double worst = 0;
    (void)state;
    assert_true(x && y);
    for (int pair = 0; pair < 4; pair++) {
        const uint64_t seed = (uint64_t[]){1, 2, 1000, UINT64_MAX - 1}[pair];
        for (size_t i = 0; i < n; i++) {
            struct orl_random a = orl_random_stream(seed, ORL_PURPOSE_PHOTON, i);
            struct orl_random b = orl_random_stream(seed + 1, ORL_PURPOSE_PHOTON, i);
            x[i] = orl_random_uniform(&a);
            y[i] = orl_random_uniform(&b);
        }
        worst = fmax(worst, fabs(correlation(x, y, n)));
        worst = fmax(worst, fabs(correlation(x, x + 1, n - 1)));
    }
    /* The maximum of eight correlations. */
    stability_row(41, "seeds s and s+1", "streams: |correlation| times sqrt N",
                  worst * sqrt((double)n), 3);
    free(x);
    free(y);
}

/*
 * Errors of whole jobs: sensors that all stand at one place differ only by their random numbers.
 * Their scatter under one seed must not repeat under the next.
 */
static void test_41_jobs(void **state)
{
    enum { SENSORS = 1000 };
    static const char scene[] = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 .3 .2 1 60\n"
                                "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                                "w polygon a 0 0 12 -1 1 0 1 1 0 1 1 2 -1 1 2\n";
    static struct orl_sensor sensors[SENSORS];
    static double lx[2][SENSORS];
    (void)state;
    for (int i = 0; i < SENSORS; i++)
        sensors[i] = (struct orl_sensor){{0, 0, 0.5}, {0, 0.3, 1}};
    for (uint64_t s = 0; s < 2; s++)
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .sensors = sensors,
                                         .n_sensors = SENSORS,
                                         .samples = 16,
                                         .global = 1000,
                                         .seed = s + 1},
                     lx[s]);
    stability_row(41, "seeds s and s+1", "jobs: |correlation of errors| times sqrt N",
                  fabs(correlation(lx[0], lx[1], SENSORS)) * sqrt(SENSORS), 3);
}

/* ---- 47: glare in the dark ------------------------------------------------------------------- */

static void test_47_dark(void **state)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 47);
    double worst = 0;
    long odd = 0;
    (void)state;
    for (int i = 0; i < 200000; i++) {
        const struct orl_glare_source s = {
            .luminance_cd_m2 = pow(10, 12 * orl_random_uniform(&random) - 2),
            .solid_angle_sr = pow(10, 8 * orl_random_uniform(&random) - 8),
            .position_index = 1 + 15 * orl_random_uniform(&random)};
        const struct orl_dgp_options options = {i & 1 ? ORL_DGP_EVALGLARE : ORL_DGP_PUBLISHED,
                                                i & 2};
        const double eye_lx = i % 4 == 0 ? 0 : pow(10, 20 * orl_random_uniform(&random) - 14);
        double dgp = NAN;
        odd += orl_dgp(eye_lx, &s, i & 8 ? 1 : 0, &options, &dgp, NULL) < 0 || !isfinite(dgp) ||
               dgp < 0 || dgp > 1;
        if (eye_lx == 0 && !options.low_light)
            worst = fmax(worst, fabs(dgp - (i & 1 ? 0.159 : 0.16)));
    }
    stability_row(47, "DGP with Ev = 0", "values that are not finite or not from 0 to 1",
                  (double)odd, 0);
    stability_row(47, "DGP with Ev = 0", "|DGP - the formula's constant|, no correction", worst, 0);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_36_albedo),
        cmocka_unit_test(test_42_saturated),
        cmocka_unit_test(test_a_little_below_zero),
        cmocka_unit_test(test_43_known_angles),
        cmocka_unit_test(test_43_to_grazing),
        cmocka_unit_test(test_43_at_grazing),
        cmocka_unit_test(test_41_streams),
        cmocka_unit_test(test_41_jobs),
        cmocka_unit_test(test_47_dark),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
