/* Warnings in a run's result. */
#ifndef ORL_RUN_DIAGNOSTICS_RUN_WARNINGS_H
#define ORL_RUN_DIAGNOSTICS_RUN_WARNINGS_H

#include "run/run_state.h"

/* Adds a warning to the run's result. */
void orl_run_warn(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Warns unless the result already has the same warning, such as from an earlier round. */
void orl_run_warn_once(struct orl_run_state *state, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
