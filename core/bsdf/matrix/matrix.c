#include "bsdf/matrix/matrix.h"

#include <stdlib.h>
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
        return orl_error_set(err, ORL_ERR_LIMIT, "angle basis '%s' has no cells, or more than %d",
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

int orl_matrix_init(struct orl_matrix *matrix, const struct orl_basis *a, const struct orl_basis *b,
                    struct orl_error *err)
{
    const size_t count = (size_t)a->n_cells * (size_t)b->n_cells;
    memset(matrix, 0, sizeof *matrix);
    matrix->basis[ORL_AXIS_A] = *a;
    matrix->basis[ORL_AXIS_B] = *b;
    matrix->values = calloc(count, sizeof *matrix->values);
    if (!matrix->values)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF matrix");
    return 0;
}

static float value_at(const struct orl_matrix *m, enum orl_tree_axis given, int cell, int other)
{
    const size_t columns = (size_t)m->basis[ORL_AXIS_B].n_cells;
    const size_t a = (size_t)(given == ORL_AXIS_A ? cell : other);
    const size_t b = (size_t)(given == ORL_AXIS_A ? other : cell);
    return m->values[a * columns + b];
}

/* Computes the running sums over the other axis for one given cell, scaled to end in exactly 1.
 * Returns their unscaled total. */
static double accumulate(const struct orl_matrix *m, enum orl_tree_axis given, int cell,
                         double *row)
{
    const struct orl_basis *other = &m->basis[1 - given];
    double sum = 0;
    for (int i = 0; i < other->n_cells; i++) {
        sum += (double)value_at(m, given, cell, i) * orl_basis_ring(other, i)->omega_sr;
        row[i] = sum;
    }
    for (int i = 0; i < other->n_cells && sum > 0; i++)
        row[i] /= sum;
    return sum;
}

int orl_matrix_finish(struct orl_matrix *m, struct orl_error *err)
{
    const size_t cells[2] = {(size_t)m->basis[0].n_cells, (size_t)m->basis[1].n_cells};
    m->minimum = m->values[0];
    for (size_t i = 1; i < cells[0] * cells[1]; i++)
        if (m->values[i] < m->minimum)
            m->minimum = m->values[i];
    for (int given = 0; given < 2; given++) {
        m->cumulative[given] = calloc(cells[0] * cells[1], sizeof **m->cumulative);
        m->total[given] = calloc(cells[given], sizeof **m->total);
        if (!m->cumulative[given] || !m->total[given])
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF matrix");
        for (size_t c = 0; c < cells[given]; c++)
            m->total[given][c] = accumulate(m, (enum orl_tree_axis)given, (int)c,
                                            m->cumulative[given] + c * cells[1 - given]);
    }
    return 0;
}

void orl_matrix_done(struct orl_matrix *m)
{
    free(m->values);
    for (int given = 0; given < 2; given++) {
        free(m->cumulative[given]);
        free(m->total[given]);
    }
    memset(m, 0, sizeof *m);
}

static bool same_rings(const struct orl_basis *a, const struct orl_basis *b)
{
    if (a->n_rings != b->n_rings || a->n_cells != b->n_cells)
        return false;
    for (int i = 0; i < a->n_rings; i++)
        if (a->rings[i].cells != b->rings[i].cells ||
            a->rings[i].cos2_high != b->rings[i].cos2_high)
            return false;
    return true;
}

bool orl_matrix_is_alike(const struct orl_matrix *m, const struct orl_matrix *other)
{
    return same_rings(&m->basis[0], &other->basis[0]) && same_rings(&m->basis[1], &other->basis[1]);
}

bool orl_matrix_equal(const struct orl_matrix *m, const struct orl_matrix *other)
{
    const size_t count =
        (size_t)m->basis[ORL_AXIS_A].n_cells * (size_t)m->basis[ORL_AXIS_B].n_cells;
    return orl_matrix_is_alike(m, other) &&
           !memcmp(m->values, other->values, count * sizeof *m->values);
}

size_t orl_matrix_bytes(const struct orl_matrix *m)
{
    const size_t a = (size_t)m->basis[0].n_cells, b = (size_t)m->basis[1].n_cells;
    return a * b * (sizeof(float) + 2 * sizeof(double)) + (a + b) * sizeof(double);
}

int orl_matrix_cell(const struct orl_matrix *m, enum orl_tree_axis axis, struct orl_polar place)
{
    return orl_basis_cell(&m->basis[axis], place, axis == ORL_AXIS_A);
}

bool orl_matrix_is_square(const struct orl_matrix *m)
{
    return same_rings(&m->basis[ORL_AXIS_A], &m->basis[ORL_AXIS_B]);
}

ptrdiff_t orl_matrix_index(const struct orl_matrix *m, struct orl_polar a, struct orl_polar b)
{
    const int cell_a = orl_matrix_cell(m, ORL_AXIS_A, a),
              cell_b = orl_matrix_cell(m, ORL_AXIS_B, b);
    if (cell_a < 0 || cell_b < 0)
        return -1;
    return (ptrdiff_t)cell_a * m->basis[ORL_AXIS_B].n_cells + cell_b;
}

double orl_matrix_eval(const struct orl_matrix *m, struct orl_polar a, struct orl_polar b)
{
    const ptrdiff_t index = orl_matrix_index(m, a, b);
    return index < 0 ? 0 : (double)m->values[index];
}

double orl_matrix_total(const struct orl_matrix *m, enum orl_tree_axis given,
                        struct orl_polar place)
{
    const int cell = orl_matrix_cell(m, given, place);
    return cell < 0 ? 0 : m->total[given][cell];
}

double orl_matrix_sample(const struct orl_matrix *m, enum orl_tree_axis given,
                         struct orl_polar place, const double u[2], struct orl_vec3 *ret_direction)
{
    const struct orl_basis *other = &m->basis[1 - given];
    const int cell = orl_matrix_cell(m, given, place);
    const double *row = m->cumulative[given] + (size_t)cell * (size_t)other->n_cells;
    const double sign = given == ORL_AXIS_A ? 1 : -1;
    int low = 0, high = other->n_cells - 1;
    double below, rest;
    while (low < high) { /* the first cell whose running sum exceeds u */
        const int middle = (low + high) / 2;
        if (row[middle] > u[0])
            high = middle;
        else
            low = middle + 1;
    }
    below = low > 0 ? row[low - 1] : 0;
    rest = (u[0] - below) / (row[low] - below);
    *ret_direction = orl_basis_direction(other, low, rest < 1 ? rest : 1, u[1]);
    ret_direction->x *= sign;
    ret_direction->y *= sign;
    return (double)value_at(m, given, cell, low);
}
