#include "annual/sky/bins.h"

#include <math.h>
#include <stdbool.h>

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
