/* Makes a record of the irradiance cache (icache.h) for a picture: a hemisphere of rays, and a
 * radius, which the pixel size bounds from both sides. */
#ifndef ORL_RENDER_GATHER_IRRADIANCE_RECORD_H
#define ORL_RENDER_GATHER_IRRADIANCE_RECORD_H

#include "render/gather/icache.h"

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

#endif
