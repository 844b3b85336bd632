/* Terms of a request's matrices (oriel/annual_matrices.h), before any file of theirs is read. */
#ifndef ORL_ANNUAL_MATRIX_TERMS_H
#define ORL_ANNUAL_MATRIX_TERMS_H

#include <oriel/annual.h>

/* Whether the request can be made by matrices: ORL_ERR_INVALID, _LIMIT. */
int orl_matrix_terms_validate(const struct orl_annual_request *request, struct orl_error *err);

/* The term's sensors: of all, put into room, where it names no grid. NULL: there is no such grid.
 */
const struct orl_annual_grid *orl_matrix_term_grid(const struct orl_annual_request *request,
                                                   const struct orl_matrix_term *term,
                                                   struct orl_annual_grid *room);

#endif
