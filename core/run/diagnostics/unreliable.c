/* Sensors with unreliable values, and the effect on the accuracy that the job requested. */
#include <stdio.h>
#include <stdlib.h>

#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"

const char *orl_doubt_name(enum orl_doubt doubt)
{
    return doubt == ORL_DOUBT_CROSS_CHECK ? "cross-check" : "missed-light";
}

void orl_run_mark_unreliable(struct orl_run_state *state, size_t sensor, enum orl_doubt doubt)
{
    struct orl_result *r = state->result;
    if (!r->doubts)
        r->doubts = calloc(r->n_sensors, sizeof *r->doubts);
    if (r->doubts)
        r->doubts[sensor] |= (unsigned char)doubt;
}

void orl_run_apply_unreliable(struct orl_run_state *state)
{
    struct orl_result *r = state->result;
    struct orl_outcome *outcome = &r->outcome;
    size_t n = 0;
    for (size_t i = 0; r->doubts && i < r->n_sensors; i++)
        n += r->doubts[i] != 0;
    if (n == 0 || !outcome->asked || !outcome->met)
        return;
    outcome->met = false;
    snprintf(outcome->why, sizeof outcome->why, "%zu sensor%s unreliable: see warnings", n,
             n == 1 ? " is" : "s are");
}
