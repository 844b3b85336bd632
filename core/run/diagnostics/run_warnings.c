/* Warnings in a run's result, and sensors that are marked as unreliable. */
#include "run/diagnostics/diagnostics.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/run_state.h"

enum { WARNING_SIZE = 1024 };

static void add_warning(struct orl_run_state *state, const char *text)
{
    struct orl_result *r = state->result;
    if (state->env->warned)
        state->env->warned(state->env->ctx, text);
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    if (!grown)
        return;
    r->warnings = grown;
    grown[r->n_warnings] = strdup(text);
    if (grown[r->n_warnings])
        r->n_warnings++;
}

void orl_run_warn(struct orl_run_state *state, const char *format, ...)
{
    char text[WARNING_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    add_warning(state, text);
}

void orl_run_warn_once(struct orl_run_state *state, const char *format, ...)
{
    char text[WARNING_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    for (size_t i = 0; i < state->result->n_warnings; i++)
        if (strcmp(state->result->warnings[i], text) == 0)
            return;
    add_warning(state, text);
}

/* Sensors with unreliable values, and the effect on the accuracy that the job requested. */

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
