/*
 * The corners of a geometry's triangles while it is built, each once: one that another triangle had
 * shortly before, to the last bit, is that one's. Those that are not found again stand twice,
 * which takes memory and nothing else.
 */
#ifndef ORL_SCENE_GEOMETRY_CORNERS_H
#define ORL_SCENE_GEOMETRY_CORNERS_H

#include "scene/geometry/geometry.h"

struct orl_corners {
    struct orl_geometry *geometry; /* borrowed; owns what is found */
    size_t room;                   /* of its corners */
    uint32_t *latest;              /* by a hash of the place: a corner's index and 1 */
};

bool orl_corners_init(struct orl_corners *corners, struct orl_geometry *geometry);
void orl_corners_done(struct orl_corners *corners);

/* The corner's index, or false: out of memory. */
bool orl_corners_add(struct orl_corners *corners, struct orl_vec3 place, uint32_t *ret_index);

#endif
