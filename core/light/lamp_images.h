/*
 * Lamps as flat mirrors and panes show them, by one reflection: virtual lamps for shadow rays. From
 * a point the lamp is aimed at from the point's own mirror image; the ray itself sets out to where
 * that line crosses the mirror, has to meet it there, and goes on to the lamp. The solid angle is
 * that of the lamp from the mirrored point, so that a ray drawn by a lobe and this one are two
 * strategies over the same directions, combined as with lamps seen straight (orl_chance).
 *
 * The brightest pairs of lamp and mirror are kept: 64, or twice as many as there are lamps, up to
 * 1024. All other ways by mirrors (more reflections, mirrors left out, mirrors outside a sealed
 * building, surfaces that stand in several places) are left to rays that happen on the lamp and to
 * photons: who asks by orl_lamp_images_cover knows which.
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
    uint32_t emitter;               /* of the world's */
    uint32_t lamp, mirror;          /* their facets */
    struct orl_vec3 normal, center; /* of the mirror; center on its plane */
    double radius;                  /* of a sphere about center that holds the mirror */
};

struct orl_lamp_images {
    struct orl_lamp_image *images; /* by mirror, then by lamp */
    size_t n_images;
    double left_out; /* roughly the share of the mirrored light whose pairs are not kept */
    double twice; /* roughly the flux by way of two mirrors, which have no images, over that of all
                     lamps */
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

/* Finds the pairs of the world's lamps and mirrors. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED;
 * orl_lamp_images_done in any case. */
int orl_lamp_images_build(struct orl_lamp_images *images, const struct orl_world *world,
                          const struct orl_crew *crew);
void orl_lamp_images_done(struct orl_lamp_images *images);

/* Returns true if light by way of two mirrors matters: it is more than a hundredth of all. */
static inline bool orl_lamp_images_twice(const struct orl_lamp_images *images)
{
    return images->twice > 0.01;
}

/* Returns an image in that mirror, which is a facet; or NULL. */
const struct orl_lamp_image *orl_lamp_images_in(const struct orl_lamp_images *images,
                                                uint32_t mirror);
/* Returns true if there is an image of that lamp, a facet too, in that mirror. */
bool orl_lamp_images_cover(const struct orl_lamp_images *images, uint32_t lamp, uint32_t mirror);

#endif
