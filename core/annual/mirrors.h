/*
 * Flat mirrors, panes among them, by the planes they lie in, and sunlight by way of one of them.
 *
 * Facets of one class (light/images.h) in one plane, of whose ports one side is outdoors, are one
 * plane: a ray to where the sun seems to be behind it meets at most one of them. The largest planes
 * are kept; what the others throw is left out, and they are counted.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_MIRRORS_H
#define ORL_ANNUAL_MIRRORS_H

#include "annual/direction_tree.h"
#include "annual/port_windows.h"
#include "render/gather/gather.h"

enum { ORL_MIRRORS_MOST_PLANES = 256 };

struct orl_mirror_plane {
    struct orl_window whole; /* about all its panes */
    uint32_t first, count;   /* of the panes; they lie one after the other */
    int16_t class;
    int32_t port; /* of one of them, or ORL_NO_PORT */
};

/* Panes to choose from at a place. */
struct orl_mirror_set {
    struct orl_window *panes;
    uint32_t *planes; /* of each */
    size_t count;
    struct orl_pane_tree tree;
};

struct orl_mirrors {
    const struct orl_world *world;   /* borrowed, as ports are */
    const struct orl_windows *ports; /* that light gets into the building by */
    bool one_facade;                 /* all ports face one way: what they mirror inside is no sun */
    struct orl_mirror_plane *planes;
    size_t n_planes;
    struct orl_window *panes;
    struct orl_mirror_set everywhere, beyond; /* all panes; those that ports may show from inside */
    uint32_t *plane_of; /* by facet, or UINT32_MAX; NULL where there are none */
    size_t n_left_out;  /* facets, with those that are in no class though they are flat */
};

/* Returns 0 or ORL_ERR_NOMEM; orl_mirrors_done in either case. */
int orl_mirrors_init(struct orl_mirrors *mirrors, const struct orl_world *world,
                     const struct orl_windows *ports);
void orl_mirrors_done(struct orl_mirrors *mirrors);

/* What a place, or a surface there, makes of light that comes from a direction. */
typedef struct orl_rgb (*orl_mirrors_answer)(const void *ctx, struct orl_vec3 light);

/*
 * Light of a sun of 1 in that direction, by all mirrors, each by what answer says of where it seems
 * to come from. beyond: only by those that are seen through a port from inside.
 */
struct orl_rgb orl_mirrors_light(const struct orl_mirrors *mirrors, const struct orl_place *place,
                                 struct orl_vec3 towards, bool beyond, orl_mirrors_answer answer,
                                 const void *ctx);

/* The suns that may come to a point by way of a pane of a set: those in the cone about it. */
struct orl_cone orl_mirrors_cone(const struct orl_mirrors *mirrors,
                                 const struct orl_mirror_set *set, uint32_t item,
                                 struct orl_vec3 point);

/* As orl_mirrors_light, by one pane of a set alone; beyond: the set is that. *port becomes the
 * first port on the light's way back out of the building, unless it is one already. */
struct orl_rgb orl_mirrors_light_of(const struct orl_mirrors *mirrors,
                                    const struct orl_mirror_set *set, uint32_t item,
                                    const struct orl_place *place, struct orl_vec3 towards,
                                    orl_mirrors_answer answer, const void *ctx, int32_t *port);

#endif
