/*
 * Polygons that another one of the same plane covers completely and wins against. One pair settles
 * such a polygon, so other overlaps need not be found: thousands of nested polygons cost as much as
 * thousands side by side.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_COVERED_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_COVERED_H

#include <stdbool.h>

#include "scene/parsed_scene.h"

/*
 * Returns true if the winner covers the loser completely. Only corners are compared: the result may
 * be false for a concave winner, and is false for one with many corners. is_cut: by material, true
 * if antimatter cuts it.
 */
bool orl_polygon_covers(const struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                        const struct orl_surface *winner, const struct orl_surface *loser,
                        double tolerance);

#endif
