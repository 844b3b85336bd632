/*
 * Shared by genrev and genworm: expressions (expressions.h) of t, which goes from 0 to 1 in even
 * steps.
 */
#ifndef ORL_SCENE_GENERATE_CURVED_CURVED_H
#define ORL_SCENE_GENERATE_CURVED_CURVED_H

#include "scene/generate/solid/solids.h"

enum { ORL_CURVE_EXPRESSIONS_MAX = 4 };

struct orl_generator_curve {
    const char *material, *name;
    int segments;
    bool smooth; /* -s */
    struct orl_generator_expressions expressions;
};

/* Reads all words of the command: material, name, n expressions, segments and options. The caller
 * passes curve->expressions to orl_expressions_done in every case. may_smooth: the option -s is
 * allowed. */
int orl_curve_read(struct orl_generator_curve *curve, struct orl_words *words, size_t n,
                   bool may_smooth, const struct orl_generator_files *files, struct orl_error *err);

/* Returns the expressions' values at t = step / segments; ORL_ERR_RANGE unless all are finite. */
int orl_curve_at(const struct orl_generator_curve *curve, int step,
                 double ret_values[ORL_CURVE_EXPRESSIONS_MAX], struct orl_error *err);

/*
 * Shared by the parts of gensurf: a surface by functions of s and t, which go from 0 to 1, as a
 * grid of vertices, row by row of s.
 */

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
