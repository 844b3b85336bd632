/*
 * Patterns of pictures and data files: values against rtrace's at 1 000 rays, PNG and OpenEXR,
 * errors in files, cache keys, and lamps with a picture as their pattern.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/image_files.h"
#include "scene/built/scene.h"
#include "scene/grid/grid.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"
#include "support/scratch.h"

/* ---- Files ------------------------------------------------------------------------------------
 */

enum { WIDE = 7, HIGH = 5, MOST = 512 };

/* Returns a flat picture of some colours, with an exposure that patterns ignore. */
static struct orl_file picture(void)
{
    static char bytes[MOST];
    const int head = snprintf(bytes, sizeof bytes,
                              "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nPIXASPECT=0.8\nEXPOSURE=3\n\n"
                              "-Y %d +X %d\n",
                              HIGH, WIDE);
    unsigned char *at = (unsigned char *)bytes + head;
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++) {
            *at++ = (unsigned char)((x * 37 + y * 11) % 128 + 128);
            *at++ = (unsigned char)((x * 53 + y * 91) % 256);
            *at++ = (unsigned char)((x * 29 + y * 67) % 256);
            *at++ = (unsigned char)(126 + (x + y) % 4);
        }
    return (struct orl_file){bytes, (size_t)(at - (unsigned char *)bytes), NULL};
}

/* Returns a data file of periodic numbers: (i step mod cycle) / divisor + more. */
static struct orl_file data(char text[MOST], const char *head, int n, int step, int cycle,
                            double divisor, double more)
{
    int length = snprintf(text, MOST, "%s\n", head);
    for (int i = 0; i < n; i++)
        length += snprintf(text + length, (size_t)(MOST - length), "%g ",
                           i * step % cycle / divisor + more);
    return (struct orl_file){text, (size_t)length, NULL};
}

static int parse(const char *text, const struct orl_file *first, struct orl_parsed_scene *ret,
                 struct orl_error *err)
{
    static const char *const names[] = {"a.rad", "x",     "p.hdr", "a.dat", "r.dat",
                                        "g.dat", "b.dat", "d.dat", "f.cal"};
    static const char function[] =
        "u = (Px-.3)/2; v = (Py+.2)/3; tint(r,g,b) = max((r+2*g+b)/4, 0); half(x) = max(x/2, 0);\n"
        "angle = acos(-Dz)/DEGREE; dim(x) = max(x, 0)*(1+Rdot);\n";
    char a[MOST], r[MOST], g[MOST], b[MOST], d[MOST];
    static const char colours[] = "1\n2 -1 6";
    const struct orl_file contents[] = {
        {text, strlen(text), NULL},
        first ? *first : (struct orl_file){"", 0, NULL},
        picture(),
        data(a, "# two axes\n2\n-1 3 5\n0 0 4  0 .5 2 2.5", 20, 7, 11, 10, .1),
        data(r, colours, 6, 3, 7, 7, .05),
        data(g, colours, 6, 5, 7, 7, .05),
        data(b, colours, 6, 9, 7, 7, .05),
        data(d, "2\n0 180 5\n0 0 3 0 1 4", 15, 5, 13, 10, .1),
        {function, sizeof function - 1, NULL}};
    struct orl_memory_files memory = {names, contents, sizeof names / sizeof *names};
    const struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse(names, 1, &files, ret, err);
}

static struct orl_scene *load(const char *text, const struct orl_file *first)
{
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    struct orl_scene *scene = NULL;
    if (parse(text, first, &parsed_scene, &err) < 0 ||
        orl_scene_new(&parsed_scene, &scene, &err) < 0)
        fail_msg("%s:%d %s: %s", err.file, err.line, err.primitive, err.message);
    return scene;
}

/* ---- Comparison with rtrace ------------------------------------------------------------------ */

#define RED "void plastic red 0 0 5 .5 .1 .1 0 0\nred sphere r 0 0 4 0 0 0 1\n"
#define FLOOR "floor polygon q 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"

/* Returns the radiance that a ray sees of the floor: emitted, or transmitted of radiance 1. */
static struct orl_rgb seen(const struct orl_scene *scene, struct orl_vec3 origin,
                           struct orl_vec3 direction)
{
    struct orl_hit hit;
    const struct orl_vec3 back = orl_neg(direction);
    assert_true(orl_geometry_intersect(scene->geometry, orl_sub(origin, scene->geometry->center),
                                       direction, 100, &hit));
    const struct orl_material *const m = orl_scene_material(scene, hit.facet);
    return m->kind == ORL_MATERIAL_GLASS || m->kind == ORL_MATERIAL_MIXTURE
               ? orl_material_straight(m, &hit, back)
               : orl_material_emission(m, &hit, back);
}

/*
 * Sums, sums by cos(i) and sums of squares of red, green and blue over these rays, by rtrace (-fad
 * -ov -ab 0, version 6.1a) for the same scenes and files.
 */
static void test_rtrace(void **state)
{
    static const struct {
        const char *scene;
        double sums[9];
    } cases[] = {{"void brightdata w 5 noneg a.dat f.cal v u 0 0\n"
                  "w colorpict p 11 tint half blue p.hdr f.cal u v -t .1 0 0 0 0\n"
                  "p glow floor 0 0 4 1 2 3 0\n" FLOOR,
                  {301.764303, 287.036285, 706.567317, 0.499364127, 4.30930886, -20.9594604,
                   160.281801, 162.318451, 929.696067}},
                 {"void colordata c 8 half tint noneg r.dat g.dat b.dat f.cal u 0 0\n"
                  "c glow floor 0 0 4 1 2 3 0\n" FLOOR,
                  {275.725136, 1023.19406, 1658.67912, 0.676826168, 2.47967084, 4.04380525,
                   84.8991974, 1085.63296, 3187.55679}},
                 {"void brightdata w 5 dim d.dat f.cal angle Px+Py 0 0\n"
                  "w light floor 0 0 3 2 1 .5\n" FLOOR,
                  {4440.21767, 2220.10883, 1110.05442, 52.340537, 26.1702685, 13.0851342, 20804.393,
                   5201.09825, 1300.27456}},
                 {"void brightdata w 5 noneg a.dat f.cal v u 0 0\nvoid glow a 0 0 4 1 2 3 0\n"
                  "w glow b 0 0 4 3 1 .5 0\nvoid mixpict m 7 a b grey p.hdr f.cal u v 0 0\n"
                  "void alias floor m\n" FLOOR,
                  {1447.37541, 1237.14807, 1524.20155, -0.409999005, 0.69696379, 1.34883733,
                   2258.19219, 1777.28185, 3184.40925}},
                 {"void glow a 0 0 4 1 2 3 0\nvoid glow b 0 0 4 3 1 .5 0\n"
                  "void mixfunc m 6 a b u*v f.cal -rz 20 0 0\n"
                  "void mixdata floor 6 m a noneg r.dat f.cal u*3 0 0\n" FLOOR,
                  {1266.75439, 1866.6228, 2666.55701, 3.63507585, 0.621479999, -0.397516385,
                   1789.1607, 3530.40419, 7398.79816}},
                 {"void glass a 0 0 3 .8 .7 .9\nvoid trans b 0 0 7 .6 .5 .9 0 0 .7 .6\n"
                  "void mixfunc n 4 a void u*v f.cal 0 0\n"
                  "void mixfunc floor 6 n b Px/5 f.cal -rz 20 0 0\n" FLOOR,
                  {541.244394, 488.712437, 635.083266, 0.835286294, 1.19470603, 0.632179588,
                   302.36616, 246.323092, 411.830879}},
                 {"void colorpict p 7 clip_r clip_g clip_b p.hdr f.cal u v 0 0\n"
                  "p glass floor 0 0 3 .8 .7 .9\n" FLOOR,
                  {401.484208, 260.601963, 291.203694, -0.943380356, 1.7264356, -9.21947829,
                   222.726046, 115.801343, 145.777546}}};
    static const double step[] = {0.7548776662466927, 0.5698402909980532, 0.8191725133961645,
                                  0.6710436067037893};
    (void)state;
    for (size_t s = 0; s < sizeof cases / sizeof *cases; s++) {
        struct orl_scene *const scene = load(cases[s].scene, NULL);
        double sums[9] = {0};
        for (int i = 0; i < 1000; i++) {
            double a[4];
            for (int k = 0; k < 4; k++)
                a[k] = fmod(i * step[k], 1);
            const struct orl_vec3 way = {(a[2] - .5) * 1.4, (a[3] - .5) * 1.4, -1};
            const struct orl_vec3 at = {.05 + 3.9 * a[0], .05 + 3.9 * a[1], 0};
            const struct orl_rgb value = seen(scene, orl_sub(at, way), orl_normalize(way));
            const double channels[] = {value.r, value.g, value.b};
            for (int c = 0; c < 3; c++) {
                sums[c] += channels[c];
                sums[3 + c] += channels[c] * cos(i);
                sums[6 + c] += channels[c] * channels[c];
            }
        }
        for (int k = 0; k < 9; k++)
            if (!(fabs(sums[k] - cases[s].sums[k]) < 2e-6 * (10 + fabs(cases[s].sums[k]))))
                fail_msg("scene %zu, sum %d: %.9g, not %.9g", s, k, sums[k], cases[s].sums[k]);
        orl_scene_release(scene);
    }
}

/* ---- Other pictures ---------------------------------------------------------------------------
 */

static void check_corners(const struct orl_grid *grid, const float expected[2][3])
{
    double low[ORL_GRID_CHANNELS], high[ORL_GRID_CHANNELS];
    orl_grid_at(grid, (const double[]){0, 0}, low); /* bottom left */
    orl_grid_at(grid, (const double[]){grid->axes[0].size, grid->axes[1].size}, high);
    for (int c = 0; c < 3; c++) {
        if (!(fabs(low[c] - (double)expected[0][c]) < 2e-5 &&
              fabs(high[c] - (double)expected[1][c]) < 2e-5))
            fail_msg("channel %d: %.9g and %.9g, not %.9g and %.9g", c, low[c], high[c],
                     (double)expected[0][c], (double)expected[1][c]);
    }
}

/* sRGB's 188 is linear 0.50289; of 3 x 2 pixels the height is 1, the width 1.5. */
static void test_png(void **state)
{
    static const unsigned char pixels[2 * 3 * 3] = {[6] = 255, [7] = 188, [9] = 188, [11] = 255};
    static const float expected[2][3] = {{.50289F, 0, 1}, {1, .50289F, 0}};
    png_image image = {.version = PNG_IMAGE_VERSION, .width = 3, .height = 2};
    png_alloc_size_t size = 4096;
    unsigned char bytes[4096];
    struct orl_grid *grid = NULL;
    struct orl_error err = {0};
    (void)state;
    image.format = PNG_FORMAT_RGB;
    assert_true(png_image_write_to_memory(&image, bytes, &size, 0, pixels, 0, NULL));
    assert_int_equal(orl_grid_read_picture("a.png", bytes, size, &grid, &err), 0);
    check_corners(grid, expected);
    orl_grid_free(grid);
    assert_int_equal(orl_grid_read_picture("a.png", bytes, size / 2, &grid, &err), ORL_ERR_SYNTAX);
    assert_string_equal(err.file, "a.png");
}

static void test_exr(void **state)
{
    static const float expected[2][3] = {{0.25F, 3, -2}, {1, 0.5F, 40000}};
    struct orl_view view;
    struct orl_film film;
    struct orl_grid *grid = NULL;
    struct orl_error err = {0};
    unsigned char bytes[8192];
    (void)state;
    assert_int_equal(orl_view_parse("-vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1", &view, &err), 0);
    assert_int_equal(orl_film_init(&film, 3, 2, &err), 0);
    memcpy(film.pixels[3], expected[0], sizeof expected[0]);
    memcpy(film.pixels[2], expected[1], sizeof expected[1]);
    for (int halves = 0; halves < 2; halves++) {
        assert_int_equal(orl_exr_write(&film, &view, halves, scratch_path("a.exr"), &err), 0);
        FILE *const file = fopen(scratch_path("a.exr"), "rb");
        assert_non_null(file);
        const size_t size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
        if (orl_grid_read_picture("a.exr", bytes, size, &grid, &err) < 0)
            fail_msg("%s", err.message);
        check_corners(grid, expected);
        orl_grid_free(grid);
        assert_int_equal(orl_grid_read_picture("a.exr", bytes, size - 40, &grid, &err),
                         ORL_ERR_SYNTAX);
    }
    orl_film_done(&film);
}

/* ---- Errors ---------------------------------------------------------------------------------- */

static void check_refused(const char *file, int code, const char *words, int line)
{
    static const char text[] = "void brightdata w 5 noop x f.cal u v 0 0\n"
                               "w plastic floor 0 0 5 .5 .5 .5 0 0\n" FLOOR;
    const struct orl_file x = {file, strlen(file), NULL};
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    assert_int_equal(parse(text, &x, &d, &err), code);
    if (!strstr(err.message, words))
        fail_msg("'%s' is not in '%s'", words, err.message);
    assert_string_equal(err.file, line > 0 ? "x" : "a.rad");
    assert_int_equal(err.line, line > 0 ? line : 1);
    assert_string_equal(err.primitive, "brightdata w");
}

static void test_errors(void **state)
{
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    check_refused("0 1", ORL_ERR_SYNTAX, "number of its axes", 1);
    check_refused("6 1", ORL_ERR_SYNTAX, "number of its axes", 1);
    check_refused("1\n0 1 1\n1", ORL_ERR_SYNTAX, "at least 2", 2);
    check_refused("1\n0 1 2\n1\n\n", ORL_ERR_SYNTAX, "ends before", 5);
    check_refused("1\n0 1 2\n1\nx", ORL_ERR_SYNTAX, "is not a number", 4);
    check_refused("1\n0 0 3\n0 2 1 1 2 3", ORL_ERR_SYNTAX, "not in order", 3);
    check_refused("1\n0 1 2000000000\n1", ORL_ERR_SYNTAX, "more points", 2);
    check_refused("3 0 1 2 0 1 2 0 1 2\n1 2 3 4 5 6 7 8", ORL_ERR_SYNTAX, "3 coordinates", 0);
    assert_int_equal(parse("void colorpict p 7 red green blue none.hdr . Px Py 0 0\n"
                           "p plastic floor 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                           NULL, &d, &err),
                     ORL_ERR_NOT_FOUND);
    assert_non_null(strstr(err.message, "none.hdr"));
    assert_string_equal(err.primitive, "colorpict p");
    assert_int_equal(parse("void colorpict p 7 red green blue a.dat . Px Py 0 0\n"
                           "p plastic floor 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                           NULL, &d, &err),
                     ORL_ERR_UNSUPPORTED);
    assert_string_equal(err.file, "a.dat");
    assert_int_equal(parse("void brightdata w 5 dim d.dat f.cal angle Px 0 0\n"
                           "w plastic floor 0 0 5 .5 .5 .5 0 0\n" FLOOR,
                           NULL, &d, &err),
                     ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "direction"));
}

/* Mixtures of unlike or too many components are refused. */
static void test_mixtures(void **state)
{
    static const struct {
        const char *second, *words;
    } cases[] = {{"void light b 0 0 3 .2 .2 .2", "of unlike materials"},
                 {"void dielectric b 0 0 5 .2 .2 .2 1.5 0", "of unlike materials"},
                 {"void brightfunc b 2 Px . 0 0", "'b' is not a material"}};
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    char text[8192];
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        snprintf(text, sizeof text,
                 "void plastic a 0 0 5 .5 .5 .5 0 0\n%s\nvoid mixfunc floor 4 a b Px . 0 0\n" FLOOR,
                 cases[i].second);
        assert_int_equal(parse(text, NULL, &d, &err), ORL_ERR_UNSUPPORTED);
        assert_int_equal(err.line, 3);
        assert_non_null(strstr(err.message, cases[i].words));
    }
    int length = snprintf(text, sizeof text, "void plastic m0 0 0 5 .5 .5 .5 0 0\n");
    for (int i = 0; i < 7; i++) /* each doubles the size */
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "void mixfunc m%d 4 m%d m%d Px . 0 0\n", i + 1, i, i);
    assert_int_equal(parse(text, NULL, &d, &err), ORL_ERR_LIMIT);
    assert_int_equal(err.line, 8);
}

/* In arrays a mixture is read repeatedly, and stored once. */
static void test_mixture_twice(void **state)
{
    static const char text[] = "void plastic a 0 0 5 .8 .4 .2 .05 0\n"
                               "void plastic b 0 0 5 0 .4 .6 .05 0\n"
                               "void mixfunc floor 4 a b if(Px-2,1,.25) . 0 0\n" FLOOR
                               "void mixfunc floor 4 a b if(Px-2,1,.25) . 0 0\n";
    struct orl_scene *const scene = load(text, NULL);
    const struct orl_material *const m = orl_scene_material(scene, 0);
    const struct orl_hit hit = {.point = orl_sub(orl_v3(1, 1, 0), scene->geometry->center),
                                .normal = {0, 0, 1},
                                .front = true};
    (void)state;
    assert_int_equal(scene->parsed_scene.n_patterns, 1);
    assert_int_equal(scene->parsed_scene.n_materials, 3);
    const struct orl_rgb diffuse = orl_material_diffuse(m, &hit);
    assert_true(fabs(diffuse.r - .95 * .2) < 1e-6 && fabs(diffuse.g - .95 * .4) < 1e-6 &&
                fabs(diffuse.b - .95 * .5) < 1e-6);
    orl_scene_release(scene);
}

/* Every byte of a data file changes the map key; a file that two patterns use counts once. */
static void test_keys(void **state)
{
    static const char text[] =
        "void brightdata w 4 noop x f.cal u 0 0\n"
        "w plastic floor 0 0 5 .5 .5 .5 0 0\n" FLOOR "void brightdata z 4 half x f.cal v 0 0\n"
        "w plastic other 0 0 5 .5 .5 .4 0 0\n";
    static const char *const contents[] = {"1 0 1 2 .5 .6", "1 0 1 2 .5 .7", "1 0 1 2 .5 .6 "};
    struct orl_parsed_scene d[3] = {{0}};
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 3; i++) {
        const struct orl_file x = {contents[i], strlen(contents[i]), NULL};
        assert_int_equal(parse(text, &x, &d[i], &err), 0);
    }
    assert_int_equal(d[0].n_patterns, 2);
    assert_int_equal(d[0].n_grids, 1);
    assert_true(memcmp(d[0].digest, d[1].digest, sizeof d[0].digest) != 0);
    assert_true(memcmp(d[0].digest, d[2].digest, sizeof d[0].digest) != 0);
    for (int i = 0; i < 3; i++)
        orl_parsed_scene_done(&d[i]);
}

/* ---- Jobs -------------------------------------------------------------------------------------
 */

#define ROOM                                                                                       \
    "void plastic wall 0 0 5 .6 .6 .6 0 0\n"                                                       \
    "wall polygon a 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\nwall polygon b 0 0 12 4 0 0 4 0 3 4 4 3 4 4 "  \
    "0\nwall polygon c 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3\nwall polygon d 0 0 12 0 0 0 0 0 3 4 0 3 4 " \
    "0 0\nwall polygon e 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"                                         \
    "wall polygon f 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3\n"

enum { SENSORS = 3 };

/*
 * A lamp of two halves, one four times as bright, and both brighter straight down. A pattern of
 * data equals two lamps with functions of the direction; by photons, by next-event estimation, and
 * by random ray hits.
 */
static void test_lamps(void **state)
{
    static const struct orl_sensor sensors[SENSORS] = {
        {{1, 2, .01}, {0, 0, 1}}, {{3, 2, .01}, {0, 0, 1}}, {{2, 2, 1}, {0, 0, -1}}};
    static const char one[] =
        ROOM "void brightdata b 5 noop f.dat . Px -Dz*-Dz 0 0\nb light lamp 0 0 3 5 5 5\n"
             "lamp polygon l 0 0 12 1 1 2.8 1 3 2.8 3 3 2.8 3 1 2.8\n";
    static const char two[] =
        ROOM "void brightfunc d 2 (Dz*Dz) . 0 0\nd light dim 0 0 3 5 5 5\nd light bright 0 0 3 20 "
             "20 20\ndim polygon l 0 0 12 1 1 2.8 1 3 2.8 2 3 2.8 2 1 2.8\n"
             "bright polygon m 0 0 12 2 1 2.8 2 3 2.8 3 3 2.8 3 1 2.8\n";
    static const char table[] = "2\n0 0 4 0 1.9999999 2 4\n0 1 2\n0 1 0 1 0 4 0 4\n";
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    (void)state;
    for (size_t t = 0; t < sizeof techniques / sizeof *techniques; t++) {
        double lx[2][SENSORS], again[SENSORS];
        struct scene_run job = {.scene = one,
                                .resource_name = "f.dat",
                                .resource_text = table,
                                .sensors = sensors,
                                .n_sensors = SENSORS,
                                .technique = techniques[t],
                                .overrides = scene_wish_maps,
                                .samples = 4096,
                                .threads = 1};
        scene_run_lx(&job, lx[0]);
        job.threads = 2;
        scene_run_lx(&job, again);
        assert_memory_equal(lx[0], again, sizeof again);
        job.scene = two;
        scene_run_lx(&job, lx[1]);
        for (int i = 0; i < SENSORS; i++)
            if (!(fabs(lx[0][i] / lx[1][i] - 1) < .05))
                fail_msg("technique %zu, sensor %d: %g lx, and %g", t, i, lx[0][i], lx[1][i]);
        assert_true(lx[0][1] > 1.3 * lx[0][0]);
    }
}

/*
 * Skies of functions and of pictures. A radiance of the sine of the altitude gives the ground 2 pi
 * / 3; a picture of 1, 0.5 and 0.25 scales its channels by these.
 */
static void test_skies(void **state)
{
    static const struct orl_sensor sensors[] = {{{0, 0, 1}, {0, 0, 1}}, {{0, 0, 1}, {0, 0, -1}}};
    static const char scene[] =
        "void brightfunc f 2 noneg(Dz) . 0 0\nf colorpict p 7 red green blue f.hdr . .5 .5 0 0\n"
        "p glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 180\n"
        "void plastic dark 0 0 5 0 0 0 0 0\n"
        "dark polygon q 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n";
    /* 127.5 / 128 and so on, two pixels twice; no byte of the text is 0. */
    static const char hdr[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n"
                              "\x7f\x3f\x1f\x81\x7f\x3f\x1f\x81\x7f\x3f\x1f\x81\x7f\x3f\x1f\x81";
    static const enum orl_technique techniques[] = {ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER};
    (void)state;
    const double left = (.265074126 * 127.5 + .670114631 * 63.5 + .064811243 * 31.5) / 128;
    for (size_t t = 0; t < sizeof techniques / sizeof *techniques; t++) {
        double lx[2];
        scene_run_lx(&(struct scene_run){.scene = scene,
                                         .resource_name = "f.hdr",
                                         .resource_text = hdr,
                                         .sensors = sensors,
                                         .n_sensors = 2,
                                         .technique = techniques[t],
                                         .overrides = scene_wish_maps,
                                         .samples = 16384,
                                         .threads = 2},
                     lx);
        const double expected = 179 * left * 2 * ORL_PI / 3;
        if (!(fabs(lx[0] / expected - 1) < .01))
            fail_msg("technique %zu: %g lx, not %g", t, lx[0], expected);
        assert_true(lx[1] == 0);
    }
}

/* A sky with its sun in the pattern gives a warning. */
static void test_small_bright(void **state)
{
    static const char text[] = "void brightfunc f 2 if(Dz-.999,1000,.01) . 0 0\n"
                               "f glow g 0 0 4 1 1 1 0\ng source heaven 0 0 4 0 0 1 180\n" RED;
    struct orl_scene *const scene = load(text, NULL);
    (void)state;
    assert_int_equal(scene->parsed_scene.n_warnings, 1);
    assert_non_null(strstr(scene->parsed_scene.warnings[0], "light of source heaven"));
    orl_scene_release(scene);
}

/* A picture from before 1992, which begins with the commands that made it. */
static void test_pictures_without_magic(void **state)
{
    static const char bytes[] = "ra_t16 -r\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n"
                                "\x7f\x7f\x7f\x81\x7f\x7f\x7f\x81\x7f\x7f\x7f\x81\x7f\x7f\x7f\x81";
    static const char text[] = "void colorpict p 7 red green blue x . Px Py 0 0\n"
                               "p plastic m 0 0 5 .5 .5 .5 0 0\nm sphere s 0 0 4 0 0 0 1\n";
    const struct orl_file file = {bytes, sizeof bytes - 1, NULL};
    struct orl_parsed_scene d;
    struct orl_error err = {0};
    (void)state;
    if (parse(text, &file, &d, &err) < 0)
        fail_msg("%s", err.message);
    assert_non_null(d.materials[d.surfaces[0].material].pattern);
    orl_parsed_scene_done(&d);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pictures_without_magic),
        cmocka_unit_test(test_rtrace),
        cmocka_unit_test(test_png),
        cmocka_unit_test(test_exr),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_keys),
        cmocka_unit_test(test_mixtures),
        cmocka_unit_test(test_mixture_twice),
        cmocka_unit_test(test_lamps),
        cmocka_unit_test(test_skies),
        cmocka_unit_test(test_small_bright),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
