#include "annual/product.h"

#include <string.h>

#include "base/vectors.h"

enum { TILE = ORL_HOURS_TILE, BATCHES = ORL_ANNUAL_BATCHES };

/* Bins are added in their order, columns side by side: the same bits whatever the vectors. */
static ORL_FOR_WIDE_VECTORS void add_products(const float *coefficients, uint32_t n,
                                              const float *tile, float sums[TILE])
{
    for (uint32_t bin = 0; bin < n; bin++) {
        const float c = coefficients[bin];
        const float *sky = tile + (size_t)bin * TILE;
        if (c == 0)
            continue;
        for (int j = 0; j < TILE; j++)
            sums[j] += c * sky[j];
    }
}

static double of_sun(const struct orl_sun_terms *terms, size_t column, const double *sun)
{
    double sum = 0;
    for (uint32_t i = terms->first[column]; i < terms->first[column + 1]; i++)
        sum += (double)terms->weights[i] * sun[terms->which[i]];
    return sum;
}

/* What is the same for all tiles. */
struct factors {
    const struct orl_hours *hours;
    const struct orl_sun_terms *terms;
    const struct orl_annual_coefficients *coefficients;
    float bins[ORL_BINS];                   /* the mean of all batches */
    float coarse[BATCHES][ORL_BINS_COARSE]; /* of each, less the mean */
};

static void fill_factors(struct factors *f, const struct orl_bins *bins)
{
    memset(f->bins, 0, sizeof f->bins);
    memset(f->coarse, 0, sizeof f->coarse);
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        double sum = 0;
        for (int b = 0; b < BATCHES; b++)
            sum += (double)f->coefficients->bins[(size_t)b * ORL_BINS + bin];
        const float mean = (float)(sum / BATCHES);
        f->bins[bin] = mean;
        for (int b = 0; sum > 0 && b < BATCHES; b++)
            f->coarse[b][bins->coarse_of[bin]] +=
                f->coefficients->bins[(size_t)b * ORL_BINS + bin] - mean;
    }
}

static void find_errors(const struct factors *f, size_t tile, uint32_t n, double ret_squares[TILE],
                        double ret_sun[TILE])
{
    const float *coarse = f->hours->coarse + tile * ORL_BINS_COARSE * TILE;
    const size_t n_sun = f->coefficients->n_sun;
    double sun[BATCHES][TILE];
    memset(sun, 0, sizeof sun);
    memset(ret_squares, 0, TILE * sizeof *ret_squares);
    memset(ret_sun, 0, TILE * sizeof *ret_sun);
    for (uint32_t j = 0; j < n; j++) {
        const size_t column = tile * TILE + j;
        const double lx = f->hours->suns[column].normal_lx;
        for (int b = 0; b < BATCHES && lx > 0; b++) {
            sun[b][j] = lx * of_sun(f->terms, column, f->coefficients->sun + (size_t)b * n_sun);
            ret_sun[j] += sun[b][j] / BATCHES;
        }
    }
    for (int b = 0; b < BATCHES; b++) {
        float sky[TILE] = {0};
        add_products(f->coarse[b], ORL_BINS_COARSE, coarse, sky);
        for (uint32_t j = 0; j < n; j++) {
            const double off = ORL_EFFICACY_LM_PER_W * (double)sky[j] + sun[b][j] - ret_sun[j];
            ret_squares[j] += off * off / (BATCHES * (BATCHES - 1.0));
        }
    }
}

static void multiply_tile(const struct factors *f, size_t tile, const struct orl_annual_row *row)
{
    const size_t first = tile * TILE, left = f->hours->n_columns - first;
    const uint32_t n = left < TILE ? (uint32_t)left : TILE;
    double squares[TILE], sun[TILE];
    float sky[TILE] = {0};
    add_products(f->bins, ORL_BINS, f->hours->fine + tile * ORL_BINS * TILE, sky);
    find_errors(f, tile, n, squares, sun);
    for (uint32_t j = 0; j < n; j++) {
        const size_t c = first + j;
        row->total[c] = (float)(ORL_EFFICACY_LM_PER_W * (double)sky[j] + sun[j] +
                                (double)row->straight[c] + (double)row->mirrored[c]);
        row->se[c] = (float)sqrt(squares[j] + (double)row->squares[c]);
    }
}

void orl_annual_multiply(const struct orl_bins *bins, const struct orl_hours *hours,
                         const struct orl_sun_terms *terms,
                         const struct orl_annual_coefficients *coefficients,
                         const struct orl_annual_row *row)
{
    struct factors f = {.hours = hours, .terms = terms, .coefficients = coefficients};
    fill_factors(&f, bins);
    for (size_t tile = 0; tile < hours->n_tiles; tile++)
        multiply_tile(&f, tile, row);
}
