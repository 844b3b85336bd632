/*
 * Antimatter: volumes that remove surfaces of certain materials, like holes cut into walls. Where
 * the volume's own surface lies inside the material that is cut, it is the hole's lining.
 *
 * Cuts are decided at the hit point, whatever way the ray came. A surface that is cut is absent
 * where the volume is on either of its sides. The volume's surface is present only from within, and
 * only where the next cut surface behind it shows its back. Radiance (m_clip) counts the volumes
 * that a ray entered, which fails for an eye or a reflection inside one.
 *
 * Volumes must be closed with normals pointing outwards; others are refused. The area of a facet
 * includes its cut parts.
 *
 * Included only by geometry.c and copies.c, which build and free holes, hits.c, and this folder.
 * Ownership: reference-counted, shared by a geometry and its subsets. Threads: immutable once
 * built.
 */
#ifndef ORL_SCENE_GEOMETRY_ANTIMATTER_ANTIMATTER_H
#define ORL_SCENE_GEOMETRY_ANTIMATTER_ANTIMATTER_H

#include <stdatomic.h>

#include "scene/geometry/geometry.h"

/* One antimatter material. shell: geometry of its volume's surfaces; matter: geometry of the
 * surfaces that it cuts. */
struct orl_hole {
    struct orl_geometry *shell, *matter;
    bool *cuts; /* by material: true if it is cut */
    uint32_t material;
    /* has_lining: a material for the lining is given; lining_omitted: it is not used (see below) */
    bool has_lining, lining_omitted;
};

struct orl_holes {
    atomic_size_t references;
    struct orl_hole *items;
    size_t n;
    int32_t *of_facet; /* by facet: the hole whose volume it bounds, or one of the values below */
};

/* NONE: a facet that may be cut, but bounds no volume. UNTOUCHED: neither. */
enum { ORL_HOLE_NONE = -1, ORL_HOLE_UNTOUCHED = -2 };

/* antimatter_build.c: builds the holes of a geometry that has none yet. Lined facets get the
 * lining's material. Returns 0, ORL_ERR_NOMEM, ORL_ERR_RANGE, ORL_ERR_LIMIT. */
int orl_holes_build(struct orl_geometry *geometry, const struct orl_parsed_scene *parsed_scene,
                    struct orl_error *err);

/* copies.c */
void orl_holes_unref(struct orl_holes *holes); /* NULL is allowed */

/* Returns the exits from the volume along a ray, less the entries: above 0 if the point is
 * inside. */
int orl_hole_winding_number(const struct orl_geometry *shell, struct orl_vec3 point,
                            struct orl_vec3 direction);
/* An arbitrary direction that no surface is likely to be parallel to. */
extern const struct orl_vec3 orl_hole_skew;

bool orl_hole_is_inside(const struct orl_hole *hole, struct orl_vec3 point);
/* Returns true if a hit on the volume's surface lies in material that the volume cuts, and in no
 * other volume. */
bool orl_hole_is_lining(const struct orl_geometry *geometry, const struct orl_hole *hole,
                        const struct orl_hit *hit);

/* Returns true if the hit facet is present at the hit point. */
bool orl_holes_hit_remains(const struct orl_geometry *geometry, const struct orl_hit *hit);

/*
 * Linings of antimatter where matter is ambiguous. The space behind a surface that shows its back
 * counts as matter. So a room whose surfaces face outwards is matter: the lining would appear
 * inside the room and block light. Radiance's rays, which count the volumes they enter, meet no
 * lining from within such a room.
 *
 * So a lining is omitted, as if it were "void", where windows in its volume face it on one side,
 * and open space on the other. The space behind a window is not matter. Rooms without windows only
 * get a warning, by the places of sensors and eyes (run/diagnostics/health_warnings.c).
 *
 * Threads: decided once, by one thread, before the geometry is shared or copied; then immutable.
 */

/* is_window: by material, true if light passes it. */
void orl_linings_resolve(struct orl_geometry *geometry, const bool *is_window);

/* Returns the number of antimatters; their indices are 0 to this - 1. */
size_t orl_linings_count(const struct orl_geometry *geometry);
/* Returns its material, and a facet of its volume's surface, for messages. */
void orl_lining_of(const struct orl_geometry *geometry, size_t antimatter, uint32_t *ret_material,
                   uint32_t *ret_facet);
/* Returns true if orl_linings_resolve omitted the lining. */
bool orl_lining_is_omitted(const struct orl_geometry *geometry, size_t antimatter);
/* Returns true if it has a lining for which that place (moved coordinates) counts as matter:
 * surfaces that it cuts show their backs all round. */
bool orl_lining_matter_contains(const struct orl_geometry *geometry, size_t antimatter,
                                struct orl_vec3 place);

#endif
