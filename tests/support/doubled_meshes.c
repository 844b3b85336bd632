/*
 * OBJ files with and without obj2rad rules, STL and glTF files, and lamp tables.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <sodium.h>

#include "support/doubled.h"

/* Writes two more triangles for each place along a strip. */
static void write_obj_faces(FILE *f, size_t n)
{
    for (size_t i = 0; i <= n; i++)
        fprintf(f, "v %zu 0 0\nv %zu 1 0\n", i, i);
    for (size_t i = 1; i <= n; i++)
        fprintf(f, "f %zu %zu %zu %zu\n", 2 * i - 1, 2 * i + 1, 2 * i + 2, 2 * i);
}
static void write_obj_names(FILE *f, size_t n)
{
    fputs("v 0 0 0\nv 1 0 0\nv 1 1 0\n", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "o o%zu\ng a%zu b%zu\nusemtl m\nf 1 2 3\n", i, i, i);
}
/* Writes corners on a circle, every other one out of its plane, optionally with normals. */
static void write_corners(FILE *f, size_t n, double height, const char *normal)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "v %.9g %.9g %.9g\n", cos(6.283185307 * (double)i / (double)n),
                sin(6.283185307 * (double)i / (double)n), (double)(i % 2) * height);
    fprintf(f, "vn .3 0 1\nf");
    for (size_t i = 1; i <= n; i++)
        fprintf(f, " %zu%s", i, normal);
    fputs("\n", f);
}
static void write_obj_bent(FILE *f, size_t n)
{
    write_corners(f, n, .1, "");
}
static void write_obj_turned(FILE *f, size_t n)
{
    write_corners(f, n, 0, "//1");
}
static void write_obj_blanks(FILE *f, size_t n)
{
    fprintf(f, "v %*s0 0 0\n", (int)n, "");
    for (size_t i = 0; i < n; i++)
        fputs("# x\n\n", f);
}
static void write_rules(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "m (Group \"g%zu\") (Face [%zu:%zu]);\n", i, i, i + 2);
}
static void write_stl_text(FILE *f, size_t n)
{
    fputs("solid x\n", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "facet normal 0 0 1\nouter loop\nvertex %zu 0 0\nvertex %zu 1 0\nvertex %zu 0 1\n"
                "endloop\nendfacet\n",
                i, i, i);
    fputs("endsolid x\n", f);
}
static void write_stl_binary(FILE *f, size_t n)
{
    const char head[80] = "binary";
    const uint32_t count = (uint32_t)n;
    fwrite(head, 1, sizeof head, f);
    fwrite(&count, 1, sizeof count, f);
    for (size_t i = 0; i < n; i++) {
        const float at = (float)i;
        const float facet[12] = {0, 0, 1, at, 0, 0, at, 1, 0, at, 0, 1};
        fwrite(facet, 1, sizeof facet, f);
        fwrite("\0", 1, 2, f);
    }
}

/* ---- glTF ------------------------------------------------------------------------------------ */

/* Writes n corners, x y z in a strip, and the numbers from 0 on, in an embedded buffer. Accessors:
 * 0 the corners, 1 the numbers, 2 corners that are all 0 except those. more: nodes and meshes. */
static void write_gltf(FILE *f, size_t n, const char *more)
{
    const size_t size = 16 * n, room = sodium_base64_ENCODED_LEN(size, 1);
    float *const data = malloc(size);
    char *const text = malloc(room);
    uint32_t *const numbers = (uint32_t *)(data + 3 * n);
    if (!data || !text)
        abort();
    for (size_t i = 0; i < n; i++) {
        data[3 * i] = (float)(i / 2);
        data[3 * i + 1] = (float)(i % 2);
        data[3 * i + 2] = 0;
        numbers[i] = (uint32_t)i;
    }
    sodium_bin2base64(text, room, (const unsigned char *)data, size, 1);
    fprintf(f,
            "{\"asset\": {\"version\": \"2.0\"}, %s, \"buffers\": [{\"byteLength\": %zu, \"uri\": "
            "\"data:;base64,%s\"}], \"bufferViews\": [{\"buffer\": 0, \"byteLength\": %zu}, "
            "{\"buffer\": 0, \"byteOffset\": %zu, \"byteLength\": %zu}], \"accessors\": ["
            "{\"bufferView\": 0, \"componentType\": 5126, \"count\": %zu, \"type\": \"VEC3\"}, "
            "{\"bufferView\": 1, \"componentType\": 5125, \"count\": %zu, \"type\": \"SCALAR\"}, "
            "{\"componentType\": 5126, \"count\": %zu, \"type\": \"VEC3\", \"sparse\": {\"count\": "
            "%zu, \"indices\": {\"bufferView\": 1, \"componentType\": 5125}, \"values\": "
            "{\"bufferView\": 0}}}]}",
            more, size, text, 12 * n, 12 * n, 4 * n, n, n, n, n);
    free(data);
    free(text);
}
#define STRIP(corners)                                                                             \
    "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": " #corners "}, \"mode\": "     \
    "5}]}]"
static void write_gltf_strip(FILE *f, size_t n)
{
    write_gltf(f, n, "\"nodes\": [{\"mesh\": 0}], " STRIP(0));
}
static void write_gltf_apart(FILE *f, size_t n)
{
    write_gltf(f, n, "\"nodes\": [{\"mesh\": 0}], " STRIP(2));
}
/* Writes as many copies of a quad at the origin as the buffer has corners. */
static void write_gltf_copies(FILE *f, size_t n)
{
    write_gltf(f, n,
               "\"nodes\": [{\"mesh\": 0, \"extensions\": {\"EXT_mesh_gpu_instancing\": "
               "{\"attributes\": {\"TRANSLATION\": 0}}}}], \"meshes\": [{\"primitives\": "
               "[{\"attributes\": {\"POSITION\": 0}, \"mode\": 1}]}]");
}
/* Writes n nodes nested by tens, each with its own mesh and material. */
static void write_gltf_nodes(FILE *f, size_t n)
{
    char *more = NULL;
    size_t size = 0;
    FILE *const m = open_memstream(&more, &size);
    if (!m)
        abort();
    fputs("\"nodes\": [{}", m);
    for (size_t i = 1; i <= n; i++)
        fprintf(m, ", {\"mesh\": %zu%s%zu%s}", i - 1,
                i % 10 ? ", \"children\": [" : ", \"skin\": ", i + 1, i % 10 ? "]" : "");
    fputs(", {}], \"meshes\": [", m);
    for (size_t i = 0; i < n; i++)
        fprintf(m,
                "%s{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"mode\": 6, "
                "\"material\": %zu}]}",
                i > 0 ? ", " : "", i);
    fputs("], \"materials\": [", m);
    for (size_t i = 0; i < n; i++)
        fprintf(m, "%s{\"name\": \"m %zu\"}", i > 0 ? ", " : "", i);
    fputs("]", m);
    fclose(m);
    write_gltf(f, 4, more);
    free(more);
}

/* ---- Tables of lamps ------------------------------------------------------------------------- */

/* Only the last line has the luminaire's words. */
static void write_lamps(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "# %zu\n\n/[a-c]no such *lamp %zu/ .3 .3 .9\n", i, i);
    fputs("/wanted lamp/ .3 .3 .9\n", f);
}
/* Writes lines that each refer to the one before, starting with the last line. */
static void write_lamps_named(FILE *f, size_t n)
{
    fputs("/lamp 0$/ .3 .3 .9\n", f);
    for (size_t i = 1; i < n; i++)
        fprintf(f, "/lamp %zu$/ (lamp %zu)\n", i, i - 1);
    fprintf(f, "/wanted lamp/ (lamp %zu)\n", n - 1);
}

#define KIND(name, kind, n)                                                                        \
    {                                                                                              \
#name, DOUBLED_##kind, n, write_##name, 0                                                  \
    }
const struct doubled doubled_meshes[] = {
    KIND(obj_faces, OBJ, 500),    KIND(obj_names, OBJ, 500),     KIND(obj_bent, OBJ, 2000),
    KIND(obj_turned, OBJ, 2000),  KIND(obj_blanks, OBJ, 20000),  KIND(rules, RULES, 1000),
    KIND(stl_text, STL, 500),     KIND(stl_binary, STL, 500),    KIND(gltf_strip, GLTF, 1000),
    KIND(gltf_apart, GLTF, 1000), KIND(gltf_copies, GLTF, 400),  KIND(gltf_nodes, GLTF, 300),
    KIND(lamps, LAMPS, 1000),     KIND(lamps_named, LAMPS, 400),
};
const size_t doubled_n_meshes = sizeof doubled_meshes / sizeof *doubled_meshes;
