/*
 * Polygons in one plane: whether two share an area, and what of one is outside of others.
 */
#ifndef ORL_SCENE_GEOMETRY_OVERLAP_H
#define ORL_SCENE_GEOMETRY_OVERLAP_H

#include <stdbool.h>

#include "scene/geometry/arrangement.h"

struct orl_outline {
    const struct orl_vec3 *vertices;
    uint32_t n;
    struct orl_vec3 normal; /* unit: its front */
};

/* Scratch and result; zeroed is ready. */
struct orl_overlap {
    struct orl_arrangement arrangement;
    struct orl_vec3 *vertices; /* the remaining outline: loops joined by seams */
    uint32_t n;                /* 0: nothing remains */
    bool shared;               /* a and one of the others share an area, more than a seam */
    uint64_t work;
    size_t vertices_room;
    void *scratch;
    size_t scratch_room;
};

/* Quick: some edge's line has all of one on its one side, all of the other beyond. */
bool orl_outlines_apart(const struct orl_outline *a, const struct orl_outline *b, double tolerance);

enum { ORL_OVERLAP_LAYERS = 31 };

/*
 * What of a lies outside all n others. Each of those has a layer, from 0 to below
 * ORL_OVERLAP_LAYERS; of one layer, none may overlap. Strips narrower than tolerance do not count,
 * neither as shared nor as remaining. Returns 0, ORL_ERR_NOMEM, or ORL_ERR_LIMIT.
 */
int orl_outline_subtract(struct orl_overlap *overlap, const struct orl_outline *a,
                         const struct orl_outline *others, const uint32_t *layers, size_t n,
                         double tolerance);
void orl_overlap_done(struct orl_overlap *overlap);

#endif
