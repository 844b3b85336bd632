/* Makes tensor trees of a panel: measures blocks, joins cells from the finest up, writes the
 * file. */
#ifndef ORL_BSDF_MAKE_TREES_PANEL_TREES_H
#define ORL_BSDF_MAKE_TREES_PANEL_TREES_H

#include "base/sampling/sobol.h"
#include "bsdf/make/panel/panel_sample.h"

/* Like orl_bsdf_make; fills all of *made, or only a part of it after an error. */
int orl_gonio_make_trees(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_make_result *result,
                         struct orl_error *err);

#endif
