/*
 * Precomputed data for a sun in a port. Shades: parts of the pane where objects outside may block
 * the sun, so that emissions from other parts need no shadow ray. Passages: tables of the
 * directions to which the pane scatters the sun's light (scene/material/sun_bsdf_table.h).
 *
 * Facets beyond the pane's plane are projected onto it along the sun's rays, from all over its
 * disc. The bounding boxes of projections on the pane are stored. This is exact geometry, not a
 * sampled test: outside the boxes a shadow ray would hit nothing.
 */
#ifndef ORL_PHOTON_EMISSION_PORT_SUN_H
#define ORL_PHOTON_EMISSION_PORT_SUN_H

#include "photon/emission/emit.h"

enum { ORL_MOST_SHADOW_BOXES = 32 };

/* Boxes in the plane of a pane, with two axes in world coordinates. */
struct orl_shadow_boxes {
    struct orl_vec3 axis[2];
    size_t count;
    struct orl_shadow_box {
        double low[2], high[2];
    } box[ORL_MOST_SHADOW_BOXES];
};

static inline bool orl_shadow_boxes_contain(const struct orl_shadow_boxes *shadow_boxes,
                                            struct orl_vec3 point)
{
    const double x = orl_dot(point, shadow_boxes->axis[0]),
                 y = orl_dot(point, shadow_boxes->axis[1]);
    for (size_t i = 0; i < shadow_boxes->count; i++) {
        const struct orl_shadow_box *b = &shadow_boxes->box[i];
        /* One combined branch: each single comparison is unpredictable, all together are mostly
         * false. */
        if ((x >= b->low[0]) & (x <= b->high[0]) & (y >= b->low[1]) & (y <= b->high[1]))
            return true;
    }
    return false;
}

/* Builds the data for all strata of suns in ports. Returns 0, ORL_ERR_NOMEM or, if the crew is
 * cancelled, ORL_ERR_CANCELLED. */
int orl_port_sun_prepare(struct orl_emission *emission, const struct orl_thread_pool *pool);
void orl_port_sun_done(struct orl_emission *emission);

#endif
