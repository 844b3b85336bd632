/* Pixels that a source surrounds, made part of it: see sources.h. */
#ifndef ORL_METRICS_SMOOTH_H
#define ORL_METRICS_SMOOTH_H

#include <stdint.h>

#include "metrics/field.h"

/* label: of all pixels, 0 or a source's, from 1 to n_labels. ORL_ERR_NOMEM. */
int orl_smooth_sources(const struct orl_field *field, double radius_rad, uint32_t n_labels,
                       uint32_t *label);

#endif
