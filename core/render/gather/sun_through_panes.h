/*
 * Light of suns through BSDF panes at a place where no photon lands. Half of the points are uniform
 * over a pane, half are drawn along the sun lobe (sun_lobe.h). A lobe a few degrees wide
 * lights a place from a thousandth of the pane, which uniform points miss and the sun lobe's points
 * find. Points are weighed by the balance heuristic of Veach and Guibas 1995.
 */
#ifndef ORL_RENDER_GATHER_SUN_THROUGH_PANES_H
#define ORL_RENDER_GATHER_SUN_THROUGH_PANES_H

#include "render/gather/direction_sampling.h"
#include "render/gather/gather.h"

struct orl_pane_query {
    const struct orl_lit_scene *lit_scene;
    const struct orl_direction_sampler
        *sampler; /* made for that world; NULL: only uniform points */
    const struct orl_sobol *sobol;
    const struct orl_shading_point *place;
    /* Names of the sequences of uniform points and of those drawn, for all panes. */
    uint32_t sequences[2];
};

/* Returns one estimate of the irradiance at the place, W/m2. */
struct orl_rgb orl_sun_through_panes(const struct orl_pane_query *query);

#endif
