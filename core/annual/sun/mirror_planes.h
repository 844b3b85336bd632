/*
 * Flat mirrors, including panes, grouped by plane, and sunlight by one reflection in them.
 *
 * A plane groups the coplanar facets of one class (light/virtual_suns.h); its ports have outdoors
 * on the same side. A ray towards the mirror image of the sun meets at most one of them. Only the
 * largest planes are stored; facets of the others are left out and counted.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_SUN_MIRROR_PLANES_H
#define ORL_ANNUAL_SUN_MIRROR_PLANES_H

#include "annual/panes/bounding_rects.h"
#include "annual/sun/direction_tree.h"
#include "base/memory/memory.h"
#include "render/gather/gather.h"

enum { ORL_MIRRORS_MOST_PLANES = 256 };

struct orl_mirror_plane {
    struct orl_bounding_rect whole; /* rectangle around all its panes */
    uint32_t first, count;          /* its panes in the array `panes` */
    int16_t class;
    int32_t port; /* port of its first pane, or ORL_NO_PORT */
};

/* Panes to sample from at a place. */
struct orl_mirror_set {
    struct orl_bounding_rect *panes;
    uint32_t *planes; /* index of each pane's plane */
    size_t count;
    struct orl_pane_bvh tree;
};

struct orl_mirrors {
    const struct orl_lit_scene *lit_scene; /* borrowed */
    struct orl_arrays arrays;              /* all arrays but those of the trees */
    const struct orl_port_rects
        *ports; /* ports through which light enters the building; borrowed */
    /* True if all ports face one way: then their panes mirror no sun to places inside. */
    bool one_facade;
    struct orl_mirror_plane *planes;
    size_t n_planes;
    struct orl_bounding_rect *panes;
    /* All panes; the panes that may be visible through ports from inside. */
    struct orl_mirror_set everywhere, beyond;
    uint32_t *plane_of; /* by facet; UINT32_MAX: in no plane. NULL if there are no mirrors */
    size_t n_left_out;  /* facets without a plane, including flat ones without a class */
};

/* Returns 0 or ORL_ERR_NOMEM; orl_mirrors_done in either case. */
int orl_mirrors_init(struct orl_mirrors *mirrors, const struct orl_lit_scene *lit_scene,
                     const struct orl_port_rects *ports);
void orl_mirrors_done(struct orl_mirrors *mirrors);

/* Returns the response of a place, or of the surface there, to light from a direction. */
typedef struct orl_rgb (*orl_mirrors_response)(const void *ctx, struct orl_vec3 light);

/*
 * Returns the light of a sun with normal illuminance 1 by all mirrors. response weights each by the
 * direction of the sun's mirror image. beyond: only mirrors seen through a port from inside.
 */
struct orl_rgb orl_mirrors_light(const struct orl_mirrors *mirrors,
                                 const struct orl_shading_point *place, struct orl_vec3 towards,
                                 bool beyond, orl_mirrors_response response, const void *ctx);

/* Returns the cone of suns that may reach a point by reflection in a pane of a set. */
struct orl_cone orl_mirrors_cone(const struct orl_mirrors *mirrors,
                                 const struct orl_mirror_set *set, uint32_t item,
                                 struct orl_vec3 point);

/* Returns the light by one pane of a set alone, like orl_mirrors_light; with the set `beyond`, it
 * must be seen through a port. If *port is ORL_NO_PORT, it becomes the first port on the path from
 * the place out of the building. */
struct orl_rgb orl_mirrors_light_of(const struct orl_mirrors *mirrors,
                                    const struct orl_mirror_set *set, uint32_t item,
                                    const struct orl_shading_point *place, struct orl_vec3 towards,
                                    orl_mirrors_response response, const void *ctx, int32_t *port);

#endif
