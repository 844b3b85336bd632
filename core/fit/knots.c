#include "fit/knots.h"

#include <oriel/bsdf_fit.h>
#include <oriel/crew.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "base/kth.h"
#include "fit/near.h"
#include "fit/square.h"

/* Radius of a knot's Gaussian in sides of its cell. Gaussians of neighbours then meet at 0.7 of
 * their height, and equal knots interpolate to a constant within a thousandth. */
static const double radius_of_side = 0.6;
static const float steep_share = 0.7F;
enum { STEEP_ROWS = 8, ALWAYS_SPLIT = 4, CORRECTIONS = 2, KNOTS_LEAST = 16 };

void orl_fit_knots_done(struct orl_fit_knots *knots)
{
    if (!knots)
        return;
    free(knots->knots);
    free(knots->near);
    free(knots->tree);
    free(knots->axes);
    memset(knots, 0, sizeof *knots);
}

/* ---- Rows in order --------------------------------------------------------------------------- */

static int compare_keys(const void *a, const void *b)
{
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static struct orl_vec3 place_of(const struct orl_fit_row *row)
{
    return orl_v3((double)row->x, (double)row->y, (double)row->z);
}

/* Sorts rows by the cells of the square. keys: cell, then original index. */
static bool sort_rows(struct orl_fit_scan *scan, uint64_t *keys)
{
    struct orl_fit_row *sorted = malloc(scan->n_rows * sizeof *sorted);
    if (!sorted)
        return false;
    for (size_t i = 0; i < scan->n_rows; i++)
        keys[i] = (uint64_t)orl_fit_code_of(place_of(&scan->rows[i])) << 32 | (uint64_t)i;
    qsort(keys, scan->n_rows, sizeof *keys, compare_keys);
    for (size_t i = 0; i < scan->n_rows; i++)
        sorted[i] = scan->rows[keys[i] & UINT32_MAX];
    free(scan->rows);
    scan->rows = sorted;
    scan->room = scan->n_rows;
    return true;
}

/* ---- Knots ----------------------------------------------------------------------------------- */

struct builder {
    const struct orl_fit_scan *scan;
    const uint64_t *keys;
    struct orl_fit_knots *knots;
    size_t room;
};

/* Returns the end of the codes below limit. */
static size_t end_of(const struct builder *b, size_t begin, size_t end, uint64_t limit)
{
    while (begin < end) {
        const size_t middle = begin + (end - begin) / 2;
        if (b->keys[middle] >> 32 < limit)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

static bool add_knot(struct builder *b, size_t begin, size_t end, unsigned level)
{
    struct orl_fit_knots *k = b->knots;
    struct orl_vec3 sum = {0};
    double value = 0;
    if (!orl_grow(&k->knots, &b->room, k->n, sizeof *k->knots))
        return false;
    for (size_t i = begin; i < end; i++) {
        sum = orl_add(sum, place_of(&b->scan->rows[i]));
        value += (double)b->scan->rows[i].value;
    }
    const struct orl_vec3 d = orl_normalize(sum);
    const double radius = radius_of_side * orl_fit_cell_rad(level);
    k->knots[k->n++] = (struct orl_fit_knot){.x = (float)d.x,
                                             .y = (float)d.y,
                                             .z = (float)d.z,
                                             .value = (float)(value / (double)(end - begin)),
                                             .narrowness = (float)(0.5 / (radius * radius)),
                                             .code = (uint32_t)(b->keys[begin] >> 32),
                                             .level = level,
                                             .first = (uint32_t)begin,
                                             .rows = (uint32_t)(end - begin)};
    return true;
}

/* Returns true if values of rows differ too much for their mean to represent them. */
static bool is_steep(const struct builder *b, size_t begin, size_t end)
{
    float least = INFINITY, most = -INFINITY;
    for (size_t i = begin; i < end; i++) {
        const float value = b->scan->rows[i].value;
        least = value < least ? value : least;
        most = value > most ? value : most;
    }
    return least < steep_share * most;
}

static bool split_cell(struct builder *b, size_t begin, size_t end, unsigned level, uint64_t code)
{
    const unsigned below = 2 * (ORL_FIT_SQUARE_LEVELS - level - 1);
    size_t edges[5] = {begin};
    int held = 0;
    if (level == ORL_FIT_SQUARE_LEVELS)
        return add_knot(b, begin, end, level);
    for (uint64_t q = 0; q < 4; q++) {
        edges[q + 1] = q == 3 ? end : end_of(b, edges[q], end, code + ((q + 1) << below));
        held += edges[q + 1] > edges[q];
    }
    if (held < (end - begin <= STEEP_ROWS && is_steep(b, begin, end) ? 2 : 3) &&
        level >= ALWAYS_SPLIT)
        return add_knot(b, begin, end, level);
    bool fine = true;
    for (uint64_t q = 0; q < 4 && fine; q++)
        if (edges[q + 1] > edges[q])
            fine = split_cell(b, edges[q], edges[q + 1], level + 1, code + (q << below));
    return fine;
}

static bool find_near(struct orl_fit_knots *k)
{
    struct orl_fit_found found;
    k->near = malloc(k->n * ORL_FIT_NEIGHBOURS * sizeof *k->near);
    k->tree = malloc(k->n * sizeof *k->tree);
    k->axes = malloc(k->n);
    if (!k->near || !k->tree || !k->axes)
        return false;
    orl_fit_near_build(k);
    for (size_t i = 0; i < k->n; i++) {
        const struct orl_fit_knot *knot = &k->knots[i];
        orl_fit_near_find(k, orl_v3((double)knot->x, (double)knot->y, (double)knot->z), &found);
        memcpy(k->near + i * ORL_FIT_NEIGHBOURS, found.knot, sizeof found.knot);
    }
    return true;
}

/* ---- The value ------------------------------------------------------------------------------- */

/* Largest exponent distance^2 / (2 radius^2) of the nearest knot; farther away, radii are widened
 * to keep it. */
static const double reach = 2;

static double value_by(const struct orl_fit_knots *k, const uint32_t *near, const float *away2,
                       unsigned count)
{
    const double first = (double)away2[0] * (double)k->knots[near[0]].narrowness;
    const double widened = first > reach ? reach / first : 1;
    double sum = 0, weights = 0;
    for (unsigned i = 0; i < count; i++) {
        const struct orl_fit_knot *knot = &k->knots[near[i]];
        const double weight = exp(-widened * (double)away2[i] * (double)knot->narrowness);
        sum += weight * (double)knot->coefficient;
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

double orl_fit_knots_value(const struct orl_fit_knots *knots, struct orl_vec3 direction)
{
    struct orl_fit_found found;
    orl_fit_near_find(knots, direction, &found);
    return orl_larger(0, value_by(knots, found.knot, found.away2, found.count));
}

static float away2_of(const struct orl_fit_knot *a, const struct orl_fit_knot *b)
{
    const float x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
    return x * x + y * y + z * z;
}

static double value_at_knot(const struct orl_fit_knots *k, size_t i)
{
    const uint32_t *near = k->near + i * ORL_FIT_NEIGHBOURS;
    float away2[ORL_FIT_NEIGHBOURS];
    for (unsigned j = 0; j < ORL_FIT_NEIGHBOURS; j++)
        away2[j] = away2_of(&k->knots[i], &k->knots[near[j]]);
    return value_by(k, near, away2, ORL_FIT_NEIGHBOURS);
}

/* Returns the least coefficient of a knot: half of the darkest value around it. Without this limit,
 * corrections of large cells next to many small ones would make holes. */
static float least_about(const struct orl_fit_knots *k, size_t i)
{
    float least = k->knots[i].value;
    for (unsigned j = 1; j < ORL_FIT_NEIGHBOURS; j++) {
        const float value = k->knots[k->near[i * ORL_FIT_NEIGHBOURS + j]].value;
        least = value < least ? value : least;
    }
    return least > 0 ? 0.5F * least : least;
}

static bool correct_knots(struct orl_fit_knots *k)
{
    float *off = malloc(k->n * sizeof *off);
    if (!off)
        return false;
    for (size_t i = 0; i < k->n; i++)
        k->knots[i].coefficient = k->knots[i].value;
    for (int round = 0; round < CORRECTIONS; round++) {
        for (size_t i = 0; i < k->n; i++)
            off[i] = (float)((double)k->knots[i].value - value_at_knot(k, i));
        for (size_t i = 0; i < k->n; i++) {
            const float to = k->knots[i].coefficient + off[i], least = least_about(k, i);
            k->knots[i].coefficient = to > least ? to : least;
        }
    }
    free(off);
    return true;
}

/* ---- Noise and outliers ---------------------------------------------------------------------- */

enum { AROUND = ORL_FIT_NEIGHBOURS - 1 };
/* Sigma of normal errors in units of their median absolute deviation. */
static const double sigma_of_median = 1.4826;

/* Returns the deviation of a knot from the mean of the six around it, as the standard deviation of
 * one row. */
static double roughness(const struct orl_fit_knots *k, size_t i)
{
    enum { SIX = 6 };
    const uint32_t *near = k->near + i * ORL_FIT_NEIGHBOURS;
    double mean = 0, variance = 1.0 / k->knots[i].rows;
    for (unsigned j = 1; j <= SIX; j++) {
        mean += (double)k->knots[near[j]].value / SIX;
        variance += 1.0 / (SIX * SIX * (double)k->knots[near[j]].rows);
    }
    return fabs((double)k->knots[i].value - mean) / sqrt(variance);
}

/* Sets the noise from the darker half of knots. */
static bool find_noise(struct orl_fit_knots *k)
{
    double *values = malloc(2 * k->n * sizeof *values), *rough = values + k->n;
    size_t count = 0;
    if (!values)
        return false;
    for (size_t i = 0; i < k->n; i++)
        values[i] = (double)k->knots[i].value;
    const double dark = orl_find_kth(values, k->n, k->n / 2);
    for (size_t i = 0; i < k->n; i++)
        if ((double)k->knots[i].value <= dark)
            rough[count++] = roughness(k, i);
    k->noise = sigma_of_median * orl_find_kth(rough, count, count / 2);
    free(values);
    return true;
}

/* Statistics of the knots around a knot. */
struct around {
    double median, spread, least, most;
};

static struct around around_of(const struct orl_fit_knots *k, size_t i)
{
    double values[AROUND], off[AROUND];
    struct around a = {.least = INFINITY, .most = -INFINITY};
    for (unsigned j = 0; j < AROUND; j++) {
        values[j] = (double)k->knots[k->near[i * ORL_FIT_NEIGHBOURS + 1 + j]].value;
        a.least = fmin(a.least, values[j]);
        a.most = fmax(a.most, values[j]);
    }
    a.median = orl_find_kth(values, AROUND, AROUND / 2);
    for (unsigned j = 0; j < AROUND; j++)
        off[j] = fabs(values[j] - a.median);
    a.spread = fmax(k->noise, sigma_of_median * orl_find_kth(off, AROUND, AROUND / 2));
    return a;
}

static bool stands_out(double value, double other, const struct around *a)
{
    const double far = 12 * a->spread, times = 5;
    if (value > a->median)
        return value > a->median + far && value > times * fmax(a->most, other);
    return value < a->median - far && value < fmin(a->least, other) / times;
}

/* Removes the outlier of a knot if it has exactly one; moves that row to the end, where the knot
 * does not count it. Returns the number removed. */
static size_t sift_knot(struct orl_fit_knots *k, size_t i, struct orl_fit_row *rows,
                        const struct around *a)
{
    struct orl_fit_knot *knot = &k->knots[i];
    struct orl_fit_row *row = rows + knot->first;
    size_t alone = knot->rows, count = 0;
    for (size_t j = 0; j < knot->rows; j++) {
        double other = (double)row[j].value > a->median ? -INFINITY : INFINITY;
        for (size_t m = 0; m < knot->rows; m++)
            if (m != j)
                other = (double)row[j].value > a->median ? fmax(other, (double)row[m].value)
                                                         : fmin(other, (double)row[m].value);
        if (stands_out((double)row[j].value, other, a)) {
            alone = j;
            count++;
        }
    }
    if (count != 1)
        return 0;
    const struct orl_fit_row out = row[alone];
    row[alone] = row[knot->rows - 1];
    row[--knot->rows] = out;
    double sum = 0;
    for (size_t j = 0; j < knot->rows; j++)
        sum += (double)row[j].value;
    knot->value = (float)(knot->rows > 0 ? sum / knot->rows : a->median);
    knot->rows = knot->rows > 0 ? knot->rows : 1;
    return 1;
}

/* Knots with more rows are not searched: the neighbours' rows identify an outlier no better than
 * the knot's own mean. */
enum { SIFTED_ROWS = 64 };

static void sift_outliers(struct orl_fit_knots *k, const struct orl_fit_scan *scan,
                          const struct orl_fit_making *making)
{
    const struct orl_vec3 straight = orl_v3(-scan->in.x, -scan->in.y, scan->in.z);
    for (size_t i = 0; i < k->n; i++) {
        const struct orl_fit_knot *knot = &k->knots[i];
        const struct orl_vec3 d = orl_v3((double)knot->x, (double)knot->y, (double)knot->z);
        const double side = orl_fit_cell_rad(knot->level);
        if (knot->rows > SIFTED_ROWS || orl_length(orl_sub(d, straight)) < 2 * side)
            continue;
        const struct around a = around_of(k, i);
        const size_t last = knot->first + knot->rows - 1;
        if (sift_knot(k, i, scan->rows, &a) == 0)
            continue;
        const struct orl_fit_row *row = &scan->rows[last];
        if (k->n_outliers < making->most)
            making->outliers[k->n_outliers] =
                (struct orl_bsdf_outlier){row->file, row->line, (double)row->value, a.median};
        k->n_outliers++;
    }
}

/* ---- How much was seen ----------------------------------------------------------------------- */

static double covered_share(const struct orl_fit_knots *k)
{
    enum { LEVEL = 5, SIDE = 1 << LEVEL };
    double seen = 0, all = 0;
    struct orl_fit_found found;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int row = i / SIDE;
        const struct orl_vec3 d = orl_fit_from_square((i % SIDE + 0.5) / SIDE, (row + 0.5) / SIDE);
        orl_fit_near_find(k, d, &found);
        const unsigned level = k->knots[found.knot[0]].level;
        const double far = orl_fit_cell_rad(LEVEL) + fmin(0.1, orl_fit_cell_rad(level));
        all += d.z;
        if ((double)found.away2[0] <= far * far)
            seen += d.z;
    }
    return seen / all;
}

/* Returns the angle to the nearest knot if it is a gap: wider than the spacing of rows around it
 * and than a degree. Returns 0 otherwise. */
static double hidden_around(const struct orl_fit_knots *k, struct orl_vec3 in)
{
    struct orl_fit_found found;
    orl_fit_near_find(k, orl_v3(-in.x, -in.y, in.z), &found);
    const double away = sqrt((double)found.away2[0]);
    const double side = orl_fit_cell_rad(k->knots[found.knot[0]].level);
    return away > 1.5 * side && away > ORL_DEG_TO_RAD ? away : 0;
}

static int fail_few(const struct orl_fit_scan *scan, struct orl_error *err)
{
    orl_error_set(
        err, ORL_ERR_INVALID,
        "light from theta %.6g, phi %.6g is measured in too few directions out to say how "
        "it scatters",
        scan->theta_deg, scan->phi_deg);
    orl_error_hint(err, "rows have to be spread over the hemisphere, %d of them at the least",
                   KNOTS_LEAST);
    if (scan->n_rows > 0)
        orl_error_at(err, NULL, (int)scan->rows[0].line, NULL);
    return ORL_ERR_INVALID;
}

static int make_knots(struct orl_fit_scan *scan, uint64_t *keys,
                      const struct orl_fit_making *making, struct orl_fit_knots *knots,
                      struct orl_error *err)
{
    struct builder builder = {scan, keys, knots, 0};
    bool fine = sort_rows(scan, keys) && split_cell(&builder, 0, scan->n_rows, 0, 0);
    if (fine && knots->n < KNOTS_LEAST)
        return fail_few(scan, err);
    if (orl_is_cancelled(making->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    fine = fine && find_near(knots) && find_noise(knots);
    if (fine && !making->keep_outliers)
        sift_outliers(knots, scan, making);
    fine = fine && correct_knots(knots);
    if (!fine)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    knots->n_rows = scan->n_rows;
    knots->covered = covered_share(knots);
    knots->hidden_rad = hidden_around(knots, scan->in);
    return knots->covered < 0.25 ? fail_few(scan, err) : 0;
}

int orl_fit_knots_make(struct orl_fit_scan *scan, const struct orl_fit_making *making,
                       struct orl_fit_knots *ret_knots, struct orl_error *err)
{
    struct orl_fit_knots knots = {0};
    if (scan->n_rows < KNOTS_LEAST)
        return fail_few(scan, err);
    uint64_t *keys = malloc(scan->n_rows * sizeof *keys);
    const int code = keys ? make_knots(scan, keys, making, &knots, err)
                          : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    free(keys);
    if (code == 0)
        *ret_knots = knots;
    else
        orl_fit_knots_done(&knots);
    return code;
}
