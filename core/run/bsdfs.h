/*
 * BSDFs by the store: the XML is read once, and what comes of it is kept (keeping.h), as kind
 * "bsdf", for later jobs to map (bsdf/compiled.h). Small files, which load as fast as they can be
 * found, are left alone; without a store all are.
 */
#ifndef ORL_RUN_BSDFS_H
#define ORL_RUN_BSDFS_H

#include "run/stages.h"
#include "scene/parse/sources.h"

/* Borrows the state, which must outlive it. */
struct orl_bsdf_loader orl_run_bsdf_loader(struct orl_run_state *state);

#endif
