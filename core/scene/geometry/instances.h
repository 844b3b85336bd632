/*
 * Instances: a prototype is a geometry of its own, about its own centre, which a transform places
 * in the scene as an instance of Embree's.
 *
 * Indices: facets and triangles of an instance follow those of the scene itself and of earlier
 * instances. Most of their data are not stored: orl_facet_get returns the prototype's facet, whose
 * kind and material are valid; orl_instance_facet returns it transformed. They are never lights or
 * windows; arrays by facet cover the scene's own facets only.
 */
#ifndef ORL_SCENE_GEOMETRY_INSTANCES_H
#define ORL_SCENE_GEOMETRY_INSTANCES_H

#include "scene/geometry/intersect.h"
#include "scene/surfaces.h"

struct orl_instance {
    const struct orl_geometry *prototype;
    uint32_t number;           /* index of the prototype */
    struct orl_xform to, from; /* from the prototype's moved coordinates to the scene's, and back */
    double offset;             /* offset of all its facets (orl_facet) */
    uint32_t first_facet, first_triangle;
    struct orl_vec3 low, high; /* bounds in the scene */
};

/* Returns the instance of a facet whose index is beyond the scene's own. */
const struct orl_instance *orl_instance_of(const struct orl_geometry *geometry, uint32_t facet);

/* Returns a facet in the scene's coordinates: its triangles by their indices in the scene, no
 * opposite facets. Centres and radii are written to *room. */
struct orl_facet orl_instance_facet(const struct orl_geometry *geometry, uint32_t facet,
                                    struct orl_quadric *room);

/*
 * Iterates over the scene's own facets and then those of each prototype, by their indices in its
 * first instance: for (walk = orl_facet_iterator(g); orl_facet_iterator_next(&walk);).
 */
struct orl_facet_iterator {
    const struct orl_geometry *geometry;
    /* the geometry that owns the facet: the scene's, or a prototype */
    const struct orl_geometry *part;
    uint32_t facet;
    size_t places; /* number of places of the facet */
    size_t next;   /* next index within `part`, and next prototype */
    size_t next_prototype;
};
struct orl_facet_iterator orl_facet_iterator(const struct orl_geometry *geometry);
bool orl_facet_iterator_next(struct orl_facet_iterator *walk);

/* Transforms a hit on the prototype into one on the scene, for the given ray in the scene. */
void orl_instance_hit(const struct orl_geometry *geometry, const struct orl_instance *instance,
                      struct orl_vec3 origin, struct orl_vec3 direction, struct orl_hit *hit);

/* Returns true if the hit is on an instance. */
static inline bool orl_hit_is_instanced(const struct orl_geometry *geometry,
                                        const struct orl_hit *hit)
{
    return hit->instance - 1 < geometry->n_instances;
}

/*
 * Transforms a hit on an instance to the place where its prototype was read, for which functions of
 * the place are written: point and normal there, the facet by its index, instance 0. The other two
 * transform directions there and back.
 */
struct orl_hit orl_instance_to_prototype(const struct orl_geometry *geometry,
                                         const struct orl_hit *hit);
struct orl_vec3 orl_instance_direction_in(const struct orl_geometry *geometry,
                                          const struct orl_hit *hit, struct orl_vec3 direction);
struct orl_vec3 orl_instance_direction_out(const struct orl_geometry *geometry,
                                           const struct orl_hit *hit, struct orl_vec3 read);

/*
 * orl_instances_build makes the instances of prototypes that are built, and extends the scene's own
 * bounds, in the files' coordinates, by theirs; false if out of memory. orl_instances_number
 * assigns their indices once the scene's centre and its own numbers of facets and triangles are
 * known; ORL_ERR_LIMIT if there are too many.
 */
bool orl_instances_build(struct orl_geometry *geometry, const struct orl_parsed_scene *parsed_scene,
                         struct orl_vec3 *low, struct orl_vec3 *high);
int orl_instances_number(struct orl_geometry *geometry, struct orl_error *err);

#endif
