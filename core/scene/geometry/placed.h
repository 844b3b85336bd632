/*
 * What a scene has in several places, and keeps once: a prototype is a geometry of its own, about
 * its own middle, and stands in the scene by a transform, as an instance of Embree's.
 *
 * Numbers: facets and triangles of a place follow those of the scene itself and of the places
 * before. Most of them have nothing of their own: orl_facet_of is the prototype's, whose kind and
 * material hold; orl_facet_at is as it stands. They are no lamps and no panes; arrays by facet are
 * of the scene's own alone.
 */
#ifndef ORL_SCENE_GEOMETRY_PLACED_H
#define ORL_SCENE_GEOMETRY_PLACED_H

#include "scene/geometry/embree.h"
#include "scene/placements.h"

struct orl_placed {
    const struct orl_geometry *prototype;
    uint32_t number;           /* of it */
    struct orl_xform to, from; /* between its coordinates, moved as its are, and the scene's */
    double offset;             /* of all its facets (orl_facet) */
    uint32_t first_facet, first_triangle;
    struct orl_vec3 low, high; /* bounds in the scene */
};

/* Of a number that is not the scene's own. */
const struct orl_placed *orl_placed_of(const struct orl_geometry *geometry, uint32_t facet);

/* A facet as it stands: its triangles by their numbers in the scene, no rivals. What is round of it
 * is written to room. */
struct orl_facet orl_facet_at(const struct orl_geometry *geometry, uint32_t facet,
                              struct orl_curved *room);

/*
 * All that is kept, the scene's own facets and then those of each prototype, by their numbers in
 * its first place: for (walk = orl_kept_walk(g); orl_kept_next(&walk);).
 */
struct orl_kept_walk {
    const struct orl_geometry *geometry;
    const struct orl_geometry *part; /* whose facet it is: the scene's, or a prototype */
    uint32_t facet;
    size_t places; /* that it stands in */
    size_t next;   /* the number within the part, and the prototype, that come then */
    size_t next_prototype;
};
struct orl_kept_walk orl_kept_walk(const struct orl_geometry *geometry);
bool orl_kept_next(struct orl_kept_walk *walk);

/* A hit on the prototype as one on the scene, of a ray from there. */
void orl_placed_hit(const struct orl_geometry *geometry, const struct orl_placed *placed,
                    struct orl_vec3 origin, struct orl_vec3 direction, struct orl_hit *hit);

/* Whether it is on something placed. */
static inline bool orl_hit_is_placed(const struct orl_geometry *geometry, const struct orl_hit *hit)
{
    return hit->instance - 1 < geometry->n_placed;
}

/*
 * A hit on a place as one where its prototype was read, which is how functions of the place have
 * been written for it: point and normal there, the facet by its number; the instance is 0. And
 * directions, there and back.
 */
struct orl_hit orl_placed_as_read(const struct orl_geometry *geometry, const struct orl_hit *hit);
struct orl_vec3 orl_placed_direction_read(const struct orl_geometry *geometry,
                                          const struct orl_hit *hit, struct orl_vec3 direction);
struct orl_vec3 orl_placed_direction(const struct orl_geometry *geometry, const struct orl_hit *hit,
                                     struct orl_vec3 read);

/*
 * Makes the places of prototypes that are built. The scene's own bounds are known, in the files'
 * coordinates, and grow by those of all places. False: out of memory. Then, once the scene's middle
 * is known, and how many facets and triangles it has of its own, numbers them; ORL_ERR_LIMIT.
 */
bool orl_placed_measure(struct orl_geometry *geometry, const struct orl_description *description,
                        struct orl_vec3 *low, struct orl_vec3 *high);
int orl_placed_number(struct orl_geometry *geometry, struct orl_error *err);

#endif
