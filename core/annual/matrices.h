/*
 * A year by matrices of others: light is the sum of products that the request names
 * (oriel/annual_matrices.h), direct sunlight by itself Oriel's own.
 */
#ifndef ORL_ANNUAL_MATRICES_H
#define ORL_ANNUAL_MATRICES_H

#include <oriel/annual.h>

/* As orl_annual_run, of a request that names matrices; rows are not handed out one by one. */
int orl_annual_run_matrices(const struct orl_annual_request *request,
                            const struct orl_annual_env *env, struct orl_annual_result *ret_result,
                            struct orl_error *err);

#endif
