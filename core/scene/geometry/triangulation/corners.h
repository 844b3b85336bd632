/*
 * Vertices of a geometry while it is built, with duplicates merged: a corner equal to the last bit
 * to a recent one gets that one's index. Duplicates that are not found cost only memory.
 */
#ifndef ORL_SCENE_GEOMETRY_TRIANGULATION_CORNERS_H
#define ORL_SCENE_GEOMETRY_TRIANGULATION_CORNERS_H

#include "scene/geometry/geometry.h"

struct orl_corners {
    struct orl_geometry *geometry; /* borrowed; owns the corners */
    size_t room;                   /* allocated corners */
    uint32_t *latest;              /* by hash of the place: index of a corner + 1 */
};

bool orl_corners_init(struct orl_corners *corners, struct orl_geometry *geometry);
void orl_corners_done(struct orl_corners *corners);

/* Returns the corner's index; false if out of memory. */
bool orl_corners_add(struct orl_corners *corners, struct orl_vec3 place, uint32_t *ret_index);

#endif
