/*
 * Sensors of a job in grids, each with a name that its results keep: results/NAME.res (a value a
 * line) and results/NAME.npy of each, and results/grids_info.json with the names and counts of all,
 * as Honeybee's recipes of one moment leave them. Under several skies the folder is
 * SKY/results.
 */
#ifndef ORL_RUN_GRIDS_H
#define ORL_RUN_GRIDS_H

#include "run/stages.h"

/* Names, and that sensors and grids tell the same. */
int orl_grids_validate(const struct orl_job *job, struct orl_error *err);

/* The job's sensors with those of its grids' files, which *ret_grids no longer names; names in it
 * are the job's. Both arrays are the caller's. */
int orl_grids_read(const struct orl_job *job, const struct orl_files *files,
                   const atomic_bool *cancel, struct orl_grid_request **ret_grids,
                   struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

/* The sensors of all grids into the state, and into the result where each has its own. */
int orl_run_load_grids(struct orl_run_state *state, struct orl_error *err);
/* The files, once the sensors are known. */
int orl_run_write_grids(struct orl_run_state *state, struct orl_error *err);

void orl_grid_results_done(struct orl_result *result);

#endif
