/*
 * A sensor under the CIE's overcast sky, by the coefficients that all hours share: the daylight
 * factor, without a ray more.
 *
 * The sky is a third as bright at the horizon as in the zenith (Moon and Spencer 1942; CIE S
 * 011/E:2003, type 16), gives a level plane ORL_OVERCAST_LX, and lights the ground, which reflects
 * evenly. Each bin has its mean; the horizon parts bins.
 */
#ifndef ORL_ANNUAL_OVERCAST_H
#define ORL_ANNUAL_OVERCAST_H

#include "annual/product.h"

struct orl_overcast {
    double luminance[ORL_BINS]; /* cd/m2 */
};

void orl_overcast_init(struct orl_overcast *overcast, const struct orl_bins *bins,
                       double ground_reflectance);

/* Adds what a part's coefficients come to, by batch: lx. */
void orl_overcast_add(const struct orl_overcast *overcast,
                      const struct orl_annual_coefficients *coefficients,
                      double batches[ORL_ANNUAL_BATCHES]);
/* The mean of the batches, and its standard error. */
void orl_overcast_find(const double batches[ORL_ANNUAL_BATCHES], float *ret_lx, float *ret_se);

#endif
