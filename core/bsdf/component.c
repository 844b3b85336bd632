/* One component: dispatches to its kind of data. */
#include "bsdf/document.h"

const char *const orl_component_names[ORL_COMPONENT_COUNT] = {
    "Transmission Front", "Transmission Back", "Reflection Front", "Reflection Back"};

double orl_component_eval(enum orl_structure structure, const struct orl_component *c,
                          const struct orl_coords *a, const struct orl_coords *b)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return orl_tree_eval(&c->tree, a->square, b->square);
    if (structure == ORL_STRUCTURE_TREE3)
        return orl_iso_eval(&c->iso, a->disk, b->disk);
    return orl_matrix_eval(&c->matrix, a->polar, b->polar);
}

double orl_component_total(enum orl_structure structure, const struct orl_component *c,
                           enum orl_tree_axis given, const struct orl_coords *coords)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return orl_tree_total(&c->tree, given, coords->square);
    if (structure == ORL_STRUCTURE_TREE3)
        return orl_iso_total(&c->iso, given, coords->disk);
    return orl_matrix_total(&c->matrix, given, coords->polar);
}

double orl_component_sample(enum orl_structure structure, const struct orl_component *c,
                            enum orl_tree_axis given, const struct orl_coords *coords,
                            const double u[2], struct orl_vec3 *ret_other)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return orl_tree_sample(&c->tree, given, coords->square, u, ret_other);
    if (structure == ORL_STRUCTURE_TREE3)
        return orl_iso_sample(&c->iso, given, coords->disk, u, ret_other);
    return orl_matrix_sample(&c->matrix, given, coords->polar, u, ret_other);
}

size_t orl_component_bytes(enum orl_structure structure, const struct orl_component *c)
{
    const size_t extra = orl_chroma_bytes(&c->chroma) + orl_peak_bytes(&c->peak);
    if (structure == ORL_STRUCTURE_TREE4)
        return c->tree.n_lines * sizeof *c->tree.lines + extra;
    if (structure == ORL_STRUCTURE_TREE3)
        return orl_iso_bytes(&c->iso) + extra;
    return orl_matrix_bytes(&c->matrix) + extra;
}

size_t orl_component_values(enum orl_structure structure, const struct orl_component *c)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return c->tree.values;
    if (structure == ORL_STRUCTURE_TREE3)
        return c->iso.leaves;
    return (size_t)c->matrix.basis[ORL_AXIS_A].n_cells *
           (size_t)c->matrix.basis[ORL_AXIS_B].n_cells;
}

int orl_component_resolution(enum orl_structure structure, const struct orl_component *c)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return 1 << c->tree.depth;
    if (structure == ORL_STRUCTURE_TREE3)
        return 2 * (int)c->iso.half;
    return c->matrix.basis[ORL_AXIS_A].n_cells;
}

size_t orl_component_clamped(enum orl_structure structure, const struct orl_component *c)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return c->tree.clamped;
    return structure == ORL_STRUCTURE_TREE3 ? c->iso.clamped : c->matrix.clamped;
}

void orl_component_done(struct orl_component *component)
{
    orl_tree_done(&component->tree);
    orl_iso_done(&component->iso);
    orl_matrix_done(&component->matrix);
    orl_chroma_done(&component->chroma);
    orl_peak_done(&component->peak);
    component->present = false;
}
