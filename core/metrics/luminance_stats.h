/* Luminance statistics of a part of a view: of pixels where a mask is brighter than 0.1
 * (evalglare's -A), or of a band. */
#ifndef ORL_METRICS_LUMINANCE_STATS_H
#define ORL_METRICS_LUMINANCE_STATS_H

#include "metrics/glare_sources.h"

/* Computes the statistics of masked pixels. Median and percentiles are over pixels, independent of
 * their solid angle. The mean is weighted by solid angle; the deviation is about the unweighted
 * mean. All values are zero if no pixel counts. Returns 0 or ORL_ERR_NOMEM. */
int orl_glare_masked_stats(const struct orl_luminances *picture, const float *mask,
                           struct orl_glare_part *ret_part, struct orl_error *err);

/* Computes the statistics of pixels within an angle above and below the picture's middle row,
 * column by column, as evalglare's -B. For an even number of rows the middle is the lower one of
 * the two. */
int orl_glare_band_stats(const struct orl_luminances *picture, double angle_rad,
                         struct orl_glare_part *ret_part, struct orl_error *err);

#endif
