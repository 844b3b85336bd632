#include "annual/product.h"

#include <string.h>

#include "base/vectors.h"

enum { TILE = ORL_HOURS_TILE, BATCHES = ORL_ANNUAL_BATCHES, LOTS = ORL_SUN_MAP_LOTS };

enum { TOGETHER = 4, LANES = 16 };

/* Some rows of coefficients at a time times some columns side by side: what is read of the sky
 * serves all of them. Bins are added in their order: the same bits whatever the vectors. */
static ORL_FOR_WIDE_VECTORS void add_products(const float *const coefficients[TOGETHER], uint32_t n,
                                              const float *tile, float *const ret_sums[TOGETHER])
{
    for (int at = 0; at < TILE; at += LANES) {
        float a[LANES] = {0}, b[LANES] = {0}, c[LANES] = {0}, d[LANES] = {0};
        for (uint32_t bin = 0; bin < n; bin++) {
            const float *sky = tile + (size_t)bin * TILE + at;
            const float pa = coefficients[0][bin], pb = coefficients[1][bin];
            const float pc = coefficients[2][bin], pd = coefficients[3][bin];
            if (pa == 0 && pb == 0 && pc == 0 && pd == 0)
                continue;
            for (int j = 0; j < LANES; j++) {
                a[j] += pa * sky[j];
                b[j] += pb * sky[j];
                c[j] += pc * sky[j];
                d[j] += pd * sky[j];
            }
        }
        memcpy(ret_sums[0] + at, a, sizeof a);
        memcpy(ret_sums[1] + at, b, sizeof b);
        memcpy(ret_sums[2] + at, c, sizeof c);
        memcpy(ret_sums[3] + at, d, sizeof d);
    }
}

/* All batches of a sun; sun: [node or beam][batch]. */
static ORL_FOR_WIDE_VECTORS void add_sun(const struct orl_sun_terms *terms, size_t which,
                                         const double *sun, double sums[BATCHES])
{
    for (uint32_t i = terms->first[which]; i < terms->first[which + 1]; i++) {
        const double weight = (double)terms->weights[i];
        const double *batches = sun + (size_t)terms->which[i] * BATCHES;
        for (int b = 0; b < BATCHES; b++)
            sums[b] += weight * batches[b];
    }
}

/* How far two ways of interpolation lie apart: of that, a share is the error of the better one, as
 * rooms with blinds have it. */
static double interpolation_error(const struct orl_sun_terms *terms, size_t which,
                                  const double *means)
{
    static const double share = 0.35;
    double sum = 0;
    for (uint32_t i = terms->first[which]; i < terms->first[which + 1]; i++)
        sum += (double)terms->apart[i] * means[terms->which[i]];
    return share * sum;
}

static void fill_lots(struct orl_annual_factors *f,
                      const struct orl_annual_coefficients *coefficients, double *lots)
{
    const size_t n = coefficients->n_beams;
    const double share = 1.0 / coefficients->samples;
    f->n_nodes = coefficients->n_sun - n;
    f->has_beams = n > 0;
    f->lots = lots;
    memset(lots, 0, n * LOTS * sizeof *lots);
    for (size_t b = 0; b < BATCHES; b++)
        for (size_t lot = 0; lot < LOTS; lot++)
            for (size_t i = 0; i < n; i++)
                lots[i * LOTS + lot] +=
                    (double)coefficients->lots[(b * LOTS + lot) * n + i] * share / BATCHES;
}

/* Square of the standard error that the map of the sun has by its photons. */
static double photon_squares(const struct orl_annual_factors *f, const struct orl_sun_terms *terms,
                             size_t which)
{
    double sums[LOTS] = {0}, mean = 0, squares = 0;
    if (!f->has_beams)
        return 0;
    for (uint32_t i = terms->first[which]; i < terms->first[which + 1]; i++) {
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
    const double share = 1.0 / coefficients->samples;
    memset(f->coarse, 0, sizeof f->coarse);
    fill_lots(f, coefficients, lots);
    f->sun = sun;
    f->sun_means = sun + n * BATCHES;
    memset(f->sun_means, 0, n * sizeof *f->sun_means);
    for (size_t b = 0; b < BATCHES; b++)
        for (size_t i = 0; i < n; i++) {
            sun[i * BATCHES + b] = coefficients->sun[b * n + i] * share;
            f->sun_means[i] += sun[i * BATCHES + b] / BATCHES;
        }
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        double sum = 0;
        for (int b = 0; b < BATCHES; b++)
            sum += (double)coefficients->bins[(size_t)b * ORL_BINS + bin];
        const float mean = (float)(sum * share / BATCHES);
        f->bins[bin] = mean;
        for (int b = 0; sum > 0 && b < BATCHES; b++)
            f->coarse[b][bins->coarse_of[bin]] +=
                coefficients->bins[(size_t)b * ORL_BINS + bin] * (float)share - mean;
    }
}

_Static_assert(ORL_ANNUAL_PATCHES == ORL_BINS_ABOVE + 1, "the ground, and the sky's bins");

/* What is below the horizon is one patch. */
void orl_annual_factors_tell(const struct orl_annual_factors *f, float *ret_coefficients)
{
    double ground = 0;
    for (uint32_t bin = ORL_BINS_ABOVE; bin < ORL_BINS; bin++)
        ground += (double)f->bins[bin];
    ret_coefficients[0] = (float)ground;
    memcpy(ret_coefficients + 1, f->bins, ORL_BINS_ABOVE * sizeof *ret_coefficients);
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
        const struct orl_column_sun *of = &hours->sun_of_column[tile * TILE + j];
        const double lx = of->normal_lx;
        ret_squares[j] = 0;
        if (!(lx > 0))
            continue;
        const double off = lx * interpolation_error(terms, of->sun, f->sun_means);
        ret_squares[j] = off * off + lx * lx * photon_squares(f, terms, of->sun);
        add_sun(terms, of->sun, f->sun, sun[j]);
        for (int b = 0; b < BATCHES; b++) {
            sun[j][b] *= lx;
            ret_sun[j] += sun[j][b] / BATCHES;
        }
    }
    for (int b = 0; b < BATCHES; b += TOGETHER) {
        float sky[TOGETHER][TILE];
        const float *const batches[TOGETHER] = {f->coarse[b], f->coarse[b + 1], f->coarse[b + 2],
                                                f->coarse[b + 3]};
        float *const sums[TOGETHER] = {sky[0], sky[1], sky[2], sky[3]};
        add_products(batches, ORL_BINS_COARSE, coarse, sums);
        for (int k = 0; k < TOGETHER; k++)
            for (uint32_t j = 0; j < n; j++) {
                const double off =
                    ORL_EFFICACY_LM_PER_W * (double)sky[k][j] + sun[j][b + k] - ret_sun[j];
                ret_squares[j] += off * off / (BATCHES * (BATCHES - 1.0));
            }
    }
}

static void put_column(const struct orl_annual_row *row, size_t column,
                       const struct orl_column_sun *of, double indirect, double squares)
{
    const double lx = of->normal_lx;
    double direct = 0, mirrored = 0;
    if (lx > 0) {
        direct = lx * (double)row->by_sun[of->sun];
        mirrored = lx * (double)row->mirrored[of->sun];
        squares += lx * lx * (double)row->squares[of->sun];
    }
    row->direct[column] = (float)direct;
    row->total[column] = (float)(indirect + direct + mirrored);
    row->se[column] = (float)sqrt(squares);
}

static void put_columns(const struct orl_annual_factors *f, const struct orl_hours *hours,
                        const struct orl_sun_terms *terms, size_t tile, const float sky[TILE],
                        const struct orl_annual_row *row)
{
    const size_t first = tile * TILE, left = hours->n_columns - first;
    const uint32_t n = left < TILE ? (uint32_t)left : TILE;
    double squares[TILE], sun[TILE];
    find_errors(f, hours, terms, tile, n, squares, sun);
    for (uint32_t j = 0; j < n; j++)
        put_column(row, first + j, &hours->sun_of_column[first + j],
                   ORL_EFFICACY_LM_PER_W * (double)sky[j] + fmax(sun[j], 0), squares[j]);
}

void orl_annual_multiply(const struct orl_annual_factors *const *factors, size_t count,
                         const struct orl_hours *hours, const struct orl_sun_terms *terms,
                         size_t tile, const struct orl_annual_row *rows)
{
    const float *fine = hours->fine + tile * ORL_BINS * TILE;
    for (size_t i = 0; i < count; i += TOGETHER) {
        float sky[TOGETHER][TILE];
        const float *bins[TOGETHER];
        float *sums[TOGETHER];
        for (size_t k = 0; k < TOGETHER; k++) {
            bins[k] = factors[i + k < count ? i + k : i]->bins;
            sums[k] = sky[k];
        }
        add_products(bins, ORL_BINS, fine, sums);
        for (size_t k = 0; k < TOGETHER && i + k < count; k++)
            put_columns(factors[i + k], hours, terms, tile, sky[k], &rows[i + k]);
    }
}
