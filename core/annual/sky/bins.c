/* Bins of directions, and the skies of a tile of hours in them. */
#include "annual/sky/bins.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "annual/sky/hours.h"
#include "base/multiversion.h"

static const uint32_t tregenza[8] = {30, 30, 24, 24, 18, 12, 6, 1};
static const uint32_t tregenza_first[8] = {0, 30, 60, 84, 108, 126, 138, 144};

/* Altitude of the lower edge of a row, rad; rows count from the horizon up. */
static double edge(int row)
{
    return 0.5 * ORL_PI * row / (7 * ORL_BINS_FINE + 0.5);
}

static void init_rows(struct orl_bins *bins)
{
    uint32_t first = 0;
    for (int i = 0; i < ORL_BINS_ROWS; i++) {
        struct orl_bin_row *row = &bins->rows[i];
        const int below = i - ORL_BINS_ABOVE_ROWS;
        row->first = first;
        if (below < 0) {
            const uint32_t zenith = i == ORL_BINS_ABOVE_ROWS - 1;
            row->columns = zenith ? 1 : ORL_BINS_FINE * tregenza[i / ORL_BINS_FINE];
            row->low = sin(edge(i));
            row->high = zenith ? 1 : sin(edge(i + 1));
        } else {
            const bool rest = below == ORL_BINS_BELOW_ROWS;
            row->columns = rest ? 1 : ORL_BINS_BELOW_COLUMNS;
            row->low = rest ? -1 : -sin(edge(below + 1));
            row->high = -sin(edge(below));
        }
        first += row->columns;
    }
}

static uint16_t coarse_of(int row, uint32_t column)
{
    const int below = row - ORL_BINS_ABOVE_ROWS;
    if (below >= 0)
        return (uint16_t)(145 + below);
    const int patch_row = row / ORL_BINS_FINE;
    return (uint16_t)(tregenza_first[patch_row] + column / ORL_BINS_FINE);
}

/* The middle of a bin is the direction with the row's mean sine of altitude. */
void orl_bins_init(struct orl_bins *bins)
{
    init_rows(bins);
    for (int i = 0; i < ORL_BINS_ROWS; i++) {
        const struct orl_bin_row *row = &bins->rows[i];
        const double sine =
            row->columns == 1 ? (row->low < 0 ? -1 : 1) : 0.5 * (row->low + row->high);
        const double level = sqrt(fmax(0, 1 - sine * sine));
        const double solid = 2 * ORL_PI * (row->high - row->low) / row->columns;
        for (uint32_t k = 0; k < row->columns; k++) {
            const uint32_t bin = row->first + k;
            const double turn = 2 * ORL_PI * k / row->columns;
            bins->at[bin] = orl_v3(level * sin(turn), level * cos(turn), sine);
            bins->solid_sr[bin] = solid;
            bins->level_sr[bin] = 0.5 * (row->low + row->high) * solid;
            bins->row_of[bin] = (uint16_t)i;
            bins->coarse_of[bin] = coarse_of(i, k);
        }
    }
}

static int row_of(const struct orl_bins *bins, double sine)
{
    const int from = sine < 0 ? ORL_BINS_ABOVE_ROWS : 0;
    const int to = sine < 0 ? ORL_BINS_ROWS - 1 : ORL_BINS_ABOVE_ROWS - 1;
    const double down = sine < 0 ? -1 : 1, height = fabs(sine);
    int low = from, high = to; /* bisection: the last row that begins at or below that height */
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        const struct orl_bin_row *row = &bins->rows[middle];
        const double begins = down > 0 ? row->low : -row->high;
        if (height >= begins)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

uint32_t orl_bins_find(const struct orl_bins *bins, struct orl_vec3 direction)
{
    const struct orl_bin_row *row = &bins->rows[row_of(bins, direction.z)];
    if (row->columns == 1)
        return row->first;
    const double turn = atan2(direction.x, direction.y) / (2 * ORL_PI);
    const uint32_t column = (uint32_t)((turn < 0 ? turn + 1 : turn) * row->columns + 0.5);
    return row->first + (column < row->columns ? column : 0);
}

enum { TILE = ORL_HOURS_TILE };

/* ---- Functions of a tile's columns ----------------------------------------------------------- */

/* Arc cosine (Abramowitz and Stegun 1964, 4.4.46). */
static inline float angle_of(float cosine)
{
    const float x = fabsf(cosine);
    float p = -0.0012624911f;
    p = p * x + 0.0066700901f;
    p = p * x - 0.0170881256f;
    p = p * x + 0.0308918810f;
    p = p * x - 0.0501743046f;
    p = p * x + 0.0889789874f;
    p = p * x - 0.2145988016f;
    p = p * x + 1.5707963050f;
    const float angle = sqrtf(1 - x) * p;
    return cosine < 0 ? 3.14159265f - angle : angle;
}

/* Exponentials of arguments clamped to -80..80: a power of two, set by its exponent bits, times a
 * short series. The loops are short so that compilers vectorise them. */
static inline void exps_of(const float at[TILE], float ret[TILE])
{
    int32_t bits[TILE];
    float scales[TILE], bound[TILE];
    for (int j = 0; j < TILE; j++)
        bound[j] = at[j] > 80 ? 80 : at[j];
    for (int j = 0; j < TILE; j++)
        bound[j] = bound[j] < -80 ? -80 : bound[j];
    for (int j = 0; j < TILE; j++) {
        const float turns = bound[j] * 1.44269504f;
        const int32_t whole = (int32_t)(turns + copysignf(0.5f, turns));
        const float f = (turns - (float)whole) * 0.693147181f;
        bits[j] = (int32_t)((uint32_t)(whole + 127) << 23);
        ret[j] = 1 + f * (1 + f * (0.5f + f * (0.166666667f +
                                               f * (0.0416666667f +
                                                    f * (0.00833333333f + f * 0.00138888889f)))));
    }
    memcpy(scales, bits, sizeof scales);
    for (int j = 0; j < TILE; j++)
        ret[j] *= scales[j];
}

/* ---- Rows ------------------------------------------------------------------------------------ */

/* Share of the sky where it blends with the ground. */
static double sky_share(double sine)
{
    const double w = pow(sine + 1.01, 20);
    return w / (w + 1);
}

void orl_horizon_blend_init(struct orl_horizon_blend *rows, const struct orl_bins *bins)
{
    rows->bins = bins;
    rows->per_ground = 0;
    for (int i = 0; i < ORL_BINS_ROWS; i++) {
        const struct orl_bin_row *row = &bins->rows[i];
        double sum = 0;
        for (int k = 0; k < ORL_SKY_ROW_HEIGHTS; k++) {
            const double at = row->low + (row->high - row->low) * (k + 0.5) / ORL_SKY_ROW_HEIGHTS;
            rows->sines[i][k] = at;
            rows->weights[i][k] = sky_share(at);
            sum += 1 - rows->weights[i][k];
        }
        rows->ground[i] = (float)(sum / ORL_SKY_ROW_HEIGHTS);
        if (i < ORL_BINS_ABOVE_ROWS)
            rows->per_ground +=
                rows->ground[i] * bins->level_sr[row->first] * bins->rows[i].columns;
    }
}

/* Coefficients of the columns' Perez patterns, each coefficient's columns side by side. */
struct patterns {
    float gradation[2][TILE], indicatrix[3][TILE], sun[3][TILE];
};

static void load_patterns(struct patterns *p, const struct orl_daylight *const *skies, uint32_t n)
{
    memset(p, 0, sizeof *p);
    for (uint32_t j = 0; j < n; j++) {
        const double *a = skies[j]->pattern.a;
        for (int i = 0; i < 2; i++)
            p->gradation[i][j] = (float)a[2 + i];
        for (int i = 0; i < 3; i++) {
            p->indicatrix[i][j] = (float)a[4 + i];
            p->sun[i][j] = (float)a[7 + i];
        }
    }
}

/* Computes the mean over a row of the gradation times the sky's share. */
static ORL_FOR_WIDE_VECTORS void grade_row(const struct orl_horizon_blend *rows, int row,
                                           const struct patterns *p, float ret[TILE])
{
    float at[TILE], exps[TILE];
    for (int j = 0; j < TILE; j++)
        ret[j] = 0;
    for (int k = 0; k < ORL_SKY_ROW_HEIGHTS; k++) {
        const double sine = rows->sines[row][k];
        const float per = (float)(1 / (sine > 0.01 ? sine : 0.01));
        const float weight = (float)(rows->weights[row][k] / ORL_SKY_ROW_HEIGHTS);
        for (int j = 0; j < TILE; j++)
            at[j] = p->gradation[1][j] * per;
        exps_of(at, exps);
        for (int j = 0; j < TILE; j++)
            ret[j] += weight * (1 + p->gradation[0][j] * exps[j]);
    }
}

/* Computes the pattern in a bin: the indicatrix times the gradation of its row. */
static ORL_FOR_WIDE_VECTORS void compute_bin(struct orl_vec3 towards, const struct patterns *p,
                                             const float graded[TILE], float ret[TILE])
{
    const float x = (float)towards.x, y = (float)towards.y, z = (float)towards.z;
    float cosines[TILE], at[TILE], exps[TILE];
    for (int j = 0; j < TILE; j++) {
        float c = x * p->sun[0][j] + y * p->sun[1][j] + z * p->sun[2][j];
        c = c > 1 ? 1 : c < -1 ? -1 : c;
        cosines[j] = c;
        at[j] = p->indicatrix[1][j] * angle_of(c);
    }
    exps_of(at, exps);
    for (int j = 0; j < TILE; j++)
        ret[j] = graded[j] * (1 + p->indicatrix[0][j] * exps[j] +
                              p->indicatrix[2][j] * cosines[j] * cosines[j]);
}

static ORL_FOR_WIDE_VECTORS void blend_bin(float ground_share, const float sky[TILE],
                                           const float ground[TILE], float ret[TILE])
{
    for (int j = 0; j < TILE; j++) {
        const float value = ret[j] * sky[j] + ground_share * ground[j];
        ret[j] = value > 0 ? value : 0;
    }
}

static ORL_FOR_WIDE_VECTORS void add_scaled(const float from[TILE], double by, double sum[TILE])
{
    for (int j = 0; j < TILE; j++)
        sum[j] += from[j] * by;
}

static void make_coarse(const struct orl_bins *bins, const float *fine, float *ret_coarse)
{
    double solid[ORL_BINS_COARSE] = {0};
    for (uint32_t bin = 0; bin < ORL_BINS; bin++)
        solid[bins->coarse_of[bin]] += bins->solid_sr[bin];
    memset(ret_coarse, 0, (size_t)ORL_BINS_COARSE * TILE * sizeof *ret_coarse);
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        float *to = ret_coarse + (size_t)bins->coarse_of[bin] * TILE;
        const float share = (float)(bins->solid_sr[bin] / solid[bins->coarse_of[bin]]);
        for (int j = 0; j < TILE; j++)
            to[j] += share * fine[(size_t)bin * TILE + (size_t)j];
    }
}

void orl_sky_tile_compute(const struct orl_horizon_blend *rows,
                          const struct orl_daylight *const *skies, const double *diffuse_w,
                          uint32_t n, double reflectance, float *ret_fine, float *ret_coarse)
{
    const struct orl_bins *bins = rows->bins;
    struct patterns patterns;
    float graded[TILE], sky[TILE] = {0}, ground[TILE] = {0};
    double per_sky[TILE] = {0};
    load_patterns(&patterns, skies, n);
    for (uint32_t bin = 0; bin < ORL_BINS; bin++) {
        const int row = bins->row_of[bin];
        float *to = ret_fine + (size_t)bin * TILE;
        if (bin == bins->rows[row].first)
            grade_row(rows, row, &patterns, graded);
        compute_bin(bins->at[bin], &patterns, graded, to);
        if (bin < ORL_BINS_ABOVE)
            add_scaled(to, bins->level_sr[bin], per_sky);
    }
    for (uint32_t j = 0; j < n; j++) {
        const struct orl_sky_balance balance = orl_daylight_balance(
            skies[j], diffuse_w[j], reflectance, fmax(per_sky[j], 1e-30), rows->per_ground);
        sky[j] = (float)fmax(balance.sky, 0);
        ground[j] = (float)balance.ground;
    }
    for (uint32_t bin = 0; bin < ORL_BINS; bin++)
        blend_bin(rows->ground[bins->row_of[bin]], sky, ground, ret_fine + (size_t)bin * TILE);
    make_coarse(bins, ret_fine, ret_coarse);
}
