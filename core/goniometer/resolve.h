/*
 * Whether light from one incident cell has been followed far enough: cells out are joined where
 * nothing tells them apart, as a tree does it (forest.h), and what is left is looked at. A cell
 * that stands for several is told apart no better than these are known: so the error that counts is
 * theirs, and paths are sent until the next subdivision would have shown what there is.
 */
#ifndef ORL_GONIOMETER_RESOLVE_H
#define ORL_GONIOMETER_RESOLVE_H

#include "goniometer/forest.h"

/* What is seen of one component. */
struct orl_gonio_seen {
    double peak;  /* the largest cell, 1/sr */
    double worst; /* the largest share of an error in a cell from a value on */
};

/* cells: 4^levels of them, numbered as in probe.h; they are used up. */
struct orl_gonio_seen orl_gonio_resolve(struct orl_gonio_cells cells, unsigned levels,
                                        const struct orl_gonio_cull *cull, double from);

#endif
