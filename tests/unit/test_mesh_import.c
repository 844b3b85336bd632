/*
 * Meshes of other programs: OBJ files alone and by obj2rad with its rules, STL as text and binary,
 * against the polygons that they define; errors by file and line.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "scene/parse/parse.h"

#define PAINTS                                                                                     \
    "void plastic white 0 0 5 .7 .7 .7 0 0\nvoid plastic red 0 0 5 .5 .1 .1 0 0\n"                 \
    "void plastic box 0 0 5 .3 .3 .3 0 0\nvoid plastic chair 0 0 5 .2 .2 .2 0 0\n"
#define SQUARE "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\n"

/* The scene text, and a file that it names. */
struct other {
    const char *name, *data;
    size_t size; /* 0: length of the text */
};

static int parse_files(const char *const *mains, size_t n_mains, const char *scene,
                       const struct other *others, size_t n_others, struct orl_parsed_scene *ret,
                       struct orl_error *err)
{
    const char *names[4] = {"s.rad"};
    struct orl_file contents[4] = {{scene, strlen(scene), NULL}};
    for (size_t i = 0; i < n_others; i++) {
        names[i + 1] = others[i].name;
        contents[i + 1] = (struct orl_file){
            others[i].data, others[i].size ? others[i].size : strlen(others[i].data), NULL};
    }
    struct orl_memory_files memory = {names, contents, 1 + n_others};
    const struct orl_files files = orl_files_from_memory(&memory);
    *err = (struct orl_error){0};
    return orl_scene_parse(mains, n_mains, &files, ret, err);
}

static struct orl_parsed_scene read_scene(const char *scene, const struct other *others, size_t n)
{
    static const char *const mains[] = {"s.rad"};
    struct orl_parsed_scene d;
    struct orl_error err;
    if (parse_files(mains, 1, scene, others, n, &d, &err) < 0)
        fail_msg("%s:%d: %s (%s)", err.file, err.line, err.message, err.hint);
    return d;
}

static void expect_error(const char *scene, const struct other *others, size_t n, const char *file,
                         int line, const char *words)
{
    static const char *const mains[] = {"s.rad"};
    struct orl_parsed_scene d;
    struct orl_error err;
    assert_true(parse_files(mains, 1, scene, others, n, &d, &err) < 0);
    if (!strstr(err.message, words) || strcmp(err.file, file) != 0 || err.line != line)
        fail_msg("not %s:%d: ...%s... but %s:%d: %s", file, line, words, err.file, err.line,
                 err.message);
}

static const char *modifier_of(const struct orl_parsed_scene *d, size_t surface)
{
    return d->materials[d->surfaces[surface].material].name;
}

static void expect_corner(const struct orl_parsed_scene *d, size_t surface, uint32_t corner,
                          double x, double y, double z)
{
    const struct orl_vec3 v = d->surfaces[surface].vertices[corner];
    if (orl_length(orl_sub(v, orl_v3(x, y, z))) > 1e-12)
        fail_msg("corner %u of surface %zu is %g %g %g", corner, surface, v.x, v.y, v.z);
}

/* ---- OBJ ------------------------------------------------------------------------------------- */

/* An OBJ file alone among the scene's files: indices count from either end, continued lines are
 * joined, faces without area are skipped. */
static void test_alone(void **state)
{
    static const char *const mains[] = {"s.rad", "a.OBJ"};
    const struct other obj = {"a.OBJ",
                              "# by hand\r\nmtllib a.mtl\r\n" SQUARE "vt 0 0\nf 1 2 3\n"
                              "g box lid\nf 1/1 2/1 3/1\nusemtl red # not white\no it\n"
                              "f -4 -3 -2 \\\n -1\nl 1 2\np 1\ns off\n",
                              0};
    struct orl_parsed_scene d;
    struct orl_error err;
    (void)state;
    assert_int_equal(parse_files(mains, 2, PAINTS, &obj, 1, &d, &err), 0);
    assert_int_equal(d.n_surfaces, 3);
    assert_int_equal(d.n_warnings, 0);
    assert_string_equal(modifier_of(&d, 0), "white");
    assert_string_equal(d.surfaces[0].name, "unnamed.1");
    assert_string_equal(modifier_of(&d, 1), "box");
    assert_string_equal(d.surfaces[1].name, "box.lid.2");
    assert_string_equal(modifier_of(&d, 2), "red");
    assert_string_equal(d.surfaces[2].name, "it.3");
    assert_int_equal(d.surfaces[2].n_vertices, 4);
    assert_int_equal(d.surfaces[2].line, 13);
    expect_corner(&d, 2, 3, 0, 2, 0);
    orl_parsed_scene_done(&d);
}

/* Placed by xform, in both forms. */
static void test_instances(void **state)
{
    const struct other obj = {"o/a.obj", SQUARE "f 1 2 3 4\n", 0};
    (void)state;
    struct orl_parsed_scene d = read_scene(PAINTS "!xform -t 0 0 5 o/a.obj\n"
                                                  "!obj2rad -o leg o/a.obj | xform -m red -s 2\n",
                                           &obj, 1);
    assert_int_equal(d.n_surfaces, 2);
    expect_corner(&d, 0, 2, 2, 2, 5);
    expect_corner(&d, 1, 2, 4, 4, 0);
    assert_string_equal(modifier_of(&d, 1), "red");
    assert_string_equal(d.surfaces[1].name, "leg.1");
    orl_parsed_scene_done(&d);
}

/* A face that is not planar is split as by obj2rad, from the first corner on. */
static void test_bent(void **state)
{
    const struct other obj = {"a.obj",
                              "v 0 0 0\nv 1 0 0\nv 1 1 .3\nv .5 1.5 0\nv 0 1 0\n"
                              "f 1 2 3 4 5\nf 1 2 3 4\nf 1 2 4 5\n",
                              0};
    static const int cut[5][3] = {{0, 1, 2}, {2, 3, 4}, {4, 0, 2}, {0, 1, 2}, {2, 3, 0}};
    static const double v[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, .3}, {.5, 1.5, 0}, {0, 1, 0}};
    (void)state;
    struct orl_parsed_scene d = read_scene(PAINTS "!obj2rad a.obj\n", &obj, 1);
    assert_int_equal(d.n_surfaces, 6);
    for (size_t i = 0; i < 5; i++)
        for (uint32_t k = 0; k < 3; k++)
            expect_corner(&d, i, k, v[cut[i][k]][0], v[cut[i][k]][1], v[cut[i][k]][2]);
    assert_int_equal(d.surfaces[5].n_vertices, 4);
    assert_string_equal(d.surfaces[2].name, "unnamed.1");
    assert_int_equal(d.n_warnings, 0);
    orl_parsed_scene_done(&d);
}

/* Corner normals that differ from the face's split it into triangles. With -f, with normals equal
 * to the face's or facing away, and for faces that are not convex, it stays whole. */
static void test_normals(void **state)
{
    const struct other obj = {"a.obj",
                              SQUARE "vn 0 .1 1\nvn 0 0 2\nf 1//1 2//2 3//2 4//2\n"
                                     "f 1//2 2//2 3//2 4//2\n",
                              0},
                       away = {"a.obj",
                               SQUARE "v 1 .5 0\nvn 0 1 -1\nvn 0 .1 1\nvn 0 0 0\n"
                                      "f 1//1 2//1 3//1\nf 1//2 2//2 5//2 4//2\nf 1//3 2//3 3//3\n",
                               0};
    (void)state;
    struct orl_parsed_scene d = read_scene(PAINTS "!obj2rad a.obj\n", &obj, 1);
    assert_int_equal(d.n_warnings, 0);
    assert_int_equal(d.n_surfaces, 3);
    assert_true(d.surfaces[0].has_normals && d.surfaces[1].has_normals);
    assert_non_null(d.materials[d.surfaces[0].material].texture);
    assert_false(d.surfaces[2].has_normals);
    assert_null(d.materials[d.surfaces[2].material].texture);
    orl_parsed_scene_done(&d);
    d = read_scene(PAINTS "!obj2rad -f a.obj\n", &obj, 1);
    assert_int_equal(d.n_surfaces, 2);
    assert_false(d.surfaces[0].has_normals);
    orl_parsed_scene_done(&d);
    d = read_scene(PAINTS "!obj2rad a.obj\n", &away, 1);
    assert_int_equal(d.n_surfaces, 3);
    assert_int_equal(d.n_warnings, 1);
    assert_non_null(strstr(d.warnings[0], "3 faces are shaded flat"));
    assert_false(d.surfaces[0].has_normals || d.surfaces[1].has_normals);
    orl_parsed_scene_done(&d);
}

/* The last matching rule applies; void, or no match, drops a face. */
static void test_rules(void **state)
{
    const struct other others[] = {{"a.obj",
                                    SQUARE "g box\nusemtl 7\nf 1 2 3\nf 1 2 4\no junk\nf 1 3 4\n"
                                           "g beige lid\nf 2 3 4\n",
                                    0},
                                   {"a.map",
                                    "# tacky things\nwhite (Material [5:9]) ;\n"
                                    "red (Face [2:2])(Group \"box\");\nvoid (Object junk);\n"
                                    "chair (Object \"junk\") (Group lid) ;\n",
                                    0}};
    const struct other none[] = {others[0], {"a.map", "red (Group nothing);\n", 0}};
    (void)state;
    struct orl_parsed_scene d = read_scene(PAINTS "!obj2rad -m a.map a.obj\n", others, 2);
    assert_int_equal(d.n_surfaces, 3);
    assert_string_equal(modifier_of(&d, 0), "white");
    assert_string_equal(modifier_of(&d, 1), "red");
    assert_string_equal(modifier_of(&d, 2), "chair");
    assert_string_equal(d.surfaces[2].name, "junk.4");
    orl_parsed_scene_done(&d);
    d = read_scene(PAINTS "white sphere s 0 0 4 0 0 0 1\n!obj2rad -m a.map a.obj\n", none, 2);
    assert_int_equal(d.n_surfaces, 1);
    orl_parsed_scene_done(&d);
}

/* Output of a generator, piped: faces keep their order, names and places; other input is refused.
 */
static void test_piped(void **state)
{
    (void)state;
    struct orl_parsed_scene d = read_scene(
        PAINTS "!gensurf red land s t 's*t' 2 1 -o | obj2rad -o hill | xform -n h -t 0 0 1\n", NULL,
        0);
    assert_int_equal(d.n_surfaces, 4);
    assert_string_equal(modifier_of(&d, 3), "red");
    assert_string_equal(d.surfaces[3].name, "h.land.4");
    expect_corner(&d, 0, 0, .5, 0, 1);
    expect_corner(&d, 0, 1, .5, 1, 1.5);
    expect_corner(&d, 0, 2, 0, 0, 1);
    orl_parsed_scene_done(&d);
    expect_error(PAINTS "!gensurf red land s t 's*t' 2 1 -o\n", NULL, 0, "s.rad", 5,
                 "pipe it into obj2rad");
    expect_error(PAINTS "!gensurf red land s t 's*t' 2 1 | obj2rad\n", NULL, 0, "s.rad", 5,
                 "not an OBJ file");
    expect_error(PAINTS "!gensurf red land s t 's*t' 2 1 -o | obj2rad a.obj\n", NULL, 0, "s.rad", 5,
                 "takes no file");
    expect_error("\n!gensurf oak land s t 's*t' 2 1 -o | obj2rad\n", NULL, 0, "s.rad", 2,
                 "'oak' is not defined");
}

static void test_wrong_objects(void **state)
{
    static const struct {
        const char *obj, *map, *command, *file;
        int line;
        const char *words;
    } cases[] = {
        {SQUARE "f 1 2\n", "", "!obj2rad a.obj", "a.obj", 5, "three corners"},
        {SQUARE "f 1 2 5\n", "", "!obj2rad a.obj", "a.obj", 5, "does not exist"},
        {SQUARE "f 1 2 0\n", "", "!obj2rad a.obj", "a.obj", 5, "does not exist"},
        {SQUARE "f 1 2 -5\n", "", "!obj2rad a.obj", "a.obj", 5, "does not exist"},
        {SQUARE "f 1//1 2 3\n", "", "!obj2rad a.obj", "a.obj", 5, "does not exist"},
        {"v 0 0 0\nv 1 x 0\n", "", "!obj2rad a.obj", "a.obj", 2, "three numbers"},
        {"v 0 0 1e999\n", "", "!obj2rad a.obj", "a.obj", 1, "three numbers"},
        {SQUARE "usemtl oak\nf 1 2 3\n", "", "!obj2rad a.obj", "a.obj", 6, "'oak' is not defined"},
        {SQUARE, "red", "!obj2rad -m a.map a.obj", "a.map", 1, "';'"},
        {SQUARE, "\nred (Colour 7);", "!obj2rad -m a.map a.obj", "a.map", 2, "Material, Map"},
        {SQUARE, "red (Face [1;2]);", "!obj2rad -m a.map a.obj", "a.map", 1, "range"},
        {SQUARE, "red (Map a)(Map b);", "!obj2rad -m a.map a.obj", "a.map", 1, "two conditions"},
        {SQUARE, "", "!obj2rad -n a.obj", "s.rad", 5, "-n"},
        {SQUARE, "", "!obj2rad a.obj b.obj", "s.rad", 5, "one file"},
        {SQUARE, "", "!obj2rad -f", "s.rad", 5, "needs a file"},
        {SQUARE, "", "!obj2rad b.obj", "s.rad", 5, "b.obj"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct other others[] = {{"a.obj", cases[i].obj, 0}, {"a.map", cases[i].map, 0}};
        char scene[400];
        snprintf(scene, sizeof scene, PAINTS "%s\n", cases[i].command);
        expect_error(scene, others, 2, cases[i].file, cases[i].line, cases[i].words);
    }
}

/* Scene text is read as scene text, for any file name extension. */
static void test_radiance_named_obj(void **state)
{
    const struct other obj = {"a.obj", "# a ball\nred sphere v 0 0 4 0 0 0 1\n", 0};
    (void)state;
    struct orl_parsed_scene d = read_scene(PAINTS "!xform -t 1 0 0 a.obj\n", &obj, 1);
    assert_int_equal(d.n_surfaces, 1);
    assert_int_equal(d.surfaces[0].kind, ORL_SURFACE_SPHERE);
    orl_parsed_scene_done(&d);
}

/* ---- STL ------------------------------------------------------------------------------------- */

static size_t make_binary(char bytes[200], float last)
{
    const float numbers[12] = {0, 0, 1, 0, 0, 3, 1, 0, 3, 0, 1, last};
    memset(bytes, 0, 200);
    snprintf(bytes, 80, "solid, but binary");
    bytes[80] = 2;
    for (size_t i = 0; i < 2; i++)
        memcpy(bytes + 84 + 50 * i, numbers, sizeof numbers);
    return 184;
}

static void test_stl(void **state)
{
    static const char text[] =
        "solid some name\nfacet normal 0 0 1\nouter loop\nvertex 0 0 3\n"
        "vertex 1 0 3\nvertex 0 1 3\nendloop\nendfacet\nendsolid some name\n";
    char bytes[200];
    const struct other files[] = {{"m/box.stl", bytes, make_binary(bytes, 3)},
                                  {"chair.stl", text, 0}};
    (void)state;
    struct orl_parsed_scene d =
        read_scene(PAINTS "!xform -t 0 0 0 m/box.stl\n!xform -t 0 0 0 chair.stl\n", files, 2);
    assert_int_equal(d.n_surfaces, 3);
    for (size_t i = 0; i < 3; i++) {
        expect_corner(&d, i, 0, 0, 0, 3);
        expect_corner(&d, i, 1, 1, 0, 3);
        expect_corner(&d, i, 2, 0, 1, 3);
        assert_string_equal(modifier_of(&d, i), i < 2 ? "box" : "chair");
    }
    orl_parsed_scene_done(&d);
}

static void test_wrong_stl(void **state)
{
    char bytes[200];
    const struct other binary = {"box.stl", bytes, make_binary(bytes, NAN)},
                       word = {"box.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertx 0 0 0\n",
                               0},
                       number = {"box.stl",
                                 "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 y 0", 0},
                       oak = {"oak.stl",
                              "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                              "vertex 0 1 0\nendloop\n",
                              0};
    (void)state;
    expect_error(PAINTS "!xform -t 0 0 0 box.stl\n", &binary, 1, "box.stl", 1, "finite");
    expect_error(PAINTS "!xform -t 0 0 0 box.stl\n", &word, 1, "box.stl", 4, "vertex x y z");
    expect_error(PAINTS "!xform -t 0 0 0 box.stl\n", &number, 1, "box.stl", 5, "three numbers");
    expect_error(PAINTS "!xform -t 0 0 0 oak.stl\n", &oak, 1, "oak.stl", 3, "'oak' is not defined");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_alone),         cmocka_unit_test(test_instances),
        cmocka_unit_test(test_bent),          cmocka_unit_test(test_normals),
        cmocka_unit_test(test_rules),         cmocka_unit_test(test_piped),
        cmocka_unit_test(test_wrong_objects), cmocka_unit_test(test_radiance_named_obj),
        cmocka_unit_test(test_stl),           cmocka_unit_test(test_wrong_stl),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
