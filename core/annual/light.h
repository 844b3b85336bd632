/*
 * What a year's light is worked out with: world, ports, mirrors, sunlight on surfaces inside and
 * panels, each made when it is first asked for, and its suns as sums over nodes and beams. Where
 * all of these come from a store, no ray is cast.
 *
 * Errors: ORL_ERR_UNSUPPORTED, naming a surface, _INVALID, _LIMIT, _NOMEM, _CANCELLED.
 */
#ifndef ORL_ANNUAL_LIGHT_H
#define ORL_ANNUAL_LIGHT_H

#include "annual/year.h"

/* terms, n_beams and n_sun of a year whose nodes are placed. */
int orl_year_find_suns(struct orl_year *y, struct orl_error *err);
/* world and scene: for paths. */
int orl_year_need_scene(struct orl_year *y, struct orl_error *err);
/* panels, too: for the sun at sensors. */
int orl_year_need_panels(struct orl_year *y, struct orl_error *err);
void orl_year_light_done(struct orl_year *y);

#endif
