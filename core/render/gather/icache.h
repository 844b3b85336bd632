/*
 * An irradiance cache that does not depend on order. Records are placed in rounds; each round is
 * decided by the records of earlier rounds and computed in parallel. An image is therefore the same
 * for any number of threads and has no seams.
 *
 * A record holds the gathered irradiance at a place with its gradients and a radius: the harmonic
 * mean of the gather's ray lengths. The radius is smaller near close objects, on a steep gradient,
 * and beside such records (orl_icache_clamp_neighbours). It is at most a number of pixels. A record
 * serves a place x with error e = |x - x_i| / R + sqrt(1 - n . n_i) below a = ORL_ICACHE_ACCURACY,
 * where R is the radius or the least that pixels allow.
 *
 * Places are served by few records, but read from more: from all records whose e is below a when R
 * is ORL_ICACHE_OVERLAP times the radius, or the least, with the tolerance of normals increased
 * alike. Weights are 1 - e/a. A record is not read through objects that it has seen nearby, such as
 * the leg of a desk that is lit on the other side. Each place is thus a mean of several records
 * with independent ray noise. The weights have no peak, so that no record shows its noise alone.
 *
 * References: Ward, Rubinstein, Clear 1988; Ward and Heckbert 1992; Krivanek and Gautron 2009;
 * overlap and weights after Tabellion and Lamorlette 2004.
 */
#ifndef ORL_RENDER_GATHER_ICACHE_H
#define ORL_RENDER_GATHER_ICACHE_H

#include "render/gather/gather.h"

#define ORL_ICACHE_ACCURACY 0.25
#define ORL_ICACHE_OVERLAP 1.5

struct orl_irradiance_record {
    struct orl_shading_point place;
    struct orl_rgb irradiance;
    struct orl_vec3 rotation_gradient[3], translation_gradient[3];
    double photon_error, ray_error; /* standard errors, of the irradiance's luma */
    /* Number of rays through its hemisphere's strata, one each. */
    double rays;
    /* Radius, and a lower limit of the radius with which it serves. */
    double radius, least;
    /* Distance of the nearest surface that it has seen; farther places may be occluded. */
    double clear;
};

struct orl_icache {
    uint32_t channels; /* 3, or 1 if all is gray */
    /* Borrowed; tests occlusion between places; NULL: no test. */
    const struct orl_geometry *geometry;
    struct orl_irradiance_record *records;
    size_t count, capacity;
    /* An index by level (power of two of the record's reach) and cell; rebuilt between rounds. */
    struct orl_icache_entry *entries;
    uint32_t *heads; /* hash table: first entry of each bucket, and one past the last */
    size_t n_heads;  /* a power of two */
    int lowest_level, highest_level;
    int least_level;  /* lower limit of the level, which limits the size of cells */
    size_t n_visited; /* tree nodes and records that orl_icache_clamp_neighbours has visited */
};

void orl_icache_init(struct orl_icache *cache, uint32_t channels);
void orl_icache_done(struct orl_icache *cache);

/* Adds records (copied); they are found after orl_icache_index. Returns 0 or ORL_ERR_NOMEM. */
int orl_icache_add(struct orl_icache *cache, const struct orl_irradiance_record *records,
                   size_t count);
int orl_icache_index(struct orl_icache *cache);

/*
 * Reduces radii by neighbour clamping (Krivanek and Gautron 2009): where a neighbour within reach
 * has seen a near surface, no radius exceeds the neighbour's plus the distance to it. Places that
 * are then no longer served need records of their own. Rebuilds the index. Takes time n log n for n
 * records of about one radius, however close they stand. Returns 0, ORL_ERR_NOMEM or the codes of
 * orl_parallel_try; on error no radius has changed.
 */
int orl_icache_clamp_neighbours(struct orl_icache *cache, struct orl_thread_pool *pool);

/* Returns true if a place needs no record of its own. */
bool orl_icache_covers(const struct orl_icache *cache, const struct orl_shading_point *place);

/* Returns true if orl_icache_lookup finds a record at the place. */
bool orl_icache_has_record_for(const struct orl_icache *cache,
                               const struct orl_shading_point *place);

/* The interpolated irradiance at a place. */
struct orl_cached_irradiance {
    struct orl_rgb irradiance;
    double standard_error; /* standard error of its luma */
};

/*
 * Interpolates. Returns false if no record reaches this place, even by overlap. Errors by photons
 * are averaged as values are, because records share photons; errors by rays are independent. The
 * interpolation error is the records' scatter beyond their rays' noise. The noise of gradients is
 * not included.
 */
bool orl_icache_lookup(const struct orl_icache *cache, const struct orl_shading_point *place,
                       struct orl_cached_irradiance *ret_cached);

/* Interpolates from a few records outside the cache, with the cache's parameters. */
bool orl_irradiance_records_lookup(const struct orl_irradiance_record *records, size_t count,
                                   const struct orl_icache *like,
                                   const struct orl_shading_point *place,
                                   struct orl_cached_irradiance *ret_cached);

/* Makes records for a picture: a hemisphere of rays, and a radius, which the pixel size bounds from
 * both sides. */

/* The footprint of a pixel: an angle, in radians, or a width in parallel views. */
struct orl_pixel_footprint {
    double angle, width; /* one of them is 0 */
    double start;        /* distance from the eye at which rays start: -vo */
    double nearest;      /* smaller distances from the eye are rounding errors of the geometry */
};

/* Returns the least radius that pixels allow at that distance from a ray's start. */
double orl_pixel_footprint_radius(const struct orl_pixel_footprint *footprint, double distance);

/* Makes a record from a hemisphere of that many rows and about three columns for each. icache:
 * records made before, or NULL. */
struct orl_irradiance_record
orl_irradiance_record_make(const struct orl_gather *gather, const struct orl_shading_point *place,
                           double least, uint32_t rows, const struct orl_icache *icache,
                           struct orl_random *random, struct orl_search *search);

/*
 * Thins out records that are still to be made: of those closer together than a quarter of their
 * least reach, with about the same normal, it keeps the first. Other places of the view are at
 * least a pixel apart, which is more. This bounds the number of records at one place where pixels
 * are smaller than the geometry's precision: an eye in the plane of a wall, a telescope. Keeps the
 * order. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_irradiance_records_thin(struct orl_irradiance_record *records, size_t *count);

/*
 * Smooths records by local regression. Where many records stand close, as along the lines where
 * surfaces meet, each has few rays, and their noise shows as stitches. A record's value is replaced
 * by the plane through the records about it (local linear regression, weighted by inverse
 * variance). Only records on the same surface without an occluder in between count. Its gradients
 * become that plane's.
 *
 * Discs have radii of 3 to 24 pixels. The largest is used whose value lies within the error of
 * every smaller one's, and whose records scatter about their plane as their rays explain. This is
 * the intersection of confidence intervals (Goldenshluger and Nemirovski 1997, Mathematical Methods
 * of Statistics 6, 135; Katkovnik 1999, IEEE Transactions on Signal Processing 47, 2567). Curved
 * light, such as a contact shadow or its edge, is therefore left as it is.
 *
 * A fitted record shares its rays with its neighbours. Its error is therefore added to that of the
 * photons, which all records share, and is averaged like it (orl_icache_lookup).
 */

/*
 * Fits all records at once, from their original values, so that the result depends neither on order
 * nor on the number of threads. Their radii and the index stay the same. Returns 0, ORL_ERR_NOMEM
 * or the codes of orl_parallel_try.
 */
int orl_icache_fit(struct orl_icache *cache, const struct orl_geometry *geometry,
                   struct orl_thread_pool *pool);

#endif
