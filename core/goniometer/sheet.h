/*
 * What came out of the panel, counted by cells of an angle basis: for light from either side, an
 * incident cell each, and in batches that are independent of each other. An item is an incident
 * cell on one side: front * cells + cell.
 *
 * Batches that told when to stop tell too small an error: they stopped when it looked small. So
 * they are put aside, others are measured, and these alone tell the errors of values. Those of
 * shares, which nobody looked at to stop, all batches tell.
 *
 * Ownership: the caller's, orl_gonio_sheet_done. While items are measured each is written to by one
 * thread.
 */
#ifndef ORL_GONIOMETER_SHEET_H
#define ORL_GONIOMETER_SHEET_H

#include "bsdf/basis.h"
#include "goniometer/batches.h"
#include "goniometer/follow.h"

struct orl_gonio_sheet {
    struct orl_basis basis;
    enum orl_bsdf_symmetry symmetry;
    size_t items, channels; /* channels: 3, or 1 of luma alone */
    bool exact;             /* read from a file: there is no chance in it */
    double *sums;           /* weights: [item][batch][transmitted][cell out][channel] */
    double *before;         /* of all batches that were put aside: without [batch] */
    double *totals_before;  /* the same by luma, of all cells: [item][batch][transmitted] */
    float *heaviest;        /* luma that one path alone brought: [item][transmitted][cell out] */
    double *lost;           /* weight given up, by item */
    uint32_t *paths;        /* in each batch, by item */
    uint32_t *paths_before; /* and of those put aside */
};

int orl_gonio_sheet_init(struct orl_gonio_sheet *sheet, const char *basis, bool color,
                         enum orl_bsdf_symmetry symmetry, struct orl_error *err);
void orl_gonio_sheet_done(struct orl_gonio_sheet *sheet);

/* What paths are sent by. */
struct orl_gonio_lamp {
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
    uint64_t seed;
    const atomic_bool *cancel; /* may be NULL */
};

/* Sends more paths in, until there are so many in each batch of the item; when it is cancelled the
 * sheet is of no more use. */
void orl_gonio_sheet_measure(struct orl_gonio_sheet *sheet, const struct orl_gonio_lamp *lamp,
                             size_t item, uint32_t paths);

/* Puts aside what is counted of an item; its batches begin anew, by other numbers. */
void orl_gonio_sheet_put_aside(struct orl_gonio_sheet *sheet, size_t item);

/* What is counted in a batch: weights, [cell out][channel]. */
double *orl_gonio_sheet_sums(const struct orl_gonio_sheet *sheet, size_t item, size_t batch,
                             bool transmitted);

/* The cell that mirrors make of a cell. */
int orl_gonio_mirrored(const struct orl_basis *basis, int cell, enum orl_bsdf_symmetry mirrors);

/*
 * A value that the sheet tells, of an item and a cell out: f in 1/sr, its error that of its luma. A
 * path more or less is known of no cell, however alike batches are: the error holds the heaviest
 * that came, or of a cell where none came, one that brings all of its light.
 */
struct orl_gonio_value {
    struct orl_rgb f;
    double error;
};
struct orl_gonio_value orl_gonio_sheet_value(const struct orl_gonio_sheet *sheet, size_t item,
                                             bool transmitted, int out);

/* All that is reflected, or transmitted, of light from the item's direction; or of diffuse light
 * from that side. By luma. */
struct orl_bsdf_share orl_gonio_sheet_share(const struct orl_gonio_sheet *sheet, size_t item,
                                            bool transmitted);
struct orl_bsdf_share orl_gonio_sheet_diffuse(const struct orl_gonio_sheet *sheet, bool front,
                                              bool transmitted);

#endif
