/* Estimates of a run's time and memory. */
#ifndef ORL_RUN_ESTIMATE_RUN_COST_H
#define ORL_RUN_ESTIMATE_RUN_COST_H

#include "run/run_state.h"

/* Returns a rough estimate of the job's seconds on one core, without knowledge of its scene or of
 * its errors. Not valid with a deadline, or with sensors in a file that is not read yet. */
double orl_run_estimate_core_s(const struct orl_job *job);
/* Returns a rough estimate of the job's memory in bytes, besides the scene. */
uint64_t orl_run_estimate_bytes(const struct orl_job *job);

/* Estimates the job's stages into state->cost_s; called when the sensors are known, and again when
 * the photons are. */
void orl_run_estimate_stages(struct orl_run_state *state);
/* Reduces the sensors' estimate: earlier jobs have read that share of the global map. */
void orl_run_discount_map_reads(struct orl_run_state *state, double share);
/* Returns true if earlier parts of the job have measured the stages, which is more accurate than a
 * plan's estimate. */
bool orl_run_is_measured(const struct orl_run_state *state);
/* Returns the photons that could be traced and put into maps, by rough costs, in the time of all
 * views by maps; for a pilot, of the whole job's views. */
double orl_run_photons_in_view_time(const struct orl_run_state *state);
/* Returns the share of a view's time for painting; the rest is for writing files. */
double orl_run_painting_share(const struct orl_run_state *state,
                              const struct orl_view_request *view);
/* Returns the share of the sensors' time for a share of their samples. */
double orl_run_sensors_time_share(const struct orl_run_state *state, double taken);
/* Returns the sensors' share of the render stage. */
double orl_run_sensors_share(const struct orl_run_state *state);
/* Predicts the time of the whole job, into the forecast of its plan. */
void orl_run_estimate_from_pilot(struct orl_run_state *state);

#endif
