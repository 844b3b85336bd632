#include "support/grove.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "scene/parse/parse.h"

static const char once[] = "void instance tree 1 tree.oct 0 0\n"; /* once.rad */

static const char pair[] = "void instance one 1 tree.oct 0 0\n"
                           "void instance two 7 tree.oct -rz 90 -t 2 0 0 0 0\n"; /* pair.rad */

static double uniform(struct orl_random *random, double low, double high)
{
    return low + (high - low) * orl_random_uniform(random);
}

#define BLADE "void trans blade 0 0 7 .2 .6 .2 0 0 .5 0\n"

static const char matt[] = "void plastic bark 0 0 5 .4 .3 .2 0 0\n"
                           "void plastic leaf 0 0 5 .1 .4 .1 0 0\n" BLADE;

static const char *const materials[] = {
    [GROVE_MATT] = matt,
    [GROVE_BLADES] = matt,
    [GROVE_GLOSSY] = "void metal bark 0 0 5 .4 .3 .2 .3 .2\n"
                     "void plastic leaf 0 0 5 .1 .4 .1 .03 0\n",
    [GROVE_VARIED] = "void brightfunc moss 6 .6+.4*sin(3*Px+Nz) . -rz 30 -s 2 0 0\n"
                     "void texfunc furrows 4 .3*sin(9*Pz) 0 .2*Nx . 0 0\n"
                     "moss texfunc folds 8 .2*Py .1 .2*Nx . -t 1 0 0 0 0\n"
                     "furrows plastic bark 0 0 5 .4 .3 .2 .1 .2\n"
                     "folds plastic leaf 0 0 5 .1 .4 .1 0 0\n"};

/* Adds a random triangle in a box of 2 x 2 x 3, in one of two colours; with blades, some transmit
 * light. */
static void add_triangle(FILE *f, struct orl_random *r, size_t number, bool blades)
{
    const double x = uniform(r, -1, 1), y = uniform(r, -1, 1), z = uniform(r, 0, 3);
    fprintf(f, "%s polygon leaf%zu 0 0 9",
            number % 3 == 0             ? "bark"
            : blades && number % 4 == 1 ? "blade"
                                        : "leaf",
            number);
    for (int i = 0; i < 3; i++)
        fprintf(f, " %.9g %.9g %.9g", x + uniform(r, -0.3, 0.3), y + uniform(r, -0.3, 0.3),
                z + uniform(r, -0.3, 0.3));
    fprintf(f, "\n");
}

static void add_round(FILE *f, struct orl_random *r, size_t number)
{
    const double x = uniform(r, -1, 1), y = uniform(r, -1, 1), z = uniform(r, 0, 3);
    static const char *const balls[2] = {"sphere", "bubble"};
    if (number % 4 < 2)
        fprintf(f, "leaf %s ball%zu 0 0 4 %.9g %.9g %.9g 0.1\n", balls[number % 4], number, x, y,
                z);
    else if (number % 4 == 2)
        fprintf(f, "bark cone twig%zu 0 0 8 %.9g %.9g %.9g %.9g %.9g %.9g 0.08 0.02\n", number, x,
                y, z, x + uniform(r, -1, 1), y + uniform(r, -1, 1), z + uniform(r, 0.2, 1));
    else
        fprintf(f, "leaf ring disc%zu 0 0 8 %.9g %.9g %.9g %.9g %.9g 1 0 0.15\n", number, x, y, z,
                uniform(r, -1, 1), uniform(r, -1, 1));
}

static char *make_tree(size_t triangles, size_t rounds, enum grove_leaves leaves)
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_PILOT, 7);
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    assert_non_null(f);
    fputs(materials[leaves], f);
    for (size_t i = 0; i < triangles; i++)
        add_triangle(f, &random, i, leaves == GROVE_BLADES);
    for (size_t i = 0; i < rounds; i++)
        add_round(f, &random, i);
    assert_int_equal(fclose(f), 0);
    return text;
}

/* Writes a transform: rotated, scaled, every third mirrored, every fifth inverted, on a lattice. */
static void say_place(FILE *f, size_t number)
{
    fprintf(f, " -rz %zu -rx %zu", number * 37 % 360, number * 11 % 50);
    if (number % 3 == 1)
        fprintf(f, " -mx");
    fprintf(f, " -s %.3f -t %zu %zu 0.5", 0.5 + 0.1 * (double)(number % 9), number % 32 * 4,
            number / 32 * 4);
}

static bool is_inverted(size_t number)
{
    return number % 5 == 2;
}

/* An instance takes a transform but cannot be inverted; xform can invert an instance in a file. */
static void say_shared(FILE *f, size_t number)
{
    const size_t words = 1 + 2 + 2 + (number % 3 == 1 ? 1 : 0) + 2 + 4;
    if (is_inverted(number))
        fprintf(f, "!xform -I");
    else
        fprintf(f, "void instance tree%zu %zu tree.oct", number, words);
    say_place(f, number);
    fprintf(f, is_inverted(number) ? " once.rad\n" : " 0 0\n");
}

static void say_expanded(FILE *f, size_t number)
{
    fprintf(f, is_inverted(number) ? "!xform -I" : "!xform");
    say_place(f, number);
    fprintf(f, " tree.rad\n");
}

static char *make_scene(size_t places, bool shared)
{
    static const char head[] = "void plastic floor 0 0 5 .5 .5 .5 0 0\n"
                               "floor polygon ground 0 0 12 -9 -9 -2 200 -9 -2 200 200 -2 "
                               "-9 200 -2\n";
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    assert_non_null(f);
    fprintf(f, "%s", head);
    for (size_t i = 0; i < places; i++) {
        if (shared)
            say_shared(f, i);
        else
            say_expanded(f, i);
    }
    assert_int_equal(fclose(f), 0);
    return text;
}

static void put_bytes(struct grove_octree *octree, const void *data, size_t size)
{
    assert_true(octree->size + size <= sizeof octree->data);
    memcpy(octree->data + octree->size, data, size);
    octree->size += size;
}

/* Writes the octree as oconv does without -f: a header, the cube, the name of the file. */
static void make_octree(struct grove_octree *octree, const char *name)
{
    static const char head[] = "#?RADIANCE\noconv tree.rad\nFORMAT=Radiance_octree\n\n";
    static const char cube[] = "-1\0-1\0-1\0008";
    const unsigned char magic[2] = {(283 + 4) >> 8, (283 + 4) & 255}, tail[6] = {0};
    octree->size = 0;
    put_bytes(octree, head, sizeof head - 1);
    put_bytes(octree, magic, sizeof magic);
    put_bytes(octree, cube, sizeof cube);
    put_bytes(octree, name, strlen(name) + 1);
    put_bytes(octree, tail, sizeof tail);
}

void grove_init(struct grove *grove, size_t triangles, size_t rounds, size_t places)
{
    grove_init_with(grove, triangles, rounds, places, GROVE_MATT);
}

void grove_init_with(struct grove *grove, size_t triangles, size_t rounds, size_t places,
                     enum grove_leaves leaves)
{
    grove->tree = make_tree(triangles, rounds, leaves);
    grove->shared = make_scene(places, true);
    grove->expanded = make_scene(places, false);
    make_octree(&grove->octree, "tree.rad");
    make_octree(&grove->pair, "pair.rad");
}

void grove_done(struct grove *grove)
{
    free(grove->tree);
    free(grove->shared);
    free(grove->expanded);
}

struct orl_parsed_scene grove_read(const struct grove *grove, const char *scene)
{
    static const char *const names[] = {"scene.rad", "tree.rad", "tree.oct",
                                        "once.rad",  "pair.rad", "pair.oct"};
    const struct orl_file contents[] = {{scene, strlen(scene), NULL},
                                        {grove->tree, strlen(grove->tree), NULL},
                                        {grove->octree.data, grove->octree.size, NULL},
                                        {once, sizeof once - 1, NULL},
                                        {pair, sizeof pair - 1, NULL},
                                        {grove->pair.data, grove->pair.size, NULL}};
    struct orl_memory_files memory = {names, contents, 6};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene d;
    struct orl_error err = {0};
    if (orl_scene_parse(names, 1, &files, &d, &err) < 0)
        fail_msg("%s:%d: %s (%s)", err.file, err.line, err.message, err.hint);
    return d;
}

static void write_file(const char *folder, const char *name, const char *data, size_t size)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(data, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

void grove_write(const struct grove *grove, const char *folder)
{
    write_file(folder, "tree.rad", grove->tree, strlen(grove->tree));
    write_file(folder, "tree.oct", grove->octree.data, grove->octree.size);
    write_file(folder, "once.rad", once, sizeof once - 1);
    write_file(folder, "shared.rad", grove->shared, strlen(grove->shared));
    write_file(folder, "expanded.rad", grove->expanded, strlen(grove->expanded));
}
