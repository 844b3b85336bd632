/*
 * Antimatter: volumes in which surfaces of certain materials are not there, as in holes cut into
 * walls. Where the volume's own surface lies inside of what is cut, it is the hole's lining.
 *
 * What a ray meets is decided at the place it meets, whatever way it came: a surface that is cut
 * is not there where the volume is on either of its sides; the volume's surface is not there but
 * from within, and where the next surface behind it that is cut shows its back. Radiance (m_clip)
 * keeps count of what a ray entered, and so knows nothing of an eye or a reflection inside.
 *
 * Volumes are closed, their normals look outwards: a volume that is not is refused. The area of a
 * facet is that of all of it.
 *
 * Only geometry.c and copies.c, which build and free, hits.c and linings.c include this. Ownership:
 * shared by a geometry and its subsets, by count. Threads: immutable once built.
 */
#ifndef ORL_SCENE_GEOMETRY_ANTIMATTER_H
#define ORL_SCENE_GEOMETRY_ANTIMATTER_H

#include <stdatomic.h>

#include "scene/geometry/geometry.h"

/* One antimatter: the surfaces of its volume, and those that it cuts, each alone. */
struct orl_hole {
    struct orl_geometry *shell, *matter;
    bool *cuts; /* by material */
    uint32_t material;
    bool lined, left_away; /* ... its lining: see linings.h */
};

struct orl_holes {
    atomic_size_t holders;
    struct orl_hole *items;
    size_t n;
    int32_t *of_facet; /* whose volume's surface a facet is, or or one of those below */
};

/* Of a facet that is no volume's surface, but may be cut; and of all others. */
enum { ORL_HOLE_NONE = -1, ORL_HOLE_UNTOUCHED = -2 };

/* antimatter_build.c: the holes of a geometry that has none yet. Lined facets take the lining's
 * material. Returns 0, ORL_ERR_NOMEM, ORL_ERR_RANGE, ORL_ERR_LIMIT. */
int orl_holes_build(struct orl_geometry *geometry, const struct orl_description *description,
                    struct orl_error *err);

/* copies.c */
struct orl_holes *orl_holes_hold(struct orl_holes *holes); /* NULL is allowed */
void orl_holes_release(struct orl_holes *holes);           /* NULL is allowed */

/* Ways out of the volume along a ray, less ways in: above 0 inside. */
int orl_hole_windings(const struct orl_geometry *shell, struct orl_vec3 point,
                      struct orl_vec3 direction);
/* In no particular direction. */
extern const struct orl_vec3 orl_hole_skew;

bool orl_hole_is_inside(const struct orl_hole *hole, struct orl_vec3 point);
/* Of a place on its volume's surface: whether it lies in what the volume cuts, and in no other's.
 */
bool orl_hole_is_lining(const struct orl_geometry *geometry, const struct orl_hole *hole,
                        const struct orl_hit *hit);

/* Whether there is anything where a ray has met that facet. */
bool orl_holes_leave(const struct orl_geometry *geometry, const struct orl_hit *hit);

#endif
