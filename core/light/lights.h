/*
 * The lights of a scene: its lamps, and suns and domes, which are the scene's own distant sources
 * or a sky that a job gives. They are apart from the scene, so that a thousand skies share one.
 *
 * Immutable; held as a scene is.
 */
#ifndef ORL_LIGHT_LIGHTS_H
#define ORL_LIGHT_LIGHTS_H

#include "light/daylight.h"
#include "light/scene.h"

/* A small distant light, to be sampled directly: the sun, as gendaylit writes it. */
struct orl_sun {
    struct orl_frame frame; /* n towards the centre of the disc */
    double cos_half_angle, solid_angle_sr;
    struct orl_rgb radiance;   /* mean over the disc */
    struct orl_rgb irradiance; /* radiance times solid angle: on a plane that faces the sun */
};

/* A wide distant light: a sky, a ground, a hemisphere of glow. Where they lie over one another all
 * lights shine, and hide glows; of glows the first does, as in Radiance (sourcehit of rt/source.c).
 * One of a negative radius hides those behind it, too, and is there for views alone.
 */
struct orl_dome {
    struct orl_vec3 direction;
    double cos_half_angle;
    struct orl_rgb radiance;
    const struct orl_sky *sky;         /* multiplies radiance; NULL for none */
    const struct orl_pattern *pattern; /* the same, of what is no such sky */
    bool light;                        /* and no glow */
    bool seen_alone;                   /* lights nothing */
};

/* What a dome shines from a direction within it. */
struct orl_rgb orl_dome_radiance(const struct orl_dome *dome, struct orl_vec3 direction);

/*
 * A surface that shines. Glows are sampled as lamps are where they are few and small beside the
 * scene: rays hardly ever meet them, least of all by way of mirrors and lenses, and Radiance, which
 * leaves them to such rays, misses their light there.
 */
struct orl_emitter {
    uint32_t facet;
    struct orl_rgb radiance; /* mean over the surface */
    struct orl_rgb most;     /* the most, anywhere */
    bool direct; /* sampled by shadow rays: a lamp or a small glow; else met by rays by chance */
};

struct orl_lights {
    struct orl_scene *scene; /* held */
    struct orl_sky pattern;  /* of the sky given, which its domes point to */
    struct orl_sun *suns;
    size_t n_suns;
    struct orl_dome *domes;
    size_t n_domes;
    struct orl_emitter *emitters;
    size_t n_emitters;
    double most_aimed_glow; /* area up to which glows are sampled by shadow rays; 0: none are */
    atomic_uint holders;
};

/*
 * Those of the scene; and those of the sky, where one is given. Returns 0, and lights that the
 * caller holds, or ORL_ERR_NOMEM, or ORL_ERR_INVALID when a sky is given to a scene that has
 * distant sources already.
 */
int orl_lights_new(struct orl_scene *scene, const struct orl_daylight *sky,
                   struct orl_lights **ret_lights, struct orl_error *err);

/* Whether a scene can have a sky given to it: 0, or ORL_ERR_INVALID. */
int orl_lights_admit(const struct orl_description *description, struct orl_error *err);

struct orl_lights *orl_lights_hold(struct orl_lights *lights);
/* NULL is allowed. */
void orl_lights_release(struct orl_lights *lights);

/* Returns true if a facet of that material is sampled by shadow rays, as glows are up to that area.
 */
bool orl_is_lamp(const struct orl_geometry *geometry, double most_aimed_glow,
                 const struct orl_material *material, uint32_t facet);

/* A digest of suns and domes, by what they shine: two ways to ask for one sky have the same. Lamps
 * are in the scene's own. */
void orl_lights_digest(const struct orl_lights *lights, unsigned char ret_digest[32]);

/* A direction uniform over the sun's disc; u in [0,1)^2. */
struct orl_vec3 orl_sun_sample(const struct orl_sun *sun, const double u[2]);
void orl_sun_sample_many(const struct orl_sun *sun, const double (*u)[2], size_t n,
                         struct orl_vec3 *ret_directions);

#endif
