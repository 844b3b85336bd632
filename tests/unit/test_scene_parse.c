/* Valid scene text and the parsed result. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>
#include <oriel/job/run.h>

#include "scene/parse/parse.h"

#define RED "void plastic red 0 0 5 .5 .2 .1 0 0\n"
#define GLOW "void glow g 0 0 4 1 1 1 0\n"
#define SQUARE " polygon p 0 0 12 0 0 0  1 0 0  1 1 0  0 1 0\n"

/* A tensor tree of one value: 0.1 per steradian, everywhere. */
static const char uniform_xml[] =
    "<?xml version=\"1.0\"?><WindowElement><WindowElementType>System</WindowElementType>"
    "<FileType>BSDF</FileType><Optical><Layer><Material><Name>uniform</Name></Material>"
    "<DataDefinition><IncidentDataStructure>TensorTree4</IncidentDataStructure></DataDefinition>"
    "<WavelengthData><LayerNumber>System</LayerNumber>"
    "<Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock>"
    "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>"
    "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF</ScatteringDataType>"
    "<ScatteringData>{ 0.1 }</ScatteringData></WavelengthDataBlock></WavelengthData></Layer>"
    "</Optical></WindowElement>\n";

/* Parses files given as pairs of name and text; the first count_main are the main ones. */
static int parse_files(const char *const (*pairs)[2], size_t count, size_t count_main,
                       struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err)
{
    const char *names[8];
    struct orl_file contents[8];
    struct orl_memory_files memory = {names, contents, count};
    struct orl_files files = orl_files_from_memory(&memory);
    assert_true(count <= 8);
    for (size_t i = 0; i < count; i++) {
        names[i] = pairs[i][0];
        contents[i] = (struct orl_file){pairs[i][1], strlen(pairs[i][1]), NULL};
    }
    return orl_scene_parse(names, count_main, &files, ret_parsed_scene, err);
}

/* Parses one valid text. */
static struct orl_parsed_scene parse(const char *text)
{
    const char *const pairs[1][2] = {{"a.rad", text}};
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    if (parse_files(pairs, 1, 1, &parsed_scene, &err) < 0) {
        char message[1024];
        orl_error_format(&err, message, sizeof message);
        fail_msg("%s", message);
    }
    return parsed_scene;
}

static void assert_vec(struct orl_vec3 v, double x, double y, double z)
{
    assert_true(fabs(v.x - x) < 1e-9);
    assert_true(fabs(v.y - y) < 1e-9);
    assert_true(fabs(v.z - z) < 1e-9);
}

/* ---- Counts, by table ---------------------------------------------------------------------------
 */

struct good {
    const char *name, *text;
    size_t surfaces, materials, distant_sources, skies, warnings;
};

static const struct good good_scenes[] = {
    {"comment only", "# nothing\n", 0, 0, 0, 0, 0},
    {"no final newline", "# nothing", 0, 0, 0, 0, 0},
    {"carriage returns", "void plastic m\r\n0\r\n0\r\n5 .1 .1 .1 0 0\r\n", 0, 1, 0, 0, 0},
    {"byte order mark", "\xef\xbb\xbfvoid metal m 0 0 5 .9 .9 .9 1 0", 0, 1, 0, 0, 0},
    {"glass", "void glass g 0 0 3 .96 .96 .96\nvoid glass h 0 0 4 .9 .9 .9 1.4\n", 0, 2, 0, 0, 0},
    {"polygon", RED "red" SQUARE, 1, 1, 0, 0, 0},
    {"closed by hand", RED "red polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 0 0", 1, 1, 0, 0, 0},
    {"degenerate", RED "red polygon p 0 0 9 0 0 0 1 1 1 2 2 2", 0, 1, 0, 0, 1},
    {"bent", RED "red polygon p 0 0 12 0 0 0 1 0 0 1 1 .1 0 1 0", 1, 1, 0, 0, 1},
    {"no material", "void" SQUARE, 0, 1, 0, 0, 1},
    {"round",
     RED "red sphere a 0 0 4 0 0 0 1\nred bubble b 0 0 4 0 0 0 1\n"
         "red cylinder c 0 0 7 0 0 0 0 0 1 1\nred tube d 0 0 7 0 0 0 0 0 1 1\n"
         "red cone e 0 0 8 0 0 0 0 0 1 1 0\nred cup f 0 0 8 0 0 0 0 0 1 0 1\n"
         "red ring g 0 0 8 0 0 0 0 0 1 0 1\n",
     7, 1, 0, 0, 0},
    {"source", "void light l 0 0 3 1 2 3\nl source s 0 0 4 0 0 2 .5\n", 0, 1, 1, 0, 0},
    {"quoted words", "void plastic \"a b\" 0 0 5 0 0 0 0 0\n'a b'" SQUARE, 1, 1, 0, 0, 0},
    {"redefined", RED "red" SQUARE "void metal red 0 0 5 .3 .3 .3 1 0\nred" SQUARE, 2, 2, 0, 0, 0},
    {"defined twice alike", RED RED "red" SQUARE, 1, 1, 0, 0, 0},
    {"alias", RED "void alias pink red\npink" SQUARE, 1, 2, 0, 0, 0},
    {"genbox", RED "!genbox red box 1 2 3\n", 6, 1, 0, 0, 0},
    {"genbox, inverted", RED "!genbox red box 1 2 3 -i\n", 6, 1, 0, 0, 0},
    {"quoted command", "void metal 'a b' 0 0 5 0 0 0 0 0\n!genbox \"a b\" box 1 2 3\n", 6, 1, 0, 0,
     0},
    {"piped", RED "!genbox red box 1 2 3 | xform -t 1 0 0 | xform -n x -mx\n", 6, 1, 0, 0, 0},
    {"writes nothing", RED "!gensurf red w s t 0 2 2 -e 'valid(s,t)=-1'\nred" SQUARE, 1, 1, 0, 0,
     0},
    {"array", RED "!genbox red b 1 1 1 | xform -a 4 -t 2 0 0 -a 3 -t 0 2 0\n", 72, 1, 0, 0, 0},
    {"continued", RED "!genbox red b \\\n  1 1 1 \\\r\n | xform -t 0 0 1\nred" SQUARE, 7, 1, 0, 0,
     0},
    {"gensky",
     "!gensky -ang 40 10 +s\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 180", 0, 2, 2,
     1, 0},
    {"gensky, overcast", "!gensky 6 21 12 -c\n", 0, 0, 0, 1, 0},
    {"gendaylit", "!gendaylit -ang 40 10 -W 500 100\nskyfunc glow sky 0 0 4 1 1 1 0\n", 0, 2, 1, 1,
     0},
    {"gendaylit at night", "!gendaylit 12 21 23 -a 50 -o 0 -m 0 -W 0 0\n", 0, 0, 0, 1, 1},
    {"sky alias", "!gensky -ang 40 10 -s\nvoid alias mysky skyfunc\nmysky glow s 0 0 4 1 1 1 0\n",
     0, 1, 0, 1, 0},
};

static void test_good_scenes(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof good_scenes / sizeof *good_scenes; i++) {
        const struct good *good = good_scenes + i;
        struct orl_parsed_scene d = parse(good->text);
        if (d.n_surfaces != good->surfaces || d.n_materials != good->materials ||
            d.n_distant_sources != good->distant_sources || d.n_skies != good->skies ||
            d.n_warnings != good->warnings)
            fail_msg("%s: %zu surfaces, %zu materials, %zu distants, %zu skies, %zu warnings",
                     good->name, d.n_surfaces, d.n_materials, d.n_distant_sources, d.n_skies,
                     d.n_warnings);
        orl_parsed_scene_done(&d);
    }
}

/* ---- Parsed numbers -------------------------------------------------------------------------- */

static void test_materials(void **state)
{
    struct orl_parsed_scene d =
        parse("void plastic p 0 0 5 .1 .2 .3 .04 .05\n"
              "void glass g 0 0 3 .7 .8 .9\nvoid glass h 0 0 4 .7 .8 .9 1.4\n"
              "void glow w 0 0 4 1 2 3 -1\n");
    (void)state;
    assert_int_equal(d.materials[0].kind, ORL_MATERIAL_PLASTIC);
    assert_string_equal(d.materials[0].name, "p");
    const struct orl_reflector *const plastic = orl_reflector_of(&d.materials[0]);
    const struct orl_glass *const glass = orl_glass_of(&d.materials[1]);
    assert_true(d.materials[0].color.g == .2 && plastic->shares.specular == .04);
    assert_true(plastic->roughness[0] == .05 && d.materials[0].sky == -1);
    assert_true(glass->transmissivity.b == .9 && glass->ior == 1.52);
    assert_true(orl_glass_of(&d.materials[2])->ior == 1.4);
    assert_true(d.materials[3].color.b == 3 && orl_glow_of(&d.materials[3])->max_radius == -1);
    orl_parsed_scene_done(&d);
}

static void test_latest_definition_counts(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "red" SQUARE "void metal red 0 0 5 .3 .3 .3 1 0\nred" SQUARE);
    (void)state;
    assert_int_equal(d.materials[d.surfaces[0].material].kind, ORL_MATERIAL_PLASTIC);
    assert_int_equal(d.materials[d.surfaces[1].material].kind, ORL_MATERIAL_METAL);
    orl_parsed_scene_done(&d);
}

/* A mistake that Radiance takes for a source without light: it is dark here too, with a warning. */
static void test_a_pattern_alone_is_dark(void **state)
{
    struct orl_parsed_scene d =
        parse("!gensky -ang 40 10 -s\nskyfunc source sky 0 0 4 0 0 1 180\n"
              "skyfunc glow ground 0 0 4 1 1 1 0\nground source earth 0 0 4 0 0 -1 180\n");
    (void)state;
    assert_int_equal(d.n_distant_sources, 1);
    assert_string_equal(d.distant_sources[0].name, "earth");
    assert_int_equal(d.n_warnings, 1);
    assert_non_null(strstr(d.warnings[0], ":2: source sky emits no light, as in Radiance: its "
                                          "modifier 'skyfunc' is a pattern"));
    assert_non_null(strstr(d.warnings[0], "skyfunc glow sky_glow 0 0 4 1 1 1 0"));
    orl_parsed_scene_done(&d);
}

static void test_aliases(void **state)
{
    struct orl_parsed_scene d = parse("!gensky -ang 40 10 -s\n" GLOW "skyfunc alias lit g\n"
                                      "inherit alias same lit\nvoid alias plain lit\n");
    (void)state;
    assert_int_equal(d.n_materials, 4);
    assert_int_equal(d.materials[1].sky, 0);
    assert_string_equal(d.materials[2].name, "same");
    assert_int_equal(d.materials[2].sky, 0);
    assert_int_equal(d.materials[3].sky, -1);
    orl_parsed_scene_done(&d);
}

static void test_surfaces(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "red polygon p 0 0 12 0 0 0  0 1 0  0 1 1  0 0 1\n"
                  "\n\nred cone c 0 0 8 1 2 3 4 5 6 .5 0\nred ring r 0 0 8 1 1 1 0 0 -5 2 1\n");
    (void)state;
    assert_vec(d.surfaces[0].normal, 1, 0, 0);
    assert_int_equal(d.surfaces[0].n_vertices, 4);
    assert_string_equal(d.surfaces[0].name, "p");
    assert_string_equal(d.surfaces[0].file, "a.rad");
    assert_int_equal(d.surfaces[0].line, 2);
    assert_int_equal(d.surfaces[1].line, 5);
    assert_vec(d.surfaces[1].quadric->center[1], 4, 5, 6);
    assert_true(d.surfaces[1].quadric->radius[0] == .5 && d.surfaces[1].quadric->radius[1] == 0);
    assert_vec(d.surfaces[2].normal, 0, 0, -1);
    assert_true(d.surfaces[2].quadric->radius[0] == 1 && d.surfaces[2].quadric->radius[1] == 2);
    orl_parsed_scene_done(&d);
}

/* A square with a square hole, joined by a seam: ten corners in, ten corners out, 8 of area 9. */
static void test_keyhole_is_kept(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "red polygon p 0 0 30  0 0 1  3 0 1  3 3 1  0 3 1  0 0 1\n"
                  "  1 1 1  1 2 1  2 2 1  2 1 1  1 1 1\n");
    (void)state;
    assert_int_equal(d.n_surfaces, 1);
    assert_int_equal(d.surfaces[0].n_vertices, 10);
    assert_vec(d.surfaces[0].normal, 0, 0, 1);
    assert_vec(d.surfaces[0].vertices[4], 0, 0, 1);
    assert_vec(d.surfaces[0].vertices[7], 2, 2, 1);
    assert_int_equal(d.n_warnings, 0);
    orl_parsed_scene_done(&d);
}

static void test_far_polygon_is_kept(void **state)
{
    /* A square of 1 cm, 100 km away: the normal must stay accurate. */
    struct orl_parsed_scene d = parse(RED "red polygon p 0 0 12 1e5 1e5 1e5  1e5 100000.01 1e5\n"
                                          "1e5 100000.01 100000.01  1e5 1e5 100000.01\n");
    (void)state;
    assert_int_equal(d.n_surfaces, 1);
    assert_vec(d.surfaces[0].normal, 1, 0, 0);
    orl_parsed_scene_done(&d);
}

static void test_numbers(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "red sphere s 0 0 4 +.5 -1.25e-3 12345678901234567890123e-20 0.1\n"
                  "void glow g 0 0 4 1e22 5. 9007199254740993 3.0000000000000004\n");
    (void)state;
    assert_true(d.surfaces[0].quadric->center[0].x == .5 &&
                d.surfaces[0].quadric->center[0].y == -1.25e-3);
    assert_true(d.surfaces[0].quadric->center[0].z == 123.45678901234567890123);
    assert_true(d.surfaces[0].quadric->radius[0] == 0.1);
    assert_true(d.materials[1].color.r == 1e22 && d.materials[1].color.g == 5);
    assert_true(d.materials[1].color.b == 9007199254740992.0);
    assert_true(orl_glow_of(&d.materials[1])->max_radius == 3.0000000000000004);
    orl_parsed_scene_done(&d);
}

/* ---- Commands -----------------------------------------------------------------------------------
 */

static void test_genbox_faces_outwards(void **state)
{
    (void)state;
    for (int inverted = 0; inverted < 2; inverted++) {
        struct orl_parsed_scene d =
            parse(inverted ? RED "!genbox red b 1 2 3 -i\n" : RED "!genbox red b 1 2 3\n");
        const struct orl_vec3 middle = orl_v3(.5, 1, 1.5);
        for (size_t i = 0; i < 6; i++) {
            const struct orl_surface *s = d.surfaces + i;
            const double side = orl_dot(s->normal, orl_sub(s->vertices[0], middle));
            assert_true(inverted ? side < -.4 : side > .4);
            assert_int_equal(s->line, 2);
        }
        assert_string_equal(d.surfaces[0].name, "b.1540");
        orl_parsed_scene_done(&d);
    }
}

static void test_xform_arrays(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "!genbox red b 1 1 1 | xform -n x -a 2 -t 10 0 0 -a 2 -t 0 10 0 -i 1 -t 0 0 5\n");
    (void)state;
    assert_int_equal(d.n_surfaces, 24);
    assert_string_equal(d.surfaces[0].name, "x.0.0.b.1540");
    assert_string_equal(d.surfaces[18].name, "x.1.1.b.1540");
    assert_vec(d.surfaces[6].vertices[3], 0, 10, 5);
    assert_vec(d.surfaces[18].vertices[3], 10, 10, 5);
    orl_parsed_scene_done(&d);
}

/* Surfaces without extent are dropped with a warning, as by oconv; the last three have an extent
 * and stay. */
static void test_no_extent(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "red sphere a 0 0 4 0 0 0 0\nred bubble b 0 0 4 0 0 0 0\n"
                  "red cylinder c 0 0 7 0 0 0 0 0 0 1\nred tube e 0 0 7 0 0 0 0 0 1 0\n"
                  "red cone f 0 0 8 0 0 0 0 0 1 0 0\nred cup g 0 0 8 1 1 1 1 1 1 1 2\n"
                  "red ring h 0 0 8 0 0 0 0 0 0 0 1\nred ring i 0 0 8 0 0 0 0 0 1 1 1\n"
                  "red sphere s 0 0 4 0 0 0 .1\nred cone k 0 0 8 0 0 0 0 0 1 0 .1\n"
                  "red ring r 0 0 8 0 0 0 0 0 1 .1 0\n");
    (void)state;
    assert_int_equal(d.n_surfaces, 3);
    assert_int_equal(d.n_degenerate, 8);
    assert_string_equal(d.surfaces[0].name, "s");
    assert_string_equal(d.surfaces[1].name, "k");
    assert_string_equal(d.surfaces[2].name, "r");
    orl_parsed_scene_done(&d);
}

/* The corners of a square of 4, one of them lifted by 0.8, are 0.4 apart along its mean normal. */
static void test_bent_polygons(void **state)
{
    struct orl_parsed_scene d = parse(RED "red polygon p 0 0 12 0 0 0 4 0 0 4 4 .8 0 4 0\n"
                                          "red polygon q 0 0 12 0 0 0 4 0 0 4 4 .1 0 4 0\n"
                                          "red polygon r 0 0 12 0 0 0 4 0 0 4 4 .001 0 4 0\n");
    (void)state;
    assert_int_equal(d.n_surfaces, 3);
    assert_int_equal(d.n_warnings, 1);
    assert_non_null(strstr(
        d.warnings[0], "and 1 others: its corners are off a plane by up to 0.396: it is cut into "
                       "triangles, which all have its mean normal"));
    orl_parsed_scene_done(&d);
}

/* '#' works as in a shell: at the beginning of a word ends a command; within a word it is an
 * ordinary character. */
static void test_command_comments(void **state)
{
    struct orl_parsed_scene d =
        parse(RED "!genbox red b 1 1 1 | xform -n a#b -t 1 0 0 # by hand; see 'plan\n"
                  "!genbox red c 1 1 1 #\n");
    (void)state;
    assert_int_equal(d.n_surfaces, 12);
    assert_string_equal(d.surfaces[0].name, "a#b.b.1540");
    assert_vec(d.surfaces[6].vertices[0], 1, 0, 0);
    orl_parsed_scene_done(&d);
}

static void test_xform_mirror(void **state)
{
    static const char *const pairs[][2] = {
        {"main.rad", RED GLOW "!xform -mx -s 2 -t 1 0 0 part.rad\n!xform -I part.rad\n"},
        {"part.rad", "red polygon p 0 0 9 1 0 0  1 1 0  1 0 1\nred sphere s 0 0 4 1 0 0 3\n"
                     "red ring r 0 0 8 1 0 0 1 0 0 0 1\ng source d 0 0 4 1 1 0 10\n"
                     "void glow h 0 0 4 1 1 1 3\n"}};
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_files(pairs, 2, 1, &d, &err), 0);
    /* mirrored: x = 1 - 2; the front still looks away from the mirror plane */
    assert_vec(d.surfaces[0].normal, -1, 0, 0);
    assert_vec(d.surfaces[0].vertices[2], -1, 0, 0);
    assert_int_equal(d.surfaces[1].kind, ORL_SURFACE_SPHERE);
    assert_vec(d.surfaces[1].quadric->center[0], -1, 0, 0);
    assert_true(d.surfaces[1].quadric->radius[0] == 6);
    assert_vec(d.surfaces[2].normal, -1, 0, 0);
    assert_vec(d.distant_sources[0].direction, -sqrt(.5), sqrt(.5), 0);
    assert_true(orl_glow_of(&d.materials[2])->max_radius == 6);
    /* inverted: turned over in place */
    assert_vec(d.surfaces[3].normal, -1, 0, 0);
    assert_vec(d.surfaces[3].vertices[2], 1, 0, 0);
    assert_int_equal(d.surfaces[4].kind, ORL_SURFACE_BUBBLE);
    assert_vec(d.surfaces[5].normal, -1, 0, 0);
    assert_vec(d.distant_sources[1].direction, sqrt(.5), sqrt(.5), 0);
    orl_parsed_scene_done(&d);
}

static void test_xform_overrides(void **state)
{
    static const char *const pairs[][2] = {
        {"model/main.rad",
         RED "void plastic blue 0 0 5 0 0 .5 0 0\n"
             "!xform -m red -n out parts/a.rad\n!xform -f list.txt parts/b.rad\n"},
        {"model/parts/a.rad", "!xform -m blue -n in ../parts/./b.rad\n"},
        {"model/parts/b.rad", "blue" SQUARE},
        {"model/list.txt", "-t 1 0 0\n\n# no copy\nxform -t 0 \"2\" 0\n"}};
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_files(pairs, 4, 1, &d, &err), 0);
    assert_int_equal(d.n_surfaces, 3);
    assert_string_equal(d.surfaces[0].name, "out.in.p");
    assert_string_equal(d.materials[d.surfaces[0].material].name, "red");
    assert_string_equal(d.surfaces[0].file, "model/parts/b.rad");
    assert_string_equal(d.materials[d.surfaces[1].material].name, "blue");
    assert_string_equal(d.surfaces[1].name, "i0.p");
    assert_vec(d.surfaces[1].vertices[0], 1, 0, 0);
    assert_vec(d.surfaces[2].vertices[0], 0, 2, 0);
    assert_int_equal(d.n_files, 4);
    assert_int_equal(d.source.n_main, 1);
    assert_string_equal(d.files[2], "model/parts/b.rad");
    orl_parsed_scene_done(&d);
}

static void test_sky_turns_with_its_scene(void **state)
{
    struct orl_parsed_scene d = parse("!gensky -ang 30 0 -s | xform -rz 90\n"
                                      "void brightfunc s 4 skybright perezlum.cal -rz -90\n0\n"
                                      "10 1 2 3 .4 5 6 7 1 0 0\n");
    (void)state;
    /* A southern sun rotated by a quarter turn, counter-clockwise from above, is in the east. */
    assert_true(fabs(d.skies[0].a[4] - cos(30 * ORL_DEG_TO_RAD)) < 1e-6);
    assert_true(fabs(d.skies[0].a[5]) < 1e-6 && fabs(d.skies[0].a[6] - .5) < 1e-6);
    assert_int_equal(d.skies[1].kind, ORL_SKY_PEREZ);
    assert_true(fabs(d.skies[1].a[8] + 1) < 1e-12 && d.skies[1].a[6] == 7);
    orl_parsed_scene_done(&d);
}

/* ---- BSDFs and files ----------------------------------------------------------------------------
 */

static void test_bsdf_is_shared(void **state)
{
    static const char *const pairs[][2] = {
        {"m/main.rad", "void BSDF one 6 0 b.xml 0 0 1 .\n0\n9 .1 .1 .1 .2 .2 .2 .3 .3 .3\n"
                       "void BSDF two 8 0 m/c.xml 0 0 1 . -rx 90\n0\n0\n"
                       "one polygon p 0 0 9 0 0 0 1 0 0 0 0 1\n"},
        {"m/b.xml", uniform_xml},
        {"m/c.xml", uniform_xml}};
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    const int code = parse_files(pairs, 3, 1, &d, &err);
    (void)state;
    if (code < 0)
        fail_msg("%s: %s", err.primitive, err.message);
    assert_int_equal(d.materials[0].kind, ORL_MATERIAL_BSDF);
    const struct orl_bsdf_surface *const first = orl_bsdf_surface_of(&d.materials[0]);
    const struct orl_bsdf_surface *const second = orl_bsdf_surface_of(&d.materials[1]);
    assert_non_null(first->bsdf);
    assert_ptr_equal(first->bsdf, second->bsdf);
    assert_true(first->diffuse.back.g == .2 && first->diffuse.through.b == .3);
    assert_vec(first->up, 0, 0, 1);
    assert_vec(second->up, 0, -1, 0);
    orl_parsed_scene_done(&d);
}

static void test_digest_follows_content(void **state)
{
    static const char *const one[][2] = {{"a.rad", RED "!xform b.rad\n"}, {"b.rad", "red" SQUARE}};
    static const char *const same[][2] = {{"z.rad", RED "!xform b.rad\n"}, {"b.rad", "red" SQUARE}};
    static const char *const other[][2] = {{"a.rad", RED "!xform b.rad\n"},
                                           {"b.rad", "red" SQUARE " "}};
    static const char *const twice[][2] = {{"b.rad", RED "red" SQUARE}, {"b.rad", ""}};
    struct orl_parsed_scene d[5] = {{0}};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_files(one, 2, 1, &d[0], &err), 0);
    assert_int_equal(parse_files(same, 2, 1, &d[1], &err), 0);
    assert_int_equal(parse_files(other, 2, 1, &d[2], &err), 0);
    assert_int_equal(parse_files(twice, 2, 1, &d[3], &err), 0);
    assert_int_equal(parse_files(twice, 2, 2, &d[4], &err), 0);
    assert_memory_equal(d[0].digest, d[1].digest, 32);
    assert_memory_not_equal(d[0].digest, d[2].digest, 32);
    assert_memory_not_equal(d[3].digest, d[4].digest, 32);
    assert_int_equal(d[4].n_surfaces, 2);
    for (int i = 0; i < 5; i++)
        orl_parsed_scene_done(&d[i]);
}

static void test_xml_among_main_files_is_no_scene(void **state)
{
    static const char *const pairs[][2] = {{"b.xml", uniform_xml}, {"a.rad", RED "red" SQUARE}};
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_files(pairs, 2, 2, &d, &err), 0);
    assert_int_equal(d.n_surfaces, 1);
    assert_int_equal(d.source.n_main, 1);
    assert_int_equal(d.n_files, 1);
    orl_parsed_scene_done(&d);
}

/* ---- Choice of the scene's files ------------------------------------------------------------- */

/* Returns the main files of those, in one string. */
static void guess(const char *const (*pairs)[2], size_t count, char ret_main[256])
{
    const char *names[8];
    struct orl_file files[8];
    bool main_file[8];
    struct orl_error err = {0};
    assert_true(count <= 8);
    for (size_t i = 0; i < count; i++) {
        names[i] = pairs[i][0];
        files[i] = (struct orl_file){pairs[i][1], strlen(pairs[i][1]), NULL};
    }
    struct orl_memory_files memory = {names, files, count};
    const struct orl_files provider = orl_files_from_memory(&memory);
    assert_int_equal(orl_scene_guess_main(names, count, &provider, main_file, &err), 0);
    ret_main[0] = '\0';
    for (size_t i = 0; i < count; i++)
        if (main_file[i])
            snprintf(ret_main + strlen(ret_main), 256 - strlen(ret_main), "%s ", names[i]);
}

/* Files are found in an archive with their enclosing folder. */
static void test_main_files(void **state)
{
    static const char *const top[][2] = {{"a.rad", "!xform -t 1 0 0 ./b.rad\n"},
                                         {"b.rad", "# chair\n"},
                                         {"c.RAD", "!xform o/d.rad\n"},
                                         {"o/d.rad", "# table\n"}};
    static const char *const within[][2] = {{"house/a.rad", "!xform parts/b.rad\n"},
                                            {"house/c.rad", "!xform house/d.rad\n"},
                                            {"house/d.rad", "# by its name from the top\n"},
                                            {"house/e.rad", "# by its name from below\n"},
                                            {"house/parts/b.rad", "!xform ../e.rad\n"},
                                            {"notes.txt", "!xform house/a.rad\n"}};
    static const char *const several[][2] = {{"a/x.rad", "#\n"}, {"b/y.rad", "#\n"}};
    char main_files[256];
    (void)state;
    guess(top, 4, main_files);
    assert_string_equal(main_files, "a.rad c.RAD ");
    guess(within, 6, main_files);
    assert_string_equal(main_files, "house/a.rad house/c.rad ");
    guess(several, 2, main_files);
    assert_string_equal(main_files, "");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_good_scenes),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_latest_definition_counts),
        cmocka_unit_test(test_aliases),
        cmocka_unit_test(test_surfaces),
        cmocka_unit_test(test_keyhole_is_kept),
        cmocka_unit_test(test_far_polygon_is_kept),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_genbox_faces_outwards),
        cmocka_unit_test(test_xform_arrays),
        cmocka_unit_test(test_no_extent),
        cmocka_unit_test(test_bent_polygons),
        cmocka_unit_test(test_command_comments),
        cmocka_unit_test(test_xform_mirror),
        cmocka_unit_test(test_xform_overrides),
        cmocka_unit_test(test_sky_turns_with_its_scene),
        cmocka_unit_test(test_a_pattern_alone_is_dark),
        cmocka_unit_test(test_bsdf_is_shared),
        cmocka_unit_test(test_digest_follows_content),
        cmocka_unit_test(test_xml_among_main_files_is_no_scene),
        cmocka_unit_test(test_main_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
