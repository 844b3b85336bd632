/*
 * Records fitted to each other: where many stand close, as they do along the lines where surfaces
 * meet, each has few rays, and the chance in these is seen as stitches. What a record says is
 * replaced by the plane through those about it that deviates least (local linear regression, by
 * the inverse of their variances), on the same surface and with nothing in between; its gradients
 * are that plane's.
 *
 * How far about: discs of 3 to 24 pixels, the largest whose value lies within the error of
 * every smaller one's and whose records lie about their plane as their rays explain (the
 * intersection of confidence intervals: Goldenshluger and Nemirovski 1997, Mathematical Methods of
 * Statistics 6, 135; Katkovnik 1999, IEEE Transactions on Signal Processing 47, 2567). So what
 * bends the light, a contact shadow or an edge of one, is left as it is known.
 *
 * A fitted record shares its rays with those about it: their error stands with that of the
 * photons, which all share, and adds up as these do (orl_icache_lookup).
 */
#ifndef ORL_RENDER_GATHER_ICACHE_FIT_H
#define ORL_RENDER_GATHER_ICACHE_FIT_H

#include "render/gather/icache.h"

/*
 * All records at once, from what they were: no order matters, nor the crew. Where they are read
 * stays the same, and so does the index. Returns 0, ORL_ERR_NOMEM or
 * what orl_crew_try does.
 */
int orl_icache_fit(struct orl_icache *cache, const struct orl_geometry *geometry,
                   struct orl_crew *crew);

#endif
