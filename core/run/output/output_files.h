/* Files of a run's results. */
#ifndef ORL_RUN_OUTPUT_OUTPUT_FILES_H
#define ORL_RUN_OUTPUT_OUTPUT_FILES_H

#include "run/run_state.h"

/* Writes a view's files and names them in the result. */
int orl_run_write_view(struct orl_run_state *state, size_t index, const struct orl_film *film,
                       struct orl_error *err);

/* At the end: writes the requested maps and tables of the sensors. */
int orl_run_write_sensors(struct orl_run_state *state, struct orl_error *err);

/*
 * Likewise, writes the results of each grid: results/NAME.res (a value a line), results/NAME.npy,
 * and its map, results/NAME.png. results/grids_info.json has the names and counts of all, as in
 * Honeybee's point-in-time recipes. Under several skies the folder is SKY/results.
 */
int orl_run_write_grids(struct orl_run_state *state, struct orl_error *err);

#endif
