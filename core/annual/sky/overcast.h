/*
 * Light of a sensor under the CIE overcast sky, from the coefficients shared by all hours. It
 * yields the daylight factor without more rays.
 *
 * The sky's luminance at the horizon is a third of that at the zenith (Moon and Spencer 1942; CIE S
 * 011/E:2003, type 16). It gives a horizontal plane ORL_OVERCAST_LX and lights the ground, a
 * diffuse reflector. Each bin has its mean luminance; no bin crosses the horizon.
 */
#ifndef ORL_ANNUAL_SKY_OVERCAST_H
#define ORL_ANNUAL_SKY_OVERCAST_H

#include "annual/coefficients/apply_weather.h"

struct orl_overcast {
    double luminance[ORL_BINS]; /* cd/m2 */
};

void orl_overcast_init(struct orl_overcast *overcast, const struct orl_bins *bins,
                       double ground_reflectance);

/* Adds the illuminance by a window group's coefficients to each batch, lx. */
void orl_overcast_add(const struct orl_overcast *overcast,
                      const struct orl_annual_coefficients *coefficients,
                      double batches[ORL_ANNUAL_BATCHES]);
/* Computes the mean of the batches, and its standard error. */
void orl_overcast_illuminance(const double batches[ORL_ANNUAL_BATCHES], float *ret_lx,
                              float *ret_se);

#endif
