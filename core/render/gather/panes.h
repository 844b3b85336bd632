/*
 * Suns by way of BSDF panes to a place where no photon lands. Half of the points are spread over a
 * pane, half drawn along the beam that its lobes make of the sun (beam.h): a lobe a few degrees
 * wide lights a place from a thousandth of the pane, which the former miss and the latter find.
 * Either way a point weighs by the densities of both, the balance heuristic of Veach and Guibas
 * 1995.
 */
#ifndef ORL_RENDER_GATHER_PANES_H
#define ORL_RENDER_GATHER_PANES_H

#include "render/gather/aim.h"
#include "render/gather/gather.h"

struct orl_pane_query {
    const struct orl_world *world;
    const struct orl_aim *aim; /* of that world; NULL: points are spread only */
    const struct orl_sobol *sobol;
    const struct orl_place *place;
    uint32_t sequences[2]; /* names of the points spread, and of those drawn; of all panes */
};

/* Irradiance at the place, W/m2: one estimate. */
struct orl_rgb orl_light_by_panes(const struct orl_pane_query *query);

#endif
