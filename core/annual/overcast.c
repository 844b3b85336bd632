#include "annual/overcast.h"

#include <oriel/units.h>

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

void orl_overcast_find(const struct orl_overcast *overcast,
                       const struct orl_annual_coefficients *coefficients, float *ret_lx,
                       float *ret_se)
{
    double batches[ORL_ANNUAL_BATCHES] = {0}, mean = 0, squares = 0;
    for (int b = 0; b < ORL_ANNUAL_BATCHES; b++) {
        const float *bins = coefficients->bins + (size_t)b * ORL_BINS;
        for (uint32_t bin = 0; bin < ORL_BINS; bin++)
            batches[b] += overcast->luminance[bin] * (double)bins[bin];
        batches[b] /= coefficients->samples;
        mean += batches[b] / ORL_ANNUAL_BATCHES;
    }
    for (int b = 0; b < ORL_ANNUAL_BATCHES; b++)
        squares += (batches[b] - mean) * (batches[b] - mean);
    *ret_lx = (float)mean;
    *ret_se = (float)sqrt(squares / (ORL_ANNUAL_BATCHES * (ORL_ANNUAL_BATCHES - 1.0)));
}
