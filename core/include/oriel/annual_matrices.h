/*
 * Matrices of other programs in place of paths: daylight coefficients, or the three-phase method
 * (McNeil and Lee 2013, J. Building Performance Simulation 6, 24), in Radiance's format.
 *
 * A term is, for the sensors of a grid in their order, coefficients (sensors x patches of sky), or
 * view (sensors x directions of leaving the window) times transmission (those x directions of
 * coming in) times daylight (those x patches), times the sky (patches x rows of the weather file,
 * as gendaymtx makes it; all rows, dark ones too), in W/m2 of three channels. A transmission may be
 * a BSDF's XML with a matrix, light coming from outside. Windows add up; a term may be subtracted,
 * as the five-phase method does of the sun that patches have.
 *
 * The sum is the year's total, not below 0, at the hours with light. It has no errors, for matrices
 * do not tell theirs: intervals are not known, and verdicts unknown. Direct sunlight by itself is
 * Oriel's own, of the request's scene, all hours' suns exact: it is not a part of that total.
 */
#ifndef ORIEL_ANNUAL_MATRICES_H
#define ORIEL_ANNUAL_MATRICES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/files.h>

enum { ORL_MATRICES_MOST_TERMS = 256 };

/* Names of files, for the provider. All owned; orl_matrix_term_done frees them. */
struct orl_matrix_term {
    char *grid;         /* NULL: all sensors of the request */
    char *coefficients; /* or the three that follow; those not used are NULL */
    char *view, *transmission, *daylight;
    char *sky;
    bool subtract;
};
void orl_matrix_term_done(struct orl_matrix_term *term); /* NULL and zeros are fine */

/* Reads the matrices of all terms, one file at a time, and tells how many bytes the term with the
 * most takes in memory, with its products and sky. Errors are those of reading them. */
int orl_matrix_terms_measure(const struct orl_matrix_term *terms, size_t count,
                             const struct orl_files *files, uint64_t *ret_bytes,
                             struct orl_error *err);

#endif
