/*
 * Suns as flat mirrors and panes show them, by any number of reflections: in a light pipe, between
 * panes, off a tower opposite. A reflected sun has another direction, and the mirrors' planes fall
 * into few classes. So all reflections form a graph: its nodes are directions, first the suns' own.
 * An edge says that a mirror of its class turns light of one node into the other node's direction.
 *
 * A shadow ray to an image passes panes and is reflected by each mirror that has an edge. It counts
 * if it leaves the scene towards the sun itself. At a pane that both reflects and transmits, the
 * ray follows both directions. So every chain of reflections between the nodes is counted once, by
 * the image at which it is seen.
 *
 * Mirrors within a milliradian of each other form one class, that of the first of them: files have
 * rounded corners, and a sun is nine times as wide. All images by one reflection are used. Images
 * by more are used if a pilot finds that they carry a share of the light on mirrors, or that their
 * mirrors are bright, the brightest first. A path that hits the sun by mirrors calls
 * orl_virtual_suns_counted, so that it does not count light that shadow rays have found.
 *
 * Constant once built. Independent of the number of threads and of time.
 */
#ifndef ORL_LIGHT_VIRTUAL_SUNS_H
#define ORL_LIGHT_VIRTUAL_SUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

#include "base/memory/memory.h"
#include "scene/geometry/geometry.h"

/*
 * Bounds on the points from which a sun's image may be visible. All rays towards an image have one
 * direction. So the mirrors that show it are projected onto a plane across that direction, which is
 * cut into square columns. Each column holds how far along the direction its farthest mirror lies.
 * A point can see the image only if its column has a mirror before it; otherwise no shadow ray is
 * needed.
 *
 * Conservative: mirrors are enlarged by the sun's disc and by rounding errors, so no visible image
 * is missed.
 */

enum { ORL_VIRTUAL_SUN_COLUMNS = 64 };

struct orl_virtual_sun_columns {
    /* origin and columns per unit of length on the plane that the mirrors are projected onto */
    double low[2], per_unit[2];
    float farthest[ORL_VIRTUAL_SUN_COLUMNS]
                  /* position of the farthest mirror along the direction; -INFINITY: none */
                  [ORL_VIRTUAL_SUN_COLUMNS];
};

/* Builds the columns. frame.n: the direction in which the image is seen; half_angle: that of its
 * disc, radians; shows: per facet, true if it is a mirror that shows the image. */
void orl_virtual_sun_columns_build(struct orl_virtual_sun_columns *columns,
                                   const struct orl_geometry *geometry,
                                   const struct orl_frame *frame, double half_angle,
                                   const bool *shows);

/* Returns true if the image may be visible from a point. */
static inline bool orl_virtual_sun_columns_show(const struct orl_virtual_sun_columns *columns,
                                                const struct orl_frame *frame,
                                                struct orl_vec3 point)
{
    const double x = (orl_dot(frame->u, point) - columns->low[0]) * columns->per_unit[0];
    const double y = (orl_dot(frame->v, point) - columns->low[1]) * columns->per_unit[1];
    return x >= 0 && y >= 0 && x < ORL_VIRTUAL_SUN_COLUMNS && y < ORL_VIRTUAL_SUN_COLUMNS &&
           orl_dot(frame->n, point) < (double)columns->farthest[(int)y][(int)x];
}

struct orl_lit_scene;

enum { ORL_MOST_MIRRORS = 32, ORL_MOST_VIRTUAL_SUNS = 512, ORL_MOST_SUN_REFLECTIONS = 16 };

/* Chains of reflections whose share of the light is below this are not followed. */
#define ORL_VIRTUAL_SUN_LEAST 1e-5

struct orl_virtual_sun {
    struct orl_frame frame; /* n: direction of the image; u, v: mirrored as the image is */
    uint32_t sun;
    bool is_sun; /* the node is the sun's own direction */
    /* light arrives from this direction by mirrors, so shadow rays are traced to it */
    bool shown;
};

struct orl_virtual_suns {
    struct orl_arrays arrays; /* owns all arrays */
    struct orl_vec3 *mirrors; /* the classes: unit normals, up to sign */
    size_t n_mirrors;
    /* facets beyond ORL_MOST_MIRRORS classes: suns in them have no images */
    size_t n_left_out;
    size_t n_images_left_out; /* images that are needed, but have no node; a lower bound */
    int16_t *class_of;        /* per facet of the scene's own (not instanced); -1: none */
    size_t n_facets;          /* length of class_of */
    struct orl_virtual_sun *nodes;
    size_t n_nodes;
    /* node that node i becomes by class m, at i * n_mirrors + m; -1: none */
    int16_t *next;
    /* one for each node that was shown when the columns were built, in order */
    struct orl_virtual_sun_columns *columns;
    int16_t *columns_of; /* index into columns, per node; -1: none */
};

static inline struct orl_vec3 orl_virtual_sun_reflect(struct orl_vec3 v, struct orl_vec3 mirror)
{
    return orl_madd(v, mirror, -2 * orl_dot(v, mirror));
}

/* Returns the class of a facet; -1: none. */
static inline int16_t orl_virtual_suns_class(const struct orl_virtual_suns *images, uint32_t facet)
{
    return facet < images->n_facets ? images->class_of[facet] : -1;
}

/* Returns the node that a mirror of a class turns a node into; -1: none. */
static inline int orl_virtual_suns_next(const struct orl_virtual_suns *images, int node, int mirror)
{
    return images->next[(size_t)node * images->n_mirrors + (size_t)mirror];
}

/* Returns true if an image that is shown may be visible from a point; if false, its light there
 * is 0. */
static inline bool orl_virtual_suns_may_show(const struct orl_virtual_suns *images, size_t node,
                                             struct orl_vec3 point)
{
    const int16_t k = images->columns_of[node];
    return k < 0 ||
           orl_virtual_sun_columns_show(&images->columns[k], &images->nodes[node].frame, point);
}

/* Builds the images of the lit scene's suns. pool: polled for cancellation, or NULL. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED; orl_virtual_suns_done in any case. */
int orl_virtual_suns_build(struct orl_virtual_suns *images, const struct orl_lit_scene *lit_scene,
                           const struct orl_thread_pool *pool);
static inline void orl_virtual_suns_done(struct orl_virtual_suns *images)
{
    orl_arrays_free(&images->arrays);
}

/* Removes all suns but those for which `keep` is true (indices move up); NULL: removes all. */
void orl_virtual_suns_keep(struct orl_virtual_suns *images, const bool *keep);

/* Returns a direction uniform over an image's disc; u in [0,1)^2. */
struct orl_vec3 orl_virtual_sun_sample(const struct orl_lit_scene *lit_scene,
                                       const struct orl_virtual_sun *image, const double u[2]);

/*
 * Returns the share of the sun's light that arrives at origin from its image, from one direction of
 * the image's disc. If through_ports is false, the ray starts outside, and ports block.
 */
struct orl_rgb orl_virtual_sun_transmittance(const struct orl_lit_scene *lit_scene,
                                             struct orl_vec3 origin, struct orl_vec3 direction,
                                             const struct orl_virtual_sun *image,
                                             bool through_ports);

/* The reflections of a ray since its start, for orl_virtual_suns_counted. */
struct orl_mirror_history {
    struct orl_vec3 start; /* direction of the ray at its start */
    /* number of reflections, or a lower bound; classes has the first ORL_MOST_SUN_REFLECTIONS */
    uint8_t reflections;
    bool left_classes; /* the ray was refracted, or scattered by a surface without a class */
    int16_t classes[ORL_MOST_SUN_REFLECTIONS];
};

static inline struct orl_mirror_history orl_mirror_history_begin(struct orl_vec3 direction)
{
    return (struct orl_mirror_history){.start = direction};
}

/* Adds the reflection at a facet. */
void orl_mirror_history_add(struct orl_mirror_history *history,
                            const struct orl_virtual_suns *images, uint32_t facet);

/* Returns true if shadow rays to images have counted the light of a ray with that history that
 * arrived at a sun. */
bool orl_virtual_suns_counted(const struct orl_lit_scene *lit_scene,
                              const struct orl_mirror_history *history);

#endif
