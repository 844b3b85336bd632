/*
 * Glare in pictures. Discs with light, solid angle and position known by arithmetic; sources
 * against a search over all pairs of pixels; indices worked out by hand; settings; classes.
 *
 * A disc drawn by whole pixels has a ragged edge: for a radius of r pixels about sqrt(r) pixels
 * are wrong at random, a share of 1 / (pi r^1.5) of its area; tolerances are several times that.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "metrics/glare.h"
#include "metrics/glare_sources.h"
#include "metrics/indices.h"

#define FISHEYE "-vta -vp 0 0 0 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180"

struct scene {
    struct orl_view_field field;
    float *cd_m2;
};

static void near(double found, double wanted, double share)
{
    if (!(fabs(found - wanted) <= share * fabs(wanted)))
        fail_msg("%.9g is not %.9g within %g", found, wanted, share);
}

/* Returns a uniform view of that luminance. */
static struct scene scene_of(const char *text, uint32_t side, double background)
{
    struct scene scene;
    struct orl_view view;
    assert_int_equal(orl_view_parse(text, &view, NULL), 0);
    assert_int_equal(orl_view_field_init(&scene.field, &view, side, side, 0, NULL), 0);
    scene.cd_m2 = malloc((size_t)side * side * sizeof *scene.cd_m2);
    assert_non_null(scene.cd_m2);
    for (size_t i = 0; i < (size_t)side * side; i++)
        scene.cd_m2[i] = (float)background;
    return scene;
}

static void scene_done(struct scene *scene)
{
    orl_view_field_done(&scene->field);
    free(scene->cd_m2);
}

/* Returns a direction right and above, degrees from the line of sight along great circles through
 * it. */
static struct orl_vec3 towards(double right_deg, double above_deg)
{
    const double sigma = hypot(right_deg, above_deg) * ORL_DEG_TO_RAD;
    const double turn = atan2(above_deg, right_deg);
    return orl_v3(sin(sigma) * cos(turn), sin(sigma) * sin(turn), cos(sigma));
}

static void draw_disc(struct scene *scene, struct orl_vec3 middle, double radius_deg, double cd_m2)
{
    const size_t count = (size_t)scene->field.width * scene->field.height;
    for (size_t i = 0; i < count; i++)
        if (scene->field.solid_angle[i] > 0 && orl_dot(orl_view_field_direction(&scene->field, i),
                                                       middle) >= cos(radius_deg * ORL_DEG_TO_RAD))
            scene->cd_m2[i] = (float)cd_m2;
}

static struct orl_glare rate(const struct scene *scene, const struct orl_glare_settings *settings)
{
    const struct orl_luminances picture = {.field = &scene->field, .cd_m2 = scene->cd_m2};
    struct orl_glare glare;
    assert_int_equal(orl_glare_evaluate(&picture, NULL, settings, &glare, NULL), 0);
    return glare;
}

/* ---- The field of view ----------------------------------------------------------------------- */

/* A hemisphere has 2 pi sr, or pi weighted by the cosine: a luminance L gives pi L lx. */
static void test_uniform_view(void **state)
{
    const struct orl_glare_settings usual = {.threshold = 0};
    struct scene scene = scene_of(FISHEYE, 200, 1000);
    const struct orl_glare glare = rate(&scene, &usual);
    (void)state;
    near(glare.field_sr, 2 * ORL_PI, 2e-3);
    near(glare.values[ORL_GLARE_ILLUMINANCE].value, ORL_PI * 1000, 1e-3);
    near(glare.values[ORL_GLARE_AVERAGE].value, 1000, 1e-6);
    assert_int_equal(glare.n_sources, 0);
    near(glare.values[ORL_GLARE_DGP].value, 5.87e-5 * ORL_PI * 1000 + 0.159, 1e-3);
    near(glare.values[ORL_GLARE_DGPS].value, 6.22e-5 * ORL_PI * 1000 + 0.184, 1e-3);
    assert_true(glare.values[ORL_GLARE_UGR].value == 0);
    assert_true(glare.values[ORL_GLARE_VCP].value == 100);
    orl_glare_done((struct orl_glare *)&glare);
    scene_done(&scene);
}

/* A perspective view of h by v degrees holds 4 asin(sin(h/2) sin(v/2)) sr. */
static void test_perspective_field(void **state)
{
    const double half = 60 * ORL_DEG_TO_RAD;
    struct scene scene = scene_of("-vtv -vd 0 1 0 -vh 120 -vv 120", 150, 1);
    (void)state;
    near(scene.field.all_sr, 4 * asin(sin(half) * sin(half)), 1e-6);
    scene_done(&scene);
}

static void test_parallel_views_have_no_eye(void **state)
{
    struct orl_view_field field;
    struct orl_view view;
    (void)state;
    assert_int_equal(orl_view_parse("-vtl -vh 2 -vv 2", &view, NULL), 0);
    assert_int_equal(orl_view_field_init(&field, &view, 4, 4, 0, NULL), ORL_ERR_UNSUPPORTED);
    orl_view_field_done(&field);
}

/* ---- Position indices ------------------------------------------------------------------------ */

/* Worked out from the formulas by a calculator, to four digits. */
static void test_position_indices(void **state)
{
    (void)state;
    near(orl_position_index(orl_v3(0, 0, 1)), 1, 1e-9);
    near(orl_position_index(towards(0, 20)), 2.1460, 2e-4);  /* tau 0: e^(0.6796 + 0.084) */
    near(orl_position_index(towards(20, 0)), 1.2384, 2e-4);  /* tau 90: e^(0.12999 + 0.08380) */
    near(orl_position_index(towards(0, -20)), 1.2914, 2e-4); /* beta 22.7125: e^(.1474 + .1083) */
    near(orl_position_index(towards(0, 85)), 16, 1e-12);
    /* Both formulas agree at eye level, up to e^-20 and the error of tau's fit. */
    near(orl_position_index(towards(40, 1e-9)), orl_position_index(towards(40, -1e-9)), 2e-3);
}

/* ---- Discs ----------------------------------------------------------------------------------- */

/* Checks Ev, solid angle, index and DGP of one disc on a darker ground, by arithmetic. */
static void check_disc(double right_deg, double above_deg, double radius_deg, double cd_m2)
{
    const struct orl_glare_settings usual = {.threshold = 0};
    const double ground = 300, r = radius_deg * ORL_DEG_TO_RAD, side = 600;
    const double edge = 4 / (ORL_PI * pow(radius_deg * side / 180, 1.5)); /* visible from the top */
    const struct orl_vec3 middle = towards(right_deg, above_deg);
    struct scene scene = scene_of(FISHEYE, (uint32_t)side, ground);
    draw_disc(&scene, middle, radius_deg, cd_m2);
    struct orl_glare glare = rate(&scene, &usual);
    const double sr = 2 * ORL_PI * (1 - cos(r));
    /* A disc's cosine-weighted solid angle is pi sin^2 r cos sigma if all of it is in front. */
    const double direct = cd_m2 * ORL_PI * sin(r) * sin(r) * middle.z;
    const double eye = ground * ORL_PI * (1 - sin(r) * sin(r) * middle.z) + direct;
    const double p = orl_position_index(middle);
    const double sum = cd_m2 * cd_m2 * sr / (p * p * pow(eye, 1.87));
    assert_int_equal(glare.n_sources, 1);
    near(glare.sources[0].solid_angle_sr, sr, edge);
    near(glare.sources[0].luminance_cd_m2, cd_m2, 1e-5);
    near(glare.sources[0].position_index, p, 0.01);
    near(glare.values[ORL_GLARE_ILLUMINANCE].value, eye, 1e-3 + edge * direct / eye);
    near(glare.direct_lx, direct, edge);
    /* The error is at most 0.092 / ln 10 times that of the sum, plus that of Ev. */
    const double dgp = 5.87e-5 * eye + 0.092 * log10(1 + sum) + 0.159;
    const double most = 0.04 * (edge + 0.02) + 5.87e-5 * (1e-3 * eye + edge * direct);
    assert_true(fabs(glare.values[ORL_GLARE_DGP].value - fmin(dgp, 1)) <= most);
    orl_glare_done(&glare);
    scene_done(&scene);
}

static void test_discs(void **state)
{
    (void)state;
    check_disc(0, 0, 5, 10000);
    check_disc(30, 0, 4, 20000);
    check_disc(0, 30, 4, 20000);
    check_disc(-25, -25, 6, 8000);
    check_disc(40, 35, 3, 400000); /* all peak: the rest is empty, and removed */
}

/* A sun in a bright patch gives two sources; the patch excludes the sun's pixels. */
static void test_peaks_are_taken_apart(void **state)
{
    struct orl_glare_settings settings = {.threshold = 0};
    struct scene scene = scene_of(FISHEYE, 400, 500);
    (void)state;
    draw_disc(&scene, towards(10, 20), 8, 4000);
    draw_disc(&scene, towards(10, 20), 2, 1e6);
    struct orl_glare apart = rate(&scene, &settings);
    assert_int_equal(apart.n_sources, 2);
    near(apart.sources[0].luminance_cd_m2, 1e6, 1e-5);
    near(apart.sources[1].luminance_cd_m2, 4000, 1e-5);
    settings.no_peaks = true;
    struct orl_glare whole = rate(&scene, &settings);
    assert_int_equal(whole.n_sources, 1);
    near(whole.sources[0].solid_angle_sr,
         apart.sources[0].solid_angle_sr + apart.sources[1].solid_angle_sr, 1e-9);
    near(whole.direct_lx, apart.direct_lx, 1e-9);
    orl_glare_done(&apart);
    orl_glare_done(&whole);
    scene_done(&scene);
}

/* Two discs are one source if they are at most 5.73 degrees apart: edges at 5 or at 7 degrees. */
static void test_search_radius(void **state)
{
    const struct orl_glare_settings usual = {.threshold = 0}, narrow = {.radius_rad = 0.1};
    (void)state;
    for (int far = 0; far < 2; far++) {
        struct scene scene = scene_of(FISHEYE, 400, 100);
        draw_disc(&scene, towards(-4, 10), 2, 5000);
        draw_disc(&scene, towards(far ? 7 : 5, 10), 2, 5000);
        struct orl_glare found = rate(&scene, &usual), apart = rate(&scene, &narrow);
        assert_int_equal(found.n_sources, far ? 2 : 1);
        assert_int_equal(apart.n_sources, 2);
        orl_glare_done(&found);
        orl_glare_done(&apart);
        scene_done(&scene);
    }
}

/* Smoothing fills a hole of few pixels in a disc; it does not add a far pixel. */
static void test_smoothing(void **state)
{
    const struct orl_glare_settings rough = {.threshold = 0}, smooth = {.smooth = true};
    struct scene scene = scene_of(FISHEYE, 300, 100);
    (void)state;
    draw_disc(&scene, towards(0, 0), 10, 5000);
    draw_disc(&scene, towards(0, 0), 1, 1000);
    struct orl_glare a = rate(&scene, &rough), b = rate(&scene, &smooth);
    assert_int_equal(a.n_sources, 1);
    assert_int_equal(b.n_sources, 1);
    assert_true(b.sources[0].pixels > a.sources[0].pixels);
    assert_true(b.sources[0].luminance_cd_m2 < a.sources[0].luminance_cd_m2);
    /* At most the hole, and a rim narrower than the search disc of 5.5 degrees. */
    assert_true(b.sources[0].solid_angle_sr < 2 * ORL_PI * (1 - cos(14 * ORL_DEG_TO_RAD)));
    orl_glare_done(&a);
    orl_glare_done(&b);
    scene_done(&scene);
}

/* Discs as wide as the picture: a cancel between two pixels leaves all labels unchanged. */
static void test_cancelled(void **state)
{
    enum { SIDE = 40 };
    const struct orl_glare_settings smooth = {.smooth = true, .radius_rad = 3.2};
    const atomic_bool cancel = true;
    struct scene scene = scene_of(FISHEYE, SIDE, 100);
    const struct orl_luminances picture = {&scene.field, scene.cd_m2, &cancel};
    uint32_t label[SIDE * SIDE] = {0};
    struct orl_glare glare = {0};
    struct orl_error err;
    (void)state;
    draw_disc(&scene, towards(0, 0), 60, 5000);
    for (size_t i = 0; i < SIDE * SIDE; i++)
        label[i] = scene.cd_m2[i] > 1000;
    assert_int_equal(orl_glare_sources_smooth(&picture, 3.2, 1, label), ORL_ERR_CANCELLED);
    for (size_t i = 0; i < SIDE * SIDE; i++)
        assert_int_equal(label[i], scene.cd_m2[i] > 1000);
    assert_int_equal(orl_glare_evaluate(&picture, NULL, &smooth, &glare, &err), ORL_ERR_CANCELLED);
    assert_null(glare.sources);
    scene_done(&scene);
}

/* The threshold is five times the task's mean luminance, or another factor. */
static void test_task(void **state)
{
    const struct orl_glare_settings task = {.task = {150.5, 90.5, 0.5}};
    const struct orl_glare_settings average = {.threshold = 7};
    struct scene scene = scene_of(FISHEYE, 300, 100);
    (void)state;
    draw_disc(&scene, towards(0, -36), 20, 200);
    draw_disc(&scene, towards(0, 30), 5, 1500);
    struct orl_glare found = rate(&scene, &task);
    near(found.task_cd_m2, 200, 1e-5);
    near(found.threshold_cd_m2, 1000, 1e-5);
    assert_int_equal(found.n_sources, 1);
    orl_glare_done(&found);
    found = rate(&scene, &average);
    near(found.threshold_cd_m2, 7 * found.values[ORL_GLARE_AVERAGE].value, 1e-9);
    orl_glare_done(&found);
    scene_done(&scene);
}

/* A line of sight turned by 30 degrees to the left sees straight ahead what was 30 degrees to the
 * left. */
static void test_turned(void **state)
{
    struct orl_view view;
    struct orl_view_field field;
    (void)state;
    assert_int_equal(orl_view_parse(FISHEYE, &view, NULL), 0);
    assert_int_equal(orl_view_field_init(&field, &view, 100, 100, 30, NULL), 0);
    const struct orl_vec3 d = orl_view_field_direction_at(&field, 50 - 100 * 30 / 180.0, 50);
    near(d.z, 1, 1e-9);
    /* A picture of 180 degrees lacks a lune of 30 degrees, except for its corners. */
    assert_true(field.all_sr > 2 * ORL_PI * 150 / 180 && field.all_sr < 2 * ORL_PI * 170 / 180);
    orl_view_field_done(&field);
}

/* The line of sight towards a disc on the left is the worst of three, 45 degrees apart. A picture
 * of 180 degrees holds only its own. */
static void test_worst_of_several(void **state)
{
    static const struct {
        const char *view;
        double turned_deg;
    } cases[] = {{"-vta -vp 0 0 0 -vd 0 -1 0 -vu 0 0 1 -vh 300 -vv 300", 45}, {FISHEYE, 0}};
    const struct orl_glare_settings own = {.threshold = 0},
                                    several = {.directions = 3, .directions_deg = 90};
    enum { SIDE = 300 };
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        struct scene scene = scene_of(cases[i].view, SIDE, 200);
        struct orl_view view;
        struct orl_glare worst = {0};
        draw_disc(&scene, towards(-45, 0), 6, 20000);
        assert_int_equal(orl_view_parse(cases[i].view, &view, NULL), 0);
        const struct orl_glare_picture picture = {&view, SIDE, SIDE, scene.cd_m2, NULL, NULL};
        assert_int_equal(orl_glare_worst_direction(&picture, &several, &worst, NULL), 0);
        struct orl_glare ahead = rate(&scene, &own);
        assert_true(worst.turned_deg == cases[i].turned_deg);
        const double more = worst.values[ORL_GLARE_DGP].value - ahead.values[ORL_GLARE_DGP].value;
        assert_true(i == 0 ? more > 0.01 : more == 0);
        orl_glare_done(&ahead);
        orl_glare_done(&worst);
        scene_done(&scene);
    }
}

static void test_mask(void **state)
{
    const struct orl_glare_settings usual = {.threshold = 0};
    struct scene scene = scene_of(FISHEYE, 200, 100), mask = scene_of(FISHEYE, 200, 0);
    struct orl_glare glare;
    (void)state;
    draw_disc(&scene, towards(0, 0), 10, 400);
    draw_disc(&mask, towards(0, 0), 10, 1);
    const struct orl_luminances picture = {.field = &scene.field, .cd_m2 = scene.cd_m2};
    assert_int_equal(orl_glare_evaluate(&picture, mask.cd_m2, &usual, &glare, NULL), 0);
    near(glare.masked.mean, 400, 1e-6);
    near(glare.masked.median, 400, 1e-6);
    assert_true(glare.masked.deviation < 1e-9);
    near(glare.masked.solid_angle_sr, 2 * ORL_PI * (1 - cos(10 * ORL_DEG_TO_RAD)), 0.04);
    orl_glare_done(&glare);
    scene_done(&scene);
    scene_done(&mask);
}

/* In a cylindrical view a horizontal band is one of elevation: half a circle times twice its sine.
 */
static void test_band(void **state)
{
    static const double angles[] = {0.1, 0.5, 1};
    struct scene scene = scene_of("-vtc -vd 0 -1 0 -vh 180 -vv 150", 601, 100);
    const struct orl_luminances picture = {.field = &scene.field, .cd_m2 = scene.cd_m2};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const struct orl_glare_settings settings = {.band_rad = angles[i]};
        struct orl_glare glare;
        assert_int_equal(orl_glare_evaluate(&picture, NULL, &settings, &glare, NULL), 0);
        near(glare.band.mean, 100, 1e-6);
        /* Whole rows, equally high on the cylinder: an error of half a row at each edge. */
        const double row = 2 * tan(75 * ORL_DEG_TO_RAD) / 601;
        near(glare.band.solid_angle_sr, 2 * ORL_PI * sin(angles[i]), row / 2 / angles[i]);
        orl_glare_done(&glare);
    }
    scene_done(&scene);
}

/* ---- Connected pixels ------------------------------------------------------------------------ */

/* Groups pixels by a search over every pair: each gets the lowest group that it is connected to. */
static void group_by_all_pairs(const struct orl_view_field *field, const uint32_t *pixels, size_t n,
                               double angle, uint32_t *group)
{
    bool changed = true;
    for (uint32_t i = 0; i < n; i++)
        group[i] = i;
    while (changed) {
        changed = false;
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0; k < n; k++) {
                const struct orl_vec3 a = orl_view_field_direction(field, pixels[i]);
                const struct orl_vec3 b = orl_view_field_direction(field, pixels[k]);
                const double chord = orl_length(orl_sub(a, b));
                if (group[k] < group[i] && chord <= 2 * sin(angle / 2)) {
                    group[i] = group[k];
                    changed = true;
                }
            }
    }
}

static void test_united_as_by_all_pairs(void **state)
{
    enum { SIDE = 40, CASES = 60 };
    (void)state;
    struct scene scene = scene_of(FISHEYE, SIDE, 0);
    for (uint64_t c = 0; c < CASES; c++) {
        struct orl_random random = orl_random_stream(7, ORL_PURPOSE_PIXEL, c);
        const double density = 0.5 * pow(orl_random_uniform(&random), 3);
        const double angle = 0.04 + 0.3 * orl_random_uniform(&random);
        uint32_t pixels[SIDE * SIDE], fast[SIDE * SIDE], slow[SIDE * SIDE], groups, n = 0;
        for (uint32_t i = 0; i < SIDE * SIDE; i++)
            if (scene.field.solid_angle[i] > 0 && orl_random_uniform(&random) < density)
                pixels[n++] = i;
        assert_int_equal(orl_pixels_cluster(&scene.field, pixels, n, angle, fast, &groups), 0);
        group_by_all_pairs(&scene.field, pixels, n, angle, slow);
        for (uint32_t i = 0; i < n; i++) {
            assert_true(fast[i] < groups);
            /* The slow search names a group by its first pixel. */
            assert_int_equal(fast[i], fast[slow[i]]);
            if (slow[i] == i && i > 0) /* a first pixel: its label is new */
                for (uint32_t k = 0; k < i; k++)
                    assert_int_not_equal(fast[k], fast[i]);
        }
    }
    scene_done(&scene);
}

/* ---- Indices --------------------------------------------------------------------------------- */

/* One source of 10^4 cd/m2, 0.01 sr, P = 2; Lb = 100, Ev = 1000, Ed = 500, mean 200 cd/m2. */
static void test_indices_by_hand(void **state)
{
    const struct orl_glare_light light = {1000, 500, 200, 100};
    const struct orl_glare_source source = {
        .luminance_cd_m2 = 1e4, .solid_angle_sr = 0.01, .position_index = 2};
    double v[ORL_GLARE_METRICS] = {0};
    (void)state;
    orl_glare_indices(&light, &source, 1, v);
    /* L^2 w / P^2 = 2.5e5. */
    near(v[ORL_GLARE_UGR], 8 * log10(625), 1e-9); /* 0.25 / 100 * 2.5e5 */
    near(v[ORL_GLARE_UGP], 0.26 * log10(625), 1e-9);
    near(v[ORL_GLARE_CGI], 8 * log10(1000), 1e-9); /* 2 * 2 / 1000 * 2.5e5 */
    near(v[ORL_GLARE_DGI], 17.67331, 1e-5);        /* 10 log10(9949.01 / 170) */
    /* Q = 0.204 + 0.605124 - 0.075; DGR = 5000 * 0.734124 / (2 * 10.2911) = 178.343. */
    near(v[ORL_GLARE_VCP], 50 * erf((6.374 - 1.3227 * log(178.343)) / sqrt(2)) + 50, 1e-4);
    near(v[ORL_GLARE_DGPS], 0.2462, 1e-9);
}

static void test_no_formula_no_number(void **state)
{
    const struct orl_glare_light dark = {0, 0, 0, 0};
    const struct orl_glare_source source = {
        .luminance_cd_m2 = 1e4, .solid_angle_sr = 0.01, .position_index = 2};
    double v[ORL_GLARE_METRICS] = {0};
    (void)state;
    orl_glare_indices(&dark, &source, 1, v);
    assert_true(isnan(v[ORL_GLARE_UGR]));
    assert_true(isnan(v[ORL_GLARE_CGI]));
}

static void test_classes(void **state)
{
    const struct {
        struct orl_glare_value dgp;
        enum orl_glare_class wanted;
    } cases[] = {{{0.3, NAN, {NAN, NAN}}, ORL_GLARE_IMPERCEPTIBLE},
                 {{0.35, NAN, {NAN, NAN}}, ORL_GLARE_PERCEPTIBLE},
                 {{0.42, 0.01, {0.401, 0.449}}, ORL_GLARE_DISTURBING},
                 {{0.42, 0.01, {0.399, 0.44}}, ORL_GLARE_UNDECIDED},
                 {{0.9, 0.01, {0.85, 0.95}}, ORL_GLARE_INTOLERABLE}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(orl_glare_class_of(&cases[i].dgp), cases[i].wanted);
}

static void test_settings_out_of_range(void **state)
{
    const struct orl_glare_settings bad[] = {{.threshold = -1},   {.radius_rad = 4},
                                             {.peak_cd_m2 = NAN}, {.age_years = 200},
                                             {.eye_lx = -1},      {.task = {0, 0, 7}}};
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(orl_glare_settings_check(&bad[i], NULL), ORL_ERR_RANGE);
}

/*
 * A sun of half a degree in a picture of half a degree a pixel, its light shared by four pixels of
 * which one is brighter. DGP by the brightest pixel is that of the light on a smaller angle; a
 * picture whose pixels are alike, and one whose source is wide, are not blurred.
 */
static void test_blurred_sun(void **state)
{
    static const struct orl_glare_settings settings = {.directions = 0};
    struct scene scene = scene_of(FISHEYE, 360, 500);
    const size_t middle = (size_t)120 * 360 + 100;
    const size_t pixels[4] = {middle, middle + 1, middle + 360, middle + 361};
    uint32_t width = 0;
    (void)state;
    for (int i = 0; i < 4; i++)
        scene.cd_m2[pixels[i]] = i == 0 ? 4e7F : 1e7F;
    struct orl_glare glare = rate(&scene, &settings);
    const struct orl_glare_source *source = &glare.sources[0];
    const double eye_lx = glare.values[ORL_GLARE_ILLUMINANCE].value;
    assert_int_equal(glare.blurred_pixels, 4);
    /* The term of the source grows by the ratio of luminances. */
    const double term = pow(source->luminance_cd_m2, 2) * source->solid_angle_sr /
                        pow(source->position_index, 2) / pow(eye_lx, 1.87);
    const double times = source->most_cd_m2 / source->luminance_cd_m2;
    near(glare.sharper_dgp - glare.values[ORL_GLARE_DGP].value,
         9.2e-2 * log10((1 + times * term) / (1 + term)), 1e-6);
    assert_true(orl_glare_is_blurred(&glare, 360, &width));
    assert_int_equal(width, 1800); /* a hundred pixels for four: five times as wide */
    orl_glare_done(&glare);
    for (int i = 0; i < 4; i++)
        scene.cd_m2[pixels[i]] = 2e7F;
    glare = rate(&scene, &settings);
    assert_int_equal(glare.blurred_pixels, 0);
    near(glare.sharper_dgp, glare.values[ORL_GLARE_DGP].value, 1e-12);
    assert_false(orl_glare_is_blurred(&glare, 360, &width));
    orl_glare_done(&glare);
    draw_disc(&scene, towards(-20, 10), 8, 2e6);
    for (int i = 0; i < 4; i++)
        scene.cd_m2[pixels[i]] = 500;
    glare = rate(&scene, &settings);
    assert_int_equal(glare.blurred_pixels, 0);
    orl_glare_done(&glare);
    scene_done(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_uniform_view),
        cmocka_unit_test(test_perspective_field),
        cmocka_unit_test(test_parallel_views_have_no_eye),
        cmocka_unit_test(test_position_indices),
        cmocka_unit_test(test_discs),
        cmocka_unit_test(test_peaks_are_taken_apart),
        cmocka_unit_test(test_search_radius),
        cmocka_unit_test(test_smoothing),
        cmocka_unit_test(test_cancelled),
        cmocka_unit_test(test_task),
        cmocka_unit_test(test_turned),
        cmocka_unit_test(test_worst_of_several),
        cmocka_unit_test(test_mask),
        cmocka_unit_test(test_band),
        cmocka_unit_test(test_united_as_by_all_pairs),
        cmocka_unit_test(test_indices_by_hand),
        cmocka_unit_test(test_no_formula_no_number),
        cmocka_unit_test(test_classes),
        cmocka_unit_test(test_blurred_sun),
        cmocka_unit_test(test_settings_out_of_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
