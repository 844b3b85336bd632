/*
 * Density estimation: irradiance from the photons nearest to a point of a surface.
 *
 * A photon counts when it landed on the same sheet of surface (sheet.h), so that nothing is
 * gathered through a wall or from a parallel surface, and within the point's footprint
 * (footprint.h), so that nothing is gathered past a wall that stands on the surface. The estimate
 * over k neighbours is (sum of the nearest k-1 fluxes) / A, A the footprint's area within the
 * distance of the k-th: pi r_k^2 where nothing is in the way. It is unbiased for uniform density,
 * up to edges and into corners. With fewer than k within the largest radius it is all of them over
 * the largest area.
 *
 * The disc comes first, at the price of a few rays. Only where it is cut the footprint is made, to
 * twice the disc's radius (the quarter of a disc in a corner then holds about k), and, should it
 * hold too few photons, once more to the largest radius.
 *
 * Reference: Jensen 2001, chapter 7.
 */
#ifndef ORL_PHOTON_DENSITY_SEARCH_H
#define ORL_PHOTON_DENSITY_SEARCH_H

#include <oriel/health.h>

#include "photon/map/batches.h"
#include "photon/map/map.h"
#include "photon/surface/footprint.h"

enum { ORL_SEARCH_MOST = 4096, ORL_SEARCH_SPARSE = 8 };

struct orl_search_candidate {
    float distance2;
    uint32_t index;
};

/* What an adaptive estimate takes as wholes (disc_search.h), in columns: squared distances and so
 * on. */
struct orl_search_wholes {
    float distance2[2 * ORL_SEARCH_MOST], ramp[2 * ORL_SEARCH_MOST];
    uint32_t count[2 * ORL_SEARCH_MOST], patch[2 * ORL_SEARCH_MOST];
};

/* Scratch, one per thread, zero at first; big enough for k = ORL_SEARCH_MOST. */
struct orl_search {
    struct orl_search_candidate candidates[2 * ORL_SEARCH_MOST];
    struct orl_search_wholes wholes;
    struct orl_health health; /* what the thread counted */
    unsigned char apart[64];  /* lest a line of the cache be two threads' in an array of these */
};

struct orl_density_query {
    struct orl_vec3 point;  /* moved coordinates */
    struct orl_vec3 normal; /* unit, the lit side */
    uint32_t k;             /* 1 .. ORL_SEARCH_MOST */
    double max_radius;
    double hint;    /* of adaptive estimates: the disc that one close by searched; 0: not known */
    bool hint_cut;  /* and that one was cut */
    bool at_photon; /* the point is photon `skip`'s own, which is then left out: it would */
    uint32_t skip;  /* otherwise be counted wherever one asks about a photon's place */
    const struct orl_footing *footing; /* the point's surface; NULL: taken to be endless */
};

struct orl_density {
    struct orl_rgb irradiance; /* W/m2 */
    double radius;             /* of the part of the footprint used */
    double area;               /* of that part */
    double clear;              /* no wall is nearer; no more than radius */
    double disc;               /* of adaptive estimates: what was searched, for query.hint */
    bool patch;                /* of spread ones: it took in a small patch as a whole */
    bool crowded; /* not to be relied on: of leaves (crowd.h); of adaptive ones with few photons; of
                     records that tell little */
    bool cut;     /* of adaptive ones: the footprint is not the whole disc */
    double evenness; /* of adaptive estimates: radius over the widest that was tried */
    uint32_t found;  /* photons in it */
    /* Of the irradiance's luma: */
    double standard_error; /* of the photons' scatter */
    double bias;           /* what it is thought to be too high, for its width */
    double spread;         /* of records: how far they lie apart, as a standard deviation */
    struct orl_batches parts;
};

struct orl_density orl_density_estimate(const struct orl_photon_map *map,
                                        const struct orl_density_query *query,
                                        struct orl_search *search);

/*
 * The bias of that estimate: where light curves it is in proportion to the area, so that what an
 * area twice as large (half as large where none is allowed) adds to the estimate tells it. Of the
 * difference counts what is beyond its scatter.
 */
double orl_density_bias(const struct orl_photon_map *map, const struct orl_density_query *query,
                        const struct orl_density *estimate, struct orl_search *search);

/*
 * The nearest of the query's sheet, whatever stands in between: for points that are no photons,
 * records say. They are the first of search->candidates, in no order: up to k - 1, within
 * ret_radius, which is the distance of the next one; or all within max_radius. Returns how many.
 */
uint32_t orl_density_nearest(const struct orl_photon_map *map,
                             const struct orl_density_query *query, struct orl_search *search,
                             double *ret_radius);

#endif
