/*
 * A BSDF matrix: one value per pair of cells of two angle bases. Direction A is the file's incident
 * one (its x and y negated before look-up, as the light travels), B its exitant one.
 *
 * Sampling uses cumulative sums in double per given cell. They never decrease; a cell of weight
 * zero has zero width and is never chosen. Immutable once finished; any number of threads may read.
 */
#ifndef ORL_BSDF_MATRIX_MATRIX_H
#define ORL_BSDF_MATRIX_MATRIX_H

#include <stdbool.h>
#include <stddef.h>

#include "bsdf/matrix/basis.h"
#include "bsdf/tree/tree.h"

struct orl_matrix {
    struct orl_basis basis[2]; /* indexed by enum orl_tree_axis */
    float *values;             /* index: a * cells of B + b; owned */
    double *cumulative[2]; /* running sums per given cell, over the cells of the other axis, ending
                              in 1; owned */
    double *total[2];      /* per given cell: sum of value times projected solid angle; owned */
    size_t clamped;
    float minimum;
};

/* Copies the bases and allocates the values, which the caller then fills. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_matrix_init(struct orl_matrix *matrix, const struct orl_basis *a, const struct orl_basis *b,
                    struct orl_error *err);
/* Builds sums and minimum from the values. Returns 0 or ORL_ERR_NOMEM. */
int orl_matrix_finish(struct orl_matrix *matrix, struct orl_error *err);
void orl_matrix_done(struct orl_matrix *matrix); /* NULL and a partly built matrix are allowed */
/* Returns true if both have the same rings and the same values. */
bool orl_matrix_equal(const struct orl_matrix *matrix, const struct orl_matrix *other);
size_t orl_matrix_bytes(const struct orl_matrix *matrix);

/* Returns the index of a pair of directions in values: a * cells of B + b. -1: outside the
 * bases. */
ptrdiff_t orl_matrix_index(const struct orl_matrix *matrix, struct orl_polar a, struct orl_polar b);
/* Returns the cell of a direction; -1: outside the basis. */
int orl_matrix_cell(const struct orl_matrix *matrix, enum orl_tree_axis axis,
                    struct orl_polar place);
/* is_alike: true if both matrices have the same cells. is_square: true if A and B have the same
 * cells. */
bool orl_matrix_is_alike(const struct orl_matrix *matrix, const struct orl_matrix *other);
bool orl_matrix_is_square(const struct orl_matrix *matrix);

/* Like the functions of the same names in tree.h; zero outside the bases. */
double orl_matrix_eval(const struct orl_matrix *matrix, struct orl_polar a, struct orl_polar b);
double orl_matrix_total(const struct orl_matrix *matrix, enum orl_tree_axis given,
                        struct orl_polar place);
double orl_matrix_sample(const struct orl_matrix *matrix, enum orl_tree_axis given,
                         struct orl_polar place, const double u[2], struct orl_vec3 *ret_direction);

#endif
