/*
 * Lamps as flat mirrors and panes show them, by one reflection: virtual lamps for shadow rays. The
 * lamp is sampled from the mirror image of the shading point. The ray itself starts towards the
 * point where that line crosses the mirror, must hit the mirror there, and continues to the lamp.
 * The solid angle is that of the lamp from the mirrored point. So lobe sampling and this shadow ray
 * are two strategies over the same directions, combined by MIS as for lamps seen straight
 * (orl_mis_pdf).
 *
 * The brightest pairs of lamp and mirror are selected: 64, or twice the number of lamps, up to
 * 1024. Left to rays that hit the lamp by chance and to photons: more reflections, mirrors beyond
 * the limit, mirrors outside a sealed building, and instanced surfaces. orl_virtual_lamps_contain
 * returns which pairs are selected.
 */
#ifndef ORL_LIGHT_VIRTUAL_LAMPS_H
#define ORL_LIGHT_VIRTUAL_LAMPS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>

struct orl_lit_scene;

struct orl_virtual_lamp {
    uint32_t emitter;               /* index into the lit scene's emitters */
    uint32_t lamp, mirror;          /* facets of the lamp and the mirror */
    struct orl_vec3 normal, center; /* normal of the mirror, and a point of its plane */
    double radius;                  /* radius of a sphere about center that contains the mirror */
};

struct orl_virtual_lamps {
    struct orl_virtual_lamp *images; /* sorted by mirror, then by lamp */
    size_t n_images;
    double left_out; /* approximate share of the mirrored light whose pairs are not selected */
    /* some of these pairs have bright mirrors, which may send most of the light to a dark place */
    bool bright_left_out;
    /* approximate flux by way of two mirrors, which have no images, over the flux of all lamps; a
     * lower bound once it decides orl_virtual_lamps_omit_pairs */
    double two_mirror_share;
    /* two mirrors in succession reflect a twentieth or more: a place that sees the lamp by them
     * may have hardly any other light, however little of all light takes this way */
    bool two_bright_mirrors;
};

static inline double orl_virtual_lamp_height(const struct orl_virtual_lamp *image,
                                             struct orl_vec3 point)
{
    return orl_dot(orl_sub(point, image->center), image->normal);
}

static inline struct orl_vec3 orl_virtual_lamp_reflect(const struct orl_virtual_lamp *image,
                                                       struct orl_vec3 direction)
{
    return orl_madd(direction, image->normal, -2 * orl_dot(direction, image->normal));
}

static inline struct orl_vec3 orl_virtual_lamp_mirror_point(const struct orl_virtual_lamp *image,
                                                            struct orl_vec3 point)
{
    return orl_madd(point, image->normal, -2 * orl_virtual_lamp_height(image, point));
}

/* Finds the pairs of the lit scene's lamps and mirrors. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED; the caller calls orl_virtual_lamps_done in any case. */
int orl_virtual_lamps_build(struct orl_virtual_lamps *images, const struct orl_lit_scene *lit_scene,
                            const struct orl_thread_pool *pool);
void orl_virtual_lamps_done(struct orl_virtual_lamps *images);

/* Returns true if light by way of two mirrors may matter: more than a hundredth of all light, or
 * some of two bright mirrors. */
static inline bool orl_virtual_lamps_omit_pairs(const struct orl_virtual_lamps *images)
{
    return images->two_mirror_share > 0.01 || images->two_bright_mirrors;
}

/* Returns an image in a mirror, which is a facet; NULL: none. */
const struct orl_virtual_lamp *orl_virtual_lamps_in_mirror(const struct orl_virtual_lamps *images,
                                                           uint32_t mirror);
/* Returns true if there is an image of a lamp in a mirror; both are facets. */
bool orl_virtual_lamps_contain(const struct orl_virtual_lamps *images, uint32_t lamp,
                               uint32_t mirror);

#endif
