/*
 * Density estimation of irradiance: from the photons nearest to a point of a surface, and by a
 * kernel that spreads each photon over its own disc.
 *
 * A photon counts if it landed on the same sheet of surface (orl_same_sheet). So no light is
 * gathered through a wall or from a parallel surface. It must also lie within the point's footprint
 * (footprint.h), so that no light is gathered past a wall that stands on the surface. The estimate
 * over k neighbours is (sum of the nearest k-1 fluxes) / A. A is the footprint's area within the
 * distance of the k-th: pi r_k^2 without obstructions. It is unbiased for uniform density, up to
 * edges and into corners. With fewer than k photons within the maximum radius it is all of them
 * over the area for that radius.
 *
 * The disc is searched first; a few rays test whether it is cut. Only then the footprint is
 * computed, to twice the disc's radius, within which the quarter of a disc in a corner holds about
 * k. If it holds too few photons, it is computed again to the maximum radius.
 *
 * Reference: Jensen 2001, chapter 7.
 */
#ifndef ORL_PHOTON_DENSITY_DENSITY_ESTIMATE_H
#define ORL_PHOTON_DENSITY_DENSITY_ESTIMATE_H

#include <oriel/base/input_checks.h>

#include "photon/map/map.h"
#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

enum { ORL_SEARCH_MOST = 4096, ORL_SEARCH_SPARSE = 8 };

struct orl_search_candidate {
    float distance2;
    uint32_t index;
};

/* Patches that an adaptive estimate counts as wholes (nested_discs.h), in columns. */
struct orl_whole_patches {
    float distance2[2 * ORL_SEARCH_MOST], ramp[2 * ORL_SEARCH_MOST];
    uint32_t count[2 * ORL_SEARCH_MOST], patch[2 * ORL_SEARCH_MOST];
};

/* Scratch memory, one per thread, zero at first; big enough for k = ORL_SEARCH_MOST. */
struct orl_search {
    struct orl_search_candidate candidates[2 * ORL_SEARCH_MOST];
    struct orl_whole_patches whole_patches;
    struct orl_health health;  /* counters of the thread */
    unsigned char padding[64]; /* padding against false sharing in arrays of these */
};

struct orl_density_query {
    struct orl_vec3 point;  /* moved coordinates */
    struct orl_vec3 normal; /* unit, towards the lit side */
    uint32_t k;             /* 1 .. ORL_SEARCH_MOST */
    double max_radius;
    /* adaptive estimates: disc of a neighbouring estimate (orl_density.disc); 0: unknown */
    double hint;
    bool hint_cut; /* the neighbouring estimate's disc was cut */
    /* the query point is photon `skip`: exclude it from the estimate, because it would otherwise
     * be counted in every query at a photon */
    bool at_photon;
    uint32_t skip;
    const struct orl_surface_point
        *surface_point; /* the point's surface; NULL: taken to be infinite */
};

struct orl_density {
    struct orl_rgb irradiance; /* W/m2 */
    double radius;             /* radius of the part of the footprint used */
    double area;               /* area of that part */
    double clearance;          /* distance to the nearest wall, at most `radius` */
    double disc;               /* adaptive estimates: the disc that was searched, for query.hint */
    bool patch;                /* kernel estimates: a small patch was counted as a whole */
    /* the estimate is unreliable. Leaves: the place is occluded in the near field; adaptive
     * estimates: few photons; records: they do not determine the light at the point. */
    bool unreliable;
    bool cut;        /* adaptive estimates: the footprint is not the whole disc */
    double evenness; /* adaptive estimates: radius over that of the widest disc tried */
    uint32_t found;  /* number of photons used */
    /* Errors of the irradiance's luma. */
    double standard_error; /* standard error from the photons' scatter */
    double bias;           /* estimated bias of the bandwidth; > 0: the irradiance is too high */
    double spread;         /* records: standard deviation of their values */
    struct orl_batches parts;
};

struct orl_density orl_density_estimate(const struct orl_photon_map *map,
                                        const struct orl_density_query *query,
                                        struct orl_search *search);

/*
 * Returns the bias of that estimate. Where light is curved, the bias is proportional to the area.
 * So it follows from the difference to an estimate over twice the area (half the area if twice is
 * not allowed). Only the part of the difference beyond its scatter counts.
 */
double orl_density_bias(const struct orl_photon_map *map, const struct orl_density_query *query,
                        const struct orl_density *estimate, struct orl_search *search);

/*
 * Finds the nearest photons of the query's sheet, without an occlusion test, for query points that
 * are not photons, as with records. They are the first of search->candidates, unsorted: up to k - 1
 * within *ret_radius, which is the distance of the next one; or all within max_radius. Returns
 * their number.
 */
uint32_t orl_density_nearest(const struct orl_photon_map *map,
                             const struct orl_density_query *query, struct orl_search *search,
                             double *ret_radius);

/*
 * Kernel density estimation: every photon is spread evenly over its own disc. The disc's size
 * follows the density where the photon landed, so that it holds about k photons.
 *
 * A photon spreads exactly its flux, whatever the sizes: light is neither created nor lost. The
 * nearest-neighbour estimate above does not have this property. Beside a sun patch its discs extend
 * to the patch's many photons and shrink when they find them. The dark side reads several times too
 * bright there, half a percent of the light in a sunny room.
 *
 * All photons of a leaf have one radius, from the median of their distances to their centre and
 * those of neighbouring leaves. Walls and edges are taken from the footprint of the query point
 * (footprint.h): the remaining area of the disc for each radius.
 *
 * Reference: Silverman 1986, section 5.3 (the adaptive kernel method); Abramson 1982.
 */

struct orl_kernel_density;

/* Builds the estimator. k: photons in a disc. Borrows the map. Returns NULL if out of memory or the
 * pool is cancelled. */
struct orl_kernel_density *orl_kernel_density_new(const struct orl_photon_map *map, uint32_t k,
                                                  double max_radius, struct orl_thread_pool *pool);
void orl_kernel_density_free(struct orl_kernel_density *kernel_density); /* NULL is allowed */

/* Replaces the map by another copy of it, which is borrowed. */
void orl_kernel_density_rebind(struct orl_kernel_density *kernel_density,
                               const struct orl_photon_map *map);
uint64_t
orl_kernel_density_bytes(const struct orl_kernel_density *kernel_density); /* memory, bytes */

/* Returns a photon's kernel radius, m, which is the usual one where it landed. */
double orl_kernel_density_radius(const struct orl_kernel_density *kernel_density, uint32_t photon);

/* Returns the irradiance at the query's point; ignores the query's k and max_radius. */
struct orl_density orl_kernel_density_estimate(const struct orl_kernel_density *kernel_density,
                                               const struct orl_density_query *query,
                                               struct orl_search *search);

#endif
