/*
 * Shadows on ports: what stands outside before a kind of ports (sun_beams.h) keeps some of a sun's
 * light from them, and how much changes within minutes, faster than nodes of the sun tell. Points
 * of the ports, the same for all suns, and rays from them find the share of the light that arrives.
 *
 * Immutable once made.
 */
#ifndef ORL_ANNUAL_PORT_SHADOWS_H
#define ORL_ANNUAL_PORT_SHADOWS_H

#include "annual/sun_beams.h"
#include "base/sobol.h"

struct orl_port_point {
    uint32_t port;
    struct orl_hit hit;
    double on_disc[2]; /* which point of the sun's disc it looks at */
};

struct orl_port_shadows {
    const struct orl_sun_beams *beams; /* borrowed */
    struct orl_port_point *points;     /* [kind][n_points] */
    uint32_t n_points;                 /* of a kind */
    bool *clear;                       /* by kind: nothing is before its ports */
};

/* n_suns: of how many it is going to be asked; the more, the fewer points there are. Returns 0 or
 * ORL_ERR_NOMEM; orl_port_shadows_done in either case. */
int orl_port_shadows_init(struct orl_port_shadows *shadows, const struct orl_sun_beams *beams,
                          const struct orl_sobol *sobol, size_t n_suns);
void orl_port_shadows_done(struct orl_port_shadows *shadows);

/* The share, 0 to 1, of a sun's light that reaches ports of that kind straight, or through panes
 * that are no ports. 0 where the sun is behind all of them. */
double orl_port_shadows_lit(const struct orl_port_shadows *shadows, uint32_t kind,
                            struct orl_vec3 towards);

#endif
