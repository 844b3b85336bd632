/*
 * How far errors of a sensor's hours add up. Each hour has a standard error of its own; a metric
 * counts many hours, and its error depends on how their errors are correlated. Under the sky alone
 * they are so almost fully: the paths are the same, and skies of different hours are alike. Hours
 * with sun have it in different places, so that different paths matter, and different photons; and
 * errors of interpolation have either sign.
 *
 * The coherence of a sensor is the standard error of the sum of its relative errors over hours with
 * sun, divided by what that would be if they were fully correlated, the sum of their relative
 * standard errors. Hours of about the same illuminance are summed, since those are what a threshold
 * divides; of the bands of illuminance the root mean square is taken, each weighted by its errors.
 * It is found by what each standard error is made of:
 *   - paths: relative deviations of a batch are summed over hours; the spread of the sums;
 *   - photons: the same of their lots;
 *   - interpolation: errors between the same nodes of the sun add up, others are independent;
 *   - sampling of panes and of the sun's disc: independent from hour to hour.
 *
 * Errors: 0 or ORL_ERR_NOMEM. Threads: any, one sensor or tile each.
 */
#ifndef ORL_ANNUAL_COHERENCE_H
#define ORL_ANNUAL_COHERENCE_H

#include <math.h>

#include <oriel/annual.h>

#include "annual/hours.h"
#include "annual/sun_photons.h"
#include "annual/terms.h"

/* Bands of illuminance, of a factor of two each but for the first and the last. */
enum { ORL_ERROR_BANDS = 8 };
static inline int orl_error_band(double lx)
{
    const double octave = floor(log2(fmax(lx, 1) / 75));
    return (int)fmin(fmax(octave + 1, 0), ORL_ERROR_BANDS - 1);
}

/* Sums over hours with sun of some columns, in a band, all relative to the hour's light. */
struct orl_error_sums {
    double errors;                     /* standard errors */
    double squares;                    /* of errors that are each hour's own */
    float batches[ORL_ANNUAL_BATCHES]; /* deviations from the mean of all batches */
    float lots[ORL_SUN_MAP_LOTS];      /* the same of lots of photons */
};

/* Columns with sun, those of which the sun is between the same nodes next to each other. */
struct orl_sun_cells {
    uint32_t *columns, *cells; /* [count]; cells: of each of these columns */
    size_t count;
};
int orl_sun_cells_init(struct orl_sun_cells *cells, const struct orl_hours *hours,
                       const struct orl_sun_terms *terms);
void orl_sun_cells_done(struct orl_sun_cells *cells); /* zeros are fine */

/* sums: [tile * stride][band]. total: lx by column; between: the relative error of interpolation,
 * of columns with sun. Returns a number from 0 to 1; 0 where hours with sun have no errors. */
float orl_coherence_of(const struct orl_error_sums *sums, size_t n_tiles, size_t stride,
                       const float *total, const float *between, const struct orl_sun_cells *cells);

#endif
