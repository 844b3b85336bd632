/* Pixels that a source surrounds, made part of it: see sources.h. */
#ifndef ORL_METRICS_SMOOTH_H
#define ORL_METRICS_SMOOTH_H

#include <stdint.h>

#include "metrics/sources.h"

/* label: of all pixels, 0 or a source's, from 1 to n_labels. Of the picture its field and its
 * cancel, which is polled a pixel: a disc may be as wide as the picture. ORL_ERR_NOMEM,
 * ORL_ERR_CANCELLED. */
int orl_smooth_sources(const struct orl_luminances *picture, double radius_rad, uint32_t n_labels,
                       uint32_t *label);

#endif
