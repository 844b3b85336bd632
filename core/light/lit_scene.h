/*
 * A scene with its lights, as a job simulates it, without what the job's plan omits. Every
 * technique reads it; it is constant once it is made.
 *
 * Inside and outside: a photon port is a window (glass or BSDF) one face of which sees the outside.
 * Light is split by the first time it crosses a port inwards. Light that crosses one is emitted
 * from the ports (photon/emission/emit.h) with the radiance that really arrives there. Light that
 * crosses none is emitted from the lights themselves, and only if the scene has openings ("open").
 * In a sealed scene (not open) photons are therefore stored inside only, and surfaces outside are
 * shaded by path tracing (exterior.h) instead of density estimation.
 */
#ifndef ORL_LIGHT_LIT_SCENE_H
#define ORL_LIGHT_LIT_SCENE_H

#include <oriel/job/plan.h>

#include "light/lights.h"
#include "light/virtual_lamps.h"
#include "light/virtual_suns.h"
#include "scene/material/scatter.h"

/* Effects that a run omits (plan/plan.h decides). */
struct orl_omissions {
    bool exterior; /* surfaces outside reflect nothing: they only block light */
    bool glossy, media, refraction,
        /* already applied to the materials; stored so that maps of different plans have different
         * keys */
        bleached;
    bool mirror_caustics, lobe_caustics; /* no caustic photons by way of mirrors, or of lobes */
    /* do not store global photons whose light shadow rays or caustic photons count */
    bool counted_light;
    uint32_t most_reflections; /* maximum number of diffuse reflections */
    uint32_t channels;         /* 3; or 1: all colours are gray, and red holds the value */
};

struct orl_lit_scene {
    struct orl_scene *scene; /* held */
    /* held: all lights of the scene; suns and domes below point into it */
    struct orl_lights *lights;
    /* Shortcuts to the scene's members. */
    const struct orl_geometry *geometry; /* surfaces that light meets */
    const struct orl_geometry *proxies;
    const bool *hidden;
    /* index into ports, or ORL_NO_PORT, per facet of the scene's own (not instanced); NULL:
     * ports were not searched */
    const int32_t *port_of_facet;
    bool open; /* light can enter without crossing a port */
    /* the lit scene that views see: this one with another geometry; NULL: no BSDF stands for
     * geometry */
    struct orl_lit_scene *seen;
    struct orl_arrays arrays; /* `seen` and the copies below */
    /* The lit scene's own copies, of what is simulated. */
    struct orl_material *materials;
    size_t n_materials;
    struct orl_sun *suns;
    size_t n_suns;
    struct orl_dome *domes;
    size_t n_domes;
    struct orl_emitter *emitters;
    size_t n_emitters;
    double largest_sampled_glow; /* copy of the lights' value */
    struct orl_port *ports;
    size_t n_ports;
    struct orl_virtual_suns images; /* images of the suns in flat mirrors; none without ports */
    struct orl_virtual_lamps virtual_lamps; /* images of the lamps in flat mirrors */
    /* the planner found mirrors or lobes that a sun or lamp lights: trace caustic photons even
     * if a pilot finds none */
    bool caustics_lit;
    struct orl_omissions omit;
};

/*
 * Makes a lit scene of all of the scene and its lights, and holds both. pool: polled for
 * cancellation, or NULL. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. The caller may remove parts
 * of the lit scene before it is used (plan/plan.h), and then calls orl_lit_scene_update_seen.
 */
int orl_lit_scene_new(struct orl_lights *lights, const struct orl_thread_pool *pool,
                      struct orl_lit_scene **ret_lit_scene, struct orl_error *err);
void orl_lit_scene_free(struct orl_lit_scene *lit_scene);

/* Removes all suns but those for which `keep` is true; NULL: removes all. */
void orl_lit_scene_select_suns(struct orl_lit_scene *lit_scene, const bool *keep);

/* Updates orl_lit_scene.seen from the rest, once that is complete. */
void orl_lit_scene_update_seen(struct orl_lit_scene *lit_scene);

/* Returns the lit scene that views see. */
static inline const struct orl_lit_scene *orl_lit_scene_seen(const struct orl_lit_scene *lit_scene)
{
    return lit_scene->seen ? lit_scene->seen : lit_scene;
}

static inline const struct orl_material *
orl_lit_scene_material_of(const struct orl_lit_scene *lit_scene, size_t facet)
{
    return &lit_scene->materials[orl_facet_material(lit_scene->geometry, facet)];
}

static inline const struct orl_material *
orl_lit_scene_material(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit)
{
    return orl_lit_scene_material_of(lit_scene, hit->facet);
}

/* Returns true if a facet lies in a plane. */
static inline bool orl_facet_is_plane(const struct orl_facet *facet)
{
    return facet->kind == ORL_SURFACE_RING ||
           (facet->kind == ORL_SURFACE_POLYGON && !facet->nonplanar);
}

/* Returns the radiance of the domes in a direction, as it lights surfaces, without suns. */
struct orl_rgb orl_lit_scene_dome_radiance(const struct orl_lit_scene *lit_scene,
                                           struct orl_vec3 direction);
/* Returns the radiance of the domes in a direction, as views see it. */
struct orl_rgb orl_lit_scene_dome_seen(const struct orl_lit_scene *lit_scene,
                                       struct orl_vec3 direction);

/* Returns the radiance of the suns in a direction: non-zero within their discs. */
struct orl_rgb orl_lit_scene_sun_radiance(const struct orl_lit_scene *lit_scene,
                                          struct orl_vec3 direction);

/* Returns true if a surface exists for views only. */
static inline bool orl_lit_scene_hides(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    return lit_scene->hidden && !orl_facet_is_instanced(lit_scene->geometry, facet) &&
           lit_scene->hidden[facet];
}

/* Returns true if a facet is a flat mirror or pane with an area; a polygon may be slightly bent. */
static inline bool orl_is_flat_mirror(const struct orl_lit_scene *lit_scene,
                                      const struct orl_facet *facet)
{
    const struct orl_material *const m = &lit_scene->materials[facet->material];
    return orl_surface_kind_is_flat(facet->kind) && facet->area > 0 && !m->texture &&
           orl_material_is_mirror(m);
}

/* Returns true if a point in free space is outside; false unless the scene is sealed. */
bool orl_lit_scene_is_outside(const struct orl_lit_scene *lit_scene, struct orl_vec3 point);

/* Returns the index of the port that a facet is, or ORL_NO_PORT. */
static inline int32_t orl_lit_scene_port_of(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    return lit_scene->port_of_facet && !orl_facet_is_instanced(lit_scene->geometry, facet)
               ? lit_scene->port_of_facet[facet]
               : ORL_NO_PORT;
}

/* Returns the side to which a path through this hit passes a port, if the facet is one. */
static inline enum orl_port_crossing orl_lit_scene_crossing(const struct orl_lit_scene *lit_scene,
                                                            const struct orl_hit *hit)
{
    const int32_t port = orl_lit_scene_port_of(lit_scene, hit->facet);
    if (port == ORL_NO_PORT)
        return ORL_CROSSING_NONE;
    return hit->front == lit_scene->ports[port].outside_is_front ? ORL_CROSSING_INWARDS
                                                                 : ORL_CROSSING_OUTWARDS;
}

/* Returns true if a path through this hit passes outwards a port with nothing beyond it. */
static inline bool orl_lit_scene_leaves_clear(const struct orl_lit_scene *lit_scene,
                                              const struct orl_hit *hit)
{
    const int32_t port = orl_lit_scene_port_of(lit_scene, hit->facet);
    return port != ORL_NO_PORT && lit_scene->ports[port].clear &&
           hit->front != lit_scene->ports[port].outside_is_front;
}

#endif
