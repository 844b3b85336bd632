/*
 * Polygons that another one of the same plane covers wholly and wins against. One pair of such a
 * polygon says all: others that overlap it need not be found, so thousands nested in each other
 * cost as much as thousands side by side.
 */
#ifndef ORL_SCENE_GEOMETRY_COVERED_H
#define ORL_SCENE_GEOMETRY_COVERED_H

#include <stdbool.h>

#include "scene/description.h"

/*
 * Returns true if the winner covers the loser wholly, so that nothing of the loser is left. Only
 * corners are compared, so the result may be false for a concave winner, and is for one of many
 * corners. is_cut: by material, true if antimatter cuts it.
 */
bool orl_polygon_covers(const struct orl_description *description, const bool *is_cut,
                        const struct orl_surface *winner, const struct orl_surface *loser,
                        double tolerance);

#endif
