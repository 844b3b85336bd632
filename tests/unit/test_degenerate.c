/*
 * Degenerate input: films that are empty, of NaN, of the largest and smallest values, of one pixel
 * or one row; sensors on a line, on one spot, alone, at NaN. Every picture and index made of them
 * is complete and finite, or refused; sanitizers find no overflow.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <float.h>
#include <oriel/job/picture.h>

#include "metrics/glare.h"
#include "render/film/image_files.h"
#include "render/heat_map/heat_map.h"
#include "render/picture/false_color.h"
#include "support/scene_text.h"
#include "support/scratch.h"

/* ---- Films ----------------------------------------------------------------------------------- */

/* The values of all pixels; two values alternate. */
static const struct content {
    float a, b;
} contents[] = {{0, 0},
                {1, 1},
                {0, 1},
                {NAN, NAN},
                {NAN, 1},
                {INFINITY, 1},
                {-INFINITY, 1},
                {-1, 1},
                {FLT_MAX, FLT_MAX},
                {FLT_MAX, 0},
                {FLT_MIN / 4, FLT_MIN / 4},
                {FLT_MIN / 4, FLT_MAX}};
static const uint32_t sizes[][2] = {{1, 1}, {1, 300}, {300, 1}, {2, 2}, {40, 3}};
static const char *const views[] = {"-vta -vh 180 -vv 180", "-vtv -vh 120 -vv 0.01",
                                    "-vth -vh 180 -vv 180", "-vta -vh 360 -vv 360"};
enum {
    CONTENTS = sizeof contents / sizeof contents[0],
    SIZES = sizeof sizes / sizeof sizes[0],
    VIEWS = sizeof views / sizeof views[0]
};

static struct orl_film film_of(const struct content *content, const uint32_t size[2])
{
    struct orl_film film;
    assert_int_equal(orl_film_init(&film, size[0], size[1], NULL), 0);
    for (uint32_t i = 0; i < size[0] * size[1]; i++) {
        for (int c = 0; c < 3; c++)
            film.pixels[i][c] = i % 2 ? content->b : content->a;
        film.errors[i] = i % 2 ? content->b : content->a;
    }
    return film;
}

static void show(const struct orl_film *film, const struct orl_view *view)
{
    const struct orl_display displays[] = {
        {.tone = ORL_TONE_HUMAN},
        {.tone = ORL_TONE_HUMAN, .veil = true, .acuity = true, .color_loss = true},
        {.tone = ORL_TONE_LINEAR},
        {.tone = ORL_TONE_EXPOSURE, .exposure = 1e9}};
    unsigned char *bytes = malloc(3 * (size_t)film->width * film->height);
    for (size_t i = 0; i < sizeof displays / sizeof *displays; i++) {
        struct orl_tonemapped tonemapped;
        assert_int_equal(orl_tonemapped_init(&tonemapped, film, view, &displays[i]), 0);
        orl_tonemapped_bytes(&tonemapped, bytes);
        assert_int_equal(orl_tonemapped_write_png(&tonemapped, 16, scratch_path("a.png"), NULL), 0);
        for (uint32_t y = 0; y < film->height; y++)
            for (uint32_t x = 0; x < film->width; x++) {
                float rgb[3];
                orl_tonemapped_pixel(&tonemapped, x, y, rgb);
                for (int c = 0; c < 3; c++)
                    assert_true(rgb[c] >= 0 && rgb[c] <= 1.0001F);
            }
        orl_tonemapped_done(&tonemapped);
    }
    free(bytes);
}

static void color(const struct orl_film *film, const struct orl_view *view)
{
    struct orl_picture_point point = {.name = "p"};
    for (int i = 0; i < 6; i++) {
        const struct orl_false_color how = {.asked = true,
                                            .decades = i % 3 == 1   ? 3
                                                       : i % 3 == 2 ? 12
                                                                    : 0,
                                            .divisions = i % 2 ? 64 : 0,
                                            .scale = i >= 3 ? 1000 : 0,
                                            .isolines = true,
                                            .extrema = true,
                                            .points = &point,
                                            .n_points = 1};
        const struct orl_display display = {.tone = ORL_TONE_HUMAN};
        struct orl_scale scale;
        struct orl_tonemapped tonemapped;
        assert_int_equal(orl_scale_make(&scale, film, &how, false), 0);
        assert_true(isfinite(scale.top) && scale.top > 0);
        assert_int_equal(orl_tonemapped_init(&tonemapped, film, view, &display), 0);
        for (int k = ORL_PICTURE_FALSE; k <= ORL_PICTURE_BANDS; k++)
            assert_int_equal(orl_false_color_write(film, &tonemapped, &scale, &how,
                                                   (enum orl_picture)k, scratch_path("f.png"),
                                                   NULL),
                             0);
        orl_tonemapped_done(&tonemapped);
    }
}

/* Checks that glare indices are finite, or refused. */
static void rate(const struct orl_film *film, const struct orl_view *view)
{
    static const struct orl_glare_settings settings[] = {
        {.threshold = 0},
        {.threshold = 1e-6},
        {.smooth = true, .radius_rad = 3},
        {.radius_rad = 1e-6, .peak_cd_m2 = 1e-9},
        {.task = {1, 0, 6}, .directions = 5, .directions_deg = 360}};
    float *cd_m2 = orl_film_luminances(film);
    const struct orl_glare_picture glare_picture = {view,  film->width, film->height,
                                                    cd_m2, cd_m2,       NULL};
    for (size_t i = 0; i < sizeof settings / sizeof *settings; i++) {
        struct orl_glare glare = {.threshold_cd_m2 = 0};
        struct orl_error err;
        assert_int_equal(orl_glare_settings_check(&settings[i], NULL), 0);
        const int code = orl_glare_worst_direction(&glare_picture, &settings[i], &glare, &err);
        assert_true(code == 0 || code == ORL_ERR_RANGE);
        if (code == 0) {
            const double dgp = glare.values[ORL_GLARE_DGP].value;
            assert_true(dgp >= 0 && dgp <= 1);
            for (int m = 0; m < ORL_GLARE_METRICS; m++)
                assert_true(!isinf(glare.values[m].value));
        }
        orl_glare_done(&glare);
    }
    free(cd_m2);
}

static void write_files(struct orl_film *film, const struct orl_view *view)
{
    assert_int_equal(orl_film_write_hdr(film, view, scratch_path("a.hdr"), NULL), 0);
    assert_int_equal(orl_exr_write(film, view, true, scratch_path("a.exr"), NULL), 0);
    assert_int_equal(orl_exr_write(film, view, false, scratch_path("a.exr"), NULL), 0);
    assert_int_equal(orl_film_smooth_errors(film), 0);
    assert_int_equal(orl_film_write_error_png(film, scratch_path("e.png"), NULL), 0);
    assert_int_equal(orl_film_write_error_hdr(film, view, scratch_path("e.hdr"), NULL), 0);
}

static void test_films(void **state)
{
    (void)state;
    for (size_t i = 0; i < CONTENTS; i++)
        for (size_t k = 0; k < SIZES; k++) {
            struct orl_view view;
            struct orl_film film = film_of(&contents[i], sizes[k]);
            assert_int_equal(orl_view_parse(views[(i + k) % VIEWS], &view, NULL), 0);
            show(&film, &view);
            color(&film, &view);
            for (size_t v = 0; v < VIEWS; v++) {
                assert_int_equal(orl_view_parse(views[v], &view, NULL), 0);
                rate(&film, &view);
            }
            write_files(&film, &view);
            orl_film_done(&film);
        }
}

/* Places outside the picture; a search radius too small for any neighbour. */
static void test_settings(void **state)
{
    static const uint32_t size[2] = {8, 4};
    static const struct content bright = {100, 100};
    const struct orl_glare_settings outside[] = {{.task = {9, 1, 0.5}}, {.task = {1, 5, 0.5}}};
    const struct orl_glare_settings narrow = {.radius_rad = 1e-9};
    struct orl_film film = film_of(&bright, size);
    float *cd_m2 = orl_film_luminances(&film);
    struct orl_view view;
    struct orl_error err;
    (void)state;
    assert_int_equal(orl_view_parse(views[0], &view, NULL), 0);
    const struct orl_glare_picture glare_picture = {&view, 8, 4, cd_m2, NULL, NULL};
    for (int i = 0; i < 2; i++) {
        struct orl_glare glare;
        assert_int_equal(orl_glare_worst_direction(&glare_picture, &outside[i], &glare, &err),
                         ORL_ERR_RANGE);
        assert_non_null(strstr(err.message, "task"));
    }
    assert_int_equal(orl_glare_settings_check(&narrow, &err), ORL_ERR_RANGE);
    free(cd_m2);
    orl_film_done(&film);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

enum { SENSORS = 6 };

static struct orl_vec3 place_of(int kind, int i)
{
    switch (kind) {
    case 0: /* all on one spot */
        return orl_v3(1, 1, 1);
    case 1: /* on a line */
        return orl_v3(0.3 * i, 1, 1);
    case 2: /* on a sloping line, very close together */
        return orl_v3(1e-7 * i, 1e-7 * i, 1);
    case 3: /* far away */
        return orl_v3(1e12 * (i % 2), 1e12 * (i % 3), 0);
    case 4: /* a grid except for one point, very far from square */
        return orl_v3(1e-3 * (i % 2), 100.0 * (i % 3), 1);
    default: /* two spots */
        return orl_v3(i % 2, 0, 0);
    }
}

static void test_sensors(void **state)
{
    static const double values[] = {0, 1e300, 1e-300, NAN, INFINITY, 500};
    struct orl_geometry *geometry = scene_geometry(
        "void plastic w 0 0 5 .5 .5 .5 0 0\nw polygon f 0 0 12 0 0 0 2 0 0 2 2 0 0 2 0\n"
        "w polygon g 0 0 12 0 0 0 2 0 0 2 0 2 0 0 2\n");
    (void)state;
    for (int kind = 0; kind < 6; kind++)
        for (size_t value = 0; value < 6; value++)
            for (int n = 0; n <= SENSORS; n++) {
                struct orl_sensor sensors[SENSORS];
                struct orl_sensor_plane planes[2];
                double lux[SENSORS], intervals[SENSORS][2];
                size_t count;
                const struct orl_heat_map_request how = {
                    .asked = true,
                    .colors = {.decades = n % 2 ? 2 : 0, .scale = kind % 2 ? 1000 : 0},
                    .thresholds_lx = {300, 1e-6, 1e9},
                    .n_thresholds = 3};
                for (int i = 0; i < SENSORS; i++) {
                    sensors[i] = (struct orl_sensor){place_of(kind, i), orl_v3(0, 0, 1)};
                    lux[i] = values[value];
                    intervals[i][0] = values[value] / 2;
                    intervals[i][1] = i % 2 ? values[value] * 2 : NAN;
                }
                assert_int_equal(orl_sensor_planes_find(sensors, (size_t)n, 2, planes, &count), 0);
                assert_true(count == 0 || n >= ORL_LEAST_IN_PLANE);
                for (size_t p = 0; p < count; p++) {
                    const struct orl_heat_map map = {.geometry = geometry,
                                                     .plane = &planes[p],
                                                     .quantity = "illuminance",
                                                     .unit = "lx",
                                                     .values = lux,
                                                     .intervals = (const double(*)[2])intervals,
                                                     .how = &how};
                    assert_int_equal(
                        orl_heat_map_write(&map, ORL_CANVAS_SVG, scratch_path("m.svg"), NULL), 0);
                    assert_int_equal(
                        orl_heat_map_write(&map, ORL_CANVAS_PNG, scratch_path("m.png"), NULL), 0);
                }
                orl_sensor_planes_done(planes, count);
            }
    orl_geometry_free(geometry);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_films),
                                       cmocka_unit_test(test_settings),
                                       cmocka_unit_test(test_sensors)};
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
