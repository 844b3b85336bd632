/*
 * Shadows on ports: buildings and trees outside block some of a sun's light on its way to a kind of
 * ports (sun_beams.h). The blocked share changes within minutes, while nodes of the sun are 40
 * minutes apart. Rays from points of the ports, the same points for all suns, find it.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_PANES_PORT_SHADOWS_H
#define ORL_ANNUAL_PANES_PORT_SHADOWS_H

#include "annual/sun_map/sun_beams.h"
#include "base/sampling/sobol.h"

struct orl_port_point {
    uint32_t port;
    struct orl_hit hit;
    double on_disc[2]; /* the point of the sun's disc to which its ray is sent */
};

struct orl_port_shadows {
    const struct orl_sun_beams *beams; /* borrowed */
    struct orl_port_point *points;     /* [kind][n_points] */
    uint32_t n_points;                 /* points per kind */
    bool *clear;                       /* by kind: true if nothing obstructs its ports */
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

#endif
