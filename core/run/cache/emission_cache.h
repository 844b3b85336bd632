/*
 * The emission of a job's photons, and its photon pilot. Both depend on the scene, its lights, the
 * plan's omissions and the seed alone, so that the memory cache keeps them for later jobs.
 * Threads: the lead thread.
 */
#ifndef ORL_RUN_CACHE_EMISSION_CACHE_H
#define ORL_RUN_CACHE_EMISSION_CACHE_H

#include "run/run_state.h"

/* Sets state->emission, unless it is set: the emission of an earlier job, or a new one. Call it
 * once the plan has made the lit scene. */
int orl_run_ensure_emission(struct orl_run_state *state, struct orl_error *err);

/* Runs the photon pilot of the job's emission, or returns the result of an earlier job: from the
 * memory cache, or from the store (kind "pilot"), where later processes find it. */
int orl_run_photon_pilot(struct orl_run_state *state, struct orl_photon_pilot *ret_pilot,
                         struct orl_error *err);

/* Ends the use of state->emission: it goes into the memory cache, or is freed. Call it before the
 * lit scene is freed. */
void orl_run_release_emission(struct orl_run_state *state);

#endif
