/*
 * A scene without its lights: the parsed scene, the geometry that light and views meet, BSDFs as
 * proxies for geometry, participating media, and the windows that let light in. It is independent
 * of sky and plan, so jobs share it.
 *
 * Immutable once its ports are found, and shared by all threads. Reference-counted (orl_scene_hold,
 * orl_scene_release).
 */
#ifndef ORL_SCENE_BUILT_SCENE_H
#define ORL_SCENE_BUILT_SCENE_H

#include <stdatomic.h>

#include <oriel/base/sha256.h>
#include <oriel/base/thread_pool.h>

#include "base/sampling/sampling.h"
#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"
#include "scene/surfaces.h"

enum { ORL_NO_PORT = -1 };

/* A photon port (light/lit_scene.h): a window one face of which sees the outside. */
struct orl_port {
    uint32_t facet;
    bool outside_is_front; /* the declared normal points outdoors */
    struct orl_vec3 outward;
    double area;
    bool shared; /* other surfaces overlap it in its plane: see orl_port_owns */
    /* Findings of the planner, in a lit scene's own ports; if false, rays find all light. */
    /* nothing lies beyond its plane: rays outwards see domes and suns only */
    bool clear;
    bool silent; /* no light arrives at it from outside: it emits no photons */
};

/* Proxies for which it is uncertain whether they are a pair: count and first example. */
struct orl_proxy_pairing {
    size_t count;
    /* The first example. */
    uint32_t facets[2];
    /* apart: distance between the two; thick: thickness of the thicker one */
    double apart, thick;
};

struct orl_scene {
    struct orl_parsed_scene parsed_scene; /* owned */
    struct orl_geometry *geometry;        /* owned; surfaces for light */
    struct orl_geometry *seen;    /* owned; surfaces for views; NULL: the same as geometry */
    struct orl_geometry *proxies; /* owned; BSDFs as proxies for geometry; NULL: none */
    struct orl_geometry *mist;    /* owned; boundaries of participating media; NULL: none */
    /* per facet of the scene's own (not instanced): true if it exists for views only
     * (proxies below); or NULL */
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
    size_t n_openings; /* unglazed openings that were given panes (ports.h) */
    bool open;         /* light can enter without crossing a port */
    atomic_uint holders;
};

/*
 * Decides which of several coincident surfaces light meets, and removes the others. Called once.
 * Returns 0 or ORL_ERR_NOMEM, _LIMIT, _RANGE, _CANCELLED.
 */
int orl_scene_remove_coincident(struct orl_parsed_scene *parsed_scene, struct orl_error *err);

/*
 * Takes the parsed scene over (it is emptied, also on failure), calls orl_scene_remove_coincident
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
 * Adds to the hash how rays hit the scene, beyond what its files say. In scenes with many
 * triangles, rays through an edge may hit its other side (orl_geometry_is_vast), and numbers are
 * packed (packed.h): that is the third recipe for these scenes. A lining may be omitted
 * (antimatter.h), and openings may have been given panes (ports.h).
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

/*
 * Proxies: BSDFs for geometry. A BSDF with a thickness is a proxy. It was measured from the slats,
 * prisms or other surfaces within that distance, on the side opposite its normal (negative
 * thickness: on the side of its normal). Light meets the proxy, and views see the geometry.
 *
 * So there are two scenes. In the scene of light (orl_scene.geometry) the surfaces that a proxy
 * represents are removed. There the proxy scatters as any BSDF does, on both sides. Rays that leave
 * it to the side of the geometry start beyond it, because partly covered surfaces may remain there.
 *
 * If two proxies represent the same geometry, one to each side, the first serves both. They are
 * such a pair if they face opposite ways and their two thicknesses together span the distance
 * between them. (In Radiance each scatters only light from its outer side, at any distance, with
 * the same result. Files have pairs a little further apart than either is thick.)
 *
 * In the scene of views (orl_scene.seen) there are no proxies. The surfaces behind them are lit by
 * paths in that scene, which are separate and only for view rays. No light is counted twice:
 * photons, gather rays and shadow rays use one scene, views of hidden surfaces the other.
 *
 * A surface is hidden if at least three quarters of it, seen across the proxy's plane, have the
 * proxy within its thickness. A reveal that ends at the proxy's edge is not hidden, because the
 * directions spread a little to all sides. Radiance differs: it lets shadow rays pass proxies to
 * the geometry.
 */

/*
 * Splits the geometry of a new scene into the two; without proxies nothing changes. Returns 0,
 * ORL_ERR_NOMEM, or ORL_ERR_LIMIT if proxies have more orientations than are searched.
 */
int orl_proxies_split(struct orl_scene *scene, struct orl_error *err);

/* Returns the crossing of the last port that is a proxy and that a view ray passes within a
 * distance. */
enum orl_port_crossing orl_proxies_last_crossing(const struct orl_scene *scene,
                                                 struct orl_vec3 origin, struct orl_vec3 direction,
                                                 double distance);

/*
 * Participating media (Radiance's mist): volumes that absorb and scatter light, between boundaries
 * that light passes unchanged. The boundaries have a geometry of their own. A ray's path through a
 * medium lies between its crossings of them; inside is behind the normal. Where volumes overlap,
 * extinctions add up, and each volume scatters its own share.
 *
 * A scattering distance is sampled by the extinction of one of three channels. Weights use the mean
 * pdf of all three (the balance heuristic), so they are at most three. Phase functions are
 * Henyey-Greenstein, sampled exactly.
 *
 * Lengths are metres, extinction is 1/m. References: Henyey and Greenstein 1941; Wilkie et al.,
 * "Hero Wavelength Spectral Sampling", 2014, on weights of several channels.
 */

/* Moves the boundaries of participating media from the scene's geometry to one of their own.
 * Returns 0, ORL_ERR_NOMEM, or ORL_ERR_LIMIT. */
int orl_volume_split(struct orl_scene *scene, struct orl_error *err);

/* Returns the share of light that is neither absorbed nor scattered over a distance, which may
 * be infinite. */
struct orl_rgb orl_volume_transmittance(const struct orl_scene *scene, struct orl_vec3 origin,
                                        struct orl_vec3 direction, double distance);

/* A sampled scattering event, or the passage without one, and the path's weight. */
struct orl_volume_event {
    bool scattered;
    /* distance: of the event; asymmetry: parameter of its phase function, -1 to 1 */
    double distance, asymmetry;
    struct orl_rgb weight;
};
struct orl_volume_event orl_volume_sample_event(const struct orl_scene *scene,
                                                struct orl_vec3 origin, struct orl_vec3 direction,
                                                double distance, struct orl_random *random);

/* Return the phase function, 1/sr, for the cosine between old and new direction, and a direction
 * sampled from it. */
double orl_phase_function(double asymmetry, double cosine);
struct orl_vec3 orl_phase_function_sample(double asymmetry, struct orl_vec3 along,
                                          const double u[2]);

#endif
