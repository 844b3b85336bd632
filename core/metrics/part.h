/* Luminances of a part of a view: where a mask is brighter than 0.1, evalglare's -A; in a band. */
#ifndef ORL_METRICS_PART_H
#define ORL_METRICS_PART_H

#include "metrics/sources.h"

/* Median and percentiles are of pixels, whatever their solid angle; the mean is weighted by that,
 * the deviation is about the pixels' own mean. Nothing counted: all zero. ORL_ERR_NOMEM. */
int orl_glare_part_of(const struct orl_luminances *picture, const float *mask,
                      struct orl_glare_part *ret_part, struct orl_error *err);

/* The same within an angle above and below the picture's middle row, column by column: evalglare's
 * -B, whose middle of an even number of rows is the lower one of the two. */
int orl_glare_band_of(const struct orl_luminances *picture, double angle_rad,
                      struct orl_glare_part *ret_part, struct orl_error *err);

#endif
