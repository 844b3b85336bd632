/*
 * A loaded scene ready for light: geometry, materials, distant lights, local emitters, and the
 * photon ports. Everything is immutable once built and shared by all threads.
 *
 * Inside and outside. A photon port is a window (glass or BSDF) one face of which sees the outside.
 * Light is split by the first time it crosses a port inwards: what crosses is emitted from the
 * ports (photon/emit.h), carrying whatever radiance really arrives there; what never crosses is
 * emitted from the lights themselves, and only when the scene has openings ("open"). In a sealed
 * scene (not open) photons therefore land inside only, and surfaces outside are evaluated by paths
 * (exterior.h) instead of by density.
 */
#ifndef ORL_LIGHT_WORLD_H
#define ORL_LIGHT_WORLD_H

#include <oriel/crew.h>
#include <oriel/plan.h>

#include "light/images.h"
#include "scene/geometry.h"
#include "scene/scatter.h"

enum { ORL_NO_PORT = -1 };

/* A small distant light, to be sampled directly: the sun, as gendaylit writes it. */
struct orl_sun {
    struct orl_frame frame; /* n towards the centre of the disc */
    double cos_half_angle, solid_angle_sr;
    struct orl_rgb radiance;   /* mean over the disc */
    struct orl_rgb irradiance; /* radiance times solid angle: on a plane that faces the sun */
};

/* A wide distant light: a sky, a ground, a hemisphere of glow. */
struct orl_dome {
    struct orl_vec3 direction;
    double cos_half_angle;
    struct orl_rgb radiance;
    const struct orl_sky *sky; /* multiplies radiance; NULL for none */
};

/* A surface that shines. */
struct orl_emitter {
    uint32_t facet;
    struct orl_rgb radiance;
    bool direct; /* light: sampled by shadow rays; glow: found by rays that happen on it */
};

struct orl_port {
    uint32_t facet;
    bool outside_is_front; /* the declared normal points outdoors */
    struct orl_vec3 outward;
    double area;
    bool shared; /* other surfaces lie in its plane, across it: see orl_port_owns */
    /* What the planner finds out; false, all is found by rays. */
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

/* What a run leaves out (plan/plan.h decides). */
struct orl_omissions {
    bool exterior; /* surfaces outside reflect nothing: they only stand in the way */
    bool glossy, media, refraction,
        bleached; /* already done to the materials; here for who tells maps apart
                   */
    bool mirror_caustics, lobe_caustics; /* no caustic photons by way of mirrors, of lobes */
    bool counted_light; /* global photons that shadow rays or caustic photons count are not kept */
    uint32_t most_reflections; /* diffuse ones that light is followed through */
    uint32_t channels;         /* 3, or 1: all is gray, and red stands for all */
};

struct orl_world {
    struct orl_description description; /* owned */
    struct orl_geometry *geometry;      /* owned; what light meets */
    struct orl_world *seen;             /* what views see: this world with another geometry, or NULL
                                           when there are no BSDFs that stand for geometry */
    struct orl_geometry *proxies;       /* owned: of those BSDFs, or NULL */
    bool *hidden;                       /* per facet: there for views alone; or NULL. proxies.h */
    size_t n_hidden;
    struct orl_pairing paired, not_paired; /* taken as one though neither reaches the other; as two
                                              though little is missing */
    struct orl_sun *suns;
    size_t n_suns;
    struct orl_dome *domes;
    size_t n_domes;
    struct orl_emitter *emitters;
    size_t n_emitters;
    struct orl_images images; /* of the suns, in flat mirrors; made with the ports */
    struct orl_port *ports;
    size_t n_ports;
    int32_t *port_of_facet; /* index into ports or ORL_NO_PORT */
    bool open;              /* light can get in without crossing a port */
    bool caustics_lit;      /* the planner found mirrors or lobes that a sun or lamp lights: caustic
                               photons are to be shot, whether or not a pilot's flights meet them */
    struct orl_omissions omit;
};

/*
 * Takes the description over (it is emptied, also on failure) and builds all but the ports.
 * Returns 0 or ORL_ERR_NOMEM, _UNSUPPORTED, _LIMIT.
 */
int orl_world_new(struct orl_description *description, struct orl_world **ret_world,
                  struct orl_error *err);
void orl_world_free(struct orl_world *world);

/* Of its suns only those; NULL: none. */
void orl_world_keep_suns(struct orl_world *world, const bool *keep);

/* Finds the ports, whether the scene is open, and the suns' images; to be called once, before rays
 * are asked. */
int orl_world_find_ports(struct orl_world *world, struct orl_crew *crew, struct orl_error *err);

static inline const struct orl_material *orl_world_material(const struct orl_world *world,
                                                            const struct orl_hit *hit)
{
    const struct orl_facet *facet = &world->geometry->facets[hit->facet];
    return &world->description.materials[facet->material];
}

/* Radiance of the domes in a direction; suns are not in it. */
struct orl_rgb orl_world_dome_radiance(const struct orl_world *world, struct orl_vec3 direction);

/* Radiance of the suns in a direction: non-zero within their discs. */
struct orl_rgb orl_world_sun_radiance(const struct orl_world *world, struct orl_vec3 direction);

/* A direction uniform over the sun's disc; u in [0,1)^2. */
struct orl_vec3 orl_sun_sample(const struct orl_sun *sun, const double u[2]);

/*
 * Whether a place on a port is the port's own. Where two surfaces lie in one plane a ray meets one
 * of them and is past both: so must be what the ports send in, or light would be counted twice.
 */
bool orl_port_owns(const struct orl_world *world, const struct orl_port *port,
                   struct orl_vec3 point);

/* Whether a point of open space counts as outside: false unless the scene is sealed. */
bool orl_world_is_outside(const struct orl_world *world, struct orl_vec3 point);

/* Whether a path through this hit passes a port, and to which side. */
enum orl_crossing { ORL_CROSSING_NONE, ORL_CROSSING_INWARDS, ORL_CROSSING_OUTWARDS };
enum orl_crossing orl_world_crossing(const struct orl_world *world, const struct orl_hit *hit);

/* Whether it passes, outwards, a port beyond which nothing is. */
bool orl_world_leaves_clear(const struct orl_world *world, const struct orl_hit *hit);

#endif
