/*
 * Bounding rectangles of flat surfaces, for a cheap test before rays to the sun are traced. The
 * surfaces are the windows through which light enters a sealed building, and mirrors
 * (mirror_planes.h). The rectangles are slightly too large: a ray that misses all of them cannot
 * reach the sun through them.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_PANES_BOUNDING_RECTS_H
#define ORL_ANNUAL_PANES_BOUNDING_RECTS_H

#include "annual/sun/direction_tree.h"
#include "light/lit_scene.h"

struct orl_bounding_rect {
    uint32_t facet;
    struct orl_vec3 corner, normal;
    struct orl_vec3 along[2]; /* unit vectors, perpendicular to each other */
    double low[2], high[2];   /* extent along these axes, from the corner */
};

/* Returns the rectangle around a facet, which is a polygon or a ring. */
struct orl_bounding_rect orl_bounding_rect_of(const struct orl_geometry *geometry, uint32_t facet);
/* Extends a rectangle to cover another one in the same plane. */
void orl_bounding_rect_widen(struct orl_bounding_rect *window,
                             const struct orl_bounding_rect *other);

/*
 * Returns true if a ray passes a window. slack is the sine of the largest angle by which the ray's
 * direction may be off. ret_distance may be NULL.
 */
bool orl_bounding_rect_passed(const struct orl_bounding_rect *window, struct orl_vec3 origin,
                              struct orl_vec3 direction, double slack, double *ret_distance);

/* Returns a cone that contains all directions from a point to a window. */
struct orl_cone orl_bounding_rect_cone(const struct orl_bounding_rect *window,
                                       struct orl_vec3 point);

/* Returns corner i, 0 to 3; 0 is opposite 3. */
static inline struct orl_vec3 orl_bounding_rect_corner(const struct orl_bounding_rect *w, int i)
{
    return orl_madd(orl_madd(w->corner, w->along[0], i & 1 ? w->high[0] : w->low[0]), w->along[1],
                    i & 2 ? w->high[1] : w->low[1]);
}

#endif
