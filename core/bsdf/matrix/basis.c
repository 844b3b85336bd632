#include "bsdf/matrix/basis.h"

#include <string.h>
#include <strings.h>

int orl_basis_standard(const char *name, struct orl_basis *ret_basis)
{
    /* Outer edges in degrees and cells per ring, as WINDOW and Radiance define them. */
    static const struct {
        const char *name;
        double outer[10];
        int cells[10];
    } standard[] = {
        {"LBNL/Klems Full",
         {5, 15, 25, 35, 45, 55, 65, 75, 90},
         {1, 8, 16, 20, 24, 24, 24, 16, 12}},
        {"LBNL/Klems Half", {6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90}, {1, 8, 12, 16, 20, 12, 8}},
        {"LBNL/Klems Quarter", {9, 27, 45, 63, 90}, {1, 8, 12, 12, 8}},
    };
    for (size_t i = 0; i < sizeof standard / sizeof *standard; i++) {
        double inner = 0;
        if (strcasecmp(name, standard[i].name) != 0)
            continue;
        orl_basis_init(ret_basis, standard[i].name);
        for (int r = 0; r < 10 && standard[i].cells[r] > 0; r++) {
            orl_basis_add_ring(ret_basis, inner, standard[i].outer[r], standard[i].cells[r], NULL);
            inner = standard[i].outer[r];
        }
        return 0;
    }
    return ORL_ERR_NOT_FOUND;
}

void orl_basis_init(struct orl_basis *basis, const char *name)
{
    memset(basis, 0, sizeof *basis);
    strncpy(basis->name, name, sizeof basis->name - 1);
}

/* Squared cosine, exact at the pole and the horizon. */
static double cos2_deg(double angle)
{
    const double c = cos(angle * ORL_DEG_TO_RAD);
    return angle >= 90 ? 0 : c * c;
}

int orl_basis_add_ring(struct orl_basis *basis, double lower_deg, double upper_deg, double cells,
                       struct orl_error *err)
{
    struct orl_theta_ring *ring = &basis->rings[basis->n_rings];
    if (basis->n_rings == ORL_BASIS_RINGS_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "angle basis '%s' has more than %d rings",
                             basis->name, ORL_BASIS_RINGS_MAX);
    if (!(cells >= 1 && cells <= ORL_BASIS_CELLS_MAX - basis->n_cells))
        return orl_error_set(err, ORL_ERR_LIMIT, "angle basis '%s' has no or more than %d cells",
                             basis->name, ORL_BASIS_CELLS_MAX);
    if (cells != floor(cells))
        return orl_error_set(err, ORL_ERR_RANGE, "nPhis is not a whole number");
    if (!(fabs(lower_deg - basis->outer_deg) < 1e-3) || !(upper_deg > lower_deg + 1e-3) ||
        !(upper_deg < 90 + 1e-3))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "ring %g to %g degrees does not continue the basis from %g to 90",
                             lower_deg, upper_deg, basis->outer_deg);
    ring->cos2_low = cos2_deg(basis->outer_deg);
    ring->cos2_high = cos2_deg(upper_deg);
    ring->cells = (int)cells;
    ring->first = basis->n_cells;
    ring->omega_sr = ORL_PI * (ring->cos2_low - ring->cos2_high) / ring->cells;
    basis->n_rings++;
    basis->n_cells += ring->cells;
    basis->outer_deg = upper_deg;
    return 0;
}

struct orl_polar orl_polar_of(struct orl_vec3 d)
{
    const double turn = atan2(d.y, d.x) / (2 * ORL_PI);
    return (struct orl_polar){d.z * d.z, turn == turn ? turn : 0};
}

int orl_basis_cell(const struct orl_basis *basis, struct orl_polar place, int turned)
{
    const double turn = turned ? place.turn + 0.5 : place.turn;
    for (int r = 0; r < basis->n_rings; r++) {
        const struct orl_theta_ring *ring = &basis->rings[r];
        if (place.cos2 >= ring->cos2_high) {
            const int cell = (int)(turn * ring->cells + 0.5 + ring->cells);
            return ring->first + cell % ring->cells;
        }
    }
    return -1;
}

const struct orl_theta_ring *orl_basis_ring(const struct orl_basis *basis, int cell)
{
    int r = 0;
    while (cell >= basis->rings[r].first + basis->rings[r].cells)
        r++;
    return &basis->rings[r];
}

struct orl_vec3 orl_basis_direction(const struct orl_basis *basis, int cell, double u0, double u1)
{
    const double margin = 0x1p-30;
    const struct orl_theta_ring *ring = orl_basis_ring(basis, cell);
    const double t0 = margin + u0 * (1 - 2 * margin), t1 = margin + u1 * (1 - 2 * margin);
    const double cos2 = ring->cos2_low + t0 * (ring->cos2_high - ring->cos2_low);
    const double azimuth = 2 * ORL_PI * (cell - ring->first + t1 - 0.5) / ring->cells;
    const double sine = sqrt(1 - cos2);
    return orl_v3(sine * cos(azimuth), sine * sin(azimuth), sqrt(cos2));
}
