/* Matrices of a panel in a Klems basis: rounds of paths, until errors are as asked for. */
#ifndef ORL_GONIOMETER_KLEMS_H
#define ORL_GONIOMETER_KLEMS_H

#include "base/sobol.h"
#include "goniometer/sample.h"

/* As orl_bsdf_make has it, all of *made; half-filled after an error. */
int orl_gonio_make_klems(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                         const struct orl_sobol *sobol, struct orl_bsdf_made *made,
                         struct orl_error *err);

#endif
