/*
 * View of a viewpoint, built once for all hours of a year. It is a fisheye picture. Each pixel is a
 * sum of sky bins, of the light on visible points of surfaces, and of spots that the sun may light.
 *
 * A pixel's rays pass panes, mirrors and lobes (viewpoint_rays.h). At each diffuse surface on the
 * path, the surface's visible point adds to the pixel. A visible point represents the visible part
 * of its surface around it (visible_points.h); a sensor of the year gives the light there. A
 * pixel's spot is where its first ray hits. Sunlight there is computed hour by hour, so the visible
 * point's own direct sunlight is left out for such rays.
 *
 * Immutable once made. The picture has Radiance's projection -vta with 180 degrees.
 */
#ifndef ORL_ANNUAL_VIEWPOINTS_VIEWPOINT_IMAGE_H
#define ORL_ANNUAL_VIEWPOINTS_VIEWPOINT_IMAGE_H

#include <oriel/annual/annual_glare.h>

#include "annual/viewpoints/pixel_terms.h"
#include "annual/viewpoints/visible_points.h"
#include "annual/year/annual_scene.h"
#include "metrics/view_field.h"

enum { ORL_VIEWPOINT_SIDE = 160, ORL_VIEWPOINT_PIXELS = ORL_VIEWPOINT_SIDE * ORL_VIEWPOINT_SIDE };

/* Most terms and spots of a pixel. */
enum { ORL_VIEWPOINT_PIXEL_TERMS = 64, ORL_VIEWPOINT_PIXEL_SPOTS = 8 };

/* A point seen by a pixel's first ray, directly or through panes, where the sun may shine. */
struct orl_viewpoint_spot {
    struct orl_shading_point
        place; /* on the visible side; for transmitted light, on the far side */
    struct orl_hit hit;
    struct orl_vec3 eye;                 /* direction from the spot to the eye */
    const struct orl_material *material; /* material whose lobes send the light on; NULL: diffuse */
    /* Factor of the light sent to the eye; includes 1/pi for diffuse surfaces. */
    struct orl_rgb weight;
    uint32_t pixel;
};

struct orl_viewpoint_image {
    struct orl_view_field field;
    struct orl_shading_point eye;
    uint32_t *first; /* by pixel, and one more: index into terms */
    /* `which` of a term: first the bins, 0 to ORL_BINS - 1; then two per visible point, its light
     * without direct sunlight, and all of its light. */
    struct orl_pixel_term *terms;
    struct orl_viewpoint_spot *spots;
    size_t n_spots;
    struct orl_visible_points visible_points;
    uint64_t n_steps; /* traced ray segments */
};

/* name: the viewpoint's number, for random numbers. Cancellation of the crew is checked before each
 * pixel. Returns 0, ORL_ERR_NOMEM, _CANCELLED or _RANGE; the caller calls orl_viewpoint_image_done
 * in any case. */
int orl_viewpoint_image_init(struct orl_viewpoint_image *view, const struct orl_annual_scene *scene,
                             const struct orl_viewpoint *viewpoint, uint64_t name,
                             const struct orl_thread_pool *pool, struct orl_error *err);
void orl_viewpoint_image_done(struct orl_viewpoint_image *view);

#endif
