/*
 * Sampling of points on a port and directions of their light, for emissions of one stratum: the
 * part of an emission (emit.h) that traces no rays. Several at once take hardly longer than one,
 * because their table look-ups overlap.
 */
#ifndef ORL_PHOTON_EMISSION_PORT_START_H
#define ORL_PHOTON_EMISSION_PORT_START_H

#include "photon/emission/emit.h"

enum { ORL_STARTS_AT_ONCE = 16 };

struct orl_port_start {
    struct orl_vec3 point, out; /* point: on the pane; out: unit, towards the light */
    /* pdf relative to uniform by area, and for domes to projected solid angle */
    double pdf;
};

/*
 * Samples starts for a stratum whose light passes a port; u: for each, five numbers in [0,1) as for
 * orl_emission_sample_stratum; n: at most ORL_STARTS_AT_ONCE.
 */
void orl_port_starts(const struct orl_emission *emission, const struct orl_stratum *stratum,
                     bool caustic, const double *const *u, size_t n,
                     struct orl_port_start *ret_starts);

#endif
