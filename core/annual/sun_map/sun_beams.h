/* Beams of sunlight through kinds of ports, and their photons. */
#ifndef ORL_ANNUAL_SUN_MAP_SUN_BEAMS_H
#define ORL_ANNUAL_SUN_MAP_SUN_BEAMS_H

#include "base/sampling/sampling.h"
#include "light/lit_scene.h"

/*
 * Beams: sunlight from a node of the sun through a kind of ports. Ports of a kind share a material
 * and face nearly the same way. The flux that the ports of a beam let in is known for its node and
 * for any sun in between.
 *
 * Immutable once made.
 */

/* Most kinds of ports: in all; of a window group (annual_scene.h) if there are several; of
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
 * of the lit scene; NULL: there is one window group. Returns 0 or ORL_ERR_NOMEM; the caller calls
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

/*
 * Shadows on ports: buildings and trees outside block some of a sun's light on its way to a kind of
 * ports. The blocked share changes within minutes, while nodes of the sun are 40 minutes apart.
 * Rays from points of the ports, the same points for all suns, find it.
 *
 * Immutable once made.
 */

struct orl_port_point {
    uint32_t port;
    struct orl_hit hit;
    double on_disc[2]; /* the point of the sun's disc to which its ray is sent */
};

struct orl_port_shadows {
    const struct orl_sun_beams *beams; /* borrowed */
    struct orl_port_point *points;     /* [kind][n_points] */
    uint32_t n_points;                 /* points per kind */
    bool clear[ORL_SUN_MOST_KINDS];    /* by kind: true if nothing obstructs its ports */
};

/* n_suns: number of suns that will be queried; the more there are, the fewer points are drawn per
 * kind. Returns 0 or ORL_ERR_NOMEM; the caller calls orl_port_shadows_done in either case. */
int orl_port_shadows_init(struct orl_port_shadows *shadows, const struct orl_sun_beams *beams,
                          const struct orl_sobol *sobol, size_t n_suns);
void orl_port_shadows_done(struct orl_port_shadows *shadows);

/* Returns the share, 0 to 1, of a sun's light that reaches ports of that kind, straight or through
 * panes that are not ports; 0 if the sun is behind all of them. */
double orl_port_shadows_lit(const struct orl_port_shadows *shadows, uint32_t kind,
                            struct orl_vec3 towards);

/*
 * Photons of beams. They start on the sun's disc, pass the ports of a kind and go on
 * by specular and glossy reflection and transmission. Optionally diffuse surfaces scatter them,
 * too, until they are absorbed. At each diffuse surface inside the photon's flux is recorded.
 */

enum { ORL_SUN_PHOTON_BATCHES = 8 }; /* independent batches of photons */

/* Flux that a photon brings to a diffuse surface, W, for a sun with a normal irradiance of 1. */
struct orl_sun_deposit {
    uint32_t facet, batch;
    bool front;
    struct orl_vec3 point, normal;
    float flux[3]; /* RGB */
};

/* Photons of a beam that one task traces. */
struct orl_sun_photon_task {
    const struct orl_sun_beams *beams; /* borrowed, like all pointers down to sobol */
    const struct orl_frame *nodes;     /* frames in scene axes, n towards the sun */
    const struct orl_sobol *sobol;
    uint64_t seed;
    size_t beam;
    uint32_t photons;     /* photons per batch of the beam, over all tasks */
    uint32_t first, end;  /* photons of this task; the batch of a photon is index % batches */
    bool interreflection; /* true if diffuse surfaces scatter photons as well */
    struct orl_sun_deposit *deposits; /* owned; the order depends on the request alone */
    size_t n_deposits, room;
    int code; /* 0 or ORL_ERR_NOMEM */
};

/* Traces the task's photons and fills deposits and code; the caller has set the other fields. */
void orl_sun_photon_task_trace(struct orl_sun_photon_task *task);
void orl_sun_photon_task_done(struct orl_sun_photon_task *task);

#endif
