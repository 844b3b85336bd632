/*
 * Output of oconv and obj2mesh, read by instance and mesh: files made here, byte by byte, in their
 * documented formats.
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

#include "scene/material/patterns/pattern.h"
#include "scene/material/patterns/texture.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"

/* ---- Files ----------------------------------------------------------------------------------- */

struct bytes {
    unsigned char data[8192];
    size_t size;
};

static void put_bytes(struct bytes *b, const void *data, size_t size)
{
    assert_true(b->size + size <= sizeof b->data);
    memcpy(b->data + b->size, data, size);
    b->size += size;
}

static void put_int(struct bytes *b, int64_t value, unsigned bytes)
{
    for (unsigned i = bytes; i-- > 0;) {
        const unsigned char byte = (unsigned char)((uint64_t)value >> 8 * i);
        put_bytes(b, &byte, 1);
    }
}

static void put_number(struct bytes *b, double value)
{
    int exponent;
    const double mantissa = frexp(value, &exponent);
    put_int(b, (int64_t)(mantissa * 0x7fffffff), 4);
    put_int(b, value == 0 ? 0 : exponent, 1);
}

static void put_string(struct bytes *b, const char *text)
{
    put_bytes(b, text, strlen(text) + 1);
}

static void put_header(struct bytes *b, const char *format, int magic)
{
    char text[100];
    const int n = snprintf(text, sizeof text, "#?RADIANCE\nsome program\nFORMAT=%s\n\n", format);
    put_bytes(b, text, (size_t)n);
    put_int(b, magic + 4, 2); /* numbers of primitives take four bytes */
    put_string(b, "-1");
    put_string(b, "-1");
    put_string(b, "-1");
    put_string(b, "8");
}

enum { POLYGON, SPHERE, PLASTIC, ALIAS };

static void put_types(struct bytes *b)
{
    put_string(b, "polygon");
    put_string(b, "sphere");
    put_string(b, "plastic");
    put_string(b, "alias");
    put_string(b, "");
}

static void put_primitive(struct bytes *b, int modifier, int type, const char *name,
                          const double *numbers, int count)
{
    put_int(b, type, 1);
    put_int(b, modifier, 4);
    put_string(b, name);
    put_int(b, 0, 2);
    put_int(b, count, 2);
    for (int i = 0; i < count; i++)
        put_number(b, numbers[i]);
}

static const double gray[5] = {.5, .25, .125, 0, 0}, ball[4] = {1, 2, 3, .5};

/* Writes a frozen octree: a material, an equal one with another name, and a ball of that; the
 * octree has one node and its leaves. */
static void make_frozen(struct bytes *b)
{
    put_header(b, "Radiance_octree", 283);
    put_string(b, ""); /* no files */
    put_int(b, 3, 4);
    put_int(b, 2, 1); /* eight children: one full, the others empty */
    put_int(b, 1, 1);
    put_int(b, 1, 4);
    put_int(b, 2, 4);
    for (int i = 0; i < 7; i++)
        put_int(b, 0, 1);
    put_types(b);
    put_primitive(b, -1, PLASTIC, "some paint", gray, 5);
    put_primitive(b, 0, ALIAS, "red", NULL, 0);
    put_primitive(b, 1, SPHERE, "ball", ball, 4);
    put_int(b, -1, 1);
}

static void make_named(struct bytes *b, const char *name)
{
    put_header(b, "Radiance_octree", 283);
    put_string(b, name);
    put_string(b, "");
    put_int(b, 3, 4);
    put_int(b, 0, 1);
}

/* Writes a place along an edge of the cube from -1 to 7. */
static void put_place(struct bytes *b, double x)
{
    put_int(b, (int64_t)((x + 1) / 8 * 4294967296.0), 4);
}

static void put_corner(struct bytes *b, double x, double y, double z)
{
    put_place(b, x);
    put_place(b, y);
    put_place(b, z);
}

enum { POINTS = 1, NORMALS = 2, PLACES = 4 };

/* Encoded directions of 32 bits: up, towards x, and up and away from y. */
static const int64_t directions[3] = {24, 16, 24 | 8191LL << 5 | 2};

/* Writes a square of two triangles. The first is in a patch of three corners; the second has two
 * corners in that patch and one in another. */
static void make_mesh(struct bytes *b, int flags)
{
    put_header(b, "Radiance_tmesh", 319);
    for (int i = 0; i < 2; i++) { /* limits of (u, v) */
        put_number(b, -1);
        put_number(b, 3);
    }
    put_int(b, 0, 1);
    put_types(b);
    put_primitive(b, -1, PLASTIC, "paint", gray, 5);
    put_int(b, -1, 1);
    put_int(b, 2, 4);
    put_int(b, POINTS | flags, 1);
    put_int(b, 3, 2);
    put_corner(b, 0, 0, 1);
    put_corner(b, 1, 0, 1);
    put_corner(b, 1, 1, 1);
    for (int i = 0; i < 3 && (flags & NORMALS); i++)
        put_int(b, directions[i], 4);
    for (int i = 0; i < 3 && (flags & PLACES); i++) { /* u is x, v is 2 y */
        put_int(b, (int64_t)((1 + (i > 0)) / 4.0 * 4294967296.0), 4);
        put_int(b, (int64_t)((1 + 2 * (i == 2)) / 4.0 * 4294967296.0), 4);
    }
    put_int(b, 1, 2);
    for (int i = 0; i < 3; i++)
        put_int(b, i, 1);
    put_int(b, 1, 2);
    put_int(b, 0, 2); /* all triangles use the first material */
    put_int(b, 0, 2);
    put_int(b, 0, 2);
    put_int(b, 1, 1);
    put_int(b, 1, 2);
    put_corner(b, 0, 1, 1);
    put_int(b, 0, 2);
    put_int(b, 0, 2);
    put_int(b, 0, 2);
    put_int(b, 0, 2);
    put_int(b, 1, 2); /* joins two patches */
    put_int(b, 0, 4);
    put_int(b, 2, 4);
    put_int(b, 0, 1);
    put_int(b, 0, 2);
}

enum { SIDE = 9 }; /* corners along one side of a cushion */

/* Writes a cushion of 128 triangles in one patch, with texture coordinates, and normals of the
 * three directions. */
static void make_cushion(struct bytes *b)
{
    b->size = 0;
    put_header(b, "Radiance_tmesh", 319);
    for (int i = 0; i < 2; i++) {
        put_number(b, -1);
        put_number(b, 3);
    }
    put_int(b, 0, 1);
    put_types(b);
    put_primitive(b, -1, PLASTIC, "paint", gray, 5);
    put_int(b, -1, 1);
    put_int(b, 1, 4);
    put_int(b, POINTS | NORMALS | PLACES, 1);
    put_int(b, SIDE * SIDE, 2);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double x = i % SIDE / 8.0, y = i / SIDE / 8.0; /* 8 steps from 0 to 1 */
        put_corner(b, x, y, 1 + x * (1 - x) + y * (1 - y));
    }
    for (int i = 0; i < SIDE * SIDE; i++)
        put_int(b, directions[i % 3], 4);
    for (int i = 0; i < SIDE * SIDE; i++) {
        put_int(b, (int64_t)((1 + i % SIDE / 8.0) / 4 * 4294967296.0), 4);
        put_int(b, (int64_t)((1 + i / SIDE / 8.0) / 4 * 4294967296.0), 4);
    }
    put_int(b, 2 * (SIDE - 1) * (SIDE - 1), 2);
    for (int i = 0; i < (SIDE - 1) * (SIDE - 1); i++) {
        const int at = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
        const int corners[6] = {at, at + 1, at + SIDE, at + 1, at + SIDE + 1, at + SIDE};
        for (int k = 0; k < 6; k++)
            put_int(b, corners[k], 1);
    }
    put_int(b, 1, 2);
    put_int(b, 0, 2);
    put_int(b, 0, 2);
    put_int(b, 0, 2);
}

/* ---- Reading --------------------------------------------------------------------------------- */

static bool parse_apart; /* true: each place gets surfaces of its own */

static int parse(const char *scene, const struct bytes *compiled, size_t size, const char *other,
                 struct orl_parsed_scene *ret, struct orl_error *err)
{
    static const char *const names[] = {"a.rad", "b.bin", "sub/c.rad"};
    const struct orl_file contents[] = {{scene, strlen(scene), NULL},
                                        {(const char *)compiled->data, size, NULL},
                                        {other, strlen(other), NULL}};
    struct orl_memory_files memory = {names, contents, 3};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_sources sources;
    *err = (struct orl_error){0};
    orl_sources_init(&sources, &files, NULL, orl_arena_new());
    return orl_scene_parse_opened(names, 1, &sources, parse_apart, ret, err);
}

static struct orl_parsed_scene parse_well(const char *scene, const struct bytes *compiled,
                                          const char *other)
{
    struct orl_parsed_scene d;
    struct orl_error err;
    if (parse(scene, compiled, compiled->size, other, &d, &err) < 0)
        fail_msg("%s:%d: %s (%s)", err.file, err.line, err.message, err.hint);
    return d;
}

static void expect_error(const char *scene, const struct bytes *compiled, int code,
                         const char *words)
{
    struct orl_parsed_scene d;
    struct orl_error err;
    assert_int_equal(parse(scene, compiled, compiled->size, "", &d, &err), code);
    if (!strstr(err.message, words))
        fail_msg("no '%s' in: %s", words, err.message);
    assert_true(err.file[0] != '\0');
}

static void expect_point(struct orl_vec3 v, double x, double y, double z)
{
    assert_true(orl_length(orl_sub(v, orl_v3(x, y, z))) < 1e-8);
}

static const struct orl_material *material_of(const struct orl_parsed_scene *d, size_t surface)
{
    return &d->materials[d->surfaces[surface].material];
}

static void test_frozen(void **state)
{
    struct bytes b = {.size = 0};
    (void)state;
    make_frozen(&b);
    struct orl_parsed_scene d =
        parse_well("void instance \"two words\" 7 b.bin -s 2 -t 10 0 0 0 0\n", &b, "");
    assert_int_equal(d.n_surfaces, 1);
    assert_int_equal(d.surfaces[0].kind, ORL_SURFACE_SPHERE);
    expect_point(d.surfaces[0].quadric->center[0], 12, 4, 6);
    assert_true(fabs(d.surfaces[0].quadric->radius[0] - 1) < 1e-8);
    assert_true(fabs(material_of(&d, 0)->color.g - .25) < 1e-8);
    orl_parsed_scene_done(&d);
}

/* Instances in the places of markers, by replmarks, match the ball placed by Radiance 6.1's
 * replmarks and xform. */
static void test_markers(void **state)
{
    static const char scene[] =
        "void plastic red 0 0 5 .9 0 0 0 0\nvoid plastic grass 0 0 5 0 .7 0 0 0\n"
        "!genblinds mark b 1 2 3 2 20 | cat | replmarks -s .5 -m grass -i b.bin mark | "
        "xform -n n -t 0 0 1\n";
    struct bytes b = {.size = 0};
    (void)state;
    make_frozen(&b);
    struct orl_parsed_scene d = parse_well(scene, &b, "");
    assert_int_equal(d.n_surfaces, 2);
    for (int i = 0; i < 2; i++) {
        const struct orl_vec3 c = d.surfaces[i].quadric->center[0];
        const struct orl_vec3 there = orl_v3(-1.96575267155, 1, 4.22705757571 + 1.5 * i);
        assert_true(orl_length(orl_sub(c, there)) < 2e-6); /* six decimals */
        assert_true(fabs(d.surfaces[i].quadric->radius[0] - .5) < 1e-6);
        assert_string_equal(material_of(&d, (size_t)i)->name, "grass");
        assert_string_equal(d.surfaces[i].name, i == 0 ? "n.b.1.0.ball" : "n.b.2.0.ball");
    }
    orl_parsed_scene_done(&d);
    expect_error("!genblinds mark b 1 2 3 1 20 | replmarks -I b.bin mark\n", &b, ORL_ERR_SYNTAX,
                 "mesh");
}

/* Names inside an octree are local: red outside is unchanged, and not visible inside. */
static void test_names_inside(void **state)
{
    struct bytes b = {.size = 0};
    (void)state;
    make_frozen(&b);
    struct orl_parsed_scene d = parse_well("void plastic red 0 0 5 .9 0 0 0 0\n"
                                           "void instance i 1 b.bin 0 0\n"
                                           "red sphere s 0 0 4 0 0 0 1\n"
                                           "red instance i 1 b.bin 0 0\n",
                                           &b, "");
    assert_int_equal(d.n_surfaces, 3);
    assert_true(fabs(material_of(&d, 0)->color.r - .5) < 1e-8);
    assert_true(fabs(material_of(&d, 1)->color.r - .9) < 1e-8);
    assert_true(fabs(material_of(&d, 2)->color.r - .9) < 1e-8);
    assert_true(d.surfaces[0].modifier_order < d.surfaces[2].modifier_order);
    orl_parsed_scene_done(&d);
    expect_error("void instance i 1 b.bin 0 0\n\"some paint\" sphere s 0 0 4 0 0 0 1\n", &b,
                 ORL_ERR_NOT_FOUND, "some paint");
    struct bytes named = {.size = 0};
    make_named(&named, "sub/c.rad");
    struct orl_error err;
    assert_int_equal(parse("void plastic red 0 0 5 .9 0 0 0 0\nvoid instance i 1 b.bin 0 0\n",
                           &named, named.size, "red sphere s 0 0 4 0 0 0 1\n", &d, &err),
                     ORL_ERR_NOT_FOUND);
    assert_string_equal(err.file, "sub/c.rad");
}

static void test_named_files(void **state)
{
    struct bytes b = {.size = 0};
    (void)state;
    make_named(&b, "sub/c.rad");
    struct orl_parsed_scene d =
        parse_well("void instance i 5 b.bin -t 0 0 5 0 0\n", &b,
                   "void plastic p 0 0 5 .1 .1 .1 0 0\np sphere s 0 0 4 0 0 0 1\n");
    assert_int_equal(d.n_surfaces, 1);
    expect_point(d.surfaces[0].quadric->center[0], 0, 0, 5);
    orl_parsed_scene_done(&d);
    struct bytes missing = {.size = 0}, itself = {.size = 0}, command = {.size = 0};
    make_named(&missing, "away.rad");
    expect_error("void instance i 1 b.bin 0 0\n", &missing, ORL_ERR_NOT_FOUND, "away.rad");
    make_named(&itself, "a.rad");
    expect_error("void instance i 1 b.bin 0 0\n", &itself, ORL_ERR_LIMIT, "itself");
    make_named(&command, "!genbox");
    expect_error("void instance i 1 b.bin 0 0\n", &command, ORL_ERR_UNSUPPORTED, "command");
    expect_error("void instance i 1 c.bin 0 0\n", &b, ORL_ERR_NOT_FOUND, "c.bin");
}

static void test_mesh(void **state)
{
    struct bytes b = {.size = 0};
    (void)state;
    make_mesh(&b, 0);
    struct orl_parsed_scene d = parse_well("void mesh m 5 b.bin -t 0 0 1 0 0\n", &b, "");
    assert_int_equal(d.n_surfaces, 2);
    assert_int_equal(d.n_warnings, 0);
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(d.surfaces[i].n_vertices, 3);
        expect_point(d.surfaces[i].normal, 0, 0, 1);
        assert_true(fabs(material_of(&d, i)->color.b - .125) < 1e-8);
    }
    expect_point(d.surfaces[0].vertices[1], 1, 0, 2);
    expect_point(d.surfaces[1].vertices[1], 1, 1, 2);
    expect_point(d.surfaces[1].vertices[2], 0, 1, 2);
    orl_parsed_scene_done(&d);
    /* The mirror transformation also moves the front side. */
    d = parse_well("void plastic own 0 0 5 .7 .7 .7 0 0\nown mesh m 2 b.bin -mz 0 0\n", &b, "");
    expect_point(d.surfaces[0].normal, 0, 0, -1);
    assert_true(fabs(material_of(&d, 1)->color.r - .7) < 1e-8);
    orl_parsed_scene_done(&d);
}

static void test_smooth_mesh(void **state)
{
    struct bytes b = {.size = 0};
    (void)state;
    make_mesh(&b, NORMALS);
    struct orl_parsed_scene d = parse_well("void mesh m 1 b.bin 0 0\n", &b, "");
    assert_int_equal(d.n_surfaces, 2);
    assert_int_equal(d.n_warnings, 0);
    const struct orl_vec3 *const normals = orl_surface_normals(&d.surfaces[0]);
    assert_non_null(normals);
    assert_null(orl_surface_normals(&d.surfaces[1])); /* one of its corners has none */
    expect_point(normals[0], 0, 1, 0);
    expect_point(normals[1], 1, 0, 0);
    const double x = 8191 / 11584.5;
    assert_true(fabs(orl_length(normals[2]) - 1) < 1e-12);
    assert_true(fabs(normals[2].x - x) < 1e-4 && fabs(normals[2].y + sqrt(1 - x * x)) < 1e-4);
    assert_non_null(material_of(&d, 0)->texture);
    assert_null(material_of(&d, 1)->texture);
    orl_parsed_scene_done(&d);
}

/* A corner of the second triangle lacks texture coordinates. */
static void test_places(void **state)
{
    struct bytes b = {.size = 0};
    (void)state;
    make_mesh(&b, PLACES);
    struct orl_parsed_scene d = parse_well("void brightfunc f 2 Lu+10*Lv . 0 0\n"
                                           "f plastic p 0 0 5 .01 .01 .01 0 0\n"
                                           "p mesh m 2 b.bin -mz 0 0\n"
                                           "p sphere s 0 0 4 9 9 9 1\n",
                                           &b, "");
    const double *const uv = orl_surface_uv(&d.surfaces[0]);
    assert_non_null(uv);
    assert_null(orl_surface_uv(&d.surfaces[1]));
    struct orl_geometry *g = NULL;
    struct orl_error err;
    assert_int_equal(orl_geometry_new(&d, &g, &err), 0);
    assert_int_equal(orl_patterns_measure(&d, g, &err), 0);
    static const double x[3][2] = {{.5, .25}, {.9, .1}, {.25, .75}};
    for (int i = 0; i < 3; i++) {
        struct orl_hit hit;
        const struct orl_vec3 from = orl_sub(orl_v3(x[i][0], x[i][1], 3), g->center);
        assert_true(orl_geometry_intersect(g, from, orl_v3(0, 0, -1), 10, &hit));
        const struct orl_rgb factor = orl_pattern_at(material_of(&d, 0)->pattern, &hit);
        assert_true(fabs(factor.r - (i < 2 ? x[i][0] + 20 * x[i][1] : 0)) < 1e-6);
    }
    orl_geometry_free(g);
    orl_parsed_scene_done(&d);
}

/*
 * A smoothed mesh, patterned by its texture coordinates, in places that are rotated, mirrored and
 * scaled. Stored once, it has the colours and normals that separate surfaces have in each place.
 * Coordinates of corners are rounded to 2e-9 of the cube in the file only.
 */
static void test_meshes_in_places(void **state)
{
    static const char scene[] = "void brightfunc f 2 Lu*Lv+.2 . 0 0\n"
                                "f plastic p 0 0 5 .9 .9 .9 .05 .1\n"
                                "p mesh a 1 b.bin 0 0\n"
                                "p mesh b 7 b.bin -rz 30 -t 4 0 0 0 0\n"
                                "p mesh c 10 b.bin -mx -rx 20 -s 2 -t 8 0 0 0 0\n"
                                "p mesh d 9 b.bin -ry 40 -s .5 -t 0 4 0 0 0\n";
    static const char *const words[2] = {"expanded", "apart"};
    struct bytes b = {.size = 0};
    struct orl_parsed_scene d[2];
    struct orl_geometry *g[2];
    struct orl_error err;
    unsigned met = 0;
    (void)state;
    make_cushion(&b);
    for (int i = 0; i < 2; i++) {
        parse_apart = i == 1;
        d[i] = parse_well(scene, &b, "");
        parse_apart = false;
        print_message("%s: %zu surfaces, %zu places\n", words[i], d[i].n_surfaces,
                      d[i].n_placements);
        assert_int_equal(orl_geometry_new(&d[i], &g[i], &err), 0);
        assert_int_equal(orl_patterns_measure(&d[i], g[i], &err), 0);
        assert_int_equal(orl_parsed_scene_free_surfaces(&d[i]), 0);
    }
    assert_int_equal(d[0].n_placements, 4);
    assert_int_equal(d[0].n_surfaces, 0);
    assert_int_equal(d[1].n_surfaces, 4 * 2 * (SIDE - 1) * (SIDE - 1));
    for (int i = 0; i < 4000; i++) {
        const struct orl_vec3 from = orl_v3(-1 + 12 * (i % 80) / 80.0, -1 + 6 * (i / 80) / 50.0, 4);
        const struct orl_vec3 down = orl_normalize(orl_v3(.1, .2, -1));
        struct orl_hit hit[2];
        struct orl_rgb color[2];
        struct orl_vec3 normal[2];
        bool found[2];
        for (int k = 0; k < 2; k++) {
            found[k] = orl_geometry_intersect(g[k], orl_sub(from, g[k]->center), down, 99, &hit[k]);
            if (!found[k])
                continue;
            const struct orl_material *const m =
                &d[k].materials[orl_facet_material(g[k], hit[k].facet)];
            color[k] = orl_material_diffuse(m, &hit[k]);
            normal[k] = orl_texture_normal(m->texture, &hit[k], orl_neg(down));
        }
        assert_int_equal(found[0], found[1]);
        if (!found[0])
            continue;
        met++;
        assert_true(fabs(hit[0].distance - hit[1].distance) < 1e-5);
        assert_true(fabs(color[0].r - color[1].r) < 1e-4);
        assert_true(orl_length(orl_sub(normal[0], normal[1])) < 1e-4);
    }
    print_message("%u rays meet some\n", met);
    assert_true(met > 200);
    for (int i = 0; i < 2; i++) {
        orl_geometry_free(g[i]);
        orl_parsed_scene_done(&d[i]);
    }
}

/* A file cut anywhere, or with any byte changed, is refused with its name, or is another scene. */
static void test_damaged(void **state)
{
    void (*const make[2])(struct bytes *) = {make_frozen, NULL};
    static const char *const scenes[2] = {"void instance i 1 b.bin 0 0\n",
                                          "void mesh m 1 b.bin 0 0\n"};
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct bytes b = {.size = 0};
        struct orl_parsed_scene d;
        struct orl_error err;
        if (make[kind])
            make[kind](&b);
        else
            make_mesh(&b, NORMALS | PLACES);
        for (size_t cut = 1; cut < b.size; cut++) {
            if (parse(scenes[kind], &b, cut, "", &d, &err) != ORL_ERR_SYNTAX)
                fail_msg("kind %d, cut at %zu of %zu: %s", kind, cut, b.size, err.message);
            assert_string_equal(err.file, "b.bin");
        }
        for (size_t at = 0; at < b.size; at++) {
            struct bytes changed = b;
            changed.data[at] ^= 0xff;
            if (parse(scenes[kind], &changed, changed.size, "", &d, &err) == 0)
                orl_parsed_scene_done(&d);
            else
                assert_true(err.file[0] != '\0');
        }
        expect_error(scenes[!kind], &b, ORL_ERR_SYNTAX, "format");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_frozen),
        cmocka_unit_test(test_markers),
        cmocka_unit_test(test_names_inside),
        cmocka_unit_test(test_named_files),
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_smooth_mesh),
        cmocka_unit_test(test_damaged),
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_meshes_in_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
