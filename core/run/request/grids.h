/*
 * Sensors of a job in named grids. The results of each are results/NAME.res (a value a line) and
 * results/NAME.npy. results/grids_info.json has the names and counts of all, as in Honeybee's
 * point-in-time recipes. Under several skies the folder is SKY/results.
 */
#ifndef ORL_RUN_REQUEST_GRIDS_H
#define ORL_RUN_REQUEST_GRIDS_H

#include "run/run_state.h"

/* Checks the names, and that sensors and grids agree. */
int orl_grids_validate(const struct orl_job *job, struct orl_error *err);

/* Reads the job's sensors and those of its grids' files. *ret_grids has no file names any more; its
 * names borrow from the job. The caller owns both arrays. */
int orl_grids_read(const struct orl_job *job, const struct orl_files *files,
                   const atomic_bool *cancel, struct orl_grid_request **ret_grids,
                   struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

/* Loads the sensors of all grids into the state, and each grid's name and range into the result. */
int orl_run_load_grids(struct orl_run_state *state, struct orl_error *err);
/* Writes the files after the sensors are computed. */
int orl_run_write_grids(struct orl_run_state *state, struct orl_error *err);

void orl_grid_results_done(struct orl_result *result);

#endif
