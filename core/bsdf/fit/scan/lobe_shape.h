/*
 * Light of a scan as lobes that can be moved. A lobe is a Gaussian whose mass is a share of the
 * incident light.
 *
 * Three parts add up to the interpolant (centers.h). The floor is the same in all directions out.
 * The broad part is the interpolant's morphological opening by a disc of 8 degrees, less the floor.
 * The narrow part is the rest. Each part changes between incident directions in its own way, so
 * each is transported separately. Otherwise light of a sharp peak would be filled up from its
 * surroundings, which is cheaper than moving it.
 *
 * Lobes are the leaves of a quadtree (equal_area_square.h), which is divided where a leaf would
 * misplace more than a fixed share of the light. Clusters are ranges of lobes with a limited share
 * of the mass; transport plans are between clusters.
 *
 * Immutable once made. Ownership: the caller's, freed by orl_fit_shape_done.
 */
#ifndef ORL_BSDF_FIT_SCAN_LOBE_SHAPE_H
#define ORL_BSDF_FIT_SCAN_LOBE_SHAPE_H

#include "bsdf/fit/scan/rbf.h"

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
