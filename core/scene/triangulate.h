/*
 * Simple polygons, concave and keyholed (holes joined to the outline by a seam walked twice), into
 * triangles by ear clipping (Meisters 1975). Work is at most quadratic in the vertices, bounded by
 * ORL_LIMIT_POLYGON_VERTICES. Signed areas of the triangles sum to the polygon's.
 */
#ifndef ORL_SCENE_TRIANGULATE_H
#define ORL_SCENE_TRIANGULATE_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/vec.h>

/*
 * Writes at most n - 2 index triples to ret_triangles, each counter-clockwise about normal (unit).
 * Slivers of no area are left out. Returns how many were written, or ORL_ERR_NOMEM.
 */
int orl_triangulate(const struct orl_vec3 *vertices, uint32_t n, struct orl_vec3 normal,
                    uint32_t (*ret_triangles)[3]);

#endif
