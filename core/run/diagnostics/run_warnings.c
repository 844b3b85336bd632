#include "run/diagnostics/run_warnings.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
