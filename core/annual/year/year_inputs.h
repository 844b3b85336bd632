/*
 * Inputs of a year's light: world, ports, mirrors, sunlight on surfaces inside, and BSDF panes,
 * each made when first needed; and interpolation weights of the suns over nodes and beams. If all
 * results come from a store, no ray is traced.
 *
 * Errors: ORL_ERR_UNSUPPORTED, naming a surface, _INVALID, _LIMIT, _NOMEM, _CANCELLED.
 */
#ifndef ORL_ANNUAL_YEAR_YEAR_INPUTS_H
#define ORL_ANNUAL_YEAR_YEAR_INPUTS_H

#include "annual/year/annual_year.h"

/* Finds sun_weights and n_beams of a year whose nodes are placed. */
int orl_year_find_sun_weights(struct orl_year *y, struct orl_error *err);
/* Makes world and scene if necessary; paths need them. */
int orl_year_ensure_scene(struct orl_year *y, struct orl_error *err);
/* Also makes the BSDF panes; sunlight at sensors needs them. */
int orl_year_ensure_bsdf_panes(struct orl_year *y, struct orl_error *err);
void orl_year_inputs_done(struct orl_year *y);

#endif
