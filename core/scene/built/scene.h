/*
 * A scene without its lights: the parsed files, the surfaces that light and views meet, and the
 * windows that let light in. It is independent of sky and plan, so jobs share it.
 *
 * Immutable once its ports are found, and shared by all threads. Reference-counted (orl_scene_hold,
 * orl_scene_release).
 */
#ifndef ORL_SCENE_BUILT_SCENE_H
#define ORL_SCENE_BUILT_SCENE_H

#include <stdatomic.h>

#include <oriel/base/sha256.h>
#include <oriel/base/thread_pool.h>

#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"
#include "scene/surface_labels.h"

enum { ORL_NO_PORT = -1 };

/* A photon port (lit_scene.h): a window one face of which sees the outside. */
struct orl_port {
    uint32_t facet;
    bool outside_is_front; /* the declared normal points outdoors */
    struct orl_vec3 outward;
    double area;
    bool shared; /* other surfaces overlap it in its plane: see orl_port_owns */
    /* Findings of the planner, in a world's own ports; if false, rays find all light. */
    /* nothing lies beyond its plane: rays outwards see domes and suns only */
    bool clear;
    bool silent; /* no light arrives at it from outside: it emits no photons */
};

/* Proxies (proxies.h) for which it is uncertain whether they are a pair: count and first
 * example. */
struct orl_proxy_pairing {
    size_t count;
    /* The first example. */
    uint32_t facets[2];
    /* apart: distance between the two; thick: thickness of the thicker one */
    double apart, thick;
};

struct orl_scene {
    struct orl_parsed_scene parsed_scene; /* owned */
    struct orl_geometry *geometry;        /* owned; surfaces that light meets */
    struct orl_geometry *seen;    /* owned; surfaces that views meet; NULL: the same as geometry */
    struct orl_geometry *proxies; /* owned; BSDFs that stand for geometry; NULL: none */
    struct orl_geometry *mist;    /* owned; surfaces of volume.h's volumes; NULL: none */
    /* per facet of the scene's own (not instanced): true if it exists for views only
     * (proxies.h); or NULL */
    bool *hidden;
    size_t n_hidden;
    /* paired: taken as a pair although neither reaches the other; not_paired: taken as two
     * although they nearly are a pair */
    struct orl_proxy_pairing paired, not_paired;
    uint32_t *emissive; /* facets that are lamps or glow */
    size_t n_emissive;
    struct orl_port *ports;
    size_t n_ports;
    /* index into ports, or ORL_NO_PORT, per facet of the scene's own (not instanced) */
    int32_t *port_of_facet;
    size_t n_openings; /* unglazed openings that were given panes (glaze_openings.h) */
    bool open;         /* light can enter without crossing a port */
    atomic_uint holders;
};

/*
 * Decides which of several coincident surfaces light meets, and removes the others. Called once.
 * Returns 0 or ORL_ERR_NOMEM, _LIMIT, _RANGE, _CANCELLED.
 */
int orl_scene_remove_coincident(struct orl_parsed_scene *parsed_scene, struct orl_error *err);

/*
 * Takes the description over (it is emptied, also on failure), calls orl_scene_remove_coincident
 * unless that was done, and builds all but the ports. Returns 0 and a scene that the caller holds,
 * or ORL_ERR_NOMEM, _UNSUPPORTED, _LIMIT, _CANCELLED.
 */
int orl_scene_new(struct orl_parsed_scene *parsed_scene, struct orl_scene **ret_scene,
                  struct orl_error *err);

/* Finds the ports, and whether the scene is open. Called once, before lights are added. Returns
 * 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_scene_find_ports(struct orl_scene *scene, struct orl_thread_pool *pool,
                         struct orl_error *err);

struct orl_scene *orl_scene_hold(struct orl_scene *scene);
/* NULL is allowed. */
void orl_scene_release(struct orl_scene *scene);

/* Returns the scene's size in memory, roughly: surfaces, geometry with its hierarchy, each BSDF
 * once. */
uint64_t orl_scene_bytes(const struct orl_scene *scene);

static inline const struct orl_material *orl_scene_material(const struct orl_scene *scene,
                                                            size_t facet)
{
    return &scene->parsed_scene.materials[orl_facet_material(scene->geometry, facet)];
}

/*
 * Adds to the hash how rays meet the scene beyond what its files say. In scenes with many
 * triangles, rays through an edge may hit its other side (orl_geometry_is_vast), and numbers are
 * packed (packed.h): that is the third recipe for these scenes. A lining may be removed
 * (linings.h), and openings may have been given panes (glaze_openings.h).
 */
void orl_scene_digest_build(const struct orl_scene *scene, struct orl_sha256 *hash);

/* Returns the index of the port that a facet is, or ORL_NO_PORT, also before ports are searched. */
static inline int32_t orl_scene_port_of(const struct orl_scene *scene, uint32_t facet)
{
    return scene->port_of_facet && !orl_facet_is_instanced(scene->geometry, facet)
               ? scene->port_of_facet[facet]
               : ORL_NO_PORT;
}

/* The side to which a path through a hit passes a port, if it passes one. */
enum orl_port_crossing { ORL_CROSSING_NONE, ORL_CROSSING_INWARDS, ORL_CROSSING_OUTWARDS };
enum orl_port_crossing orl_scene_crossing(const struct orl_scene *scene, const struct orl_hit *hit);

/* Return what the files say of a facet, for messages; for an instanced one, of its first
 * instance. */
struct orl_surface_label orl_scene_label_of(const struct orl_scene *scene, uint32_t facet);

const char *orl_scene_name_of(const struct orl_scene *scene, uint32_t facet);
/* Returns true if `name` is the name of the facet's surface, or of its modifier. */
bool orl_scene_has_name(const struct orl_scene *scene, uint32_t facet, const char *name);

/*
 * Returns true if light at a point of a port belongs to that port. Of two surfaces that overlap in
 * a plane, a ray meets one and is then past both. Ports emit light by the same rule, or it would be
 * counted twice.
 */
bool orl_port_owns_shared(const struct orl_geometry *geometry, const struct orl_port *port,
                          struct orl_vec3 point); /* for ports that share their plane */
static inline bool orl_port_owns(const struct orl_geometry *geometry, const struct orl_port *port,
                                 struct orl_vec3 point)
{
    return !port->shared || orl_port_owns_shared(geometry, port, point);
}

#endif
