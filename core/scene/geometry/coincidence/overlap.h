/*
 * Boolean operations of coplanar polygons: whether two share an area, and the difference of one to
 * others.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_OVERLAP_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_OVERLAP_H

#include <stdbool.h>

#include "scene/geometry/triangulation/arrangement.h"

struct orl_outline {
    const struct orl_vec3 *vertices;
    uint32_t n;
    struct orl_vec3 normal; /* unit: the front */
};

/* Scratch and result; a zeroed struct is ready to use. */
struct orl_overlap {
    struct orl_arrangement arrangement;
    struct orl_vec3 *vertices; /* remaining outline: loops joined by seams */
    uint32_t n;                /* 0: nothing remains */
    bool shared;               /* a shares more than a seam's area with one of the others */
    uint64_t work;
    size_t vertices_room;
    void *scratch;
    size_t scratch_room;
};

/* Fast test: returns true if the line through some edge separates the two. */
bool orl_outlines_apart(const struct orl_outline *a, const struct orl_outline *b, double tolerance);

enum { ORL_OVERLAP_LAYERS = 31 };

/*
 * Computes the part of a outside all n others. Each of those has a layer, 0 to ORL_OVERLAP_LAYERS -
 * 1; outlines of one layer must not overlap. Strips narrower than tolerance do not count, neither
 * as shared nor as remaining. Returns 0, ORL_ERR_NOMEM, or ORL_ERR_LIMIT.
 */
int orl_outline_subtract(struct orl_overlap *overlap, const struct orl_outline *a,
                         const struct orl_outline *others, const uint32_t *layers, size_t n,
                         double tolerance);
void orl_overlap_done(struct orl_overlap *overlap);

#endif
