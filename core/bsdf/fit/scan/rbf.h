/*
 * Interpolant of one scan.
 *
 * A quadtree over the hemisphere (equal_area_square.h) groups rows. A cell is divided if at least
 * three of its quarters hold rows; two are enough for a few rows of very different values. The tree
 * thus follows the density of rows in both directions, also if rows are dense along lines that are
 * far apart. Each leaf is a center: mean direction and mean value of its rows, and a radius, that
 * of its cell. The value anywhere is the mean of the coefficients of the nearest centers, weighted
 * by a Gaussian of each center's radius. Coefficients are corrected towards an interpolant that has
 * the centers' values (normalised radial functions; Shepard 1968, Moody and Darken 1989). In gaps
 * and towards grazing the nearest centers extrapolate.
 *
 * Outliers. A row is left out if it is alone in differing from its neighbours: by more than 12
 * times their spread, and by a factor of five from each of them. A single row could not say how
 * wide its peak is. Rows near the straight direction are kept.
 *
 * Immutable once made; any number of threads may read. Ownership: the caller's, freed by _done.
 */
#ifndef ORL_BSDF_FIT_SCAN_RBF_H
#define ORL_BSDF_FIT_SCAN_RBF_H

#include "bsdf/fit/measurements/rows.h"

enum { ORL_FIT_NEIGHBOURS = 12 };

struct orl_fit_center {
    float x, y, z;
    float coefficient, value;
    float narrowness; /* 1 / (2 radius^2) */
    uint32_t code;    /* code of the cell, at the finest level */
    uint32_t level;
    uint32_t first, rows; /* range of its rows, in the order set by orl_fit_rbf_make */
};

struct orl_bsdf_outlier;

struct orl_fit_rbf {
    struct orl_fit_center *centers; /* in the order of codes; owned, like all pointers below */
    uint32_t
        *neighbors; /* [center][ORL_FIT_NEIGHBOURS]: itself and its neighbours, nearest first */
    uint32_t *tree; /* centers in the order of a kd-tree */
    unsigned char *axes; /* dividing axis of each range of the tree, stored at its middle */
    size_t n, n_outliers, n_rows;
    double noise;      /* standard deviation of a row's noise in dark regions, 1/sr */
    double hidden_rad; /* angle from straight to the nearest center if that is in a gap; else 0 */
    double covered;    /* share of the hemisphere within a center's reach, weighted by cosine */
};

/* Options, and room for outliers in the order of centers. Making centers reorders the rows. */
struct orl_fit_rbf_options {
    bool keep_outliers;
    struct orl_bsdf_outlier *outliers; /* room for `most` entries */
    size_t most;
    const atomic_bool *cancel;
};

/* Returns 0, ORL_ERR_INVALID (too few rows, or too little of the hemisphere covered), ORL_ERR_NOMEM
 * or ORL_ERR_CANCELLED. */
int orl_fit_rbf_make(struct orl_fit_scan *scan, const struct orl_fit_rbf_options *options,
                     struct orl_fit_rbf *ret_rbf, struct orl_error *err);
void orl_fit_rbf_done(struct orl_fit_rbf *centers);

/* Returns the value in a direction, 1/sr, at least 0. */
double orl_fit_rbf_value(const struct orl_fit_rbf *centers, struct orl_vec3 direction);

#endif
