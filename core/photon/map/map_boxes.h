/* Builds the boxes of a map's hierarchy (map.h): those of leaves, then level by level above. */
#ifndef ORL_PHOTON_MAP_MAP_BOXES_H
#define ORL_PHOTON_MAP_MAP_BOXES_H

#include "photon/map/map_layout.h"

enum { ORL_BOXED_AT_ONCE = ORL_MAP_LEAF * ORL_MAP_FANOUT };

/*
 * Computes the boxes of the leaves of photons first to end. Both are multiples of
 * ORL_BOXED_AT_ONCE, except for the last end. `file` is the map's, with places and normals filled
 * in.
 */
void orl_box_leaves(const struct orl_map_layout *layout, char *file, uint64_t first, uint64_t end);
/* Computes the boxes of all levels above the leaves, whose boxes must exist. */
void orl_box_nodes(const struct orl_map_layout *layout, char *file);

#endif
