/*
 * Interpolant of one scan.
 *
 * A quadtree over the hemisphere (square.h) groups rows. A cell is divided if at least three of its
 * quarters hold rows; two are enough for a few rows of very different values. The tree thus follows
 * the density of rows in both directions, also if rows are dense along lines that are far apart.
 * Each leaf is a knot: mean direction and mean value of its rows, and a radius, that of its cell.
 * The value anywhere is the mean of the coefficients of the nearest knots, weighted by a Gaussian
 * of each knot's radius. Coefficients are corrected towards an interpolant that has the knots'
 * values (normalised radial functions; Shepard 1968, Moody and Darken 1989). In gaps and towards
 * grazing the nearest knots extrapolate.
 *
 * Outliers. A row is left out if it is alone in differing from its neighbours: by more than 12
 * times their spread, and by a factor of five from each of them. A single row could not say how
 * wide its peak is. Rows near the straight direction are kept.
 *
 * Immutable once made; any number of threads may read. Ownership: the caller's, freed by _done.
 */
#ifndef ORL_FIT_KNOTS_H
#define ORL_FIT_KNOTS_H

#include "fit/rows.h"

enum { ORL_FIT_NEIGHBOURS = 12 };

struct orl_fit_knot {
    float x, y, z;
    float coefficient, value;
    float narrowness; /* 1 / (2 radius^2) */
    uint32_t code;    /* code of the cell, at the finest level */
    uint32_t level;
    uint32_t first, rows; /* range of its rows, in the order set by orl_fit_knots_make */
};

struct orl_bsdf_outlier;

struct orl_fit_knots {
    struct orl_fit_knot *knots; /* in the order of codes; owned, like all pointers below */
    uint32_t *near;      /* [knot][ORL_FIT_NEIGHBOURS]: itself and its neighbours, nearest first */
    uint32_t *tree;      /* knots in the order of a kd-tree */
    unsigned char *axes; /* dividing axis of each range of the tree, stored at its middle */
    size_t n, n_outliers, n_rows;
    double noise;      /* standard deviation of a row's noise in dark regions, 1/sr */
    double hidden_rad; /* angle from straight to the nearest knot if that is in a gap; else 0 */
    double covered;    /* share of the hemisphere within a knot's reach, weighted by cosine */
};

/* Options, and room for outliers in the order of knots. Making knots reorders the rows. */
struct orl_fit_making {
    bool keep_outliers;
    struct orl_bsdf_outlier *outliers; /* room for `most` entries */
    size_t most;
    const atomic_bool *cancel;
};

/* Returns 0, ORL_ERR_INVALID (too few rows, or too little of the hemisphere covered), ORL_ERR_NOMEM
 * or ORL_ERR_CANCELLED. */
int orl_fit_knots_make(struct orl_fit_scan *scan, const struct orl_fit_making *making,
                       struct orl_fit_knots *ret_knots, struct orl_error *err);
void orl_fit_knots_done(struct orl_fit_knots *knots);

/* Returns the value in a direction, 1/sr, at least 0. */
double orl_fit_knots_value(const struct orl_fit_knots *knots, struct orl_vec3 direction);

#endif
