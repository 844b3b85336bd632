/*
 * glTF files as parts of a scene: their triangles where nodes place them, upright, by the names of
 * materials, in one file or in several; and what is wrong with them, or would be another shape.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <sodium.h>

#include <oriel/files.h>

#include "scene/parse/parse.h"

#define PAINTS "void plastic white 0 0 5 .7 .7 .7 0 0\nvoid plastic red_wall 0 0 5 .5 .1 .1 0 0\n"

/* ---- Files ----------------------------------------------------------------------------------- */

/* A square in glTF's x and y, its corners in the order of a strip; numbers of corners of two
 * triangles, of a strip and of a fan; and a corner that is not finite. */
struct buffer {
    float corners[4][3];
    float normals[4][3];
    uint16_t triangles[6], strip[4], fan[4], lines[2];
    uint16_t beyond[3], pad;
    float not_finite[3][3];
};

static const struct buffer buffer = {
    .corners = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}},
    .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
    .triangles = {0, 1, 2, 2, 1, 3},
    .strip = {0, 1, 2, 3},
    .fan = {0, 1, 3, 2},
    .lines = {0, 1},
    .beyond = {0, 1, 4},
    .not_finite = {{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}},
};

#define VIEW "{\"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu}"
#define AT(member) offsetof(struct buffer, member), sizeof buffer.member

/* Everything but the nodes, the meshes and the buffer; its accessors: 0 corners, 1 normals,
 * 2 triangles, 3 strip, 4 fan, 5 lines, 6 beyond the corners, 7 not finite. */
static void write_json(const char *uri, const char *nodes, const char *primitives, const char *more,
                       char ret_json[8192])
{
    static const char accessor[] = "{\"bufferView\": %d, \"componentType\": %d, \"count\": %d, "
                                   "\"type\": \"%s\"},";
    static const int counts[8] = {4, 4, 6, 4, 4, 2, 3, 3};
    int at = snprintf(ret_json, 8192,
                      "{\"asset\": {\"version\": \"2.0\"}, %s \"scene\": 0, \"scenes\": "
                      "[{\"nodes\": [0]}], \"nodes\": [%s], \"meshes\": [{\"primitives\": [%s]}], "
                      "\"materials\": [{\"name\": \"red wall\"}], \"buffers\": [{\"byteLength\": "
                      "%zu%s%s%s}], \"bufferViews\": [",
                      more, nodes, primitives, sizeof buffer, uri ? ", \"uri\": \"" : "",
                      uri ? uri : "", uri ? "\"" : "");
    at += snprintf(ret_json + at, 8192 - (size_t)at,
                   VIEW "," VIEW "," VIEW "," VIEW "," VIEW "," VIEW "," VIEW "," VIEW, AT(corners),
                   AT(normals), AT(triangles), AT(strip), AT(fan), AT(lines), AT(beyond),
                   AT(not_finite));
    at += snprintf(ret_json + at, 8192 - (size_t)at, "], \"accessors\": [");
    for (int i = 0; i < 8; i++) {
        const bool corners = i < 2 || i == 7;
        at += snprintf(ret_json + at, 8192 - (size_t)at, accessor, i, corners ? 5126 : 5123,
                       counts[i], corners ? "VEC3" : "SCALAR");
    }
    snprintf(ret_json + at - 1, 8192 - (size_t)at, "]}");
}

static void put_u32(unsigned char *at, size_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> 8 * i);
}

/* The JSON and the buffer as the chunks of a .glb. */
static size_t write_glb(const char *json, unsigned char ret_bytes[16384])
{
    const size_t text = (strlen(json) + 3) / 4 * 4, size = 28 + text + sizeof buffer;
    memcpy(ret_bytes, "glTF\2\0\0\0", 8);
    put_u32(ret_bytes + 8, size);
    put_u32(ret_bytes + 12, text);
    memcpy(ret_bytes + 16, "JSON", 4);
    memset(ret_bytes + 20, ' ', text);
    memcpy(ret_bytes + 20, json, strlen(json));
    put_u32(ret_bytes + 20 + text, sizeof buffer);
    memcpy(ret_bytes + 24 + text, "BIN", 4);
    memcpy(ret_bytes + 28 + text, &buffer, sizeof buffer);
    return size;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

static int parse(const char *name, const void *data, size_t size, struct orl_description *ret,
                 struct orl_error *err)
{
    const char *const mains[] = {"s.rad", name};
    const char *names[] = {"s.rad", name, "a buffer.bin"};
    const struct orl_file contents[] = {{PAINTS, strlen(PAINTS), NULL},
                                        {data, size, NULL},
                                        {(const char *)&buffer, sizeof buffer, NULL}};
    struct orl_memory_files memory = {names, contents, 3};
    const struct orl_files files = orl_files_from_memory(&memory);
    *err = (struct orl_error){0};
    return orl_scene_parse(mains, 2, &files, ret, err);
}

static int parse_glb(const char *nodes, const char *primitives, const char *more,
                     struct orl_description *ret, struct orl_error *err)
{
    char json[8192];
    unsigned char bytes[16384];
    write_json(NULL, nodes, primitives, more, json);
    return parse("m.glb", bytes, write_glb(json, bytes), ret, err);
}

static struct orl_description read_glb(const char *nodes, const char *primitives, const char *more)
{
    struct orl_description d;
    struct orl_error err;
    if (parse_glb(nodes, primitives, more, &d, &err) < 0)
        fail_msg("%s:%d: %s (%s)", err.file, err.line, err.message, err.hint);
    return d;
}

static void expect_refused(const char *nodes, const char *primitives, const char *more,
                           const char *words)
{
    struct orl_description d;
    struct orl_error err;
    assert_true(parse_glb(nodes, primitives, more, &d, &err) < 0);
    if (!strstr(err.message, words) || strcmp(err.file, "m.glb") != 0 || !err.hint[0])
        fail_msg("not ...%s... but %s: %s (%s)", words, err.file, err.message, err.hint);
}

/* To a float's last digit or two. */
static void expect_corners(const struct orl_description *d, size_t surface, const double v[3][3])
{
    assert_int_equal(d->surfaces[surface].n_vertices, 3);
    for (uint32_t k = 0; k < 3; k++) {
        const struct orl_vec3 at = d->surfaces[surface].vertices[k];
        if (orl_length(orl_sub(at, orl_v3(v[k][0], v[k][1], v[k][2]))) > 1e-6)
            fail_msg("corner %u of surface %zu is %g %g %g", k, surface, at.x, at.y, at.z);
    }
}

#define SQUARE "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1}, \"indices\": 2, \"material\": 0}"
#define NODE "{\"name\": \"a b\", \"mesh\": 0}"

/* ---- Tests ----------------------------------------------------------------------------------- */

/* The square in x and y stands upright in x and z, and looks where glTF's z does: to -y. */
static void test_upright(void **state)
{
    static const double v[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}},
                                      {{0, 0, 2}, {1, 0, 0}, {1, 0, 2}}};
    (void)state;
    struct orl_description d = read_glb(NODE, SQUARE, "");
    assert_int_equal(d.n_surfaces, 2);
    assert_int_equal(d.n_warnings, 0);
    for (size_t i = 0; i < 2; i++) {
        expect_corners(&d, i, v[i]);
        assert_true(fabs(d.surfaces[i].normal.y + 1) < 1e-12);
        assert_string_equal(d.materials[d.surfaces[i].material].name, "red_wall");
        assert_int_equal(d.surfaces[i].line, i + 1);
    }
    assert_string_equal(d.surfaces[1].name, "a_b.2");
    orl_description_done(&d);
}

/* Nodes within nodes; a mirror turns the corners' order, not the side that is the front. */
static void test_nodes(void **state)
{
    static const double turned[3][3] = {{1, -3, 4}, {1, -3, 3}, {3, -3, 4}};
    static const double mirrored[3][3] = {{0, 0, 4}, {-3, 0, 0}, {0, 0, 0}};
    (void)state;
    struct orl_description d =
        read_glb("{\"translation\": [1, 4, 3], \"children\": [1]},"
                 "{\"mesh\": 0, \"rotation\": [0, 0, -0.70710678, 0.70710678]}",
                 SQUARE, "");
    expect_corners(&d, 0, turned);
    assert_true(fabs(d.surfaces[0].normal.y + 1) < 1e-6);
    orl_description_done(&d);
    d = read_glb("{\"mesh\": 0, \"scale\": [-3, 2, 1]}", SQUARE, "");
    expect_corners(&d, 0, mirrored);
    assert_true(fabs(d.surfaces[0].normal.y + 1) < 1e-6);
    orl_description_done(&d);
    d = read_glb("{\"mesh\": 0, \"matrix\": [0,-1,0,0, 1,0,0,0, 0,0,1,0, 1,4,3,1]}", SQUARE, "");
    expect_corners(&d, 0, turned);
    orl_description_done(&d);
}

/* Strips and fans are the same square; lines are nothing; without a material it is white. */
static void test_modes(void **state)
{
    static const double first[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}};
    (void)state;
    struct orl_description d =
        read_glb(NODE,
                 "{\"attributes\": {\"POSITION\": 0}, \"indices\": 3, \"mode\": 5},"
                 "{\"attributes\": {\"POSITION\": 0}, \"indices\": 4, \"mode\": 6},"
                 "{\"attributes\": {\"POSITION\": 0}, \"indices\": 5, \"mode\": 1}",
                 "\"extensionsRequired\": [\"KHR_materials_unlit\"],");
    assert_int_equal(d.n_surfaces, 4);
    expect_corners(&d, 0, first);
    for (size_t i = 0; i < 4; i++) {
        assert_true(fabs(d.surfaces[i].normal.y + 1) < 1e-6);
        assert_string_equal(d.materials[d.surfaces[i].material].name, "white");
    }
    orl_description_done(&d);
}

static void expect_square(const char *uri)
{
    static const double first[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}};
    char json[8192];
    struct orl_description d;
    struct orl_error err;
    write_json(uri, NODE, SQUARE, "", json);
    if (parse("m.gltf", json, strlen(json), &d, &err) < 0)
        fail_msg("%s: %s", err.file, err.message);
    assert_int_equal(d.n_surfaces, 2);
    expect_corners(&d, 0, first);
    orl_description_done(&d);
}

/* The buffer within the JSON, and in a file beside it, which is one of the scene's. */
static void test_text(void **state)
{
    char uri[2048] = "data:application/octet-stream;base64,", json[8192];
    struct orl_description d;
    struct orl_error err;
    (void)state;
    sodium_bin2base64(uri + strlen(uri), sizeof uri - strlen(uri), (const unsigned char *)&buffer,
                      sizeof buffer, sodium_base64_VARIANT_ORIGINAL);
    expect_square(uri);
    expect_square("a%20buffer.bin");
    write_json("not_there.bin", NODE, SQUARE, "", json);
    assert_int_equal(parse("m.gltf", json, strlen(json), &d, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.file, "m.gltf");
    assert_non_null(strstr(err.message, "not_there.bin"));
}

static void test_refused(void **state)
{
    (void)state;
    expect_refused(NODE, SQUARE,
                   "\"extensionsRequired\": [\"KHR_texture_transform\", "
                   "\"KHR_mesh_quantization\"],",
                   "'KHR_mesh_quantization' is not read");
    expect_refused("{\"mesh\": 0, \"extensions\": {\"EXT_mesh_gpu_instancing\": {}}}", SQUARE, "",
                   "'EXT_mesh_gpu_instancing' is not read");
    expect_refused(NODE, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 6}", "", "no faces");
    expect_refused(NODE, "{\"attributes\": {\"POSITION\": 7}}", "", "not finite");
    expect_refused(NODE, "{\"attributes\": {\"POSITION\": 40}}", "", "no glTF 2.0");
    expect_refused("", SQUARE, "", "no glTF 2.0");
}

/* glTF 1.0; and a chunk that says it is longer than the file. */
static void test_heads(void **state)
{
    char json[8192];
    unsigned char bytes[16384];
    struct orl_description d;
    struct orl_error err;
    (void)state;
    write_json(NULL, NODE, SQUARE, "", json);
    const size_t size = write_glb(json, bytes);
    bytes[4] = 1;
    assert_int_equal(parse("m.glb", bytes, size, &d, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "not of version 2"));
    bytes[4] = 2;
    bytes[15] = 0x7e;
    assert_int_equal(parse("m.glb", bytes, size, &d, &err), ORL_ERR_SYNTAX);
    assert_non_null(strstr(err.message, "ends behind the file's end"));
    assert_string_equal(err.file, "m.glb");
}

/* Of a file that is cut short anywhere nothing is taken. */
static void test_cut(void **state)
{
    char json[8192];
    unsigned char bytes[16384];
    (void)state;
    write_json(NULL, NODE, SQUARE, "", json);
    const size_t size = write_glb(json, bytes);
    for (size_t cut = 0; cut < size; cut += 97) {
        struct orl_description d;
        struct orl_error err;
        assert_true(parse("m.glb", bytes, cut, &d, &err) < 0 || d.n_surfaces == 0);
        if (err.message[0] == '\0')
            orl_description_done(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_upright), cmocka_unit_test(test_nodes),
        cmocka_unit_test(test_modes),   cmocka_unit_test(test_text),
        cmocka_unit_test(test_refused), cmocka_unit_test(test_cut),
        cmocka_unit_test(test_heads),
    };
    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
