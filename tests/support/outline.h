/*
 * Polygons in their own plane, and the conditions on their triangles and rays. The plane has an
 * arbitrary tilt, so that nothing depends on axes.
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
double outline_area(const struct outline *o); /* signed area */

/* Returns the relative error of the triangles' total area; all must be counter-clockwise. */
double outline_area_error(const struct outline *o);

/*
 * Counts the rays through a grid of side x side that disagree with the even-odd rule, or hit at a
 * wrong distance; also checks the facet's area. Points within 1e-5 of the outline are left out,
 * because rays are floats.
 */
uint32_t outline_misses(const struct outline *o, uint32_t side);

#endif
