/*
 * Windows of the three-phase method: the ports of a closed building, grouped by material and
 * direction. Computes their transmission, and the sky that they see, by cells of directions.
 */
#ifndef ORL_ANNUAL_MATRICES_PHASE_WINDOWS_H
#define ORL_ANNUAL_MATRICES_PHASE_WINDOWS_H

#include <oriel/annual/annual_phases.h>

#include "annual/coefficients/trace_sensor.h"
#include "annual/year/annual_year.h"

struct orl_phase_windows {
    struct orl_basis basis;
    uint32_t *of_port;        /* window of each port of the world */
    struct orl_frame *frames; /* by window: n points inwards */
    uint32_t *panes;          /* one port of each window */
};

/* Groups the ports, and creates the result's windows with names. Returns 0, ORL_ERR_NOMEM or
 * _LIMIT. */
int orl_phase_windows_init(struct orl_phase_windows *windows, const struct orl_lit_scene *lit_scene,
                           struct orl_phase_matrices *result, struct orl_error *err);
void orl_phase_windows_done(struct orl_phase_windows *windows);

/* Fills transmission and daylight, which are allocated. healths: by crew member. Returns 0,
 * ORL_ERR_NOMEM or _CANCELLED. */
int orl_phase_windows_compute(const struct orl_phase_windows *windows, struct orl_year *year,
                              struct orl_phase_matrices *result, struct orl_health *healths);

#endif
