/*
 * Decides if light from one incident cell has been sampled enough. Cells out are joined as in a
 * tree (builder.h) if the data do not distinguish them, and the rest is examined. The error that
 * counts is that of the cells joined into one. Paths are thus sent until the next subdivision would
 * have shown any differences.
 */
#ifndef ORL_BSDF_MAKE_TREES_CONVERGENCE_H
#define ORL_BSDF_MAKE_TREES_CONVERGENCE_H

#include "bsdf/make/trees/tree_builder.h"

/* Result for one component. */
struct orl_gonio_convergence {
    double peak;      /* largest cell, 1/sr */
    double max_error; /* largest relative error of a cell whose value is at least `from` */
};

/* Joins 4^levels cells, numbered as in probe.h. The cells are overwritten. */
struct orl_gonio_convergence orl_gonio_test_convergence(struct orl_gonio_cells cells,
                                                        unsigned levels,
                                                        const struct orl_gonio_cull *cull,
                                                        double from);

#endif
