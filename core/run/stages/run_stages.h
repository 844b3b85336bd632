/* The stages of a run: plan, photon maps, rendering by a technique. */
#ifndef ORL_RUN_STAGES_RUN_STAGES_H
#define ORL_RUN_STAGES_RUN_STAGES_H

#include "run/run_state.h"

/* Creates state->emission, where photons start, unless it exists. */
int orl_run_ensure_emission(struct orl_run_state *state, struct orl_error *err);
/* Creates state->backward, the backward technique's data of the world, unless it exists. */
int orl_run_ensure_backward(struct orl_run_state *state, struct orl_error *err);
void orl_run_free_backward(struct orl_run_state *state);

/* Photons and maps stages: loads every map that the job needs into state->maps, or makes it. */
int orl_run_prepare_maps(struct orl_run_state *state, struct orl_error *err);
void orl_run_release_maps(struct orl_run_state *state);

/* Returns the paths per pixel of a job without rounds, by backward. */
uint32_t orl_run_pixel_samples(const struct orl_run_state *state);
/* Returns the number of equal rounds that a job without a goal is divided into to estimate the
 * errors of its glare; 1: none. */
uint32_t orl_run_count_batches(const struct orl_run_state *state);

/* Plan stage: stores technique and effects in the result's plan, and makes state->world without the
 * plan's omissions. */
int orl_run_plan(struct orl_run_state *state, struct orl_error *err);

/* Returns the limit of emissions for photons to sensors in mid-air. */
uint64_t orl_run_sensor_flux_limit(const struct orl_run_state *state);

/* Run the photons, maps and render stages; orl_run_technique chooses by the plan. */
int orl_run_backward(struct orl_run_state *state, struct orl_error *err);
int orl_run_gather(struct orl_run_state *state, struct orl_error *err);
int orl_run_technique(struct orl_run_state *state, struct orl_error *err);

#endif
