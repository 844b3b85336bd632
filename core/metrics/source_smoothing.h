/* Adds pixels that a source surrounds to that source; see glare_sources.h. */
#ifndef ORL_METRICS_SOURCE_SMOOTHING_H
#define ORL_METRICS_SOURCE_SMOOTHING_H

#include <stdint.h>

#include "metrics/glare_sources.h"

/* label: for each pixel, 0 or a source, from 1 to n_labels. Of the picture only field and cancel
 * are used. cancel is polled per pixel, since a disc may be as wide as the picture. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_glare_sources_smooth(const struct orl_luminances *picture, double radius_rad,
                             uint32_t n_labels, uint32_t *label);

#endif
