/* Tensor trees of a panel: measured block by block, joined from the finest cells up, written. */
#ifndef ORL_GONIOMETER_TREES_H
#define ORL_GONIOMETER_TREES_H

#include "base/sobol.h"
#include "goniometer/sample.h"

/* As orl_bsdf_make has it, all of *made; half-filled after an error. */
int orl_gonio_make_trees(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_made *made,
                         struct orl_error *err);

#endif
