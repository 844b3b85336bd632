/*
 * Exact duplicates: surfaces with the same numbers as another, dropped in n log n before pairs of
 * surfaces in one place are sought, of which n duplicates would make n squared.
 *
 * Polygons of the same corners, wherever the outline begins and whichever way it runs, form a
 * group. By the rule for surfaces in one place (coincidence_rule.h) all of a group lose to the
 * winners of the two ways they face, at most two, and would be cut away. Whatever a loser would cut
 * its winner cuts, too. Of round surfaces and rings those are dropped that are of one kind and one
 * material that is alike on both sides.
 */
#ifndef ORL_SCENE_GEOMETRY_DUPLICATES_H
#define ORL_SCENE_GEOMETRY_DUPLICATES_H

#include "scene/geometry/coincident_words.h"

/*
 * Drops the duplicates, each with a warning or a count, and keeps the order of the others. The
 * materials that antimatter cuts are marked: a pane in the place of one of those is left for the
 * search for pairs to refuse. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED.
 */
int orl_duplicates_drop(struct orl_description *description, const bool *is_cut,
                        struct orl_coincidence_words *words);

#endif
