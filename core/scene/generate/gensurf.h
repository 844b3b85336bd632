/*
 * What the parts of gensurf share: a surface by functions of s and t, which run from 0 to 1, as a
 * grid of vertices, row by row of s.
 */
#ifndef ORL_SCENE_GENERATE_GENSURF_H
#define ORL_SCENE_GENERATE_GENSURF_H

#include "scene/generate/expressions.h"

/* Numbers of a file instead of expressions, between which those wanted lie: of z alone, or of all
 * three coordinates; at the grid's vertices, or in the middles of its fields. */
struct orl_gensurf_data {
    double *values; /* owned; s runs first */
    int n_s, n_t;
    size_t each; /* 3, or 1; 0: there are none */
    bool middles;
};

struct orl_gensurf_vertex {
    bool valid;
    int number, normal_number; /* in an OBJ file; 0: has no normal */
    struct orl_vec3 place;
    struct orl_vec3 normal; /* mean of what is around it; unit or 0 */
    double s, t;
};

struct orl_gensurf {
    const char *material, *name;
    int m, n; /* fields along s and t */
    bool smooth, object, inverted;
    bool checked; /* the last expression says which vertices there are */
    struct orl_generator_expressions expressions;
    struct orl_gensurf_data data;
    int n_vertices, n_normals, n_faces; /* written so far */
    struct orl_vec3 last_normal;        /* that was written */
};

/* The words; pass the surface to orl_gensurf_done, whatever comes of it. */
int orl_gensurf_read(struct orl_gensurf *surface, struct orl_words *words,
                     const struct orl_generator_files *files, struct orl_error *err);
void orl_gensurf_done(struct orl_gensurf *surface);

/* The vertex at (i / m, j / n), without a normal. */
int orl_gensurf_at(const struct orl_gensurf *surface, int i, int j,
                   struct orl_gensurf_vertex *ret_vertex, struct orl_error *err);

/* A field of the grid by its corners, as two triangles, or one polygon where they lie in a plane.
 * corners[1] and [2] are where both triangles meet. */
void orl_gensurf_add_field(struct orl_gensurf *surface,
                           const struct orl_gensurf_vertex *const corners[4],
                           struct orl_text *text);

#endif
