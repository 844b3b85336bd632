/*
 * Texels of surfaces, identified by number: the texel that a hit falls into, and the surface area
 * in it. Polygons are divided in their plane, round surfaces by angle and height (orl_hit_uv).
 */
#ifndef ORL_ANNUAL_SUN_MAP_SUN_TEXELS_H
#define ORL_ANNUAL_SUN_MAP_SUN_TEXELS_H

#include "scene/geometry/geometry.h"

/* Division of a polygon into rows and columns that fit its extent, so that no slivers remain. */
struct orl_sun_texel_grid {
    float along[3]; /* the first axis, unit; the second is perpendicular to it in the plane */
    float low[2], step[2];
};

struct orl_sun_texels {
    const struct orl_geometry *geometry;    /* borrowed */
    struct orl_sun_texel_grid *texel_grids; /* by facet that is not instanced */
    double width;
};

/* Divides surfaces into texels of about this width. Strips narrower than three widths get eight
 * rows of longer cells. Returns 0 or ORL_ERR_NOMEM. */
int orl_sun_texels_init(struct orl_sun_texels *texels, const struct orl_geometry *geometry,
                        double width);
void orl_sun_texels_done(struct orl_sun_texels *texels);

/* Returns the identifier of the hit's texel, on the side that was hit; never 0. */
uint64_t orl_sun_texel_of(const struct orl_sun_texels *texels, const struct orl_hit *hit);

/* Returns the surface area in the texel that a hit falls into. */
double orl_sun_texel_area(const struct orl_sun_texels *texels, const struct orl_hit *hit);

#endif
