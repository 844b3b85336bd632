/*
 * Light that comes straight from suns and lamps: shadow rays, through thin panes and by way of flat
 * mirrors; and who counts a lamp that shadow rays and rays drawn by a lobe can both find.
 */
#ifndef ORL_LIGHT_DIRECT_H
#define ORL_LIGHT_DIRECT_H

#include "light/lamp_aim.h"
#include "light/world.h"

/*
 * Share of light that comes straight from `direction`, from within max_distance, thin glass on the
 * way included. With through_ports false ports block.
 */
struct orl_rgb orl_transmittance(const struct orl_world *world, struct orl_vec3 origin,
                                 struct orl_vec3 direction, double max_distance,
                                 bool through_ports);
/* Returns the transmittance towards a surface that is neither sun nor lamp. The front of an illum
 * blocks it: the illum shines in place of all such surfaces behind it. */
struct orl_rgb orl_transmittance_to_surface(const struct orl_world *world, struct orl_vec3 origin,
                                            struct orl_vec3 direction, double max_distance,
                                            bool through_ports);
/* Returns orl_transmittance for an infinite distance, through ports. If *port is ORL_NO_PORT, it
 * becomes the first port by which the ray leaves the building; else the path has left it before,
 * and it stays. */
struct orl_rgb orl_transmittance_by(const struct orl_world *world, struct orl_vec3 origin,
                                    struct orl_vec3 direction, int32_t *port);

/*
 * Irradiance at a point with that (unit) normal from suns and lights sampled directly: one shadow
 * ray each. With lobes not NULL, weighted by that hit's lobes towards eye instead of counted
 * whole: the result is then radiance, of lamps the share that rays drawn by those lobes leave.
 */
struct orl_direct_query {
    struct orl_vec3 point;          /* clear of the surface */
    struct orl_vec3 normal;         /* towards the side that is lit */
    const struct orl_vec3 *shading; /* the cosine is to this one; NULL: to the normal */
    bool through_ports;
    const struct orl_material *lobes;
    const struct orl_hit *hit;
    struct orl_vec3 eye;
    bool mist; /* not a surface: scattered towards eye by the phase function (mist.h) of */
    double forward;
    bool mirrored;   /* with the suns' images in flat mirrors */
    const double *u; /* two numbers in [0,1) from an even sequence, or NULL for random ones */
};
struct orl_rgb orl_direct_light(const struct orl_world *world, const struct orl_direct_query *query,
                                struct orl_random *random);

/* The lamp's radiance from there towards where the aim was taken, times the transmittance on the
 * way and the solid angle: with a cosine, irradiance. With through_ports false ports block. */
struct orl_rgb orl_lamp_arriving(const struct orl_world *world, const struct orl_emitter *emitter,
                                 struct orl_vec3 from, const struct orl_lamp_aim *aim,
                                 bool through_ports);

/* Of that, with query.mirrored, the part of the suns' images in flat mirrors alone. */
struct orl_rgb orl_direct_by_images(const struct orl_world *world,
                                    const struct orl_direct_query *query,
                                    struct orl_random *random);

/* Radiance of suns and lamps that mist scatters there, by that phase function (mist.h), towards an
 * eye whose ray goes along that direction: one shadow ray each. */
struct orl_rgb orl_direct_in_mist(const struct orl_world *world, struct orl_vec3 point,
                                  struct orl_vec3 along, double forward, struct orl_random *random);

/*
 * Radiance of suns (images in flat mirrors included) and lights that the lobes of material at that
 * hit send towards eye, from both sides where it transmits: one shadow ray each. The rest of the
 * light of lamps is for rays drawn by the lobes (orl_chance_after).
 */
struct orl_rgb orl_direct_by_lobes(const struct orl_world *world, const struct orl_hit *hit,
                                   const struct orl_material *material, struct orl_vec3 eye,
                                   struct orl_random *random);

/*
 * How a ray came by its direction, for the lamps that it may meet: shadow rays may have looked for
 * them too. Where both can find a lamp, each counts a share: rays count more in a narrow lobe,
 * shadow rays in a wide one. (Veach 1997, chapter 9: the balance heuristic.) After one reflection
 * by a flat mirror that shows lamps (lamp_images.h) that holds of the lamps shown.
 */
enum { ORL_MIRROR_NONE = 0, ORL_MIRROR_UNKNOWN = -1 };
struct orl_chance {
    double pdf;           /* 1/sr; 0: shadow rays have found all lamps; infinite: there were none */
    struct orl_vec3 from; /* the lobe that the ray was drawn by, or its mirror image */
    int64_t mirror;       /* 1 + the facet that has mirrored it since, or ORL_MIRROR_NONE; after
                             ORL_MIRROR_UNKNOWN only rays find lamps */
};

/* Shadow rays have looked for lamps, seen straight and in mirrors. */
static inline struct orl_chance orl_chance_found(void)
{
    return (struct orl_chance){.pdf = 0, .mirror = ORL_MIRROR_NONE};
}
/* Only for lamps seen straight. */
static inline struct orl_chance orl_chance_found_straight(void)
{
    return (struct orl_chance){.pdf = 0, .mirror = ORL_MIRROR_UNKNOWN};
}
static inline struct orl_chance orl_chance_unsought(void)
{
    return (struct orl_chance){.pdf = INFINITY, .mirror = ORL_MIRROR_UNKNOWN};
}

/* Radiance that the surface there shines towards eye: of a lamp, the ray's share. */
struct orl_rgb orl_shining(const struct orl_world *world, const struct orl_hit *hit,
                           struct orl_vec3 eye, const struct orl_chance *chance);

/* What holds after the event at a surface; suns and lamps were looked for by way of its lobes. */
struct orl_chance orl_chance_after(const struct orl_world *world, const struct orl_hit *hit,
                                   struct orl_vec3 eye, const struct orl_scatter *scatter,
                                   struct orl_chance before);

#endif
