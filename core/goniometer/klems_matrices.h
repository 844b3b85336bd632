/* Measures matrices of a panel in a Klems basis: rounds of paths until the accuracy is reached. */
#ifndef ORL_GONIOMETER_KLEMS_MATRICES_H
#define ORL_GONIOMETER_KLEMS_MATRICES_H

#include "base/sobol.h"
#include "goniometer/sample.h"

/* Like orl_bsdf_make; fills all of *made, or only a part of it after an error. */
int orl_gonio_make_klems(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_made *made,
                         struct orl_error *err);

#endif
