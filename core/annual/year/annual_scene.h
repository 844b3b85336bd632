/* Scene data of a year, the window groups of its ports, and the scenes that a year supports. */
#ifndef ORL_ANNUAL_YEAR_ANNUAL_SCENE_H
#define ORL_ANNUAL_YEAR_ANNUAL_SCENE_H

#include "annual/sky/bins.h"
#include "annual/sky/hours.h"
#include "annual/sun/direction_tree.h"
#include "annual/sun/mirror_planes.h"
#include "annual/sun_map/sun_map.h"
#include "base/sampling/sampling.h"
#include "light/lit_scene.h"
#include "render/gather/direction_sampling.h"
#include "render/gather/gather.h"

/*
 * Check that a year of the scene can be computed. Sunlight on paths that are not followed is
 * refused with the surface's name, never left out silently.
 */

/* Returns 0, or ORL_ERR_UNSUPPORTED naming a surface. */
int orl_annual_check_supported(const struct orl_lit_scene *lit_scene, struct orl_error *err);

/* Counts curved surfaces that reflect some sunlight, which is left out; *ret_first is the first
 * one. */
size_t orl_annual_count_curved(const struct orl_lit_scene *lit_scene, uint32_t *ret_first);

/* Returns true if materials colour light by diffuse scattering only. */
bool orl_annual_is_colourless(const struct orl_lit_scene *lit_scene);

/*
 * Window groups: one for each group with shades, and one for windows in no group. The light
 * of a year is the sum over its window groups. Light belongs to the window group of the port by
 * which its path, followed back from the sensor, first leaves the building.
 */

/* Returns the window group of a port, from 0; windows of no group are window group n_groups. */
uint16_t orl_window_group_of_port(const struct orl_lit_scene *lit_scene, size_t port,
                                  size_t n_groups);

/*
 * Checks that all surfaces of a window group are near its ports: no further from one of them than
 * half its longer side, in front, behind and beside it. Returns 0, or ORL_ERR_UNSUPPORTED naming
 * the surface. name: the window group's.
 */
int orl_window_group_check_near(const struct orl_lit_scene *lit_scene, uint32_t window_group,
                                const char *name, struct orl_error *err);

/* Data that all paths of a year read: the lit scene without light sources, and nodes of the sun.
 * Immutable once made, and shared by all threads. */
struct orl_annual_scene {
    const struct orl_lit_scene
        *lit_scene; /* borrowed, like bins and nodes; has no suns, domes and lamps */
    const struct orl_bins *bins;
    struct orl_sky_rotation north;
    const struct orl_frame *nodes; /* frames of the sun's nodes in scene axes, n towards the sun */
    size_t n_nodes;
    struct orl_sun_grid_subsets subsets; /* subsets of the nodes */
    uint32_t nodes_per_circle;           /* nodes per circle, stored contiguously (sun_weights.h) */
    struct orl_direction_sampler sampler;
    struct orl_sobol sobol;
    struct orl_port_rects ports;
    struct orl_mirrors mirrors; /* light of mirrors seen through ports is in no map */
    struct orl_sun_map
        *map; /* owned, set by the caller; NULL: sunlight is found by shadow rays alone */
    bool map_interreflection;       /* true if the map includes light between diffuse surfaces */
    uint32_t n_window_groups;       /* number of window groups */
    uint16_t *window_group_of_port; /* owned; NULL: there is one window group */
};

/* Returns the window group to which light through a port belongs; ORL_NO_PORT: through no port. */
static inline uint32_t orl_annual_window_group_of(const struct orl_annual_scene *scene,
                                                  int32_t port)
{
    if (!scene->window_group_of_port)
        return 0;
    return port == ORL_NO_PORT ? scene->n_window_groups - 1 : scene->window_group_of_port[port];
}

/* Makes the rest of a scene whose borrowed fields, north, nodes_per_circle and n_window_groups are
 * set. Returns 0, ORL_ERR_NOMEM or _CANCELLED; the caller calls orl_annual_scene_done in either
 * case. */
int orl_annual_scene_init(struct orl_annual_scene *scene, struct orl_thread_pool *pool);
/* Returns the request with which the caller makes the scene's sun map. */
struct orl_sun_map_request orl_annual_scene_map_request(const struct orl_annual_scene *scene,
                                                        const struct orl_annual_request *request);
/* Estimates the time of the map, in seconds of one core, before the scene is loaded. */
double orl_annual_scene_map_core_s(const struct orl_annual_request *request, size_t n_nodes);
void orl_annual_scene_done(struct orl_annual_scene *scene);

#endif
