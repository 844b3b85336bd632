/*
 * Lamps as flat mirrors and panes show them, by one reflection: virtual lamps for shadow rays. The
 * lamp is sampled from the mirror image of the shading point. The ray itself starts towards the
 * point where that line crosses the mirror, must hit the mirror there, and continues to the lamp.
 * The solid angle is that of the lamp from the mirrored point. So lobe sampling and this shadow ray
 * are two strategies over the same directions, combined by MIS as for lamps seen straight
 * (orl_chance).
 *
 * The brightest pairs of lamp and mirror are kept: 64, or twice the number of lamps, up to 1024.
 * Left to rays that hit the lamp by chance and to photons: more reflections, mirrors beyond the
 * limit, mirrors outside a sealed building, and instanced surfaces. orl_lamp_images_cover says
 * which pairs are kept.
 */
#ifndef ORL_LIGHT_LAMP_IMAGES_H
#define ORL_LIGHT_LAMP_IMAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/crew.h>
#include <oriel/vec.h>

struct orl_world;

struct orl_lamp_image {
    uint32_t emitter;               /* index into the world's emitters */
    uint32_t lamp, mirror;          /* facets of the lamp and the mirror */
    struct orl_vec3 normal, center; /* normal of the mirror, and a point of its plane */
    double radius;                  /* radius of a sphere about center that contains the mirror */
};

struct orl_lamp_images {
    struct orl_lamp_image *images; /* sorted by mirror, then by lamp */
    size_t n_images;
    double left_out; /* approximate share of the mirrored light whose pairs are not kept */
    /* approximate flux by way of two mirrors, which have no images, over the flux of all lamps */
    double twice;
};

static inline double orl_lamp_image_height(const struct orl_lamp_image *image,
                                           struct orl_vec3 point)
{
    return orl_dot(orl_sub(point, image->center), image->normal);
}

static inline struct orl_vec3 orl_lamp_image_turned(const struct orl_lamp_image *image,
                                                    struct orl_vec3 direction)
{
    return orl_madd(direction, image->normal, -2 * orl_dot(direction, image->normal));
}

static inline struct orl_vec3 orl_lamp_image_of(const struct orl_lamp_image *image,
                                                struct orl_vec3 point)
{
    return orl_madd(point, image->normal, -2 * orl_lamp_image_height(image, point));
}

/* Finds the pairs of the world's lamps and mirrors. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED; the caller calls orl_lamp_images_done in any case. */
int orl_lamp_images_build(struct orl_lamp_images *images, const struct orl_world *world,
                          const struct orl_crew *crew);
void orl_lamp_images_done(struct orl_lamp_images *images);

/* Returns true if light by way of two mirrors matters: more than a hundredth of all light. */
static inline bool orl_lamp_images_twice(const struct orl_lamp_images *images)
{
    return images->twice > 0.01;
}

/* Returns an image in a mirror, which is a facet; NULL: none. */
const struct orl_lamp_image *orl_lamp_images_in(const struct orl_lamp_images *images,
                                                uint32_t mirror);
/* Returns true if there is an image of a lamp in a mirror; both are facets. */
bool orl_lamp_images_cover(const struct orl_lamp_images *images, uint32_t lamp, uint32_t mirror);

#endif
