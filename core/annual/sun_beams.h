/*
 * Beams: a node of the sun by way of a kind of ports, those of one material that face about one
 * way. Of each it is known how much its ports let in, from the node and from any sun between.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_SUN_BEAMS_H
#define ORL_ANNUAL_SUN_BEAMS_H

#include "light/world.h"

/* Kinds of ports: in all, and of a part (parts.h) of several, or of the only one. Those of more are
 * of the part's last one. */
enum { ORL_SUN_MOST_KINDS = 256, ORL_SUN_KINDS_OF_PART = 3, ORL_SUN_KINDS_OF_ALL = 8 };

struct orl_sun_beam {
    uint32_t node, kind;
};

struct orl_sun_beams {
    const struct orl_world *world; /* borrowed */
    struct orl_sun_beam *at;       /* node by node */
    size_t count;
    uint8_t *kind_of_port;
    struct orl_sun_kind {
        const struct orl_material *material;
        struct orl_vec3 outward; /* of its first port */
        uint16_t part;           /* of its ports */
    } kinds[ORL_SUN_MOST_KINDS];
    uint32_t n_kinds;
};

/* nodes: n towards the sun, as the scene has it. part_of_port: of the world's; NULL: there is one
 * part. Returns 0 or ORL_ERR_NOMEM; orl_sun_beams_done in
 * either case. */
int orl_sun_beams_init(struct orl_sun_beams *beams, const struct orl_world *world,
                       const struct orl_frame *nodes, size_t n_nodes, const uint16_t *part_of_port);
void orl_sun_beams_done(struct orl_sun_beams *beams);

/* How many beams have that one's node, itself included. */
uint32_t orl_sun_beams_of_node(const struct orl_sun_beams *beams, size_t beam);

/*
 * Flux that a kind's ports let in from a sun in that direction, were nothing before them, of one
 * that gives 1 to what faces it: by this, what beams bring goes on between nodes.
 */
double orl_sun_beams_let_in(const struct orl_sun_beams *beams, uint32_t kind,
                            struct orl_vec3 towards);

#endif
