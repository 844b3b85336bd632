/*
 * The search for photon ports: which side of a window is outside, what focuses light before it,
 * unglazed openings, and the panes that they get.
 */
#ifndef ORL_SCENE_BUILT_PORTS_H
#define ORL_SCENE_BUILT_PORTS_H

#include "base/sampling/sampling.h"
#include "scene/built/scene.h"
#include "scene/geometry/geometry.h"
#include "scene/parsed_scene.h"

/*
 * Shares of rays that leave the scene from either side of a window or an opening, with every
 * surface taken as opaque. They show which side is outside.
 */

/* Fills ret_shares with the shares of rays that leave from the front and from the back of one of
 * the scene's own facets. Directions are cosine-weighted. Fewer rays are traced if the result is
 * clear earlier (orl_escape_is_decided). */
void orl_escape_shares(const struct orl_geometry *geometry, uint32_t facet, uint32_t rays,
                       struct orl_random *random, double ret_shares[2]);

/* Returns true if `rays` rays of each side are enough, of which left[] have left. That is so if
 * at least a quarter of one side's leave, and none of the other's. The probability that the
 * other side's share then exceeds a quarter of the first's is at most 1e-7. */
static inline bool orl_escape_is_decided(const uint32_t left[2], uint32_t rays)
{
    const uint32_t more = left[0] > left[1] ? left[0] : left[1];
    return rays >= 256 && more >= rays / 4 && (left[0] == 0 || left[1] == 0);
}

/* Returns true if the side with the larger share is outside and the other one is not. Free-standing
 * panes see open space from both sides, so the result is false. */
bool orl_escape_shows_outside(const double shares[2]);

/*
 * Surfaces outdoors that focus or spread the light of a sun: curved or textured mirrors, and bodies
 * that refract. Paths outdoors do not find suns by way of them (exterior.h), so ports, which emit
 * the light of such paths, would omit it. Photons from the sun find it.
 */

/* Rays traced from the outer side of a window or an opening, and how many of them met a focusing
 * surface. */
struct orl_focusing_probe {
    const struct orl_scene *scene;
    bool any_orientation; /* flat refracting surfaces count whatever their orientation */
    size_t rays;
    /* rays that met a focusing surface; those to convex mirrors have a smaller weight */
    double focusing_rays;
    /* the first two orientations (normals) of flat refracting surfaces; 0: none yet */
    struct orl_vec3 flat_normals[2];
};

/* Traces a ray to its first hit. Flat refracting surfaces count from the third orientation on:
 * water, and panes in one or two facades, only move the light. */
void orl_focusing_trace(struct orl_focusing_probe *probe, struct orl_vec3 from,
                        struct orl_vec3 direction);

/* Returns true if at least 1 ray in 500 has met such a surface, or 1 in 50 a convex mirror. */
bool orl_focusing_is_significant(const struct orl_focusing_probe *probe);

/*
 * Unglazed openings: free rectangles that the polygons of a plane surround, such as a window
 * without a pane, or the part of a hole beside a pane.
 *
 * An opening made of several rectangles is found as these. Their sides are parallel to the longest
 * edge of the plane's first polygon, or perpendicular to it; other openings are not found, nor are
 * those that reach the rim of all polygons of the plane. The search takes bounded work: planes with
 * many polygons or corners are left out.
 */

enum { ORL_UNGLAZED_OPENINGS_MAX = 256 };

struct orl_unglazed_opening {
    struct orl_vec3 corner, sides[2]; /* the other corners are corner plus one or both sides */
    struct orl_vec3 normal;           /* unit, along sides[0] x sides[1] */
    size_t surface;                   /* one of the polygons about it */
};

/* Fills ret_openings[ORL_UNGLAZED_OPENINGS_MAX]. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_unglazed_find(const struct orl_parsed_scene *parsed_scene,
                      struct orl_unglazed_opening *ret_openings, size_t *ret_n);

/*
 * Panes for unglazed openings that let daylight in. Each gets a pane that changes no light, glass
 * of index 1, so that it is a port (scene.h) as a glazed window is. Photons then start at it, and
 * rays from inside are sampled towards it.
 */

/*
 * Adds the panes to a scene whose geometry is built; the geometry is rebuilt if there are any.
 * Returns 0 or ORL_ERR_NOMEM, _LIMIT, _CANCELLED.
 *
 * An opening gets a pane if rays leave the scene from one of its sides several times as often as
 * from the other (orl_escape_shows_outside). Rays past panes of other openings are not counted. It
 * gets none if
 * - it is before windows that are ports themselves (the opening of a frame or a courtyard)
 * - curved mirrors or lenses are before it outdoors, whose light ports do not send in
 * - the scene has participating media
 */
int orl_scene_glaze_openings(struct orl_scene *scene, struct orl_error *err);

#endif
