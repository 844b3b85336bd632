/*
 * Sorts scans by component, then by direction, and applies the sample's symmetry. If a mirror
 * leaves a direction in place, the images of its rows are added. Isotropic samples are turned so
 * that all light comes from -x; directions of equal theta are merged.
 */
#ifndef ORL_BSDF_FIT_MEASUREMENTS_SCANS_H
#define ORL_BSDF_FIT_MEASUREMENTS_SCANS_H

#include <oriel/bsdf/bsdf_fit.h>

#include "bsdf/fit/measurements/rows.h"

/* *ret_symmetry: as asked, or derived from the incident azimuths. Returns 0, ORL_ERR_INVALID (no
 * rows; azimuths that are ambiguous or contradict the symmetry) or ORL_ERR_NOMEM. */
int orl_fit_sort_scans(struct orl_fit_data *data, enum orl_bsdf_fit_symmetry requested,
                       enum orl_bsdf_fit_symmetry *ret_symmetry, struct orl_error *err);

#endif
