#include "annual/product.h"

#include <string.h>

#include "base/vectors.h"

enum { TILE = ORL_HOURS_TILE, BATCHES = ORL_ANNUAL_BATCHES, LOTS = ORL_SUN_MAP_LOTS };

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

/* All batches of a column; sun: [node or beam][batch]. */
static ORL_FOR_WIDE_VECTORS void add_sun(const struct orl_sun_terms *terms, size_t column,
                                         const double *sun, double sums[BATCHES])
{
    for (uint32_t i = terms->first[column]; i < terms->first[column + 1]; i++) {
        const double weight = (double)terms->weights[i];
        const double *batches = sun + (size_t)terms->which[i] * BATCHES;
        for (int b = 0; b < BATCHES; b++)
            sums[b] += weight * batches[b];
    }
}

/* How far two ways of interpolation lie apart: of that, a share is the error of the better one, as
 * rooms with blinds have it. */
static double interpolation_error(const struct orl_sun_terms *terms, size_t column,
                                  const double *means)
{
    static const double share = 0.35;
    double sum = 0;
    for (uint32_t i = terms->first[column]; i < terms->first[column + 1]; i++)
        sum += (double)terms->apart[i] * means[terms->which[i]];
    return share * sum;
}

static void fill_lots(struct orl_annual_factors *f,
                      const struct orl_annual_coefficients *coefficients, double *lots)
{
    const size_t n = coefficients->n_beams;
    f->n_nodes = coefficients->n_sun - n;
    f->lots = lots;
    memset(lots, 0, n * LOTS * sizeof *lots);
    for (size_t b = 0; b < BATCHES; b++)
        for (size_t lot = 0; lot < LOTS; lot++)
            for (size_t i = 0; i < n; i++)
                lots[i * LOTS + lot] +=
                    (double)coefficients->lots[(b * LOTS + lot) * n + i] / BATCHES;
}

/* Square of the standard error that the map of the sun has by its photons. */
static double photon_squares(const struct orl_annual_factors *f, const struct orl_sun_terms *terms,
                             size_t column)
{
    double sums[LOTS] = {0}, mean = 0, squares = 0;
    for (uint32_t i = terms->first[column]; i < terms->first[column + 1]; i++) {
        if (terms->which[i] < f->n_nodes)
            continue;
        const double *lots = f->lots + (terms->which[i] - f->n_nodes) * LOTS;
        for (int lot = 0; lot < LOTS; lot++)
            sums[lot] += (double)terms->weights[i] * lots[lot];
    }
    for (int lot = 0; lot < LOTS; lot++)
        mean += sums[lot] / LOTS;
    for (int lot = 0; lot < LOTS; lot++)
        squares += (sums[lot] - mean) * (sums[lot] - mean) / (LOTS * (LOTS - 1.0));
    return squares;
}

void orl_annual_factors_fill(struct orl_annual_factors *f, const struct orl_bins *bins,
                             const struct orl_annual_coefficients *coefficients, double *sun,
                             double *lots)
{
    const size_t n = coefficients->n_sun;
    memset(f->coarse, 0, sizeof f->coarse);
    fill_lots(f, coefficients, lots);
    f->sun = sun;
    f->sun_means = sun + n * BATCHES;
    memset(f->sun_means, 0, n * sizeof *f->sun_means);
    for (size_t b = 0; b < BATCHES; b++)
        for (size_t i = 0; i < n; i++) {
            sun[i * BATCHES + b] = coefficients->sun[b * n + i];
            f->sun_means[i] += coefficients->sun[b * n + i] / BATCHES;
        }
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        double sum = 0;
        for (int b = 0; b < BATCHES; b++)
            sum += (double)coefficients->bins[(size_t)b * ORL_BINS + bin];
        const float mean = (float)(sum / BATCHES);
        f->bins[bin] = mean;
        for (int b = 0; sum > 0 && b < BATCHES; b++)
            f->coarse[b][bins->coarse_of[bin]] +=
                coefficients->bins[(size_t)b * ORL_BINS + bin] - mean;
    }
}

static void find_errors(const struct orl_annual_factors *f, const struct orl_hours *hours,
                        const struct orl_sun_terms *terms, size_t tile, uint32_t n,
                        double ret_squares[TILE], double ret_sun[TILE])
{
    const float *coarse = hours->coarse + tile * ORL_BINS_COARSE * TILE;
    double sun[TILE][BATCHES];
    memset(sun, 0, sizeof sun);
    memset(ret_sun, 0, TILE * sizeof *ret_sun);
    for (uint32_t j = 0; j < n; j++) {
        const size_t column = tile * TILE + j;
        const double lx = hours->suns[column].normal_lx;
        const double off = lx * interpolation_error(terms, column, f->sun_means);
        ret_squares[j] = off * off + lx * lx * photon_squares(f, terms, column);
        add_sun(terms, column, f->sun, sun[j]);
        for (int b = 0; b < BATCHES; b++) {
            sun[j][b] *= lx;
            ret_sun[j] += sun[j][b] / BATCHES;
        }
    }
    for (int b = 0; b < BATCHES; b++) {
        float sky[TILE] = {0};
        add_products(f->coarse[b], ORL_BINS_COARSE, coarse, sky);
        for (uint32_t j = 0; j < n; j++) {
            const double off = ORL_EFFICACY_LM_PER_W * (double)sky[j] + sun[j][b] - ret_sun[j];
            ret_squares[j] += off * off / (BATCHES * (BATCHES - 1.0));
        }
    }
}

void orl_annual_multiply(const struct orl_annual_factors *f, const struct orl_hours *hours,
                         const struct orl_sun_terms *terms, size_t tile,
                         const struct orl_annual_row *row)
{
    const size_t first = tile * TILE, left = hours->n_columns - first;
    const uint32_t n = left < TILE ? (uint32_t)left : TILE;
    double squares[TILE], sun[TILE];
    float sky[TILE] = {0};
    add_products(f->bins, ORL_BINS, hours->fine + tile * ORL_BINS * TILE, sky);
    find_errors(f, hours, terms, tile, n, squares, sun);
    for (uint32_t j = 0; j < n; j++) {
        const size_t c = first + j;
        row->total[c] = (float)(ORL_EFFICACY_LM_PER_W * (double)sky[j] + fmax(sun[j], 0) +
                                (double)row->straight[c] + (double)row->mirrored[c]);
        row->se[c] = (float)sqrt(squares[j] + (double)row->squares[c]);
    }
}
