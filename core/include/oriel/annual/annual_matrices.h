/*
 * Matrices of other programs in place of paths: daylight coefficients, or the three-phase method
 * (McNeil and Lee 2013, J. Building Performance Simulation 6, 24), in Radiance's format.
 *
 * A term holds for the sensors of a grid in their order. It is either coefficients (sensors x sky
 * patches), or view (sensors x window exit directions) times transmission (exit directions x entry
 * directions) times daylight (entry directions x sky patches). Both are multiplied by the sky (sky
 * patches x rows of the weather file, as gendaymtx writes it; all rows, dark ones too), in W/m2 of
 * three channels. A transmission may be a BSDF's XML with a matrix, for light from outside. Windows
 * add up. A term may be subtracted, as in the five-phase method for the sun that patches contain.
 *
 * The sum is the year's total at the hours with light, clamped at 0. Since matrices carry no
 * errors, intervals are not known, and verdicts are unknown. Direct sunlight is still computed by
 * Oriel from the request's scene, with exact suns of all hours; it is not part of that total.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_MATRICES_H
#define ORIEL_ANNUAL_ANNUAL_MATRICES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>

enum { ORL_MATRICES_MOST_TERMS = 256 };

/* Term of the sum, with file names for the provider. All owned; orl_matrix_term_done frees them. */
struct orl_matrix_term {
    char *grid;         /* NULL: all sensors of the request */
    char *coefficients; /* alternative to the next three; unused names are NULL */
    char *view, *transmission, *daylight;
    char *sky;
    bool subtract;
};
void orl_matrix_term_done(struct orl_matrix_term *term); /* NULL and zeros are fine */

/* Reads the matrices of all terms, one file at a time. Returns in *ret_bytes the memory of the
 * largest term, in bytes, with its products and sky. Errors are those of reading the files. */
int orl_matrix_terms_measure(const struct orl_matrix_term *terms, size_t count,
                             const struct orl_files *files, uint64_t *ret_bytes,
                             struct orl_error *err);

#endif
