/* Matrix terms of a request (oriel/annual/annual_matrices.h), checked before their files are read.
 */
#ifndef ORL_ANNUAL_MATRICES_MATRIX_TERMS_H
#define ORL_ANNUAL_MATRICES_MATRIX_TERMS_H

#include <oriel/annual/annual.h>

/* Checks that the request can be computed by matrices. Returns 0, ORL_ERR_INVALID or _LIMIT. */
int orl_matrix_terms_validate(const struct orl_annual_request *request, struct orl_error *err);

/* Returns the term's grid. If the term names no grid, fills room with all sensors and returns it.
 * Returns NULL if the named grid does not exist. */
const struct orl_annual_grid *orl_matrix_term_grid(const struct orl_annual_request *request,
                                                   const struct orl_matrix_term *term,
                                                   struct orl_annual_grid *room);

#endif
