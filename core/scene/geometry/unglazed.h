/*
 * Unglazed openings: rectangles in a plane of polygons that these surround and leave free, such as
 * a window without a pane, or what is free beside one.
 *
 * Found are those that are rectangular, or made of a few rectangles, along the longest edge of
 * their plane's first polygon. Work is bounded by what a plane has of corners and polygons; planes
 * of more are left out.
 */
#ifndef ORL_SCENE_GEOMETRY_UNGLAZED_H
#define ORL_SCENE_GEOMETRY_UNGLAZED_H

#include "scene/description.h"

enum { ORL_MOST_UNGLAZED = 256 };

struct orl_unglazed {
    struct orl_vec3 corner, sides[2]; /* the others are corner plus one or both sides */
    struct orl_vec3 normal;           /* unit; sides[0] x sides[1] */
    size_t surface;                   /* one of those about it */
};

/* Fills ret_openings[ORL_MOST_UNGLAZED]. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_unglazed_find(const struct orl_description *description, struct orl_unglazed *ret_openings,
                      size_t *ret_n);

#endif
