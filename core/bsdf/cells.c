/* Cells of directions that the data distinguish; the transmission matrix by these cells. */
#include <stdlib.h>

#include "bsdf/bsdf_internal.h"
#include "bsdf/tree/shirley.h"

/* Returns the depth of the component's tree or of its colour, whichever is finer. */
static unsigned depth_of(const struct orl_component *c)
{
    return c->tree.depth > c->chroma.depth ? c->tree.depth : c->chroma.depth;
}

static unsigned rings_of(const struct orl_component *c)
{
    return c->iso.half > c->chroma.rings ? c->iso.half : c->chroma.rings;
}

size_t orl_view_cells(const struct orl_bsdf *bsdf, const struct orl_component_view *view)
{
    if (!view->component)
        return 0;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return (size_t)1 << 2 * depth_of(view->component);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return rings_of(view->component);
    return (size_t)view->component->matrix.basis[orl_view_axis(view, ORL_ROLE_IN)].n_cells;
}

static struct orl_vec3 tree_incident(unsigned depth, size_t cell, double *ret_omega_sr)
{
    const size_t side = (size_t)1 << depth;
    const double width = 2.0 / (double)side;
    *ret_omega_sr = ORL_PI / (double)(side * side);
    return orl_square_to_hemisphere(
        (struct orl_square){((double)(cell >> depth) + 0.5) * width - 1,
                            ((double)(cell & (side - 1)) + 0.5) * width - 1});
}

/* Returns the middle of a ring, at azimuth 0 (x axis); all azimuths are equivalent. */
static struct orl_vec3 iso_incident(unsigned rings, size_t ring, double *ret_omega_sr)
{
    const double sine = ((double)ring + 0.5) / rings;
    *ret_omega_sr = ORL_PI * (2.0 * (double)ring + 1) / ((double)rings * rings);
    return orl_v3(sine, 0, sqrt(1 - sine * sine));
}

struct orl_vec3 orl_view_incident(const struct orl_bsdf *bsdf,
                                  const struct orl_component_view *view, size_t cell, bool front,
                                  double *ret_omega_sr)
{
    const enum orl_tree_axis axis = orl_view_axis(view, ORL_ROLE_IN);
    const double sign = axis == ORL_AXIS_A ? -1 : 1;
    const struct orl_basis *basis = &view->component->matrix.basis[axis];
    struct orl_vec3 in;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4) {
        in = tree_incident(depth_of(view->component), cell, ret_omega_sr);
    } else if (bsdf->document.structure == ORL_STRUCTURE_TREE3) {
        in = iso_incident(rings_of(view->component), cell, ret_omega_sr);
    } else {
        in = orl_basis_direction(basis, (int)cell, 0.5, 0.5);
        *ret_omega_sr = orl_basis_ring(basis, (int)cell)->omega_sr;
    }
    return orl_v3(sign * in.x, sign * in.y, front ? in.z : -in.z);
}

double orl_view_omega(const struct orl_bsdf *bsdf, const struct orl_component_view *view,
                      struct orl_vec3 in, struct orl_vec3 out)
{
    const struct orl_component *c = view->component;
    const struct orl_basis *basis;
    struct orl_coords a, b;
    unsigned level;
    int cell;
    if (!c)
        return 0;
    a = orl_coords_of(bsdf->document.structure, view->transposed ? out : in);
    b = orl_coords_of(bsdf->document.structure, view->transposed ? in : out);
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4) {
        orl_tree_eval_level(&c->tree, a.square, b.square, &level);
        return ORL_PI / (double)((size_t)1 << 2 * level);
    }
    if (bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return ORL_PI / (4.0 * c->iso.half * c->iso.half);
    basis = &c->matrix.basis[orl_view_axis(view, ORL_ROLE_OUT)];
    cell = orl_basis_cell(basis, view->transposed ? a.polar : b.polar, view->transposed);
    return cell < 0 ? 0 : orl_basis_ring(basis, cell)->omega_sr;
}

/* ---- Transmission matrix, as used by the three-phase method ---------------------------------- */

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
                             "the three-phase method needs a BSDF with a transmission matrix");
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
