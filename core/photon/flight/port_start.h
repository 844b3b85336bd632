/*
 * Where on a port emissions of one stratum start, and whence their light comes: the part of an
 * emission (emit.h) that takes numbers alone and no rays. Several at once take hardly longer than
 * one, for none waits for another's.
 */
#ifndef ORL_PHOTON_FLIGHT_PORT_START_H
#define ORL_PHOTON_FLIGHT_PORT_START_H

#include "photon/flight/emit.h"

enum { ORL_STARTS_AT_ONCE = 16 };

struct orl_port_start {
    struct orl_vec3 point, out; /* on the pane; unit, towards the light */
    double density;             /* against uniform by area, and by projected solid angle of domes */
};

/*
 * Of a stratum whose light passes a port; u: five numbers in [0,1) of each, as orl_emission_from
 * has them; n at most ORL_STARTS_AT_ONCE.
 */
void orl_port_starts(const struct orl_emission *emission, const struct orl_stratum *stratum,
                     bool caustic, const double *const *u, size_t n,
                     struct orl_port_start *ret_starts);

#endif
