/*
 * What can be known beforehand of a sun in a port: where on the pane something outside may stand in
 * its way, so that emissions from elsewhere need no shadow ray; and tables of where the pane sends
 * its light (scene/material/passage.h).
 *
 * Facets beyond the pane's plane are moved onto it along the sun's rays, those from all over its
 * disc; boxes about what comes to lie on the pane are kept. It is geometry, not a matter of rays
 * that happened to pass: outside the boxes a shadow ray would meet nothing.
 */
#ifndef ORL_PHOTON_FLIGHT_PORT_SUN_H
#define ORL_PHOTON_FLIGHT_PORT_SUN_H

#include "photon/flight/emit.h"

enum { ORL_MOST_SHADES = 32 };

/* Boxes in the plane of a pane, by two axes of the world's. */
struct orl_shades {
    struct orl_vec3 axis[2];
    size_t count;
    struct orl_shade {
        double low[2], high[2];
    } box[ORL_MOST_SHADES];
};

static inline bool orl_may_be_shaded(const struct orl_shades *shades, struct orl_vec3 point)
{
    const double x = orl_dot(point, shades->axis[0]), y = orl_dot(point, shades->axis[1]);
    for (size_t i = 0; i < shades->count; i++) {
        const struct orl_shade *b = &shades->box[i];
        /* Each by itself is chance, all together mostly not: one branch for them. */
        if ((x >= b->low[0]) & (x <= b->high[0]) & (y >= b->low[1]) & (y <= b->high[1]))
            return true;
    }
    return false;
}

/* For all strata of suns in ports. Returns 0, ORL_ERR_NOMEM or, as the crew heeds,
 * ORL_ERR_CANCELLED. */
int orl_port_sun_prepare(struct orl_emission *emission, const struct orl_crew *crew);
void orl_port_sun_done(struct orl_emission *emission);

#endif
