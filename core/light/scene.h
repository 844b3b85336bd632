/*
 * A scene without its lights: what the files say, the surfaces that light and views meet, the
 * windows that let light in. All of it is the same under every sky and for every plan, so that jobs
 * share it.
 *
 * Immutable once its ports are found, and shared by all threads; held by whoever uses it
 * (orl_scene_hold), and gone with the last of them.
 */
#ifndef ORL_LIGHT_SCENE_H
#define ORL_LIGHT_SCENE_H

#include <stdatomic.h>

#include <oriel/crew.h>
#include <oriel/sha256.h>

#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"
#include "scene/surface_labels.h"

enum { ORL_NO_PORT = -1 };

/* A photon port (world.h): a window one face of which sees the outside. */
struct orl_port {
    uint32_t facet;
    bool outside_is_front; /* the declared normal points outdoors */
    struct orl_vec3 outward;
    double area;
    bool shared; /* other surfaces lie in its plane, across it: see orl_port_owns */
    /* What the planner finds out, of its world's own; false, all is found by rays. */
    bool clear;  /* nothing lies beyond its plane: whoever looks out sees domes and suns alone */
    bool silent; /* no light comes to it from outside: it sends no photons */
};

/* Proxies (proxies.h) of which it is not plain that they are a pair, or none. */
struct orl_pairing {
    size_t count;
    /* Of the first: */
    uint32_t facets[2];
    double apart, thick; /* the thicker one */
};

struct orl_scene {
    struct orl_description description; /* owned */
    struct orl_geometry *geometry;      /* owned; what light meets */
    struct orl_geometry *seen;          /* owned: what views meet, or NULL for the same */
    struct orl_geometry *proxies;       /* owned: BSDFs that stand for geometry, or NULL */
    struct orl_geometry *mist;          /* owned: the surfaces of mist.h's volumes, or NULL */
    bool *hidden; /* per facet of its own: there for views alone; or NULL. proxies.h */
    size_t n_hidden;
    struct orl_pairing paired, not_paired; /* taken as one though neither reaches the other; as two
                                              though little is missing */
    uint32_t *shining;                     /* facets that are lamps, or glow */
    size_t n_shining;
    struct orl_port *ports;
    size_t n_ports;
    int32_t *port_of_facet; /* of its own: index into ports or ORL_NO_PORT */
    size_t n_openings;      /* unglazed ones that were given panes (glaze.h) */
    bool open;              /* light can get in without crossing a port */
    atomic_uint holders;
};

/*
 * Settles which of surfaces in one place light meets, once: what rays are to meet is all that is
 * left. ORL_ERR_NOMEM, _LIMIT, _RANGE, _CANCELLED.
 */
int orl_scene_settle(struct orl_description *description, struct orl_error *err);

/*
 * Takes the description over (it is emptied, also on failure), settles it unless it is, and builds
 * all but the ports. Returns 0, and a scene that the caller holds, or ORL_ERR_NOMEM, _UNSUPPORTED,
 * _LIMIT, _CANCELLED.
 */
int orl_scene_new(struct orl_description *description, struct orl_scene **ret_scene,
                  struct orl_error *err);

/* Finds the ports, and whether the scene is open; to be called once, before lights are added. */
int orl_scene_find_ports(struct orl_scene *scene, struct orl_crew *crew, struct orl_error *err);

struct orl_scene *orl_scene_hold(struct orl_scene *scene);
/* NULL is allowed. */
void orl_scene_release(struct orl_scene *scene);

/* What it holds in memory, roughly: surfaces, geometry with its hierarchy, each BSDF once. */
uint64_t orl_scene_bytes(const struct orl_scene *scene);

static inline const struct orl_material *orl_scene_material(const struct orl_scene *scene,
                                                            size_t facet)
{
    return &scene->description.materials[orl_facet_material(scene->geometry, facet)];
}

/*
 * What its files do not say of how rays meet it: where triangles are many, those that pass through
 * an edge may meet the other side of it (orl_geometry_is_vast), and numbers are packed (packed.h),
 * which is the third recipe of that; and a lining may be left away (linings.h).
 */
void orl_scene_digest_recipe(const struct orl_scene *scene, struct orl_sha256 *hash);

/* Which port a facet is, or ORL_NO_PORT; which it is, too, before ports are sought. */
static inline int32_t orl_scene_port_of(const struct orl_scene *scene, uint32_t facet)
{
    return scene->port_of_facet && !orl_facet_is_placed(scene->geometry, facet)
               ? scene->port_of_facet[facet]
               : ORL_NO_PORT;
}

/* Whether a path through this hit passes a port, and to which side. */
enum orl_crossing { ORL_CROSSING_NONE, ORL_CROSSING_INWARDS, ORL_CROSSING_OUTWARDS };
enum orl_crossing orl_scene_crossing(const struct orl_scene *scene, const struct orl_hit *hit);

/* What the files say of it, for messages; where it stands in several places, of the first. */
struct orl_surface_label orl_scene_label_of(const struct orl_scene *scene, uint32_t facet);

const char *orl_scene_name_of(const struct orl_scene *scene, uint32_t facet);
/* Whether that is its surface's name, or its modifier's. */
bool orl_scene_has_name(const struct orl_scene *scene, uint32_t facet, const char *name);

/*
 * Whether a place on a port is the port's own. Where two surfaces lie in one plane a ray meets one
 * of them and is past both: so must be what the ports send in, or light would be counted twice.
 */
bool orl_port_owns_shared(const struct orl_geometry *geometry, const struct orl_port *port,
                          struct orl_vec3 point); /* of a plane that is shared */
static inline bool orl_port_owns(const struct orl_geometry *geometry, const struct orl_port *port,
                                 struct orl_vec3 point)
{
    return !port->shared || orl_port_owns_shared(geometry, port, point);
}

#endif
