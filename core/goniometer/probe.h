/*
 * Light from one finest cell of a tensor tree's incident directions, counted by the finest cells of
 * those it leaves to. Cells of a square are numbered by the bits of x and y in turn, the coarsest
 * on top, that of x below that of y: so do trees.
 */
#ifndef ORL_GONIOMETER_PROBE_H
#define ORL_GONIOMETER_PROBE_H

#include "goniometer/batches.h"
#include "goniometer/follow.h"
#include "goniometer/forest.h"

struct orl_gonio_probe {
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
    uint64_t seed;
    unsigned rank, levels; /* 2^levels cells a side */
    uint32_t paths;        /* in each batch */
    bool front;            /* light comes from there */
    /* What is counted; owned: */
    double *sums;                        /* [batch][transmitted][cell out], of one incident cell */
    double totals[ORL_GONIO_BATCHES][2]; /* of all incident cells: shares, summed */
    double lost;
};

static inline size_t orl_gonio_probe_cells(const struct orl_gonio_probe *probe)
{
    return (size_t)1 << 2 * probe->levels;
}

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err);
void orl_gonio_probe_done(struct orl_gonio_probe *probe);

/* Fills ret_nodes[transmitted * cells + cell out] with the leaves of incident cell a: of rank 4 one
 * of the square, of rank 3 a ring. */
void orl_gonio_probe_measure(struct orl_gonio_probe *probe, uint32_t a,
                             struct orl_gonio_node *ret_nodes);

#endif
