/*
 * A BSDF matrix: one value per pair of cells of two angle bases. Direction A is the file's
 * incident one (its x and y negated before look-up, as the light travels), B its exitant one.
 *
 * Draws use exact cumulative sums in double per given cell: they never fall, and a cell of weight
 * zero has zero width and is never drawn. Immutable once finished; any number of threads may read.
 */
#ifndef ORL_BSDF_MATRIX_H
#define ORL_BSDF_MATRIX_H

#include <stdbool.h>
#include <stddef.h>

#include "bsdf/basis.h"
#include "bsdf/tree.h"

struct orl_matrix {
    struct orl_basis basis[2]; /* by enum orl_tree_axis */
    float *values;             /* a * cells of B + b; owned */
    double *cumulative[2];     /* per given cell, over the cells of the other axis; owned */
    double *total[2];          /* per given cell: sum of value times projected solid angle; owned */
    size_t clamped;
    float minimum;
};

/* Copies the bases and makes room for the values, which the caller then fills. */
int orl_matrix_init(struct orl_matrix *matrix, const struct orl_basis *a, const struct orl_basis *b,
                    struct orl_error *err);
/* Builds sums and minimum from the values. */
int orl_matrix_finish(struct orl_matrix *matrix, struct orl_error *err);
void orl_matrix_done(struct orl_matrix *matrix); /* NULL and half-built are allowed */
/* The same values over the same rings. */
bool orl_matrix_equal(const struct orl_matrix *matrix, const struct orl_matrix *other);
size_t orl_matrix_bytes(const struct orl_matrix *matrix);

/* Where a pair of directions has its value: a * cells of B + b. -1 outside the bases. */
ptrdiff_t orl_matrix_index(const struct orl_matrix *matrix, struct orl_polar a, struct orl_polar b);
/* The cell of a direction; -1 outside. */
int orl_matrix_cell(const struct orl_matrix *matrix, enum orl_tree_axis axis,
                    struct orl_polar place);
/* Whether two matrices have the same cells, and whether one has the same for both directions. */
bool orl_matrix_is_alike(const struct orl_matrix *matrix, const struct orl_matrix *other);
bool orl_matrix_is_square(const struct orl_matrix *matrix);

/* As the functions of the same names in tree.h; zero outside the bases. */
double orl_matrix_eval(const struct orl_matrix *matrix, struct orl_polar a, struct orl_polar b);
double orl_matrix_total(const struct orl_matrix *matrix, enum orl_tree_axis given,
                        struct orl_polar place);
double orl_matrix_draw(const struct orl_matrix *matrix, enum orl_tree_axis given,
                       struct orl_polar place, const double u[2], struct orl_vec3 *ret_direction);

#endif
