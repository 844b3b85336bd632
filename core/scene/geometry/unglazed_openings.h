/*
 * Unglazed openings: free rectangles that the polygons of a plane surround, such as a window
 * without a pane, or the part of a hole beside a pane.
 *
 * An opening made of several rectangles is found as these. Their sides are parallel to the longest
 * edge of the plane's first polygon, or perpendicular to it; other openings are not found, nor are
 * those that reach the rim of all polygons of the plane. The search takes bounded work: planes with
 * many polygons or corners are left out.
 */
#ifndef ORL_SCENE_GEOMETRY_UNGLAZED_OPENINGS_H
#define ORL_SCENE_GEOMETRY_UNGLAZED_OPENINGS_H

#include "scene/parsed_scene.h"

enum { ORL_UNGLAZED_OPENINGS_MAX = 256 };

struct orl_unglazed_opening {
    struct orl_vec3 corner, sides[2]; /* the other corners are corner plus one or both sides */
    struct orl_vec3 normal;           /* unit, along sides[0] x sides[1] */
    size_t surface;                   /* one of the polygons about it */
};

/* Fills ret_openings[ORL_UNGLAZED_OPENINGS_MAX]. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_unglazed_find(const struct orl_parsed_scene *parsed_scene,
                      struct orl_unglazed_opening *ret_openings, size_t *ret_n);

#endif
