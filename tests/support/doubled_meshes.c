/*
 * OBJ files, with rules of obj2rad and without, and STL files.
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "support/doubled.h"

/* Two triangles more for each place along a strip. */
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
/* Corners on a circle, every other one out of its plane, and with normals, too. */
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

#define KIND(name, kind, n)                                                                        \
    {                                                                                              \
#name, DOUBLED_##kind, n, write_##name, 0                                                  \
    }
const struct doubled doubled_meshes[] = {
    KIND(obj_faces, OBJ, 500),   KIND(obj_names, OBJ, 500),    KIND(obj_bent, OBJ, 2000),
    KIND(obj_turned, OBJ, 2000), KIND(obj_blanks, OBJ, 20000), KIND(rules, RULES, 1000),
    KIND(stl_text, STL, 500),    KIND(stl_binary, STL, 500),
};
const size_t doubled_n_meshes = sizeof doubled_meshes / sizeof *doubled_meshes;
