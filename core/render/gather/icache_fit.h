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
#ifndef ORL_RENDER_GATHER_ICACHE_FIT_H
#define ORL_RENDER_GATHER_ICACHE_FIT_H

#include "render/gather/icache.h"

/*
 * Fits all records at once, from their original values, so that the result depends neither on order
 * nor on the crew. Their radii and the index stay the same. Returns 0, ORL_ERR_NOMEM or the codes
 * of orl_parallel_try.
 */
int orl_icache_fit(struct orl_icache *cache, const struct orl_geometry *geometry,
                   struct orl_thread_pool *pool);

#endif
