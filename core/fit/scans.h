/*
 * Scans put in order: by component, then by direction; and what the sample's symmetry makes of
 * them. Rows of a direction that a mirror leaves in place count on both sides of it. Those of an
 * isotropic sample are turned so that all light comes from -x, directions of one theta become one.
 */
#ifndef ORL_FIT_SCANS_H
#define ORL_FIT_SCANS_H

#include <oriel/bsdf_fit.h>

#include "fit/rows.h"

/* *ret_symmetry: as asked, or as the incident azimuths say. 0, ORL_ERR_INVALID (no rows; azimuths
 * that say nothing, or something else), ORL_ERR_NOMEM. */
int orl_fit_sort_scans(struct orl_fit_data *data, enum orl_bsdf_fit_symmetry asked,
                       enum orl_bsdf_fit_symmetry *ret_symmetry, struct orl_error *err);

#endif
