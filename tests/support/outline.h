/*
 * Polygons in their own plane, and what their triangles and rays are to agree with. The plane is
 * tilted any way: nothing may depend on axes.
 */
#ifndef ORL_TESTS_SUPPORT_OUTLINE_H
#define ORL_TESTS_SUPPORT_OUTLINE_H

#include <stdbool.h>
#include <stdint.h>

enum { OUTLINE_MOST = 512, OUTLINE_GRID = 97 };

struct outline {
    double xy[OUTLINE_MOST][2];
    uint32_t n;
};

void outline_add(struct outline *o, double x, double y);
struct outline outline_of(const double (*xy)[2], uint32_t n);
double outline_area(const struct outline *o); /* signed */

/* Relative error of the triangles' areas, all of which must be counter-clockwise. */
double outline_area_error(const struct outline *o);

/*
 * Of the rays through a grid of side x side, those that hit where the even-odd rule says there is
 * nothing, or the other way round, or at a wrong distance; the facet's area is checked as well.
 * Places within 1e-5 of the outline are left out, for rays are floats.
 */
uint32_t outline_misses(const struct outline *o, uint32_t side);

#endif
