/*
 * Light that left the panel, counted by cells of an angle basis. There are counts for incident
 * cells on both sides, in independent batches. An item is an incident cell on one side: front *
 * cells + cell.
 *
 * Batches used for the stopping rule underestimate the error, because they stopped when it appeared
 * small. They become the pilot, and the errors of values come from fresh batches. Errors of shares
 * are not used for stopping and come from all batches.
 *
 * Ownership: the caller's, freed by orl_gonio_histogram_done. Each item is measured by one thread
 * at a time.
 */
#ifndef ORL_BSDF_MAKE_KLEMS_EXIT_HISTOGRAM_H
#define ORL_BSDF_MAKE_KLEMS_EXIT_HISTOGRAM_H

#include "bsdf/make/panel/panel.h"
#include "bsdf/matrix/matrix.h"

struct orl_gonio_histogram {
    struct orl_basis basis;
    enum orl_bsdf_symmetry symmetry;
    size_t items, channels; /* channels: 3, or 1 for luma only */
    bool exact;             /* true if read from a file, without random errors */
    double *sums;           /* weights: [item][batch][transmitted][cell out][channel] */
    double *pilot;          /* sums of all pilot batches: like sums, without [batch] */
    double *pilot_totals;   /* pilot's luma, summed over cells: [item][batch][transmitted] */
    float *max_weight;      /* largest luma of a single path: [item][transmitted][cell out] */
    double *lost;           /* weight of paths that were cut, by item */
    uint32_t *paths;        /* in each batch, by item */
    uint32_t *pilot_paths;  /* paths of the pilot in each batch, by item */
};

int orl_gonio_histogram_init(struct orl_gonio_histogram *histogram, const char *basis, bool color,
                             enum orl_bsdf_symmetry symmetry, struct orl_error *err);
void orl_gonio_histogram_done(struct orl_gonio_histogram *histogram);

/* Sends paths until each batch of the item has `paths`. If cancelled, the histogram must be
 * discarded. */
void orl_gonio_histogram_measure(struct orl_gonio_histogram *histogram,
                                 const struct orl_gonio_measurement *measurement, size_t item,
                                 uint32_t paths);

/* Ends an item's pilot: adds its counts to the pilot's. New batches use other random numbers. */
void orl_gonio_histogram_end_pilot(struct orl_gonio_histogram *histogram, size_t item);

/* Returns the weights counted in a batch: [cell out][channel]. */
double *orl_gonio_histogram_sums(const struct orl_gonio_histogram *histogram, size_t item,
                                 size_t batch, bool transmitted);

/* Returns the mirror image of a cell. */
int orl_gonio_mirrored(const struct orl_basis *basis, int cell, enum orl_bsdf_symmetry mirrors);

/*
 * Value of an item and a cell out: f in 1/sr; error: standard error of its luma, 1/sr. The error
 * includes one path's weight, even if batches agree. It is the weight of the heaviest path or, in
 * an empty cell, the full weight.
 */
struct orl_gonio_value {
    struct orl_rgb f;
    double error;
};
struct orl_gonio_value orl_gonio_histogram_value(const struct orl_gonio_histogram *histogram,
                                                 size_t item, bool transmitted, int out);

/* Return the share reflected or transmitted, by luma: of light from the item's direction, or of
 * diffuse light from that side. */
struct orl_bsdf_share orl_gonio_histogram_share(const struct orl_gonio_histogram *histogram,
                                                size_t item, bool transmitted);
struct orl_bsdf_share orl_gonio_histogram_diffuse(const struct orl_gonio_histogram *histogram,
                                                  bool front, bool transmitted);

#endif
