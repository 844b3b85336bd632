/*
 * Flat surfaces as rays to the sun are tried against before they are traced: the windows that a
 * sealed building lets light in by, and mirrors (mirrors.h). Each is taken for the rectangle about
 * it, a little too large: a ray that passes by all of them has nothing to find.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_WINDOWS_H
#define ORL_ANNUAL_WINDOWS_H

#include "annual/direction_tree.h"
#include "light/world.h"

struct orl_window {
    uint32_t facet;
    struct orl_vec3 corner, normal;
    struct orl_vec3 along[2]; /* unit, at right angles */
    double low[2], high[2];   /* along those, from the corner */
};

/* The one about a facet that is a polygon or a ring. */
struct orl_window orl_window_of(const struct orl_geometry *geometry, uint32_t facet);
/* Makes one wide enough for another, in the same plane. */
void orl_window_widen(struct orl_window *window, const struct orl_window *other);

/*
 * Where a ray passes a window, slack (a sine) for rays of about that direction; false: it does not.
 * ret_distance may be NULL.
 */
bool orl_window_passed(const struct orl_window *window, struct orl_vec3 origin,
                       struct orl_vec3 direction, double slack, double *ret_distance);

/* The directions from a point to a window lie in this cone. */
struct orl_cone orl_window_cone(const struct orl_window *window, struct orl_vec3 point);

/* The corners 0 to 3; 0 is opposite 3. */
static inline struct orl_vec3 orl_window_corner(const struct orl_window *w, int i)
{
    return orl_madd(orl_madd(w->corner, w->along[0], i & 1 ? w->high[0] : w->low[0]), w->along[1],
                    i & 2 ? w->high[1] : w->low[1]);
}

#endif
