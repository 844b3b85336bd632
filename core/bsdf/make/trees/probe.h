/*
 * Measures light from one finest cell of a tensor tree's incident directions, counted by the finest
 * cells of directions out. Cells of a square are numbered by the interleaved bits of x and y, as in
 * trees: coarsest bits highest, each bit of x below that of y.
 */
#ifndef ORL_BSDF_MAKE_TREES_PROBE_H
#define ORL_BSDF_MAKE_TREES_PROBE_H

#include "bsdf/make/batch_mean.h"
#include "bsdf/make/panel/trace_panel.h"
#include "bsdf/make/trees/tree_builder.h"

struct orl_gonio_probe {
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
    uint64_t seed;
    unsigned rank, levels;     /* there are 2^levels cells a side */
    bool color;                /* true to count red, green and blue beside luma */
    bool front;                /* true if light comes from the front */
    const atomic_bool *cancel; /* may be NULL */
    /* Counts of one incident cell, by planes: luma, then the three of colour. Owned: */
    double *sums;  /* [plane][batch][transmitted][cell out] */
    double *pilot; /* [plane][transmitted][cell out]: sum of all batches put aside */
    double pilot_totals[ORL_GONIO_BATCHES][2]; /* weights put aside, summed over cells */
    float *max_weight;    /* [transmitted][cell out]: largest luma of a single path */
    uint32_t pilot_paths; /* paths in each batch put aside */
    double totals[ORL_GONIO_BATCHES][2]; /* shares, summed over all incident cells */
    double lost;
};

static inline size_t orl_gonio_probe_cells(const struct orl_gonio_probe *probe)
{
    return (size_t)1 << 2 * probe->levels;
}

/* Returns a direction of travel for incident cell a, z > 0; in rank 3 at the azimuth given by
 * u[1]. */
struct orl_vec3 orl_gonio_probe_direction(const struct orl_gonio_probe *probe, uint32_t a,
                                          const double u[2]);

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err);
void orl_gonio_probe_done(struct orl_gonio_probe *probe);

/* Sends paths `from` to `to` of each batch into incident cell a: a cell of the square in rank 4, a
 * ring in rank 3. If cancelled, it sends only some of them. */
void orl_gonio_probe_trace(struct orl_gonio_probe *probe, uint32_t a, uint32_t from, uint32_t to);
/* Puts the counts aside, after `paths` paths of each batch. New batches use other random numbers,
 * and only they give the errors of values (as in exit_histogram.h). */
void orl_gonio_probe_end_pilot(struct orl_gonio_probe *probe, uint32_t paths);
/* Fills ret_cells[transmitted * cells + cell out] with leaves, after `paths` paths of each
 * batch. */
void orl_gonio_probe_estimate(const struct orl_gonio_probe *probe, uint32_t paths,
                              struct orl_gonio_cells ret_cells);
/* orl_gonio_probe_finish_cell adds the sums to the totals, _drop discards them. Both prepare the
 * probe for another cell. */
void orl_gonio_probe_finish_cell(struct orl_gonio_probe *probe, uint32_t paths);
void orl_gonio_probe_clear(struct orl_gonio_probe *probe);

#endif
