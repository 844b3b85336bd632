/* Directions that the data distinguish, and the cells that belong to them. */
#include "bsdf/bsdf_internal.h"
#include "bsdf/tree/shirley.h"

/* Colour may be finer than luminance. */
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

/* All azimuths are equivalent; the direction returned has azimuth 0 (x axis). */
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
