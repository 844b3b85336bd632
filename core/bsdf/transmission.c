/* Transmission matrix of a matrix BSDF, as used by the three-phase method. */
#include <stdlib.h>

#include "bsdf/bsdf_internal.h"

/* Returns the middle of a cell in the file's numbering. Incident directions are negated, because
 * cells hold them as the light travels. */
static struct orl_vec3 middle_of(const struct orl_basis *basis, size_t cell, bool incident)
{
    const struct orl_vec3 d = orl_basis_direction(basis, (int)cell, 0.5, 0.5);
    return incident ? orl_neg(d) : d;
}

int orl_bsdf_transmission(const struct orl_bsdf *bsdf, size_t *ret_rows, size_t *ret_columns,
                          float **ret_values, struct orl_error *err)
{
    const struct orl_component_view *view = &bsdf->views[0][1];
    if (bsdf->document.structure != ORL_STRUCTURE_MATRIX || !view->component)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "the three-phase method takes BSDFs with a matrix of transmission");
    const struct orl_basis *in = &view->component->matrix.basis[orl_view_axis(view, ORL_ROLE_IN)];
    const struct orl_basis *out = &view->component->matrix.basis[orl_view_axis(view, ORL_ROLE_OUT)];
    const size_t rows = (size_t)out->n_cells, columns = (size_t)in->n_cells;
    float *values = malloc(rows * columns * 3 * sizeof *values);
    if (!values)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a BSDF's matrix");
    for (size_t c = 0; c < columns; c++) {
        const struct orl_vec3 from = middle_of(in, c, true);
        const double omega = orl_basis_ring(in, (int)c)->omega_sr;
        for (size_t r = 0; r < rows; r++) {
            const struct orl_rgb f = orl_bsdf_eval(bsdf, from, middle_of(out, r, false));
            float *at = values + 3 * (r * columns + c);
            at[0] = (float)(f.r * omega);
            at[1] = (float)(f.g * omega);
            at[2] = (float)(f.b * omega);
        }
    }
    *ret_rows = rows;
    *ret_columns = columns;
    *ret_values = values;
    return 0;
}
