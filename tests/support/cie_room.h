/*
 * The room of the CIE 171 cases, 4 x 4 m and 3 m high, with a corner at the origin, as scene text:
 * six inward faces of a material "w", one of which may have a hole.
 */
#ifndef ORL_TESTS_CIE_ROOM_H
#define ORL_TESTS_CIE_ROOM_H

#include <stddef.h>

#include <oriel/base/vec.h>

enum { CIE_FLOOR, CIE_NORTH, CIE_WEST, CIE_EAST, CIE_SOUTH, CIE_CEILING, CIE_FACES };

struct cie_face {
    const char *name;
    struct orl_vec3 corner, u, v, normal; /* two edges; the normal faces in */
};
extern const struct cie_face cie_faces[CIE_FACES];

/* A hole in the middle of a face along u, and starting at `from` along v. */
struct cie_hole {
    int face; /* -1: no hole */
    double w, h, from;
};

/* Returns a hole's corner and edges. */
void cie_hole_edges(const struct cie_hole *hole, struct orl_vec3 *ret_corner,
                    struct orl_vec3 *ret_a, struct orl_vec3 *ret_b);

/* Writes the room after `at` characters of text; if pane is not NULL, also a polygon of that
 * material that fills the hole and faces in. Returns the new length of the text. */
size_t cie_room_text(char *text, size_t size, size_t at, const struct cie_hole *hole,
                     const char *pane);

#endif
