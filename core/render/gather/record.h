/*
 * How a record of the irradiance cache (icache.h) is made for a picture: a hemisphere of rays, and
 * how far what it says holds, which pixels bound from both sides.
 */
#ifndef ORL_RENDER_GATHER_RECORD_H
#define ORL_RENDER_GATHER_RECORD_H

#include "render/gather/icache.h"

/* What a pixel measures: an angle, in radians, or in parallel views a width. */
struct orl_grain {
    double angle, width; /* one of them is 0 */
};

/* The least radius that pixels allow at that distance from the eye. */
double orl_record_least(const struct orl_grain *grain, double distance);

/* Rays of a hemisphere: so many rows, and about three columns for each. known: records made
 * before. */
struct orl_record orl_record_make(const struct orl_gather *gather, const struct orl_place *place,
                                  double least, uint32_t rows, const struct orl_icache *known,
                                  struct orl_random *random, struct orl_search *search);

#endif
