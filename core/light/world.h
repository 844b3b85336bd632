/*
 * A scene with its lights, as a job simulates it: what its plan leaves out is not in it. Everything
 * that carries light reads this, and nobody changes it once it is made.
 *
 * Inside and outside. A photon port is a window (glass or BSDF) one face of which sees the outside.
 * Light is split by the first time it crosses a port inwards: what crosses is emitted from the
 * ports (photon/flight/emit.h), carrying whatever radiance really arrives there; what never crosses
 * is emitted from the lights themselves, and only when the scene has openings ("open"). In a sealed
 * scene (not open) photons therefore land inside only, and surfaces outside are evaluated by paths
 * (exterior.h) instead of by density.
 */
#ifndef ORL_LIGHT_WORLD_H
#define ORL_LIGHT_WORLD_H

#include <oriel/plan.h>

#include "light/images.h"
#include "light/lamp_images.h"
#include "light/lights.h"

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
    struct orl_scene *scene;   /* held */
    struct orl_lights *lights; /* held: all there are; suns and domes point into them */
    /* The scene's, at hand: */
    const struct orl_geometry *geometry; /* what light meets */
    const struct orl_geometry *proxies;
    const bool *hidden;
    const int32_t *port_of_facet; /* of the scene's own facets: index into ports or ORL_NO_PORT;
                                     NULL: ports were not sought */
    bool open;                    /* light can get in without crossing a port */
    struct orl_world *seen;       /* what views see: this world with another geometry, or NULL when
                                     there are no BSDFs that stand for geometry */
    /* What is simulated, of its own: */
    struct orl_material *materials;
    size_t n_materials;
    struct orl_sun *suns;
    size_t n_suns;
    struct orl_dome *domes;
    size_t n_domes;
    struct orl_emitter *emitters;
    size_t n_emitters;
    double most_aimed_glow; /* the lights' */
    struct orl_port *ports;
    size_t n_ports;
    struct orl_images images;           /* of the suns, in flat mirrors; none without ports */
    struct orl_lamp_images lamp_images; /* the same of lamps */
    bool caustics_lit; /* the planner found mirrors or lobes that a sun or lamp lights: caustic
                          photons are to be shot, whether or not a pilot's flights meet them */
    struct orl_omissions omit;
};

/*
 * All of the scene and its lights; both are held. crew: whose cancellation is heeded, or NULL.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. Whoever made it may take things out of it
 * (plan/plan.h) before it is used, and then has to settle it.
 */
int orl_world_new(struct orl_lights *lights, const struct orl_crew *crew,
                  struct orl_world **ret_world, struct orl_error *err);
void orl_world_free(struct orl_world *world);

/* Of its suns only those; NULL: none. */
void orl_world_keep_suns(struct orl_world *world, const bool *keep);

/* Makes orl_world.seen what it is to be, once the rest is. */
void orl_world_settle(struct orl_world *world);

/* The scene that views see. */
static inline const struct orl_world *orl_world_seen(const struct orl_world *world)
{
    return world->seen ? world->seen : world;
}

static inline const struct orl_material *orl_world_material(const struct orl_world *world,
                                                            const struct orl_hit *hit)
{
    return &world->materials[orl_facet_material(world->geometry, hit->facet)];
}

/* Radiance of the domes in a direction, as it lights things; suns are not in it. */
struct orl_rgb orl_world_dome_radiance(const struct orl_world *world, struct orl_vec3 direction);
/* As views see it. */
struct orl_rgb orl_world_dome_seen(const struct orl_world *world, struct orl_vec3 direction);

/* Radiance of the suns in a direction: non-zero within their discs. */
struct orl_rgb orl_world_sun_radiance(const struct orl_world *world, struct orl_vec3 direction);

/* Whether a surface is there for views alone. */
static inline bool orl_world_hides(const struct orl_world *world, uint32_t facet)
{
    return world->hidden && !orl_facet_is_placed(world->geometry, facet) && world->hidden[facet];
}

/* Whether a point of open space counts as outside: false unless the scene is sealed. */
bool orl_world_is_outside(const struct orl_world *world, struct orl_vec3 point);

/* Which port a facet is, or ORL_NO_PORT. */
static inline int32_t orl_world_port_of(const struct orl_world *world, uint32_t facet)
{
    return world->port_of_facet && !orl_facet_is_placed(world->geometry, facet)
               ? world->port_of_facet[facet]
               : ORL_NO_PORT;
}

/* Whether a path through this hit passes a port, and to which side. */
static inline enum orl_crossing orl_world_crossing(const struct orl_world *world,
                                                   const struct orl_hit *hit)
{
    const int32_t port = orl_world_port_of(world, hit->facet);
    if (port == ORL_NO_PORT)
        return ORL_CROSSING_NONE;
    return hit->front == world->ports[port].outside_is_front ? ORL_CROSSING_INWARDS
                                                             : ORL_CROSSING_OUTWARDS;
}

/* Whether it passes, outwards, a port beyond which nothing is. */
static inline bool orl_world_leaves_clear(const struct orl_world *world, const struct orl_hit *hit)
{
    const int32_t port = orl_world_port_of(world, hit->facet);
    return port != ORL_NO_PORT && world->ports[port].clear &&
           hit->front != world->ports[port].outside_is_front;
}

#endif
