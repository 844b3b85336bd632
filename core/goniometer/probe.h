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
    unsigned rank, levels;     /* 2^levels cells a side */
    bool color;                /* red, green and blue beside luma */
    bool front;                /* light comes from there */
    const atomic_bool *cancel; /* may be NULL */
    /* What is counted, of one incident cell, by planes: of luma, and the three of colour. Owned: */
    double *sums;   /* [plane][batch][transmitted][cell out] */
    double *before; /* [plane][transmitted][cell out], of all batches put aside */
    double totals_before[ORL_GONIO_BATCHES][2]; /* weights that were put aside, of all cells */
    float *heaviest;       /* luma that one path alone brought: [transmitted][cell out] */
    uint32_t paths_before; /* in each batch that was put aside */
    double totals[ORL_GONIO_BATCHES][2]; /* of all incident cells: shares, summed */
    double lost;
};

static inline size_t orl_gonio_probe_cells(const struct orl_gonio_probe *probe)
{
    return (size_t)1 << 2 * probe->levels;
}

/* A direction that light of incident cell a travels in, z > 0; of rank 3 at any azimuth, by u[1].
 */
struct orl_vec3 orl_gonio_probe_travel(const struct orl_gonio_probe *probe, uint32_t a,
                                       const double u[2]);

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err);
void orl_gonio_probe_done(struct orl_gonio_probe *probe);

/* Sends paths from .. to of each batch into incident cell a: of rank 4 one of the square, of rank 3
 * a ring. When it is cancelled, some of them. */
void orl_gonio_probe_send(struct orl_gonio_probe *probe, uint32_t a, uint32_t from, uint32_t to);
/* Puts aside what is counted, after that many of each batch; these begin anew, by other numbers,
 * and alone tell the errors of values (as in sheet.h). */
void orl_gonio_probe_put_aside(struct orl_gonio_probe *probe, uint32_t paths);
/* After that many of each batch: fills ret_cells[transmitted * cells + cell out] with leaves. */
void orl_gonio_probe_tell(const struct orl_gonio_probe *probe, uint32_t paths,
                          struct orl_gonio_cells ret_cells);
/* Adds the sums to the totals, or drops them; then another cell may come. */
void orl_gonio_probe_settle(struct orl_gonio_probe *probe, uint32_t paths);
void orl_gonio_probe_drop(struct orl_gonio_probe *probe);

#endif
