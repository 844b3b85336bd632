/*
 * What all paths of a year read: the world without its lights, and where these are to be.
 *
 * Immutable once made, and shared by all threads.
 */
#ifndef ORL_ANNUAL_SCENE_H
#define ORL_ANNUAL_SCENE_H

#include "annual/bins.h"
#include "annual/hours.h"
#include "annual/mirrors.h"
#include "annual/node_lots.h"
#include "annual/sun_map.h"
#include "base/sobol.h"
#include "render/gather/aim.h"
#include "render/gather/gather.h"

struct orl_annual_scene {
    const struct orl_world *world; /* borrowed, all: without suns, domes and lamps */
    const struct orl_bins *bins;
    struct orl_turn north;
    const struct orl_frame *nodes; /* of the sun, as the scene has it: n towards it */
    size_t n_nodes;
    struct orl_node_lots lots; /* of those */
    uint32_t a_circle;         /* of nodes, one after the other (nodes.h) */
    struct orl_aim aim;
    struct orl_sobol sobol;
    struct orl_windows ports;
    struct orl_mirrors mirrors; /* what those beyond ports throw in is in no map */
    struct orl_sun_map
        *map; /* owned, set by who made it; NULL: sunlight is looked for by shadow rays alone */
    bool whole_map;         /* it has what diffuse surfaces send from one to another */
    uint32_t n_parts;       /* of the windows (parts.h) */
    uint16_t *part_of_port; /* owned; NULL: there is one part */
};

/* Returns the part of light that comes in by a port; ORL_NO_PORT: by none. */
static inline uint32_t orl_annual_part_of(const struct orl_annual_scene *scene, int32_t port)
{
    if (!scene->part_of_port)
        return 0;
    return port == ORL_NO_PORT ? scene->n_parts - 1 : scene->part_of_port[port];
}

/* Returns 0, ORL_ERR_NOMEM or _CANCELLED; orl_annual_scene_done in either case. */
int orl_annual_scene_init(struct orl_annual_scene *scene, const struct orl_world *world,
                          const struct orl_bins *bins, struct orl_turn north,
                          const struct orl_frame *nodes, size_t n_nodes, uint32_t a_circle,
                          struct orl_crew *crew);
/* Tells light apart by window groups, the last part being windows of no group. Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_annual_scene_split(struct orl_annual_scene *scene, size_t n_groups);
/* Returns the request for the scene's sun map, which it does not have yet. */
struct orl_sun_map_request orl_annual_scene_map_request(const struct orl_annual_scene *scene,
                                                        const struct orl_annual_request *request);
/* Seconds of one core that the map is thought to take, of a scene that is not known yet. */
double orl_annual_scene_map_core_s(const struct orl_annual_request *request, size_t n_nodes);
/* Whether ports have BSDFs. */
bool orl_annual_has_panels(const struct orl_world *world);
void orl_annual_scene_done(struct orl_annual_scene *scene);

#endif
