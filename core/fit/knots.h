/*
 * The interpolant of one scan.
 *
 * Rows are gathered by a quadtree over the hemisphere (square.h) that goes on where at least three
 * of a cell's quarters hold rows: so it follows the density of rows in both directions, and rows
 * that lie thick along a line but far from the next line count as what they are. Each leaf is a
 * knot: mean direction and mean value of its rows, and a radius, that of its cell. The value
 * anywhere is the mean of the coefficients of the nearest knots, weighted by a Gaussian of each
 * knot's radius; coefficients are corrected until the interpolant has the knots' values
 * (normalised radial functions; Shepard 1968, Moody and Darken 1989). In gaps and towards grazing
 * it is what the nearest knots say.
 *
 * Outliers. A row that stands alone, by more than 12 times the spread of its neighbours and five
 * times what any of them has, is left out, but for those in the straight direction. Alone it could
 * not tell how wide what it saw is.
 *
 * Immutable once made; any number of threads may read. Ownership: the caller's, _done.
 */
#ifndef ORL_FIT_KNOTS_H
#define ORL_FIT_KNOTS_H

#include "fit/rows.h"

enum { ORL_FIT_NEIGHBOURS = 12 };

struct orl_fit_knot {
    float x, y, z;
    float coefficient, value;
    float narrowness; /* 1 / (2 radius^2) */
    uint32_t code;    /* of the cell, at the finest level */
    uint32_t level;
    uint32_t first, rows; /* of the rows in their order, which making them sets */
};

struct orl_bsdf_outlier;

struct orl_fit_knots {
    struct orl_fit_knot *knots; /* in the order of codes; owned, as all below */
    uint32_t *near;      /* [knot][ORL_FIT_NEIGHBOURS]: itself and those around, nearest first */
    uint32_t *tree;      /* knots as a search tree */
    unsigned char *axes; /* what halves a stretch of the tree, by its middle */
    size_t n, n_outliers, n_rows;
    double noise; /* 1/sr: of a row where it is dark */
    double
        hidden_rad; /* how far the nearest knot is from the straight direction, if in a gap; or 0 */
    double covered; /* share of the hemisphere, by cosine, within a knot's reach */
};

/* What is found of outliers, in the order of files and lines; rows are put in another order. */
struct orl_fit_making {
    bool keep_outliers;
    struct orl_bsdf_outlier *outliers; /* room for most */
    size_t most;
    const atomic_bool *cancel;
};

/* 0, ORL_ERR_INVALID (too few rows, or none but in a plane), ORL_ERR_NOMEM, ORL_ERR_CANCELLED. */
int orl_fit_knots_make(struct orl_fit_scan *scan, const struct orl_fit_making *making,
                       struct orl_fit_knots *ret_knots, struct orl_error *err);
void orl_fit_knots_done(struct orl_fit_knots *knots);

/* The value in a direction, 1/sr, at least 0. */
double orl_fit_knots_value(const struct orl_fit_knots *knots, struct orl_vec3 direction);

#endif
