/*
 * Finds pairs of polygons and rings that lie in one plane and near each other. They are candidates
 * for coincidence, which the caller tests in detail.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COPLANAR_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COPLANAR_H

#include "scene/geometry/coincidence/box_tree.h"
#include "scene/geometry/coincidence/pairs.h"
#include "scene/parsed_scene.h"

/* The scene's extent, and the distance below which surfaces coincide. */
struct orl_coincidence_scale {
    struct orl_vec3 middle;
    double reach, tolerance;
};

/* Number of box comparisons or equivalent work; and its limit. */
struct orl_comparison_budget {
    uint64_t n, most;
};

/* Bounding box of a polygon or ring. */
struct orl_box orl_box_of_flat(const struct orl_surface *surface);
/* Returns true if the boxes of two coplanar surfaces overlap by more than a seam; they may be thin
 * along any one axis. */
bool orl_boxes_overlap(const struct orl_box *a, const struct orl_box *b, double tolerance);

/*
 * Adds the pairs, and counts comparisons; stops at the limit or when cancelled. Polygons of a pair
 * may still be disjoint if they have many corners. If a larger polygon covers one completely, only
 * that pair need be listed. is_cut: by material, true if antimatter cuts it. Returns 0 or
 * ORL_ERR_NOMEM.
 */
int orl_coplanar_find(const struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                      struct orl_coincidence_scale *ret_scale, struct orl_pairs *pairs,
                      struct orl_comparison_budget *budget);

#endif
