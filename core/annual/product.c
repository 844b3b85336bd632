#include "annual/product.h"

#include <string.h>

#include "base/vectors.h"

enum { TILE = ORL_HOURS_TILE, BATCHES = ORL_ANNUAL_BATCHES, LOTS = ORL_SUN_MAP_LOTS };

enum { TOGETHER = 4, LANES = 16 };

/* Some rows of coefficients at a time times some columns side by side: what is read of the sky
 * serves all of them. Bins are added in their order: the same bits whatever the vectors. lanes: a
 * bit for each LANES columns that are wanted; the others become 0. */
static ORL_FOR_WIDE_VECTORS void add_products(const float *const coefficients[TOGETHER], uint32_t n,
                                              const float *tile, uint32_t lanes,
                                              float *const ret_sums[TOGETHER])
{
    for (int at = 0; at < TILE; at += LANES) {
        float a[LANES] = {0}, b[LANES] = {0}, c[LANES] = {0}, d[LANES] = {0};
        for (uint32_t bin = 0; bin < n && (lanes >> (at / LANES) & 1); bin++) {
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

/* Adds a sun's terms in a range, of all batches. of_batches: [node or beam][batch]. */
static ORL_FOR_WIDE_VECTORS void add_sun(const struct orl_sun_terms *terms,
                                         struct orl_sun_range range, const double *of_batches,
                                         double sums[BATCHES])
{
    for (uint32_t i = range.first; i < range.end; i++) {
        const double weight = (double)terms->weights[i];
        const double *batches = of_batches + (size_t)terms->which[i] * BATCHES;
        for (int b = 0; b < BATCHES; b++)
            sums[b] += weight * batches[b];
    }
}

/* How far two ways of interpolation lie apart. */
static double distance_apart(const struct orl_sun_terms *terms, struct orl_sun_range range,
                             const double *means)
{
    double sum = 0;
    for (uint32_t i = range.first; i < range.end; i++)
        sum += (double)terms->apart[i] * means[terms->which[i]];
    return sum;
}

/* Square of the standard error that the map of the sun has by its photons. */
static double photon_squares(const struct orl_sun_terms *terms, struct orl_sun_range range,
                             const double *of_lots)
{
    double sums[LOTS] = {0}, mean = 0, squares = 0;
    for (uint32_t i = range.first; i < range.end; i++) {
        const double *lots = of_lots + (size_t)terms->which[i] * LOTS;
        for (int lot = 0; lot < LOTS; lot++)
            sums[lot] += (double)terms->weights[i] * lots[lot];
    }
    for (int lot = 0; lot < LOTS; lot++)
        mean += sums[lot] / LOTS;
    for (int lot = 0; lot < LOTS; lot++)
        squares += (sums[lot] - mean) * (sums[lot] - mean) / (LOTS * (LOTS - 1.0));
    return squares;
}

/* ---- Factors --------------------------------------------------------------------------------- */

/* Fills a node or beam of all batches; returns their mean. */
static double fill_sun(const double *const batches[BATCHES], size_t which, double share,
                       double ret[BATCHES])
{
    double mean = 0;
    for (size_t b = 0; b < BATCHES; b++) {
        ret[b] = batches[b] ? batches[b][which] * share : 0;
        mean += ret[b] / BATCHES;
    }
    return mean;
}

void orl_annual_beams_fill(struct orl_annual_beams *beams,
                           const struct orl_annual_beam_coefficients *coefficients, double *sums,
                           double *lots)
{
    const size_t n = coefficients->n_beams;
    const double share = 1.0 / coefficients->samples;
    *beams = (struct orl_annual_beams){sums, sums + n * BATCHES, lots};
    for (size_t k = 0; k < coefficients->n_which; k++) {
        const size_t i = coefficients->which[k];
        beams->means[i] = fill_sun(coefficients->beams, i, share, sums + i * BATCHES);
        for (size_t lot = 0; lot < LOTS; lot++) {
            double sum = 0;
            for (size_t b = 0; b < BATCHES; b++)
                sum += (double)coefficients->lots[b][lot * n + i];
            lots[i * LOTS + lot] = sum * share / BATCHES;
        }
    }
}

void orl_annual_factors_fill(struct orl_annual_factors *f, const struct orl_bins *bins,
                             const struct orl_annual_coefficients *coefficients, double *nodes)
{
    const double share = 1.0 / coefficients->samples;
    memset(f->coarse, 0, sizeof f->coarse);
    f->nodes = nodes;
    f->node_means = nodes + coefficients->n_nodes * BATCHES;
    for (size_t i = 0; i < coefficients->n_nodes; i++)
        f->node_means[i] = fill_sun(coefficients->nodes, i, share, nodes + i * BATCHES);
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        double sum = 0;
        for (int b = 0; b < BATCHES; b++)
            sum += coefficients->bins[b] ? (double)coefficients->bins[b][bin] : 0;
        const float mean = (float)(sum * share / BATCHES);
        f->bins[bin] = mean;
        for (int b = 0; sum > 0 && b < BATCHES; b++)
            f->coarse[b][bins->coarse_of[bin]] +=
                (coefficients->bins[b] ? coefficients->bins[b][bin] : 0) * (float)share - mean;
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

/* ---- A tile of a sensor ---------------------------------------------------------------------- */

/* A sensor's light in each column of a tile, summed over the parts. */
struct tile_sums {
    const struct orl_annual_row *row; /* NULL: of no sensor */
    float sky[TILE];
    float off[BATCHES][TILE];  /* of the sky, of each batch: less the mean */
    double sun[TILE][BATCHES]; /* indirect, lx */
    double straight[TILE];     /* by the sun, and by mirrors, lx */
    double squares[TILE];      /* of the standard error, but for what batches differ by */
};

struct tile {
    const struct orl_hours *hours;
    const struct orl_sun_terms *terms;
    size_t index;
    uint32_t n; /* columns */
};

static bool is_wanted(const struct orl_annual_share *light, size_t column)
{
    return !light->wanted || light->wanted[column];
}

static const struct orl_column_sun *sun_of(const struct tile *tile, uint32_t j)
{
    return &tile->hours->sun_of_column[tile->index * TILE + j];
}

static void add_indirect_sun(const struct tile *tile, const struct orl_annual_share *light,
                             uint32_t j, struct tile_sums *sums)
{
    /* The error of the better interpolation is this share of the distance between the two. It was
     * measured in rooms with blinds. */
    static const double share = 0.35;
    const struct orl_column_sun *of = sun_of(tile, j);
    const struct orl_sun_terms *terms = tile->terms;
    const struct orl_sun_range nodes = orl_sun_terms_nodes(terms, of->sun);
    const struct orl_sun_range beams = orl_sun_terms_beams(terms, of->sun, light->part);
    double batches[BATCHES] = {0};
    const double apart = distance_apart(terms, nodes, light->factors->node_means) +
                         distance_apart(terms, beams, light->beams->means);
    const double off = of->normal_lx * share * apart;
    sums->squares[j] += off * off + of->normal_lx * of->normal_lx *
                                        photon_squares(terms, beams, light->beams->lots);
    add_sun(terms, nodes, light->factors->nodes, batches);
    add_sun(terms, beams, light->beams->sums, batches);
    for (int b = 0; b < BATCHES; b++)
        sums->sun[j][b] += batches[b] * of->normal_lx;
}

/* sky, lanes: of the light. */
static void add_indirect(const struct tile *tile, const struct orl_annual_share *light,
                         const float sky[TILE], uint32_t lanes, struct tile_sums *sums)
{
    const float *coarse = tile->hours->coarse + tile->index * ORL_BINS_COARSE * TILE;
    for (int b = 0; b < BATCHES; b += TOGETHER) {
        float off[TOGETHER][TILE];
        const float *batches[TOGETHER];
        float *to[TOGETHER];
        for (int k = 0; k < TOGETHER; k++) {
            batches[k] = light->factors->coarse[b + k];
            to[k] = off[k];
        }
        add_products(batches, ORL_BINS_COARSE, coarse, lanes, to);
        for (int k = 0; k < TOGETHER; k++)
            for (uint32_t j = 0; j < tile->n; j++)
                if (is_wanted(light, tile->index * TILE + j))
                    sums->off[b + k][j] += off[k][j];
    }
    for (uint32_t j = 0; j < tile->n; j++) {
        if (!is_wanted(light, tile->index * TILE + j))
            continue;
        sums->sky[j] += sky[j];
        if (sun_of(tile, j)->normal_lx > 0)
            add_indirect_sun(tile, light, j, sums);
    }
}

static void add_straight(const struct tile *tile, const struct orl_annual_share *light,
                         struct tile_sums *sums)
{
    for (uint32_t j = 0; j < tile->n && light->by_sun; j++) {
        const struct orl_column_sun *of = sun_of(tile, j);
        const double lx = of->normal_lx;
        if (!(lx > 0) || !is_wanted(light, tile->index * TILE + j))
            continue;
        sums->straight[j] +=
            lx * ((double)light->by_sun[of->sun] + (double)light->mirrored[of->sun]);
        sums->squares[j] += lx * lx * (double)light->squares[of->sun];
    }
}

static void put_direct(const struct tile *tile, const struct orl_annual_share *light)
{
    for (uint32_t j = 0; j < tile->n && light->by_sun; j++) {
        const struct orl_column_sun *of = sun_of(tile, j);
        if (of->normal_lx > 0)
            light->row->direct[tile->index * TILE + j] +=
                (float)(of->normal_lx * (double)light->by_sun[of->sun]);
    }
}

static void put_columns(const struct tile *tile, const struct tile_sums *sums)
{
    for (uint32_t j = 0; j < tile->n && sums->row; j++) {
        const size_t column = tile->index * TILE + j;
        double sun = 0, squares = sums->squares[j];
        for (int b = 0; b < BATCHES; b++)
            sun += sums->sun[j][b] / BATCHES;
        for (int b = 0; b < BATCHES; b++) {
            const double off =
                ORL_EFFICACY_LM_PER_W * (double)sums->off[b][j] + sums->sun[j][b] - sun;
            squares += off * off / (BATCHES * (BATCHES - 1.0));
        }
        sums->row->total[column] = (float)(ORL_EFFICACY_LM_PER_W * (double)sums->sky[j] +
                                           fmax(sun, 0) + sums->straight[j]);
        sums->row->se[column] = (float)sqrt(squares);
    }
}

/* ---- All sensors of a tile ------------------------------------------------------------------- */

/* Returns a bit for each LANES columns in some of which the light is wanted. */
static uint32_t lanes_of(const struct tile *tile, const struct orl_annual_share *light)
{
    uint32_t lanes = 0;
    for (uint32_t j = 0; j < tile->n; j++)
        lanes |= (uint32_t)is_wanted(light, tile->index * TILE + j) << (j / LANES);
    return lanes;
}

/* Multiplies up to TOGETHER lights by the sky. Lights without factors give 0. */
static void multiply_skies(const struct tile *tile, const struct orl_annual_share *const *lights,
                           const uint32_t *lanes, size_t count, float sky[TOGETHER][TILE])
{
    static const float none[ORL_BINS];
    const float *bins[TOGETHER];
    float *to[TOGETHER];
    uint32_t any = 0;
    for (size_t k = 0; k < TOGETHER; k++) {
        any |= k < count ? lanes[k] : 0;
        bins[k] = k < count && lights[k]->factors ? lights[k]->factors->bins : none;
        to[k] = sky[k];
    }
    add_products(bins, ORL_BINS, tile->hours->fine + tile->index * ORL_BINS * TILE, any, to);
}

void orl_annual_multiply(const struct orl_annual_share *lights, size_t count,
                         const struct orl_hours *hours, const struct orl_sun_terms *terms,
                         size_t tile)
{
    const size_t left = hours->n_columns - tile * TILE;
    const struct tile here = {hours, terms, tile, left < TILE ? (uint32_t)left : TILE};
    const struct orl_annual_share *list[ORL_ANNUAL_MOST_SHARES];
    uint32_t lanes[ORL_ANNUAL_MOST_SHARES];
    struct tile_sums sums = {.row = NULL};
    size_t n = 0;
    for (size_t i = 0; i < count; i++) {
        put_direct(&here, &lights[i]);
        lanes[n] = lanes_of(&here, &lights[i]);
        list[n] = &lights[i];
        n += lanes[n] != 0;
    }
    for (size_t i = 0; i < n; i += TOGETHER) {
        float sky[TOGETHER][TILE];
        multiply_skies(&here, list + i, lanes + i, n - i, sky);
        for (size_t k = 0; k < TOGETHER && i + k < n; k++) {
            const struct orl_annual_share *light = list[i + k];
            if (light->row != sums.row) {
                put_columns(&here, &sums);
                memset(&sums, 0, sizeof sums);
                sums.row = light->row;
            }
            if (light->factors)
                add_indirect(&here, light, sky[k], lanes[i + k], &sums);
            add_straight(&here, light, &sums);
        }
    }
    put_columns(&here, &sums);
}
