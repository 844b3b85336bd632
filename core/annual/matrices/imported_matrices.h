/*
 * A year by imported matrices: light is the sum of products that the request names
 * (oriel/annual/annual_matrices.h); direct sunlight alone is computed by Oriel.
 */
#ifndef ORL_ANNUAL_MATRICES_IMPORTED_MATRICES_H
#define ORL_ANNUAL_MATRICES_IMPORTED_MATRICES_H

#include <oriel/annual/annual.h>

/* Does what orl_annual_run does, for a request that names matrices. Rows are not delivered one by
 * one. */
int orl_annual_run_matrices(const struct orl_annual_request *request,
                            const struct orl_annual_env *env, struct orl_annual_result *ret_result,
                            struct orl_error *err);

#endif
