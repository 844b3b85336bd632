/* BSDF matrices and their angle bases. */
#ifndef ORL_BSDF_MATRIX_MATRIX_H
#define ORL_BSDF_MATRIX_MATRIX_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

#include "bsdf/tree/tree.h"

/*
 * Angle bases of BSDF matrices. The hemisphere is cut into rings of constant polar angle, each ring
 * into equal cells. The first cell of a ring is centred on azimuth 0 (the x axis). Klems, J. H., "A
 * new method for predicting the solar heat gain of complex fenestration systems", ASHRAE
 * Transactions 100(1), 1994.
 *
 * Invariants: rings follow each other without gap from the pole outwards; every cell has a positive
 * projected solid angle. A basis is plain data and may be copied.
 */

enum { ORL_BASIS_RINGS_MAX = 64, ORL_BASIS_CELLS_MAX = 2048, ORL_BASIS_NAME_MAX = 64 };

struct orl_theta_ring {
    double cos2_low, cos2_high; /* squared cosine at the inner and the outer edge: low > high */
    int cells, first; /* cells: number in azimuth; first: index of the ring's first cell */
    double omega_sr;  /* projected solid angle of one cell, sr */
};

struct orl_basis {
    char name[ORL_BASIS_NAME_MAX];
    struct orl_theta_ring rings[ORL_BASIS_RINGS_MAX];
    int n_rings, n_cells;
    double outer_deg; /* polar angle at which the next ring must begin, degrees */
};

/* Finds a standard basis by its name; case is ignored. Returns 0 or ORL_ERR_NOT_FOUND. */
int orl_basis_standard(const char *name, struct orl_basis *ret_basis);

/* Sets an empty basis. Rings are then added from the pole outwards; add_ring returns 0,
 * ORL_ERR_LIMIT or ORL_ERR_RANGE. */
void orl_basis_init(struct orl_basis *basis, const char *name);
int orl_basis_add_ring(struct orl_basis *basis, double lower_deg, double upper_deg, double cells,
                       struct orl_error *err);

/* A direction in the coordinates of the bases, which are the same on both sides of the surface. */
struct orl_polar {
    double cos2; /* squared cosine of the polar angle */
    double turn; /* azimuth in turns, -0.5 to 0.5 */
};
struct orl_polar orl_polar_of(struct orl_vec3 direction);

/* Returns the cell of a direction or, if turned, of the direction half a turn about the axis away.
 * -1: outside the basis. */
int orl_basis_cell(const struct orl_basis *basis, struct orl_polar place, int turned);

/* Returns the ring of a cell. */
const struct orl_theta_ring *orl_basis_ring(const struct orl_basis *basis, int cell);

/* Returns a direction with z > 0 in a cell, uniform in projected solid angle for uniform u. It
 * keeps 1e-9 of the cell away from the border. */
struct orl_vec3 orl_basis_direction(const struct orl_basis *basis, int cell, double u0, double u1);

/*
 * A BSDF matrix: one value per pair of cells of two angle bases. Direction A is the file's incident
 * one (its x and y negated before look-up, as the light travels), B its exitant one.
 *
 * Sampling uses cumulative sums in double per given cell. They never decrease; a cell of weight
 * zero has zero width and is never chosen. Immutable once finished; any number of threads may read.
 */

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
void orl_matrix_done(struct orl_matrix *matrix); /* a partly built matrix is allowed */
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
