/*
 * Beams: sunlight from a node of the sun through a kind of ports. Ports of a kind share a material
 * and face nearly the same way. The flux that the ports of a beam let in is known for its node and
 * for any sun in between.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_SUN_MAP_SUN_BEAMS_H
#define ORL_ANNUAL_SUN_MAP_SUN_BEAMS_H

#include "light/lit_scene.h"

/* Most kinds of ports: in all; of a window group (window_group_ports.h) if there are several; of
 * the only window group. Further kinds are merged into the window group's last one. */
enum { ORL_SUN_MOST_KINDS = 256, ORL_SUN_KINDS_OF_GROUP = 3, ORL_SUN_KINDS_OF_ALL = 8 };

struct orl_sun_beam {
    uint32_t node, kind;
};

struct orl_sun_beams {
    const struct orl_lit_scene *lit_scene; /* borrowed */
    struct orl_sun_beam *at;               /* node by node */
    size_t count;
    uint8_t *kind_of_port;
    struct orl_sun_kind {
        const struct orl_material *material;
        struct orl_vec3 outward; /* outward direction of its first port */
        uint16_t window_group;   /* window group that its ports belong to */
    } kinds[ORL_SUN_MOST_KINDS];
    uint32_t n_kinds;
};

/* nodes: frames in scene axes, n towards the sun. window_group_of_port: window group of each port
 * of the world; NULL: there is one window group. Returns 0 or ORL_ERR_NOMEM; the caller calls
 * orl_sun_beams_done in either case. */
int orl_sun_beams_init(struct orl_sun_beams *beams, const struct orl_lit_scene *lit_scene,
                       const struct orl_frame *nodes, size_t n_nodes,
                       const uint16_t *window_group_of_port);
void orl_sun_beams_done(struct orl_sun_beams *beams);

/* Returns the number of beams from the same node, including this one. */
uint32_t orl_sun_beams_of_node(const struct orl_sun_beams *beams, size_t beam);

/*
 * Returns the flux that a kind's ports let in from a sun in that direction with normal illuminance
 * 1, without obstructions. Light of beams is interpolated between nodes in proportion to it.
 */
double orl_sun_beams_flux(const struct orl_sun_beams *beams, uint32_t kind,
                          struct orl_vec3 towards);

#endif
