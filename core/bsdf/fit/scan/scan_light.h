/*
 * Light of one scan: the hemisphere as a square of equal solid angles, the scan's interpolant by
 * radial functions, the search for its nearest centers, and its lobes.
 */
#ifndef ORL_BSDF_FIT_SCAN_SCAN_LIGHT_H
#define ORL_BSDF_FIT_SCAN_SCAN_LIGHT_H

#include <stdint.h>

#include "bsdf/fit/measurements/measurements.h"
#include "bsdf/tree/shirley.h"

/*
 * Hemisphere as a square of equal solid angles: the map of Shirley and Chiu after stretching the
 * disk's radius by sqrt(2) sin(theta / 2). All cells have the same solid angle. They are numbered
 * in Morton order, so cells of a quadtree are ranges of numbers.
 */

enum { ORL_FIT_SQUARE_LEVELS = 14 }; /* cells of 0.01 degrees */

/* Returns the side in radians of a cell at a level, as if it were square. */
static inline double orl_fit_cell_rad(unsigned level)
{
    return sqrt(2 * ORL_PI) / (double)(UINT32_C(1) << level);
}
static inline double orl_fit_cell_sr(unsigned level)
{
    return 2 * ORL_PI / (double)(UINT64_C(1) << 2 * level);
}

/* Returns the direction of a place on the square; x and y from 0 to 1. */
static inline struct orl_vec3 orl_fit_from_square(double x, double y)
{
    const struct orl_vec3 d = orl_square_to_hemisphere((struct orl_square){2 * x - 1, 2 * y - 1});
    const double r2 = d.x * d.x + d.y * d.y, stretch = sqrt(orl_larger(0, 2 - r2));
    return orl_v3(d.x * stretch, d.y * stretch, orl_larger(0, 1 - r2));
}

/* Returns the number of a direction's cell at the finest level. Numbers in a coarser cell begin
 * with the same bits. */
static inline uint32_t orl_fit_morton_code(struct orl_vec3 d)
{
    const double shrink = 1 / sqrt(1 + orl_larger(d.z, 0));
    const struct orl_square s = orl_disk_to_square(d.x * shrink, d.y * shrink);
    return orl_morton_spread(orl_square_index(s.x, 1U << ORL_FIT_SQUARE_LEVELS)) |
           orl_morton_spread(orl_square_index(s.y, 1U << ORL_FIT_SQUARE_LEVELS)) << 1;
}

/*
 * Interpolant of one scan by radial basis functions.
 *
 * A quadtree over the hemisphere groups rows. A cell is divided if at least three of its quarters
 * hold rows; two are enough for a few rows of very different values. The tree thus follows the
 * density of rows in both directions, also if rows are dense along lines that are far apart. Each
 * leaf is a center: mean direction and mean value of its rows, and a radius, that of its cell. The
 * value anywhere is the mean of the coefficients of the nearest centers, weighted by a Gaussian of
 * each center's radius. Coefficients are corrected towards an interpolant that has the centers'
 * values (normalised radial functions; Shepard 1968, Moody and Darken 1989). In gaps and towards
 * grazing the nearest centers extrapolate.
 *
 * Outliers. A row is left out if it is alone in differing from its neighbours: by more than 12
 * times their spread, and by a factor of five from each of them. A single row could not say how
 * wide its peak is. Rows near the straight direction are kept.
 *
 * Immutable once made; any number of threads may read. Ownership: the caller's, freed by _done.
 */

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

/* Options, and an array for outliers in the order of centers. Making centers reorders the rows. */
struct orl_fit_rbf_options {
    bool keep_outliers;
    struct orl_bsdf_outlier *outliers; /* array of `most` entries */
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

/*
 * Search for the nearest centers by a kd-tree over their places (Friedman, Bentley and Finkel
 * 1977). The tree is an array in which the middle of every range divides it.
 */

struct orl_fit_nearest {
    uint32_t center[ORL_FIT_NEIGHBOURS];
    float distance2[ORL_FIT_NEIGHBOURS]; /* squared chords, ascending */
    unsigned count;
};

/* Orders centers->tree and sets its axes. */
void orl_fit_kd_tree_build(struct orl_fit_rbf *centers);
void orl_fit_kd_tree_find(const struct orl_fit_rbf *centers, struct orl_vec3 place,
                          struct orl_fit_nearest *ret_found);

/*
 * Light of a scan as lobes that can be moved. A lobe is a Gaussian whose mass is a share of the
 * incident light.
 *
 * Three parts add up to the interpolant. The floor is the same in all directions out. The broad
 * part is the interpolant's morphological opening by a disc of 8 degrees, less the floor. The
 * narrow part is the rest. The parts change differently between incident directions, so each is
 * transported separately. Otherwise a sharp peak would receive light from its surroundings, which
 * costs less than moving the peak.
 *
 * Lobes are the leaves of a quadtree, which is divided where a leaf would misplace more than a
 * fixed share of the light. Clusters are ranges of lobes with a limited share of the mass;
 * transport plans are between clusters.
 *
 * Immutable once made. Ownership: the caller's, freed by orl_fit_shape_done.
 */

enum orl_fit_kind { ORL_FIT_BROAD, ORL_FIT_NARROW, ORL_FIT_KINDS };

struct orl_fit_lobe {
    float x, y, z, mass, sigma_rad;
    uint32_t cluster, code, level;
    float target; /* target for the sum of all lobes in its middle, above the floor, 1/sr */
};

struct orl_fit_cluster {
    float x, y, z, mass, sigma_rad; /* sigma: standard deviation of its light */
};

struct orl_fit_part {
    struct orl_fit_lobe *lobes;       /* in the order of codes; owned */
    struct orl_fit_cluster *clusters; /* owned */
    size_t n_lobes, n_clusters, capacity, cluster_capacity;
    double mass;
};

struct orl_fit_shape {
    struct orl_vec3 in;
    double floor; /* constant value in all directions, 1/sr; its mass is pi times that */
    struct orl_fit_part parts[ORL_FIT_KINDS];
    double total, total_error; /* share of the light, and its standard error */
    struct orl_vec3 peak;
    double peak_value;
};

/* levels: of lobes in bright regions, at most 7, and of the smallest lobes. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_fit_shape_make(const struct orl_fit_rbf *centers, struct orl_vec3 in,
                       const unsigned levels[2], const atomic_bool *cancel,
                       struct orl_fit_shape *ret_shape, struct orl_error *err);
void orl_fit_shape_done(struct orl_fit_shape *shape);

/* Corrects the blur of Gaussians. Masses are changed until the sum of all lobes has the target
 * values, by Richardson (1972) and Lucy (1974), which keeps masses positive. The total light is
 * unchanged. Returns false if out of memory. */
bool orl_fit_deconvolve(struct orl_fit_shape *shape);

/* Copies a shape mirrored in x (bit 0), y (bit 1), or both. Returns false if out of memory. */
bool orl_fit_shape_mirror(const struct orl_fit_shape *shape, unsigned mirror,
                          struct orl_fit_shape *ret_shape);

#endif
