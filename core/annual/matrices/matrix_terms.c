/* Matrix terms of a request: freeing and validation. */
#include "annual/matrices/matrix_terms.h"

#include <stdlib.h>
#include <string.h>

void orl_matrix_term_done(struct orl_matrix_term *term)
{
    if (!term)
        return;
    free(term->grid);
    free(term->coefficients);
    free(term->view);
    free(term->transmission);
    free(term->daylight);
    free(term->sky);
    *term = (struct orl_matrix_term){.grid = NULL};
}

/* ---- Checks ---------------------------------------------------------------------------------- */

const struct orl_annual_grid *orl_matrix_term_grid(const struct orl_annual_request *request,
                                                   const struct orl_matrix_term *term,
                                                   struct orl_annual_grid *room)
{
    *room = (struct orl_annual_grid){NULL, 0, request->n_sensors};
    if (!term->grid)
        return room;
    for (size_t i = 0; i < request->n_grids; i++)
        if (request->grids[i].name && strcmp(request->grids[i].name, term->grid) == 0)
            return &request->grids[i];
    return NULL;
}

int orl_matrix_terms_validate(const struct orl_annual_request *request, struct orl_error *err)
{
    struct orl_annual_grid all;
    if (request->n_terms > ORL_MATRICES_MOST_TERMS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu matrices' terms are more than %d",
                             request->n_terms, ORL_MATRICES_MOST_TERMS);
    if (request->n_terms > 0 && request->n_groups > 0)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "matrices are of one state: a year by matrices has no shades");
    if (request->n_terms > 0 && request->coefficients)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a year by matrices has no daylight coefficients of its own");
    for (size_t i = 0; i < request->n_terms; i++) {
        const struct orl_matrix_term *t = &request->terms[i];
        const bool three = t->view && t->transmission && t->daylight;
        const bool any = t->view || t->transmission || t->daylight;
        if (!t->sky || (t->coefficients ? any : !three))
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "matrices[%zu]: a sky is wanted, and coefficients, or view, "
                                 "transmission and daylight",
                                 i);
        if (!orl_matrix_term_grid(request, t, &all))
            return orl_error_set(err, ORL_ERR_INVALID, "matrices[%zu]: no grid is named '%.100s'",
                                 i, t->grid);
    }
    return 0;
}
