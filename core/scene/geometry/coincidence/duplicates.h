/*
 * Drops exact duplicates, surfaces with the same numbers as another, in n log n. This precedes the
 * search for coincident pairs, which n duplicates would make quadratic.
 *
 * Polygons with the same corners, wherever the outline begins and in either direction, form a
 * group. By coincidence_rule.h all of a group lose to the winners of the two orientations, at most
 * two, and would be cut away. A winner cuts all that its losers would cut. Quadrics and rings are
 * dropped if they have the same kind and the same two-sided material.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENCE_DUPLICATES_H
#define ORL_SCENE_GEOMETRY_COINCIDENCE_DUPLICATES_H

#include "scene/geometry/coincidence/coincidence_warnings.h"

/*
 * Drops the duplicates, each with a warning or a count, and keeps the order of the others. is_cut:
 * by material, true if antimatter cuts it; a pane that coincides with such a surface is left for
 * the search for pairs to refuse. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_duplicates_drop(struct orl_parsed_scene *parsed_scene, const bool *is_cut,
                        struct orl_coincidence_warnings *warnings);

#endif
