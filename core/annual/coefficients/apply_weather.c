/*
 * Coefficients of a sensor times the skies and suns of all hours, and times the CIE overcast
 * sky.
 */
#include "annual/coefficients/apply_weather.h"

#include <string.h>

#include <oriel/base/vec.h>

#include "base/multiversion.h"

enum {
    TILE = ORL_HOURS_TILE,
    BATCHES = ORL_ANNUAL_BATCHES,
    PHOTON_BATCHES = ORL_SUN_PHOTON_BATCHES
};

enum { TOGETHER = 4, LANES = 16 };

/* Adds the bins in order, so that the result does not depend on the vector width. tile:
 * [ORL_BINS][TILE]. */
static ORL_FOR_WIDE_VECTORS void multiply_sky(const struct orl_sparse_coefficients *f,
                                              const float *tile, float ret_sky[TILE])
{
    float sums[TILE] = {0};
    for (uint32_t i = 0; i < f->n_bins; i++) {
        const float *sky = tile + (size_t)f->which[i] * TILE;
        for (int j = 0; j < TILE; j++)
            sums[j] += f->bins[i] * sky[j];
    }
    memcpy(ret_sky, sums, sizeof sums);
}

/* Multiplies the differences of TOGETHER batches by the coarse sky. lanes has a bit for each group
 * of LANES columns; columns whose bit is 0 are not set. */
static ORL_FOR_WIDE_VECTORS void multiply_coarse(const struct orl_sparse_coefficients *f, int batch,
                                                 const float *tile, uint32_t lanes,
                                                 float ret_off[TOGETHER][TILE])
{
    for (int at = 0; at < TILE; at += LANES) {
        float sums[TOGETHER][LANES] = {{0}};
        if (!(lanes >> (at / LANES) & 1))
            continue;
        for (uint32_t i = 0; i < f->n_coarse; i++) {
            const float *sky = tile + (size_t)f->which_coarse[i] * TILE + at;
            for (int k = 0; k < TOGETHER; k++)
                for (int j = 0; j < LANES; j++)
                    sums[k][j] += f->coarse[i][batch + k] * sky[j];
        }
        for (int k = 0; k < TOGETHER; k++)
            memcpy(ret_off[k] + at, sums[k], sizeof sums[k]);
    }
}

/* Adds a sun's weights in a range to the sums of all batches. of_batches: [node or beam][batch].
 * means: mean of the batches; 0 if all are 0. Returns the difference between two interpolations. */
static ORL_FOR_WIDE_VECTORS double add_sun(const struct orl_sun_weights *sun_weights,
                                           struct orl_sun_weight_range range,
                                           const double *of_batches, const double *means,
                                           double sums[BATCHES])
{
    double difference = 0;
    for (uint32_t i = range.first; i < range.end; i++) {
        const double mean = means[sun_weights->which[i]];
        const double weight = (double)sun_weights->weights[i];
        const double *batches = of_batches + (size_t)sun_weights->which[i] * BATCHES;
        if (mean == 0)
            continue;
        difference += (double)sun_weights->difference[i] * mean;
        for (int b = 0; b < BATCHES; b++)
            sums[b] += weight * batches[b];
    }
    return difference;
}

/* Computes the deviations of photon batches of the sun map from their mean. Returns the squared
 * standard error of the mean. */
static ORL_FOR_WIDE_VECTORS double photon_squares(const struct orl_sun_weights *sun_weights,
                                                  struct orl_sun_weight_range range,
                                                  const double *means, const double *of_lots,
                                                  double ret_off[PHOTON_BATCHES])
{
    double sums[PHOTON_BATCHES] = {0}, mean = 0, squares = 0;
    for (uint32_t i = range.first; i < range.end; i++) {
        const double *photon_batches = of_lots + (size_t)sun_weights->which[i] * PHOTON_BATCHES;
        if (means[sun_weights->which[i]] == 0)
            continue;
        for (int photon_batch = 0; photon_batch < PHOTON_BATCHES; photon_batch++)
            sums[photon_batch] += (double)sun_weights->weights[i] * photon_batches[photon_batch];
    }
    for (int photon_batch = 0; photon_batch < PHOTON_BATCHES; photon_batch++)
        mean += sums[photon_batch] / PHOTON_BATCHES;
    for (int photon_batch = 0; photon_batch < PHOTON_BATCHES; photon_batch++) {
        ret_off[photon_batch] = sums[photon_batch] - mean;
        squares += ret_off[photon_batch] * ret_off[photon_batch] /
                   (PHOTON_BATCHES * (PHOTON_BATCHES - 1.0));
    }
    return squares;
}

/* ---- Coefficients
 * --------------------------------------------------------------------------------- */

/* Fills a node or beam for all batches; returns their mean. */
static double fill_batches(const double *const batches[BATCHES], size_t which, double share,
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
                           double *photon_batches)
{
    const size_t n = coefficients->n_beams;
    const double share = 1.0 / coefficients->samples;
    *beams = (struct orl_annual_beams){sums, sums + n * BATCHES, photon_batches};
    for (size_t k = 0; k < coefficients->n_which; k++) {
        const size_t i = coefficients->which[k];
        beams->means[i] = fill_batches(coefficients->beams, i, share, sums + i * BATCHES);
        for (size_t photon_batch = 0; photon_batch < PHOTON_BATCHES; photon_batch++) {
            double sum = 0;
            for (size_t b = 0; b < BATCHES; b++)
                sum += (double)coefficients->photon_batches[b][i * PHOTON_BATCHES + photon_batch];
            photon_batches[i * PHOTON_BATCHES + photon_batch] = sum * share / BATCHES;
        }
    }
}

/* Fills the mean of all batches, for bins that have light. */
static void fill_bins(struct orl_sparse_coefficients *f,
                      const struct orl_annual_coefficients *coefficients)
{
    const double share = 1.0 / coefficients->samples;
    double sums[ORL_BINS] = {0};
    for (int b = 0; b < BATCHES; b++)
        for (uint32_t bin = 0; coefficients->bins[b] && bin < ORL_BINS; bin++)
            sums[bin] += (double)coefficients->bins[b][bin];
    f->n_bins = 0;
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        if (!(sums[bin] > 0))
            continue;
        f->which[f->n_bins] = (uint16_t)bin;
        f->bins[f->n_bins++] = (float)(sums[bin] * share / BATCHES);
    }
}

/* Fills the differences of the batches from their mean, for coarse bins that have light. */
static void fill_coarse(struct orl_sparse_coefficients *f, const struct orl_bins *bins,
                        const struct orl_annual_coefficients *coefficients)
{
    const float share = (float)(1.0 / coefficients->samples);
    bool lit[ORL_BINS_COARSE] = {false};
    uint16_t index[ORL_BINS_COARSE];
    f->n_coarse = 0;
    for (uint32_t i = 0; i < f->n_bins; i++)
        lit[bins->coarse_of[f->which[i]]] = true;
    for (uint32_t c = 0; c < ORL_BINS_COARSE; c++) {
        index[c] = f->n_coarse;
        f->which_coarse[f->n_coarse] = (uint16_t)c;
        f->n_coarse += lit[c];
    }
    memset(f->coarse, 0, f->n_coarse * sizeof f->coarse[0]);
    for (uint32_t i = 0; i < f->n_bins; i++) {
        const uint32_t bin = f->which[i];
        float *to = f->coarse[index[bins->coarse_of[bin]]];
        for (int b = 0; b < BATCHES; b++)
            to[b] += (coefficients->bins[b] ? coefficients->bins[b][bin] : 0) * share - f->bins[i];
    }
}

void orl_sparse_coefficients_fill(struct orl_sparse_coefficients *f, const struct orl_bins *bins,
                                  const struct orl_annual_coefficients *coefficients, double *nodes)
{
    const double share = 1.0 / coefficients->samples;
    f->nodes = nodes;
    f->node_means = nodes + coefficients->n_nodes * BATCHES;
    for (size_t i = 0; i < coefficients->n_nodes; i++)
        f->node_means[i] = fill_batches(coefficients->nodes, i, share, nodes + i * BATCHES);
    fill_bins(f, coefficients);
    fill_coarse(f, bins, coefficients);
}

_Static_assert(ORL_ANNUAL_PATCHES == ORL_BINS_ABOVE + 1, "the ground, and the sky's bins");

/* All bins below the horizon form one patch. */
void orl_sparse_coefficients_expand(const struct orl_sparse_coefficients *f,
                                    float *ret_coefficients)
{
    double ground = 0;
    memset(ret_coefficients, 0, ORL_ANNUAL_PATCHES * sizeof *ret_coefficients);
    for (uint32_t i = 0; i < f->n_bins; i++)
        if (f->which[i] < ORL_BINS_ABOVE)
            ret_coefficients[1 + f->which[i]] = f->bins[i];
        else
            ground += (double)f->bins[i];
    ret_coefficients[0] = (float)ground;
}

/* ---- A tile of a sensor ---------------------------------------------------------------------- */

/* A sensor's light in each column of a tile, summed over the window groups. */
struct tile_sums {
    float sky[TILE];
    float off[BATCHES][TILE];                    /* sky of each batch, less the mean */
    double sun[TILE][BATCHES];                   /* indirect, lx */
    double straight[TILE];                       /* sun, direct and by mirrors, lx */
    double photon_batches[TILE][PHOTON_BATCHES]; /* each photon batch, less the mean, lx */
    /* Terms of the squared standard error, lx2, by source: photons; interpolation; sampling of
     * panes and of the sun's disc. */
    double photons[TILE], interpolation_error[TILE], sampling[TILE];
};

struct tile {
    const struct orl_hours *hours;
    const struct orl_sun_weights *sun_weights;
    size_t index;
    uint32_t n; /* columns */
};

static bool is_wanted(const struct orl_window_group_light *light, size_t column)
{
    return !light->wanted || light->wanted[column];
}

static const struct orl_column_sun *sun_of(const struct tile *tile, uint32_t j)
{
    return &tile->hours->sun_of_column[tile->index * TILE + j];
}

static void add_indirect_sun(const struct tile *tile, const struct orl_window_group_light *light,
                             uint32_t j, struct tile_sums *sums)
{
    /* Estimated error of the better interpolation, as a share of the difference between the two.
     * Measured in rooms with blinds. */
    static const double share = 0.35;
    const struct orl_column_sun *of = sun_of(tile, j);
    const struct orl_sun_weights *sun_weights = tile->sun_weights;
    const struct orl_sun_weight_range nodes = orl_sun_weights_of_nodes(sun_weights, of->sun);
    const struct orl_sun_weight_range beams =
        orl_sun_weights_of_beams(sun_weights, of->sun, light->window_group);
    const struct orl_annual_beams *of_beams = light->beams;
    double batches[BATCHES] = {0}, photon_batches[PHOTON_BATCHES];
    const double difference =
        add_sun(sun_weights, nodes, light->sparse->nodes, light->sparse->node_means, batches) +
        add_sun(sun_weights, beams, of_beams->sums, of_beams->means, batches);
    const double off = of->normal_lx * share * difference;
    sums->interpolation_error[j] += off * off;
    sums->photons[j] += of->normal_lx * of->normal_lx *
                        photon_squares(sun_weights, beams, of_beams->means,
                                       of_beams->photon_batches, photon_batches);
    for (int photon_batch = 0; photon_batch < PHOTON_BATCHES; photon_batch++)
        sums->photon_batches[j][photon_batch] += photon_batches[photon_batch] * of->normal_lx;
    for (int b = 0; b < BATCHES; b++)
        sums->sun[j][b] += batches[b] * of->normal_lx;
}

/* lanes: as in multiply_coarse, for this light. */
static void add_indirect(const struct tile *tile, const struct orl_window_group_light *light,
                         uint32_t lanes, struct tile_sums *sums)
{
    float sky[TILE];
    multiply_sky(light->sparse, tile->hours->fine + tile->index * ORL_BINS * TILE, sky);
    for (int b = 0; b < BATCHES; b += TOGETHER) {
        float off[TOGETHER][TILE];
        multiply_coarse(light->sparse, b,
                        tile->hours->coarse + tile->index * ORL_BINS_COARSE * TILE, lanes, off);
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

static void add_straight(const struct tile *tile, const struct orl_window_group_light *light,
                         struct tile_sums *sums)
{
    for (uint32_t j = 0; j < tile->n && light->by_sun; j++) {
        const struct orl_column_sun *of = sun_of(tile, j);
        const double lx = of->normal_lx;
        if (!(lx > 0) || !is_wanted(light, tile->index * TILE + j))
            continue;
        sums->straight[j] +=
            lx * ((double)light->by_sun[of->sun] + (double)light->mirrored[of->sun]);
        sums->sampling[j] += lx * lx * (double)light->squares[of->sun];
    }
}

static void add_direct(const struct tile *tile, const struct orl_window_group_light *light,
                       const struct orl_annual_columns *row)
{
    for (uint32_t j = 0; j < tile->n && light->by_sun; j++) {
        const struct orl_column_sun *of = sun_of(tile, j);
        if (of->normal_lx > 0)
            row->direct[tile->index * TILE + j] +=
                (float)(of->normal_lx * (double)light->by_sun[of->sun]);
    }
}

/* Adds a column's errors relative to its light. If the error exceeds the light, they are relative
 * to the error, so that no value shifts by more than its size. off: deviations of batches, lx. */
static void add_errors(const struct tile *tile, const struct tile_sums *sums, uint32_t j,
                       const double off[BATCHES], const struct orl_annual_columns *row)
{
    const size_t column = tile->index * TILE + j;
    const double total = (double)row->total[column], se = (double)row->se[column];
    const double whole = fmax(total, se);
    if (!(total > 0) || !(sun_of(tile, j)->normal_lx > 0))
        return;
    struct orl_error_sums *band = &row->sums[orl_error_band(total)];
    band->errors += se / whole;
    band->squares += sums->sampling[j] / (whole * whole);
    for (int b = 0; b < BATCHES; b++)
        band->batches[b] += (float)(off[b] / whole);
    for (int photon_batch = 0; photon_batch < PHOTON_BATCHES; photon_batch++)
        band->photon_batches[photon_batch] +=
            (float)(sums->photon_batches[j][photon_batch] / whole);
    row->interpolation_error[column] = (float)(sqrt(sums->interpolation_error[j]) / whole);
}

static void write_columns(const struct tile *tile, const struct tile_sums *sums,
                          const struct orl_annual_columns *row)
{
    for (uint32_t j = 0; j < tile->n; j++) {
        const size_t column = tile->index * TILE + j;
        double sun = 0,
               squares = sums->photons[j] + sums->interpolation_error[j] + sums->sampling[j];
        double off[BATCHES];
        for (int b = 0; b < BATCHES; b++)
            sun += sums->sun[j][b] / BATCHES;
        for (int b = 0; b < BATCHES; b++) {
            off[b] = ORL_EFFICACY_LM_PER_W * (double)sums->off[b][j] + sums->sun[j][b] - sun;
            squares += off[b] * off[b] / (BATCHES * (BATCHES - 1.0));
        }
        row->total[column] = (float)(ORL_EFFICACY_LM_PER_W * (double)sums->sky[j] + fmax(sun, 0) +
                                     sums->straight[j]);
        row->se[column] = (float)sqrt(squares);
        add_errors(tile, sums, j, off, row);
    }
}

/* Returns a bit for each group of LANES columns; it is set if the light is wanted in one of
 * them. */
static uint32_t lanes_of(const struct tile *tile, const struct orl_window_group_light *light)
{
    uint32_t lanes = 0;
    for (uint32_t j = 0; j < tile->n; j++)
        lanes |= (uint32_t)is_wanted(light, tile->index * TILE + j) << (j / LANES);
    return lanes;
}

void orl_annual_apply_weather(const struct orl_annual_columns *row,
                              const struct orl_window_group_light *lights, size_t count,
                              const struct orl_hours *hours,
                              const struct orl_sun_weights *sun_weights, size_t tile)
{
    const size_t left = hours->n_columns - tile * TILE;
    const struct tile here = {hours, sun_weights, tile, left < TILE ? (uint32_t)left : TILE};
    struct tile_sums sums;
    memset(&sums, 0, sizeof sums);
    for (size_t i = 0; i < count; i++) {
        const uint32_t lanes = lanes_of(&here, &lights[i]);
        add_direct(&here, &lights[i], row);
        if (lanes != 0 && lights[i].sparse)
            add_indirect(&here, &lights[i], lanes, &sums);
        if (lanes != 0)
            add_straight(&here, &lights[i], &sums);
    }
    write_columns(&here, &sums, row);
}

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
