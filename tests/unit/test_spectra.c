/*
 * Spectra as patterns: the chromaticities of CIE's illuminants, one spectrum in four forms,
 * varying places, errors, and cache keys.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/built/scene.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"

#define FLOOR "floor polygon q 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"
#define LAMP " glow floor 0 0 4 1 1 1 0\n" FLOOR

/* CIE standard illuminant D65, 380 to 780 nm. */
#define D65                                                                                        \
    "49.9755 54.6482 82.7549 91.4860 93.4318 86.6823 104.865 117.008 117.812 114.861 115.923 "     \
    "108.811 109.354 107.802 104.790 107.689 104.405 104.046 100 96.3342 95.7880 88.6856 "         \
    "90.0062 89.5991 87.6987 83.2886 83.6992 80.0268 80.2146 82.2778 78.2842 69.7213 71.6091 "     \
    "74.3490 61.6040 69.8856 75.0870 63.5927 46.4182 66.8054 63.3828 "

static int parse(const char *text, struct orl_parsed_scene *ret, struct orl_error *err)
{
    static const char *const names[] = {"a.rad",    "d65.dat", "tent.dat", "tent.cal", "places.dat",
                                        "flat.dat", "two.hsr", "two.dat",  "cut.hsr"};
    static const char d65[] = "1\n380 780 41\n" D65;
    static const char tent[] = "1\n0 0 3 700 560 410\n0 1 0\n";
    static const char cal[] =
        "tent(nm) = if(nm-560, max(700-nm,0)/140, max(nm-410,0)/150);\n"
        "lit(nm) = Px * tent(nm); x = Px; own(v,nm) = v*nm/500; keep(v,nm) = v;\n"
        "hot(nm) = (560/nm)^5*(exp(1.435e7/(2848*560))-1)/(exp(1.435e7/(2848*nm))-1);\n"
        "hole(nm) = if(nm-500, 1/0, 1);";
    static const char places[] = "2\n0 4 2\n380 780 5\n1 1 1 1 1  0 .25 .5 .75 1\n";
    static const char flat[] = "2\n0 4 2\n0 4 2\n1 1 1 1\n";
    /* Two pixels of five bands twice: (m + .5) / 256. */
    static const char two[] = "#?RADIANCE\nNCOMP=5\nWAVELENGTH_SPLITS= 380 480 580 780\n"
                              "FORMAT=Radiance_spectra\n\n-Y 2 +X 2\n"
                              "\x7f\x7f\x7f\x7f\x7f\x80\x19\x4c\x7f\xb2\xe5\x80"
                              "\x7f\x7f\x7f\x7f\x7f\x80\x19\x4c\x7f\xb2\xe5\x80";
    static const char same[] =
        "2\n0 1 2\n420 740 5\n.498046875 .498046875 .498046875 .498046875 .498046875\n"
        ".099609375 .298828125 .498046875 .697265625 .896484375\n";
    const struct orl_file contents[] = {
        {text, strlen(text), NULL},        {d65, sizeof d65 - 1, NULL},
        {tent, sizeof tent - 1, NULL},     {cal, sizeof cal - 1, NULL},
        {places, sizeof places - 1, NULL}, {flat, sizeof flat - 1, NULL},
        {two, sizeof two - 1, NULL},       {same, sizeof same - 1, NULL},
        {two, sizeof two - 2, NULL}};
    struct orl_memory_files memory = {names, contents, sizeof names / sizeof *names};
    const struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse(names, 1, &files, ret, err);
}

/* Returns the floor's emission at a place of that x. */
static struct orl_rgb seen(const char *text, double x)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    struct orl_hit hit;
    if (parse(text, &parsed_scene, &err) < 0 || orl_scene_new(&parsed_scene, &scene, &err) < 0)
        fail_msg("%s:%d %s: %s", err.file, err.line, err.primitive, err.message);
    assert_true(orl_geometry_intersect(scene->geometry,
                                       orl_sub(orl_v3(x, 2, 1), scene->geometry->center),
                                       orl_v3(0, 0, -1), 100, &hit));
    const struct orl_rgb value =
        orl_material_emission(orl_scene_material(scene, hit.facet), &hit, orl_v3(0, 0, 1));
    orl_scene_release(scene);
    return value;
}

static void check_color(struct orl_rgb a, struct orl_rgb b, double tolerance)
{
    const double most = fmax(fabs(a.r - b.r), fmax(fabs(a.g - b.g), fabs(a.b - b.b)));
    if (!(most <= tolerance))
        fail_msg("%.9g %.9g %.9g, not %.9g %.9g %.9g", a.r, a.g, a.b, b.r, b.g, b.b);
}

/* Checks the chromaticity, by the primaries that README and bsdf/document.h name. */
static void check_chromaticity(struct orl_rgb c, double x, double y, double tolerance)
{
    static const double primaries[3][2] = {{.64, .33}, {.29, .6}, {.15, .06}};
    static const double luminances[3] = {0.26510582010582012, 0.67010582010582009,
                                         0.064788359788359784};
    const double channels[3] = {c.r, c.g, c.b};
    double sum[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++) {
        const double weight = channels[i] * luminances[i] / primaries[i][1];
        sum[0] += weight * primaries[i][0];
        sum[1] += weight * primaries[i][1];
        sum[2] += weight;
    }
    if (!(fabs(sum[0] / sum[2] - x) < tolerance && fabs(sum[1] / sum[2] - y) < tolerance))
        fail_msg("%.6f %.6f, not %.6f %.6f", sum[0] / sum[2], sum[1] / sum[2], x, y);
}

/* CIE 15: D65 and A; the latter by Planck's law, in the numbers that define it. */
static void test_illuminants(void **state)
{
    (void)state;
    check_color(seen("void spectrum s 0 0 6 390 770 1 1 1 1\ns" LAMP, 2), orl_gray(1), 1e-4);
    check_color(seen("void spectrum s 0 0 6 900 100 .5 .5 .5 .5\ns" LAMP, 2), orl_gray(.5), 1e-12);
    check_chromaticity(seen("void specfile s 1 d65.dat 0 0\ns" LAMP, 2), .31272, .32903, 2e-4);
    check_chromaticity(seen("void spectrum s 0 0 43 380 780 " D65 "\ns" LAMP, 2), .31272, .32903,
                       2e-4);
    check_chromaticity(seen("void specfunc s 2 hot tent.cal 0 2 380 780\ns" LAMP, 2), .44757,
                       .40745, 2e-4);
}

/* Luminance is kept if a colour is outside the gamut: this band's green has a red of 0. */
static void test_triangle(void **state)
{
    const struct orl_rgb green = seen("void spectrum s 0 0 6 515 485 1 1 1 1\ns" LAMP, 2);
    struct orl_tristimulus band = {0, 0, 0};
    (void)state;
    orl_tristimulus_add(&band, 480, 520, 1);
    assert_true(green.r == 0 && green.g > 0 && green.b > 0);
    /* rgb are shares of the luminances of primaries whose sum is white's. */
    assert_true(fabs(0.26510582010582012 * green.r + 0.67010582010582009 * green.g +
                     0.064788359788359784 * green.b - band.y) < 1e-12);
}

/* A tent spectrum: by a function, by uneven and by even samples, rising and falling; and
 * multiplied by a colour. */
static void test_ways(void **state)
{
    char rising[512] = "", falling[512] = "", text[1200];
    const struct orl_rgb tent = seen("void specfunc s 2 tent tent.cal 0 2 780 380\ns" LAMP, 2);
    (void)state;
    for (int nm = 400; nm <= 710; nm += 5) {
        const double v = nm > 560 ? (700 - nm) / 140.0 : (nm - 410) / 150.0;
        char number[16], before[512];
        snprintf(number, sizeof number, "%.5f ", fmax(v, 0));
        snprintf(before, sizeof before, "%s", falling);
        snprintf(rising + strlen(rising), sizeof rising - strlen(rising), "%.5f ", fmax(v, 0));
        snprintf(falling, sizeof falling, "%.15s%.495s", number, before);
    }
    check_color(seen("void specfile s 1 tent.dat 0 0\ns" LAMP, 2), tent, 2e-3);
    snprintf(text, sizeof text, "void spectrum s 0 0 65 400 710 %s\ns" LAMP, rising);
    const struct orl_rgb up = seen(text, 2);
    snprintf(text, sizeof text, "void spectrum s 0 0 65 710 400 %s\ns" LAMP, falling);
    check_color(seen(text, 2), up, 1e-12);
    check_color(up, tent, 2e-3);
    check_color(seen("void colorfunc c 4 .5 1 2 . 0 0\nc specfunc s 2 tent tent.cal 0 2 380 780\n"
                     "s" LAMP,
                     2),
                (struct orl_rgb){tent.r / 2, tent.g, tent.b * 2}, 1e-12);
}

static void test_places(void **state)
{
    static const char function[] = "void specfunc s 2 lit tent.cal 0 2 380 780\ns" LAMP;
    static const char data[] = "void specdata s 4 %s places.dat tent.cal x 0 0\ns" LAMP;
    static const char ramp[] = "void spectrum s 0 0 7 380 780 0 .25 .5 .75 1\ns" LAMP;
    char text[256];
    const struct orl_rgb tent = seen("void specfunc s 2 tent tent.cal 0 2 380 780\ns" LAMP, 2);
    const struct orl_rgb end = seen(ramp, 2);
    (void)state;
    snprintf(text, sizeof text, data, "keep");
    for (double x = .5; x < 4; x++) {
        check_color(seen(function, x), orl_rgb_scale(tent, x), 1e-5);
        check_color(seen(text, x), orl_rgb_add(orl_gray(1 - x / 4), orl_rgb_scale(end, x / 4)),
                    1e-5);
    }
    snprintf(text, sizeof text, data, "own");
    check_color(seen(text, 1e-4),
                seen("void spectrum s 0 0 7 380 780 .76 .96 1.16 1.36 1.56\ns" LAMP, 2), 1e-4);
    /* Where a wavelength has no value, colours are unchanged. */
    check_color(seen("void specfunc s 2 hole tent.cal 0 2 380 780\ns" LAMP, 2), orl_gray(1), 0);
}

/* A spectral picture equals data of the same values, with its pixels' centres at the ends. */
static void test_picture(void **state)
{
    (void)state;
    for (double x = 0; x <= 4; x += .5)
        check_color(seen("void specpict s 5 keep two.hsr tent.cal x/4 .5 0 0\ns" LAMP, x),
                    seen("void specdata s 4 keep two.dat tent.cal x/4 0 0\ns" LAMP, x), 1e-6);
}

static void test_errors(void **state)
{
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"void spectrum s 0 0 4 380 780 1 1\ns" LAMP, "three values"},
        {"void spectrum s 0 0 5 400 400 1 1 1\ns" LAMP, "that differ"},
        {"void spectrum s 1 d65.dat 0 5 400 700 1 1 1\ns" LAMP, "takes 0 string"},
        {"void specfile s 0 0 0\ns" LAMP, "takes 1 string"},
        {"void specfile s 1 flat.dat 0 0\ns" LAMP, "has 2 axes"},
        {"void specdata s 3 keep d65.dat tent.cal 0 0\ns" LAMP, "an axis of wavelengths"},
        {"void specpict s 4 keep two.hsr tent.cal x 0 0\ns" LAMP, "2 coordinates"},
        {"void specpict s 5 keep cut.hsr tent.cal x 0 0 0\ns" LAMP, "ends before its last pixel"},
        {"void specfunc s 2 tent tent.cal 0 1 380\ns" LAMP, "first two numbers"},
        {"void specfunc s 2 tent tent.cal 0 2 900 800\ns" LAMP, "none is visible"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_parsed_scene parsed_scene = {0};
        struct orl_error err = {0};
        const int code = parse(cases[i].text, &parsed_scene, &err);
        if (code == 0 || !strstr(err.message, cases[i].message))
            fail_msg("case %zu: %d %s", i, code, err.message);
        orl_parsed_scene_done(&parsed_scene);
    }
}

static void test_warning(void **state)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse("void spectrum s 0 0 6 450 600 1 1 1 1\ns" LAMP, &parsed_scene, &err),
                     0);
    assert_int_equal(parsed_scene.n_warnings, 1);
    assert_non_null(strstr(parsed_scene.warnings[0], "of the eye's response"));
    assert_int_equal(parsed_scene.n_materials, 1);
    orl_parsed_scene_done(&parsed_scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_illuminants), cmocka_unit_test(test_triangle),
        cmocka_unit_test(test_ways),        cmocka_unit_test(test_places),
        cmocka_unit_test(test_picture),     cmocka_unit_test(test_errors),
        cmocka_unit_test(test_warning),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
