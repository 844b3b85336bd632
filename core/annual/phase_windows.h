/*
 * Windows of the three-phase method: a closed building's ports that are of one material and face
 * one way; what they transmit, and what of the sky they see, by cells of directions.
 */
#ifndef ORL_ANNUAL_PHASE_WINDOWS_H
#define ORL_ANNUAL_PHASE_WINDOWS_H

#include <oriel/annual_phases.h>

#include "annual/light.h"
#include "annual/trace.h"

struct orl_phase_windows {
    struct orl_basis basis;
    uint32_t *of_port;        /* of the world's ports, which window */
    struct orl_frame *frames; /* by window: n inwards */
    uint32_t *panes;          /* a port of each window */
};

/* Finds them, and makes as many of the result, with names. ORL_ERR_NOMEM, _LIMIT. */
int orl_phase_windows_init(struct orl_phase_windows *windows, const struct orl_world *world,
                           struct orl_annual_phases *result, struct orl_error *err);
void orl_phase_windows_done(struct orl_phase_windows *windows);

/* Fills transmission and daylight, for which there is room. healths: by member of the crew.
 * ORL_ERR_NOMEM, _CANCELLED. */
int orl_phase_windows_look(const struct orl_phase_windows *windows, struct orl_year *year,
                           struct orl_annual_phases *result, struct orl_health *healths);

#endif
