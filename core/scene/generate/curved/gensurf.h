/*
 * Shared by the parts of gensurf: a surface by functions of s and t, which go from 0 to 1, as a
 * grid of vertices, row by row of s.
 */
#ifndef ORL_SCENE_GENERATE_CURVED_GENSURF_H
#define ORL_SCENE_GENERATE_CURVED_GENSURF_H

#include "scene/generate/curved/expressions.h"

/* Numbers from a file in place of expressions, interpolated: z only, or all three coordinates; at
 * the grid's vertices, or at the centres of its cells. */
struct orl_gensurf_data {
    double *values; /* owned; s changes fastest */
    int n_s, n_t;
    size_t each; /* 3, or 1; 0: no file */
    bool middles;
};

struct orl_gensurf_vertex {
    bool valid;
    int number, normal_number; /* numbers in an OBJ file; 0: no normal */
    struct orl_vec3 place;
    struct orl_vec3 normal; /* average over its neighbourhood; unit or 0 */
    double s, t;
};

struct orl_gensurf {
    const char *material, *name;
    int m, n; /* cells along s and t */
    bool smooth, object, inverted;
    bool checked; /* the last expression says which vertices exist */
    struct orl_generator_expressions expressions;
    struct orl_gensurf_data data;
    int n_vertices, n_normals, n_faces; /* numbers written so far */
    struct orl_vec3 last_normal;        /* last one written */
};

/* Reads the words. The caller passes the surface to orl_gensurf_done in every case. */
int orl_gensurf_read(struct orl_gensurf *surface, struct orl_words *words,
                     const struct orl_generator_files *files, struct orl_error *err);
void orl_gensurf_done(struct orl_gensurf *surface);

/* Computes the vertex at (i / m, j / n), without a normal. */
int orl_gensurf_at(const struct orl_gensurf *surface, int i, int j,
                   struct orl_gensurf_vertex *ret_vertex, struct orl_error *err);

/* Adds a cell of the grid by its corners: two triangles, or one polygon if they are coplanar.
 * corners[1] and [2] are the triangles' common edge. */
void orl_gensurf_add_field(struct orl_gensurf *surface,
                           const struct orl_gensurf_vertex *const corners[4],
                           struct orl_text *text);

#endif
