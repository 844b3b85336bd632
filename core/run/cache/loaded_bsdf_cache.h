/*
 * Loads BSDFs through the store: the XML is read once, and the result is stored (file_cache.h), as
 * kind "bsdf", for later jobs to map (bsdf/compiled_bsdf.h). Small files, which load as fast as a
 * look-up, are not stored; without a store none are.
 */
#ifndef ORL_RUN_CACHE_LOADED_BSDF_CACHE_H
#define ORL_RUN_CACHE_LOADED_BSDF_CACHE_H

#include "run/run_state.h"
#include "scene/parse/sources.h"

/* Returns a loader that borrows the state, which must outlive it. */
struct orl_bsdf_loader orl_run_bsdf_loader(struct orl_run_state *state);

#endif
