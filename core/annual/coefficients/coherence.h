/*
 * Coherence: how far the errors of a sensor's hours add up. Each hour has its own standard error. A
 * metric counts many hours, and its error depends on how their errors are correlated. Under the sky
 * alone errors are almost fully correlated: the paths are the same, and skies of different hours
 * are similar. Hours with sun have it in different places, so they depend on different paths and
 * photons. Errors of interpolation have either sign.
 *
 * The coherence of a sensor is the standard error of the sum of its relative errors over hours with
 * sun. It is divided by the sum of their relative standard errors, the value for full correlation.
 * Hours of similar illuminance are summed in a band, because a threshold separates such hours. The
 * result is the root mean square over bands, weighted by their errors.
 *
 * It combines the sources of each standard error:
 *   - paths: relative deviations of a batch are summed over hours; the spread of the sums counts;
 *   - photons: likewise for their photon batches;
 *   - interpolation: errors between the same nodes of the sun add up, others are independent;
 *   - sampling of panes and of the sun's disc: independent from hour to hour.
 *
 * Errors: 0 or ORL_ERR_NOMEM. Threads: any, if each handles other sensors or tiles.
 */
#ifndef ORL_ANNUAL_COEFFICIENTS_COHERENCE_H
#define ORL_ANNUAL_COEFFICIENTS_COHERENCE_H

#include <math.h>

#include <oriel/annual/annual.h>

#include "annual/sky/hours.h"
#include "annual/sun/sun_weights.h"
#include "annual/sun_map/sun_photons.h"

/* Bands of illuminance, each a factor of two wide except the first and the last. */
enum { ORL_ERROR_BANDS = 8 };
static inline int orl_error_band(double lx)
{
    const double octave = floor(log2(fmax(lx, 1) / 75));
    return (int)fmin(fmax(octave + 1, 0), ORL_ERROR_BANDS - 1);
}

/* Sums over some columns with sun in a band, relative to the light of each hour. */
struct orl_error_sums {
    double errors;  /* sum of standard errors */
    double squares; /* sum of squares of errors that are independent from hour to hour */
    float batches[ORL_ANNUAL_BATCHES];            /* deviations from the mean of all batches */
    float photon_batches[ORL_SUN_PHOTON_BATCHES]; /* deviations of photon batches from their mean */
};

/* Columns with sun, sorted so that those between the same nodes of the sun are adjacent. */
struct orl_sun_cells {
    uint32_t *columns, *cells; /* [count]; cells[i] is the first node of columns[i] */
    size_t count;
};
int orl_sun_cells_init(struct orl_sun_cells *cells, const struct orl_hours *hours,
                       const struct orl_sun_weights *sun_weights);
void orl_sun_cells_done(struct orl_sun_cells *cells); /* zeros are allowed */

/* sums: [tile * stride][band]. total: lx by column. interpolation_error: relative error of
 * interpolation by column; used in columns with sun. Returns a number from 0 to 1; 0 if hours with
 * sun have no errors. */
float orl_coherence_of(const struct orl_error_sums *sums, size_t n_tiles, size_t stride,
                       const float *total, const float *interpolation_error,
                       const struct orl_sun_cells *cells);

#endif
