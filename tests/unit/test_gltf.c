/*
 * glTF files in a scene: triangles placed by nodes, z up, with materials by name, in one file or
 * in several; and messages for invalid files and unsupported shapes.
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

#include <oriel/base/files.h>

#include "scene/parse/parse.h"

#define PAINTS "void plastic white 0 0 5 .7 .7 .7 0 0\nvoid plastic red_wall 0 0 5 .5 .1 .1 0 0\n"

/* ---- Files ----------------------------------------------------------------------------------- */

/* The binary data: a square in glTF's x and y, its corners in the order of a strip; indices of two
 * triangles, of a strip and of a fan; a corner that is not finite; the square in integers with a
 * gap behind each corner, and its corners except the first alone; places of copies. */
struct buffer {
    float corners[4][3];
    float normals[4][3];
    uint16_t triangles[6], strip[4], fan[4], lines[2];
    uint16_t beyond[3], restart[3];
    float not_finite[3][3];
    int16_t whole[4][4];
    int8_t whole_normals[4][4];
    float apart[3][3];
    float moves[2][3];
    int16_t turns[2][4];
    uint8_t places[3], falling[3], all[6];
};

static const struct buffer buffer = {
    .corners = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {1, 2, 0}},
    .normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
    .triangles = {0, 1, 2, 2, 1, 3},
    .strip = {0, 1, 2, 3},
    .fan = {0, 1, 3, 2},
    .lines = {0, 1},
    .beyond = {0, 1, 4},
    .restart = {0, 1, 65535},
    .not_finite = {{0, 0, 0}, {NAN, 0, 0}, {0, 1, 0}},
    .whole = {{0, 0, 0, 9}, {32767, 0, 0, 9}, {0, 32767, 0, 9}, {32767, 32767, -32768, 9}},
    .whole_normals = {{0, 0, 127, 9}, {0, 0, 127, 9}, {0, 0, 127, 9}, {0, 0, 127, 9}},
    .apart = {{1, 0, 0}, {0, 2, 0}, {1, 2, 0}},
    .moves = {{0, 0, 0}, {1, 4, 3}},
    .turns = {{0, 0, 0, 32767}, {0, 0, -23170, 23170}},
    .places = {1, 2, 3},
    .falling = {1, 3, 2},
    .all = {0, 1, 2, 2, 1, 3},
};

#define AT(member, stride)                                                                         \
    {                                                                                              \
        offsetof(struct buffer, member), sizeof buffer.member, stride                              \
    }
static const struct {
    size_t offset, length, stride;
} views[] = {AT(corners, 0),    AT(normals, 12), AT(triangles, 0),     AT(strip, 0),
             AT(fan, 0),        AT(lines, 0),    AT(beyond, 0),        AT(restart, 0),
             AT(not_finite, 0), AT(whole, 8),    AT(whole_normals, 4), AT(apart, 0),
             AT(moves, 0),      AT(turns, 0),    AT(places, 0),        AT(falling, 0),
             AT(all, 0)};

#define OF(view, component, count, type)                                                           \
    "{\"bufferView\": " #view ", \"componentType\": " #component ", \"count\": " #count            \
    ", \"type\": \"" type "\"}"
#define APART(count, places, values)                                                               \
    "\"sparse\": {\"count\": " #count ", \"indices\": {\"bufferView\": " #places                   \
    ", \"componentType\": 5121}, \"values\": {\"bufferView\": " #values "}}}"
#define ZEROS(count) "{\"componentType\": 5126, \"type\": \"VEC3\", \"count\": " #count
static const char *const accessors[] = {
    OF(0, 5126, 4, "VEC3"),
    OF(1, 5126, 4, "VEC3"),
    OF(2, 5123, 6, "SCALAR"),
    OF(3, 5123, 4, "SCALAR"),
    OF(4, 5123, 4, "SCALAR"),
    OF(5, 5123, 2, "SCALAR"),
    OF(6, 5123, 3, "SCALAR"),
    OF(8, 5126, 3, "VEC3"),
    /* 8: normalized integers, in steps of 8 bytes; 9: normals in the same form */
    "{\"bufferView\": 9, \"componentType\": 5122, \"count\": 4, \"type\": \"VEC3\", "
    "\"normalized\": true}",
    "{\"bufferView\": 10, \"componentType\": 5120, \"count\": 4, \"type\": \"VEC3\", "
    "\"normalized\": true}",
    /* 10: sparse, all corners but the first; 11: sparse, replaces one; 12: sparse, places decrease
     */
    ZEROS(4) ", " APART(3, 14, 11),
    "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\", \"sparse\": "
    "{\"count\": 1, \"indices\": {\"bufferView\": 14, \"componentType\": 5121}, \"values\": "
    "{\"bufferView\": 12, \"byteOffset\": 12}}}",
    ZEROS(4) ", " APART(3, 15, 11),
    /* 13 and 14: of copies; 15: more than the limit */
    OF(12, 5126, 2, "VEC3"),
    "{\"bufferView\": 13, \"componentType\": 5122, \"count\": 2, \"type\": \"VEC4\", "
    "\"normalized\": true}",
    ZEROS(4000000000) "}",
    /* 16: a byte each; 17: restarts a strip; 18: beyond its buffer view; 19: an unknown component
     * type */
    OF(16, 5121, 6, "SCALAR"),
    OF(7, 5123, 3, "SCALAR"),
    OF(0, 5126, 5, "VEC3"),
    OF(0, 5124, 4, "VEC3"),
};

enum { JSON_BYTES = 24576 };

/* Writes the JSON with these nodes, meshes and buffer. */
static void write_json(const char *uri, const char *nodes, const char *primitives, const char *more,
                       char ret_json[JSON_BYTES])
{
    FILE *const f = fmemopen(ret_json, JSON_BYTES, "w");
    assert_non_null(f);
    fprintf(f,
            "{\"asset\": {\"version\": \"2.0\"}, %s \"nodes\": [%s], \"meshes\": [{\"primitives\": "
            "[%s]}], \"materials\": [{\"name\": \"red wall\"}], \"buffers\": [{\"byteLength\": "
            "%zu%s%s%s}], \"bufferViews\": [",
            more, nodes, primitives, sizeof buffer, uri ? ", \"uri\": \"" : "", uri ? uri : "",
            uri ? "\"" : "");
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        fprintf(f, "%s{\"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu", i > 0 ? ", " : "",
                views[i].offset, views[i].length);
        if (views[i].stride > 0)
            fprintf(f, ", \"byteStride\": %zu", views[i].stride);
        fputs("}", f);
    }
    fputs("], \"accessors\": [", f);
    for (size_t i = 0; i < sizeof accessors / sizeof *accessors; i++)
        fprintf(f, "%s%s", i > 0 ? ", " : "", accessors[i]);
    fputs("]}", f);
    assert_int_equal(fclose(f), 0);
    assert_true(strlen(ret_json) < JSON_BYTES - 1);
}

static void put_u32(unsigned char *at, size_t value)
{
    for (int i = 0; i < 4; i++)
        at[i] = (unsigned char)(value >> 8 * i);
}

/* Returns the size of a .glb with the JSON and the buffer as chunks. */
static size_t write_glb(const char *json, unsigned char ret_bytes[2 * JSON_BYTES])
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

#define ONE_SCENE "\"scene\": 0, \"scenes\": [{\"nodes\": [0]}],"

/* ---- Scenes ---------------------------------------------------------------------------------- */

static int parse(const char *name, const void *data, size_t size, struct orl_parsed_scene *ret,
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
                     struct orl_parsed_scene *ret, struct orl_error *err)
{
    char json[JSON_BYTES], all[1024];
    unsigned char bytes[2 * JSON_BYTES];
    snprintf(all, sizeof all, "%s%s", strstr(more, "\"scene") ? "" : ONE_SCENE, more);
    write_json(NULL, nodes, primitives, all, json);
    return parse("m.glb", bytes, write_glb(json, bytes), ret, err);
}

static struct orl_parsed_scene read_glb(const char *nodes, const char *primitives, const char *more)
{
    struct orl_parsed_scene d;
    struct orl_error err;
    if (parse_glb(nodes, primitives, more, &d, &err) < 0)
        fail_msg("%s:%d: %s (%s)", err.file, err.line, err.message, err.hint);
    return d;
}

static void expect_refused(const char *nodes, const char *primitives, const char *more,
                           const char *words)
{
    struct orl_parsed_scene d;
    struct orl_error err;
    assert_true(parse_glb(nodes, primitives, more, &d, &err) < 0);
    if (!strstr(err.message, words) || strcmp(err.file, "m.glb") != 0 || !err.hint[0])
        fail_msg("not ...%s... but %s: %s (%s)", words, err.file, err.message, err.hint);
}

/* Checks corners to a float's last digit or two. */
static void expect_corners(const struct orl_parsed_scene *d, size_t surface, const double v[3][3])
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

/* The square in x and y is upright in x and z, and faces along glTF's z: to -y. */
static void test_upright(void **state)
{
    static const double v[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 0, 2}},
                                      {{0, 0, 2}, {1, 0, 0}, {1, 0, 2}}};
    (void)state;
    struct orl_parsed_scene d = read_glb(NODE, SQUARE, "");
    assert_int_equal(d.n_surfaces, 2);
    assert_int_equal(d.n_warnings, 0);
    for (size_t i = 0; i < 2; i++) {
        expect_corners(&d, i, v[i]);
        assert_true(fabs(d.surfaces[i].normal.y + 1) < 1e-12);
        assert_string_equal(d.materials[d.surfaces[i].material].name, "red_wall");
        assert_int_equal(d.surfaces[i].line, i + 1);
    }
    assert_string_equal(d.surfaces[1].name, "a_b.2");
    orl_parsed_scene_done(&d);
}

/* Nested nodes; a mirroring node reverses the corners' order and keeps the front side. */
static void test_nodes(void **state)
{
    static const double turned[3][3] = {{1, -3, 4}, {1, -3, 3}, {3, -3, 4}};
    static const double mirrored[3][3] = {{0, 0, 4}, {-3, 0, 0}, {0, 0, 0}};
    (void)state;
    struct orl_parsed_scene d =
        read_glb("{\"translation\": [1, 4, 3], \"children\": [1]},"
                 "{\"mesh\": 0, \"rotation\": [0, 0, -0.70710678, 0.70710678]}",
                 SQUARE, "");
    expect_corners(&d, 0, turned);
    assert_true(fabs(d.surfaces[0].normal.y + 1) < 1e-6);
    orl_parsed_scene_done(&d);
    d = read_glb("{\"mesh\": 0, \"scale\": [-3, 2, 1]}", SQUARE, "");
    expect_corners(&d, 0, mirrored);
    assert_true(fabs(d.surfaces[0].normal.y + 1) < 1e-6);
    orl_parsed_scene_done(&d);
    d = read_glb("{\"mesh\": 0, \"matrix\": [0,-1,0,0, 1,0,0,0, 0,0,1,0, 1,4,3,1]}", SQUARE, "");
    expect_corners(&d, 0, turned);
    orl_parsed_scene_done(&d);
}

/* Strips and fans give the same square; lines give nothing; the default material is white. */
static void test_modes(void **state)
{
    static const double first[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}};
    (void)state;
    struct orl_parsed_scene d =
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
    orl_parsed_scene_done(&d);
}

static void expect_square(const char *uri)
{
    static const double first[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}};
    char json[JSON_BYTES];
    struct orl_parsed_scene d;
    struct orl_error err;
    write_json(uri, NODE, SQUARE, ONE_SCENE, json);
    if (parse("m.gltf", json, strlen(json), &d, &err) < 0)
        fail_msg("%s: %s", err.file, err.message);
    assert_int_equal(d.n_surfaces, 2);
    expect_corners(&d, 0, first);
    orl_parsed_scene_done(&d);
}

static void expect_no_buffer(const char *uri, int code, const char *words)
{
    char json[JSON_BYTES];
    struct orl_parsed_scene d;
    struct orl_error err;
    write_json(uri, NODE, SQUARE, ONE_SCENE, json);
    assert_int_equal(parse("m.gltf", json, strlen(json), &d, &err), code);
    assert_string_equal(err.file, "m.gltf");
    assert_string_equal(err.primitive, "buffers[0]");
    if (!strstr(err.message, words))
        fail_msg("not ...%s... but %s", words, err.message);
}

/* The buffer is in the JSON, or in a file beside it that belongs to the scene. */
static void test_text(void **state)
{
    char uri[2048] = "data:application/octet-stream;base64,";
    (void)state;
    sodium_bin2base64(uri + strlen(uri), sizeof uri - strlen(uri), (const unsigned char *)&buffer,
                      sizeof buffer, sodium_base64_VARIANT_ORIGINAL);
    expect_square(uri);
    while (uri[strlen(uri) - 1] == '=')
        uri[strlen(uri) - 1] = '\0';
    expect_square(uri);
    expect_square("a%20buffer.bin");
    expect_no_buffer("data:,AAAA", ORL_ERR_UNSUPPORTED, "not base64");
    expect_no_buffer("data:;base64,A*", ORL_ERR_SYNTAX, "base64 data are invalid");
    expect_no_buffer("data:;base64,AAAA", ORL_ERR_SYNTAX, "it has 3 bytes");
    expect_no_buffer("not_there.bin", ORL_ERR_NOT_FOUND, "not_there.bin");
}

/* The square from integers, from sparse corners, and from indices of a byte each. */
static void test_vertices(void **state)
{
    static const double first[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 2}},
                        whole[3][3] = {{0, 0, 1}, {1, 0, 0}, {1, 1, 1}},
                        replaced[3][3] = {{0, 0, 0}, {1, -3, 4}, {0, 0, 2}};
    (void)state;
    struct orl_parsed_scene d =
        read_glb(NODE, "{\"attributes\": {\"POSITION\": 8, \"NORMAL\": 9}, \"indices\": 2}",
                 "\"extensionsRequired\": [\"KHR_mesh_quantization\"],");
    assert_int_equal(d.n_surfaces, 2);
    assert_int_equal(d.n_warnings, 0);
    expect_corners(&d, 1, whole);
    orl_parsed_scene_done(&d);
    d = read_glb(NODE, "{\"attributes\": {\"POSITION\": 10}, \"indices\": 16}", "");
    assert_int_equal(d.n_surfaces, 2);
    expect_corners(&d, 0, first);
    orl_parsed_scene_done(&d);
    d = read_glb(NODE, "{\"attributes\": {\"POSITION\": 11}, \"indices\": 16}", "");
    expect_corners(&d, 0, replaced);
    orl_parsed_scene_done(&d);
}

#define COPIES(attributes)                                                                         \
    "{\"mesh\": 0, \"translation\": [0, 0, 1], \"extensions\": {\"EXT_mesh_gpu_instancing\": "     \
    "{\"attributes\": {" attributes "}}}}"

/* Two instances; the second is rotated and moved within the node, which is moved itself. */
static void test_copies(void **state)
{
    static const double first[3][3] = {{0, -1, 0}, {1, -1, 0}, {0, -1, 2}},
                        second[3][3] = {{1, -4, 4}, {1, -4, 3}, {3, -4, 4}};
    (void)state;
    struct orl_parsed_scene d =
        read_glb(COPIES("\"TRANSLATION\": 13, \"ROTATION\": 14, \"_ID\": 99"), SQUARE,
                 "\"extensionsRequired\": [\"EXT_mesh_gpu_instancing\"],");
    assert_int_equal(d.n_surfaces, 4);
    expect_corners(&d, 0, first);
    expect_corners(&d, 2, second);
    orl_parsed_scene_done(&d);
    expect_refused(COPIES(""), SQUARE, "", "the position of any copy");
    expect_refused(COPIES("\"TRANSLATION\": 13, \"SCALE\": 10"), SQUARE, "", "different counts");
    expect_refused(COPIES("\"TRANSLATION\": 15"), SQUARE, "", "exceeds 5000000 triangles");
}

/* Nodes to place: those of "scene", of the first scene, or all roots. */
static void test_scenes(void **state)
{
    static const char nodes[] =
        NODE ", {\"mesh\": 0, \"scale\": [2, 2, 2]}, {\"children\": [0, 1]}";
    static const struct {
        const char *scenes;
        size_t n;
        double height;
    } cases[] = {
        {"\"scene\": 1, \"scenes\": [{\"nodes\": [0]}, {\"nodes\": [1]}],", 2, 4},
        {"\"scenes\": [{\"nodes\": [0]}, {\"nodes\": [1]}],", 2, 2},
        {"\"scenes\": [],", 4, 2},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_parsed_scene d = read_glb(nodes, SQUARE, cases[i].scenes);
        assert_int_equal(d.n_surfaces, cases[i].n);
        assert_true(fabs(d.surfaces[0].vertices[2].z - cases[i].height) < 1e-6);
        orl_parsed_scene_done(&d);
    }
    expect_refused(nodes, SQUARE, "\"scene\": 2, \"scenes\": [{\"nodes\": [0]}],",
                   "scenes[2], which does not exist");
    expect_refused(nodes, SQUARE, "\"scenes\": [{\"nodes\": [0, 2]}],", "has two parents");
    expect_refused("{\"children\": [1]}, {\"children\": [0]}", SQUARE, "", "contains itself");
}

/* 501 nested nodes are accepted; a node one level too deep is named in the error. */
static void test_depth(void **state)
{
    char nodes[16384];
    (void)state;
    for (int deep = 501; deep <= 502; deep++) {
        FILE *const f = fmemopen(nodes, sizeof nodes, "w");
        assert_non_null(f);
        for (int i = 1; i < deep; i++)
            fprintf(f, "{\"children\":[%d]},", i);
        fputs("{\"mesh\":0}", f);
        assert_int_equal(fclose(f), 0);
        if (deep == 501) {
            struct orl_parsed_scene d = read_glb(nodes, SQUARE, "");
            assert_int_equal(d.n_surfaces, 2);
            orl_parsed_scene_done(&d);
        } else {
            expect_refused(nodes, SQUARE, "", "more than 500 deep");
        }
    }
}

/* Animated and morphed meshes give warnings. */
static void test_warnings(void **state)
{
    static const char blended[] =
        "{\"attributes\": {\"POSITION\": 0}, \"indices\": 2, \"targets\": [{\"POSITION\": 0}]}";
    (void)state;
    struct orl_parsed_scene d = read_glb("{\"mesh\": 0, \"weights\": [0.5]}", blended, "");
    assert_int_equal(d.n_warnings, 1);
    assert_non_null(strstr(d.warnings[0], "morph targets"));
    orl_parsed_scene_done(&d);
    d = read_glb("{\"mesh\": 0, \"skin\": 0, \"weights\": [0]}", blended, "");
    assert_int_equal(d.n_warnings, 1);
    assert_non_null(strstr(d.warnings[0], "skeleton"));
    orl_parsed_scene_done(&d);
}

static void test_refused(void **state)
{
    (void)state;
    expect_refused(NODE, SQUARE,
                   "\"extensionsRequired\": [\"KHR_texture_transform\", "
                   "\"KHR_draco_mesh_compression\"],",
                   "'KHR_draco_mesh_compression' is not supported");
    expect_refused("", SQUARE, "", "nodes[0], which does not");
    expect_refused("{\"mesh\": 1}", SQUARE, "", "meshes[1], which does not");
    expect_refused("{\"mesh\": -1}", SQUARE, "", "not a whole number");
    expect_refused("{\"mesh\": 0, \"matrix\": [1]}", SQUARE, "", "not 16 numbers");
    expect_refused("{\"mesh\": 0, \"rotation\": [0, 0, 0, 0]}", SQUARE, "",
                   "quaternion has length 0");
    expect_refused("{\"mesh\": 0, \"scale\": [1, 1, 1], "
                   "\"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}",
                   SQUARE, "", "both a 'matrix'");
    expect_refused("{\"mesh\": 0, \"matrix\": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]}", SQUARE, "",
                   "last row");
    expect_refused("{\"mesh\": 0, \"scale\": [1e308, 1e308, 1], \"rotation\": [0, 0, 0.6, 0.8]}",
                   SQUARE, "", "not finite");
}

/* Meshes with invalid accessors, corners and modes. */
static void test_damaged_meshes(void **state)
{
    static const char *const cases[][2] = {
        {"{\"attributes\": {\"POSITION\": 0}, \"indices\": 6}", "corner 4, which"},
        {"{\"attributes\": {\"POSITION\": 0}, \"indices\": 17}", "corner 65535, which"},
        {"{\"attributes\": {\"POSITION\": 7}}", "not finite"},
        {"{\"attributes\": {\"POSITION\": 40}}", "accessors[40], which does not"},
        {"{\"attributes\": {\"POSITION\": 2}}", "its 'type' is SCALAR"},
        {"{\"attributes\": {\"POSITION\": 12}}", "indices do not increase"},
        {"{\"attributes\": {\"POSITION\": 18}}", "beyond the end of its bufferViews[0]"},
        {"{\"attributes\": {\"POSITION\": 19}}", "'componentType' or 'count'"},
        {"{\"attributes\": {\"POSITION\": 15}}",
         "4000000000 corners, which is not a multiple of 3"},
        {"{\"attributes\": {\"POSITION\": 15}, \"mode\": 5}", "exceeds 5000000 triangles"},
        {"{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 7}}", "4 corners but 3 normals"},
        {"{\"attributes\": {\"NORMAL\": 1}}", "no 'POSITION'"},
        {"{\"attributes\": {\"POSITION\": 0}, \"indices\": 3}",
         "4 corners, which is not a multiple"},
        {"{\"attributes\": {\"POSITION\": 0}, \"indices\": 0}", "its 'type' is VEC3"},
        {"{\"attributes\": {\"POSITION\": 0}, \"indices\": 2, \"mode\": 7}", "the 'mode' 7"},
        {"{\"attributes\": {\"POSITION\": 0}, \"indices\": 2, \"material\": 1}",
         "materials[1], which does not"},
        {"{\"attributes\": 0}", "an object is expected here"},
        {"7", "an object is expected here"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        expect_refused(NODE, cases[i][0], "", cases[i][1]);
}

/* A byte order mark and blanks before the JSON; other glTF versions, and invalid JSON. */
static void test_heads_of_text(void **state)
{
    static const struct {
        const char *text, *words;
    } cases[] = {
        {"{\"asset\": {\"version\": \"1.0\"}}", "not version 2.0"},
        {"{\"asset\": {\"version\": \"2.1\", \"minVersion\": \"2.1\"}}", "not version 2.0"},
        {"{\"scene\": \"a\"}", "no 'asset'"},
        {"{\"asset\": {\"version\": \"2.0\"}, \"asset\": 0}", "line 1, column"},
        {"{\"asset\": {\"version\": \"2.0\"}} {", "line 1, column"},
    };
    struct orl_parsed_scene d;
    struct orl_error err;
    (void)state;
    static const char marked[] = "\xef\xbb\xbf \n{\"asset\": {\"version\": \"2.0\"}} ";
    assert_int_equal(parse("m.gltf", marked, sizeof marked - 1, &d, &err), 0);
    assert_int_equal(d.n_warnings, 1); /* an empty file */
    orl_parsed_scene_done(&d);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_true(parse("m.gltf", cases[i].text, strlen(cases[i].text), &d, &err) < 0);
        if (!strstr(err.message, cases[i].words))
            fail_msg("not ...%s... but %s", cases[i].words, err.message);
    }
}

/* glTF 1.0; and a chunk that claims to be longer than the file. */
static void test_heads(void **state)
{
    char json[JSON_BYTES];
    unsigned char bytes[2 * JSON_BYTES];
    struct orl_parsed_scene d;
    struct orl_error err;
    (void)state;
    write_json(NULL, NODE, SQUARE, ONE_SCENE, json);
    const size_t size = write_glb(json, bytes);
    bytes[4] = 1;
    assert_int_equal(parse("m.glb", bytes, size, &d, &err), ORL_ERR_UNSUPPORTED);
    assert_non_null(strstr(err.message, "not version 2"));
    bytes[4] = 2;
    bytes[8]++;
    assert_int_equal(parse("m.glb", bytes, size, &d, &err), ORL_ERR_SYNTAX);
    assert_non_null(strstr(err.message, "a longer file"));
    bytes[8]--;
    bytes[15] = 0x7e;
    assert_int_equal(parse("m.glb", bytes, size, &d, &err), ORL_ERR_SYNTAX);
    assert_non_null(strstr(err.message, "extends beyond the file's end"));
    assert_string_equal(err.file, "m.glb");
}

/* A file that is cut short anywhere is refused as a whole. */
static void test_cut(void **state)
{
    char json[JSON_BYTES];
    unsigned char bytes[2 * JSON_BYTES];
    (void)state;
    write_json(NULL, NODE, SQUARE, ONE_SCENE, json);
    const size_t size = write_glb(json, bytes);
    for (size_t cut = 0; cut < size; cut += 97) {
        struct orl_parsed_scene d;
        struct orl_error err;
        assert_true(parse("m.glb", bytes, cut, &d, &err) < 0 || d.n_surfaces == 0);
        if (err.message[0] == '\0')
            orl_parsed_scene_done(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_upright),        cmocka_unit_test(test_nodes),
        cmocka_unit_test(test_modes),          cmocka_unit_test(test_text),
        cmocka_unit_test(test_refused),        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_heads),          cmocka_unit_test(test_vertices),
        cmocka_unit_test(test_copies),         cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_depth),          cmocka_unit_test(test_warnings),
        cmocka_unit_test(test_damaged_meshes), cmocka_unit_test(test_heads_of_text),
    };
    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
