#include "annual/sky/overcast.h"

#include <oriel/base/units.h>

void orl_overcast_init(struct orl_overcast *overcast, const struct orl_bins *bins,
                       double ground_reflectance)
{
    double level = 0;
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        const struct orl_bin_row *row = &bins->rows[bins->row_of[bin]];
        overcast->luminance[bin] =
            bin < ORL_BINS_ABOVE ? 1 + row->low + row->high : ground_reflectance / ORL_PI;
        if (bin < ORL_BINS_ABOVE)
            level += overcast->luminance[bin] * bins->level_sr[bin];
    }
    for (uint32_t bin = 0; bin < ORL_BINS; bin++)
        overcast->luminance[bin] *=
            bin < ORL_BINS_ABOVE ? ORL_OVERCAST_LX / level : ORL_OVERCAST_LX;
}

void orl_overcast_add(const struct orl_overcast *overcast,
                      const struct orl_annual_coefficients *coefficients,
                      double batches[ORL_ANNUAL_BATCHES])
{
    for (int b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const float *bins = coefficients->bins[b];
        double sum = 0;
        for (uint32_t bin = 0; bins && bin < ORL_BINS; bin++)
            sum += overcast->luminance[bin] * (double)bins[bin];
        batches[b] += sum / coefficients->samples;
    }
}

void orl_overcast_illuminance(const double batches[ORL_ANNUAL_BATCHES], float *ret_lx,
                              float *ret_se)
{
    double mean = 0, squares = 0;
    for (int b = 0; b < ORL_ANNUAL_BATCHES; b++)
        mean += batches[b] / ORL_ANNUAL_BATCHES;
    for (int b = 0; b < ORL_ANNUAL_BATCHES; b++)
        squares += (batches[b] - mean) * (batches[b] - mean);
    *ret_lx = (float)mean;
    *ret_se = (float)sqrt(squares / (ORL_ANNUAL_BATCHES * (ORL_ANNUAL_BATCHES - 1.0)));
}
