/*
 * The lights of a scene: its lamps, and suns and domes, which are the scene's own distant sources
 * or a sky that a job gives. They are separate from the scene, so that a thousand skies share one.
 *
 * Immutable; reference-counted as a scene is.
 */
#ifndef ORL_LIGHT_LIGHTS_H
#define ORL_LIGHT_LIGHTS_H

#include "base/memory/memory.h"
#include "light/daylight/daylight.h"
#include "scene/built/scene.h"

/* A small distant light, which is sampled directly: the sun, as gendaylit writes it. */
struct orl_sun {
    struct orl_frame frame; /* n towards the centre of the disc */
    double cos_half_angle, solid_angle_sr;
    struct orl_rgb radiance; /* mean over the disc */
    /* radiance times solid angle: irradiance of a plane that faces the sun */
    struct orl_rgb irradiance;
};

/*
 * A wide distant light: a sky, a ground, a hemisphere of glow. Where domes overlap, all lights
 * shine and hide glows; of glows the first one shines, as in Radiance (sourcehit() of its src/rt).
 * A dome of negative radius also hides those behind it, and exists for views only.
 */
struct orl_dome {
    struct orl_vec3 direction;
    double cos_half_angle;
    struct orl_rgb radiance;
    const struct orl_sky *sky; /* multiplies radiance; NULL for none */
    /* multiplies radiance, for patterns that are not such a sky; NULL for none */
    const struct orl_pattern *pattern;
    bool light;      /* a light, not a glow */
    bool views_only; /* exists for views only: it lights nothing */
};

/* Returns the radiance of a dome in a direction within it. */
struct orl_rgb orl_dome_radiance(const struct orl_dome *dome, struct orl_vec3 direction);

/*
 * A surface that emits light. Glows are sampled as lamps are if they are few, and small beside the
 * scene. Rays hardly ever hit such glows, least of all by mirrors and lenses. Radiance relies on
 * those rays and misses the light.
 */
struct orl_emitter {
    uint32_t facet;
    struct orl_rgb radiance; /* mean over the surface */
    struct orl_rgb most;     /* maximum radiance over the surface */
    /* sampled by shadow rays: a lamp or a small glow. Otherwise rays find it by chance. */
    bool direct;
};

struct orl_lights {
    struct orl_scene *scene;  /* held */
    struct orl_arrays arrays; /* the arrays below */
    struct orl_sky pattern;   /* the pattern of the given sky, to which its domes point */
    struct orl_sun *suns;
    size_t n_suns;
    struct orl_dome *domes;
    size_t n_domes;
    struct orl_emitter *emitters;
    size_t n_emitters;
    double
        largest_sampled_glow; /* area up to which glows are sampled by shadow rays; 0: no glow is */
    atomic_uint holders;
};

/*
 * Makes the lights of the scene, and those of the sky if one is given. Returns 0 and lights that
 * the caller holds, or ORL_ERR_NOMEM, or ORL_ERR_INVALID if a sky is given to a scene that has
 * distant sources already.
 */
int orl_lights_new(struct orl_scene *scene, const struct orl_daylight *sky,
                   struct orl_lights **ret_lights, struct orl_error *err);

/* Checks that a scene can be given a sky. Returns 0 or ORL_ERR_INVALID. */
int orl_lights_check_sky(const struct orl_parsed_scene *parsed_scene, struct orl_error *err);

struct orl_lights *orl_lights_hold(struct orl_lights *lights);
/* NULL is allowed. */
void orl_lights_release(struct orl_lights *lights);

/* Returns true if a facet of that material is sampled by shadow rays. Glows are, up to the area
 * largest_sampled_glow. */
bool orl_is_lamp(const struct orl_geometry *geometry, double largest_sampled_glow,
                 const struct orl_material *material, uint32_t facet);

/* Computes a digest of suns and domes by the light that they emit: two requests for one sky have
 * the same digest. Lamps are in the scene's own digest. */
void orl_lights_digest(const struct orl_lights *lights, unsigned char ret_digest[32]);

/* Returns a direction uniform over the sun's disc; u in [0,1)^2. */
struct orl_vec3 orl_sun_sample(const struct orl_sun *sun, const double u[2]);
void orl_sun_sample_many(const struct orl_sun *sun, const double (*u)[2], size_t n,
                         struct orl_vec3 *ret_directions);

#endif
