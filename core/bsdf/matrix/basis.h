/*
 * Angle bases of BSDF matrices. The hemisphere is cut into rings of constant polar angle, each ring
 * into equal cells. The first cell of a ring is centred on azimuth 0 (the x axis). Klems, J. H., "A
 * new method for predicting the solar heat gain of complex fenestration systems", ASHRAE
 * Transactions 100(1), 1994.
 *
 * Invariants: rings follow each other without gap from the pole outwards; every cell has a positive
 * projected solid angle. A basis is plain data and may be copied.
 */
#ifndef ORL_BSDF_MATRIX_BASIS_H
#define ORL_BSDF_MATRIX_BASIS_H

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

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

#endif
