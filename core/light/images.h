/*
 * Suns as flat mirrors and panes show them, by any number of reflections: in a light pipe, between
 * panes, off a tower opposite. A sun reflected comes from another direction, and mirrors are few
 * kinds of planes; so all that light does between them is a graph. Its nodes are directions, the
 * suns' own first; an edge says that a mirror of that class turns light of one node into the
 * other's.
 *
 * A shadow ray to an image goes through panes, is turned where it meets a mirror that has an edge,
 * and counts when it leaves the scene towards the sun itself. Each ray goes on both ways where a
 * pane mirrors some and lets the rest through, so that every chain of reflections between the nodes
 * is counted once, by the image it is seen at.
 *
 * Mirrors within a milliradian of each other are one class, that of the first of them: files round
 * their corners, and a sun is nine times as wide. Images by one reflection are all there; those by
 * more are kept where a pilot finds that they carry a share of the light that falls on mirrors, the
 * brightest first. Whoever happens on a sun by a mirrored ray asks orl_images_cover whether shadow
 * rays have found it already.
 *
 * Constant once built. Depends on no crew and no clock.
 */
#ifndef ORL_LIGHT_IMAGES_H
#define ORL_LIGHT_IMAGES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/vec.h>

#include "light/image_columns.h"
#include "scene/geometry/geometry.h"

struct orl_world;

enum { ORL_MOST_MIRRORS = 32, ORL_MOST_IMAGES = 512, ORL_IMAGE_REFLECTIONS = 16 };

/* A chain of reflections that has less of the light left is not followed. */
#define ORL_IMAGE_DIMMEST 1e-5

struct orl_image {
    struct orl_frame frame; /* n: where it is; mirrored like the image */
    uint32_t sun;
    bool is_sun; /* the sun's own direction */
    bool shown;  /* light comes from there by way of mirrors: shadow rays are worth while */
};

struct orl_images {
    struct orl_vec3 *mirrors; /* the classes: unit normals, up to sign */
    size_t n_mirrors;
    size_t n_left_out; /* facets beyond the most classes: suns are not reflected by those */
    int16_t *class_of; /* per facet of the scene's own, or -1 */
    size_t n_facets;   /* of those */
    struct orl_image *nodes;
    size_t n_nodes;
    int16_t *next;                     /* of node i by class m, at i * n_mirrors + m; or -1 */
    struct orl_image_columns *columns; /* of nodes that were shown when they were built, in order */
    int16_t *columns_of;               /* per node, or -1 */
};

static inline struct orl_vec3 orl_image_turned(struct orl_vec3 v, struct orl_vec3 mirror)
{
    return orl_madd(v, mirror, -2 * orl_dot(v, mirror));
}

/* The class of a facet, or -1. */
static inline int16_t orl_images_class(const struct orl_images *images, uint32_t facet)
{
    return facet < images->n_facets ? images->class_of[facet] : -1;
}

/* What a mirror of that class makes of a node; or -1. */
static inline int orl_images_next(const struct orl_images *images, int node, int mirror)
{
    return images->next[(size_t)node * images->n_mirrors + (size_t)mirror];
}

/* Whether an image that is shown may be seen from there; if not, its light is 0 there. */
static inline bool orl_images_may_show(const struct orl_images *images, size_t node,
                                       struct orl_vec3 point)
{
    const int16_t k = images->columns_of[node];
    return k < 0 ||
           orl_image_columns_may_show(&images->columns[k], &images->nodes[node].frame, point);
}

/* Builds the images of the world's suns. crew: polled for cancellation, or NULL. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED; orl_images_done in any case. */
int orl_images_build(struct orl_images *images, const struct orl_world *world,
                     const struct orl_crew *crew);
void orl_images_done(struct orl_images *images);

/* Of those suns alone (indices move up), or of none: NULL. */
void orl_images_keep_suns(struct orl_images *images, const bool *keep);

/* A direction uniform over an image's disc; u in [0,1)^2. */
struct orl_vec3 orl_image_sample(const struct orl_world *world, const struct orl_image *image,
                                 const double u[2]);

/*
 * Share of the sun's light that comes to origin from its image, from that direction of its disc.
 * With through_ports false the ray starts outside, and ports block.
 */
struct orl_rgb orl_image_transmittance(const struct orl_world *world, struct orl_vec3 origin,
                                       struct orl_vec3 direction, const struct orl_image *image,
                                       bool through_ports);

/* What has happened to a ray since it set out, for orl_images_cover. */
struct orl_image_trail {
    struct orl_vec3 start; /* its direction then */
    uint8_t reflections;   /* at least; the first ORL_IMAGE_REFLECTIONS are known: */
    bool strange;          /* by something that is in no class, or refracted */
    int16_t classes[ORL_IMAGE_REFLECTIONS];
};

static inline struct orl_image_trail orl_image_trail_from(struct orl_vec3 direction)
{
    return (struct orl_image_trail){.start = direction};
}

/* Mirrored at that facet. */
void orl_image_trail_add(struct orl_image_trail *trail, const struct orl_images *images,
                         uint32_t facet);

/* Whether a ray of that trail, arrived at a sun, is one that shadow rays to images have taken. */
bool orl_images_cover(const struct orl_world *world, const struct orl_image_trail *trail);

#endif
