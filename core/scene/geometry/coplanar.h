/*
 * Pairs of polygons and rings that lie in one plane, and near each other there: candidates for
 * being in one place, which who asks has to look at closely.
 */
#ifndef ORL_SCENE_GEOMETRY_COPLANAR_H
#define ORL_SCENE_GEOMETRY_COPLANAR_H

#include "scene/description.h"
#include "scene/geometry/box_tree.h"
#include "scene/geometry/pairs.h"

/* What "in one place" means for a scene, and where it is. */
struct orl_same_place {
    struct orl_vec3 middle;
    double reach, tolerance;
};

/* Pairs of boxes compared, or what takes as long. */
struct orl_looks {
    uint64_t n, most;
};

/* Of a polygon or ring. */
struct orl_box orl_box_of_flat(const struct orl_surface *surface);
/* Their boxes share more than a seam; both lie in one plane, and may be thin across any one axis.
 */
bool orl_boxes_overlap(const struct orl_box *a, const struct orl_box *b, double tolerance);

/*
 * Adds the pairs, and counts looks; stops when there are more than the most, or when cancelled. Of
 * a pair of polygons an edge's line may still part the two where they have many corners. Of a
 * polygon that a larger one covers wholly only the pair of these two need be among the pairs.
 * is_cut: by material, whether antimatter cuts it. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_coplanar_find(const struct orl_description *description, const bool *is_cut,
                      struct orl_same_place *ret_place, struct orl_pairs *pairs,
                      struct orl_looks *looks);

#endif
