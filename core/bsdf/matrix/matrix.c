#include "bsdf/matrix/matrix.h"

#include <stdlib.h>
#include <string.h>

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
    if (!m)
        return;
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
