/* Interpolant of one scan by radial basis functions; its noise and outliers. */
#include "bsdf/fit/scan/scan_light.h"

#include <oriel/base/thread_pool.h>
#include <oriel/bsdf/bsdf_fit.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "base/statistics/numeric.h"

/* Radius of a center's Gaussian in sides of its cell. Gaussians of neighbours then meet at 0.7 of
 * their height, and equal centers interpolate to a constant within a thousandth. */
static const double radius_of_side = 0.6;
static const float steep_share = 0.7F;
enum { STEEP_ROWS = 8, ALWAYS_SPLIT = 4, CORRECTIONS = 2, MIN_CENTERS = 16 };

void orl_fit_rbf_done(struct orl_fit_rbf *centers)
{
    free(centers->centers);
    free(centers->neighbors);
    free(centers->tree);
    free(centers->axes);
    memset(centers, 0, sizeof *centers);
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
        keys[i] = (uint64_t)orl_fit_morton_code(place_of(&scan->rows[i])) << 32 | (uint64_t)i;
    qsort(keys, scan->n_rows, sizeof *keys, compare_keys);
    for (size_t i = 0; i < scan->n_rows; i++)
        sorted[i] = scan->rows[keys[i] & UINT32_MAX];
    free(scan->rows);
    scan->rows = sorted;
    scan->capacity = scan->n_rows;
    return true;
}

/* ---- Centers --------------------------------------------------------------------------------- */

struct builder {
    const struct orl_fit_scan *scan;
    const uint64_t *keys;
    struct orl_fit_rbf *centers;
    size_t capacity;
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

static bool add_center(struct builder *b, size_t begin, size_t end, unsigned level)
{
    struct orl_fit_rbf *k = b->centers;
    struct orl_vec3 sum = {0};
    double value = 0;
    if (!orl_array_reserve(&k->centers, &b->capacity, k->n, sizeof *k->centers))
        return false;
    for (size_t i = begin; i < end; i++) {
        sum = orl_add(sum, place_of(&b->scan->rows[i]));
        value += (double)b->scan->rows[i].value;
    }
    const struct orl_vec3 d = orl_normalize(sum);
    const double radius = radius_of_side * orl_fit_cell_rad(level);
    k->centers[k->n++] = (struct orl_fit_center){.x = (float)d.x,
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
        return add_center(b, begin, end, level);
    for (uint64_t q = 0; q < 4; q++) {
        edges[q + 1] = q == 3 ? end : end_of(b, edges[q], end, code + ((q + 1) << below));
        held += edges[q + 1] > edges[q];
    }
    if (held < (end - begin <= STEEP_ROWS && is_steep(b, begin, end) ? 2 : 3) &&
        level >= ALWAYS_SPLIT)
        return add_center(b, begin, end, level);
    bool fine = true;
    for (uint64_t q = 0; q < 4 && fine; q++)
        if (edges[q + 1] > edges[q])
            fine = split_cell(b, edges[q], edges[q + 1], level + 1, code + (q << below));
    return fine;
}

static bool find_neighbors(struct orl_fit_rbf *k)
{
    struct orl_fit_nearest found;
    k->neighbors = malloc(k->n * ORL_FIT_NEIGHBOURS * sizeof *k->neighbors);
    k->tree = malloc(k->n * sizeof *k->tree);
    k->axes = malloc(k->n);
    if (!k->neighbors || !k->tree || !k->axes)
        return false;
    orl_fit_kd_tree_build(k);
    for (size_t i = 0; i < k->n; i++) {
        const struct orl_fit_center *center = &k->centers[i];
        orl_fit_kd_tree_find(k, orl_v3((double)center->x, (double)center->y, (double)center->z),
                             &found);
        memcpy(k->neighbors + i * ORL_FIT_NEIGHBOURS, found.center, sizeof found.center);
    }
    return true;
}

/* ---- The value ------------------------------------------------------------------------------- */

/* Largest exponent distance^2 / (2 radius^2) of the nearest center; farther away, radii are widened
 * to keep it. */
static const double reach = 2;

static double value_by(const struct orl_fit_rbf *k, const uint32_t *neighbors,
                       const float *distance2, unsigned count)
{
    const double first = (double)distance2[0] * (double)k->centers[neighbors[0]].narrowness;
    const double widened = first > reach ? reach / first : 1;
    double sum = 0, weights = 0;
    for (unsigned i = 0; i < count; i++) {
        const struct orl_fit_center *center = &k->centers[neighbors[i]];
        const double weight = exp(-widened * (double)distance2[i] * (double)center->narrowness);
        sum += weight * (double)center->coefficient;
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

double orl_fit_rbf_value(const struct orl_fit_rbf *centers, struct orl_vec3 direction)
{
    struct orl_fit_nearest found;
    orl_fit_kd_tree_find(centers, direction, &found);
    return orl_larger(0, value_by(centers, found.center, found.distance2, found.count));
}

static float distance2_of(const struct orl_fit_center *a, const struct orl_fit_center *b)
{
    const float x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
    return x * x + y * y + z * z;
}

static double value_at_center(const struct orl_fit_rbf *k, size_t i)
{
    const uint32_t *neighbors = k->neighbors + i * ORL_FIT_NEIGHBOURS;
    float distance2[ORL_FIT_NEIGHBOURS];
    for (unsigned j = 0; j < ORL_FIT_NEIGHBOURS; j++)
        distance2[j] = distance2_of(&k->centers[i], &k->centers[neighbors[j]]);
    return value_by(k, neighbors, distance2, ORL_FIT_NEIGHBOURS);
}

/* Returns the least coefficient of a center: half of the darkest value around it. Without this
 * limit, corrections of large cells next to many small ones would make holes. */
static float least_about(const struct orl_fit_rbf *k, size_t i)
{
    float least = k->centers[i].value;
    for (unsigned j = 1; j < ORL_FIT_NEIGHBOURS; j++) {
        const float value = k->centers[k->neighbors[i * ORL_FIT_NEIGHBOURS + j]].value;
        least = value < least ? value : least;
    }
    return least > 0 ? 0.5F * least : least;
}

static bool correct_centers(struct orl_fit_rbf *k)
{
    float *off = malloc(k->n * sizeof *off);
    if (!off)
        return false;
    for (size_t i = 0; i < k->n; i++)
        k->centers[i].coefficient = k->centers[i].value;
    for (int round = 0; round < CORRECTIONS; round++) {
        for (size_t i = 0; i < k->n; i++)
            off[i] = (float)((double)k->centers[i].value - value_at_center(k, i));
        for (size_t i = 0; i < k->n; i++) {
            const float to = k->centers[i].coefficient + off[i], least = least_about(k, i);
            k->centers[i].coefficient = to > least ? to : least;
        }
    }
    free(off);
    return true;
}

/* ---- Noise and outliers ---------------------------------------------------------------------- */

enum { AROUND = ORL_FIT_NEIGHBOURS - 1 };
/* Sigma of normal errors in units of their median absolute deviation. */
static const double sigma_of_median = 1.4826;

/* Returns the deviation of a center from the mean of the six around it, as the standard deviation
 * of one row. */
static double roughness(const struct orl_fit_rbf *k, size_t i)
{
    enum { SIX = 6 };
    const uint32_t *neighbors = k->neighbors + i * ORL_FIT_NEIGHBOURS;
    double mean = 0, variance = 1.0 / k->centers[i].rows;
    for (unsigned j = 1; j <= SIX; j++) {
        mean += (double)k->centers[neighbors[j]].value / SIX;
        variance += 1.0 / (SIX * SIX * (double)k->centers[neighbors[j]].rows);
    }
    return fabs((double)k->centers[i].value - mean) / sqrt(variance);
}

/* Sets the noise from the darker half of centers. */
static bool find_noise(struct orl_fit_rbf *k)
{
    double *values = malloc(2 * k->n * sizeof *values), *rough = values + k->n;
    size_t count = 0;
    if (!values)
        return false;
    for (size_t i = 0; i < k->n; i++)
        values[i] = (double)k->centers[i].value;
    const double dark = orl_nth_element(values, k->n, k->n / 2);
    for (size_t i = 0; i < k->n; i++)
        if ((double)k->centers[i].value <= dark)
            rough[count++] = roughness(k, i);
    k->noise = sigma_of_median * orl_nth_element(rough, count, count / 2);
    free(values);
    return true;
}

/* Statistics of the centers around a center. */
struct around {
    double median, spread, least, most;
};

static struct around around_of(const struct orl_fit_rbf *k, size_t i)
{
    double values[AROUND], off[AROUND];
    struct around a = {.least = INFINITY, .most = -INFINITY};
    for (unsigned j = 0; j < AROUND; j++) {
        values[j] = (double)k->centers[k->neighbors[i * ORL_FIT_NEIGHBOURS + 1 + j]].value;
        a.least = fmin(a.least, values[j]);
        a.most = fmax(a.most, values[j]);
    }
    a.median = orl_nth_element(values, AROUND, AROUND / 2);
    for (unsigned j = 0; j < AROUND; j++)
        off[j] = fabs(values[j] - a.median);
    a.spread = fmax(k->noise, sigma_of_median * orl_nth_element(off, AROUND, AROUND / 2));
    return a;
}

static bool stands_out(double value, double other, const struct around *a)
{
    const double far = 12 * a->spread, times = 5;
    if (value > a->median)
        return value > a->median + far && value > times * fmax(a->most, other);
    return value < a->median - far && value < fmin(a->least, other) / times;
}

/* Removes the outlier of a center if it has exactly one; moves that row to the end, where the
 * center does not count it. Returns the number removed. */
static size_t sift_center(struct orl_fit_rbf *k, size_t i, struct orl_fit_row *rows,
                          const struct around *a)
{
    struct orl_fit_center *center = &k->centers[i];
    struct orl_fit_row *row = rows + center->first;
    size_t alone = center->rows, count = 0;
    for (size_t j = 0; j < center->rows; j++) {
        double other = (double)row[j].value > a->median ? -INFINITY : INFINITY;
        for (size_t m = 0; m < center->rows; m++)
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
    row[alone] = row[center->rows - 1];
    row[--center->rows] = out;
    double sum = 0;
    for (size_t j = 0; j < center->rows; j++)
        sum += (double)row[j].value;
    center->value = (float)(center->rows > 0 ? sum / center->rows : a->median);
    center->rows = center->rows > 0 ? center->rows : 1;
    return 1;
}

/* Centers with more rows are not searched: the neighbours' rows identify an outlier no better than
 * the center's own mean. */
enum { SIFTED_ROWS = 64 };

static void sift_outliers(struct orl_fit_rbf *k, const struct orl_fit_scan *scan,
                          const struct orl_fit_rbf_options *options)
{
    const struct orl_vec3 straight = orl_v3(-scan->in.x, -scan->in.y, scan->in.z);
    for (size_t i = 0; i < k->n; i++) {
        const struct orl_fit_center *center = &k->centers[i];
        const struct orl_vec3 d = orl_v3((double)center->x, (double)center->y, (double)center->z);
        const double side = orl_fit_cell_rad(center->level);
        if (center->rows > SIFTED_ROWS || orl_length(orl_sub(d, straight)) < 2 * side)
            continue;
        const struct around a = around_of(k, i);
        const size_t last = center->first + center->rows - 1;
        if (sift_center(k, i, scan->rows, &a) == 0)
            continue;
        const struct orl_fit_row *row = &scan->rows[last];
        if (k->n_outliers < options->most)
            options->outliers[k->n_outliers] =
                (struct orl_bsdf_outlier){row->file, row->line, (double)row->value, a.median};
        k->n_outliers++;
    }
}

/* ---- Coverage -------------------------------------------------------------------------------- */

static double covered_share(const struct orl_fit_rbf *k)
{
    enum { LEVEL = 5, SIDE = 1 << LEVEL };
    double seen = 0, all = 0;
    struct orl_fit_nearest found;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int row = i / SIDE;
        const struct orl_vec3 d = orl_fit_from_square((i % SIDE + 0.5) / SIDE, (row + 0.5) / SIDE);
        orl_fit_kd_tree_find(k, d, &found);
        const unsigned level = k->centers[found.center[0]].level;
        const double far = orl_fit_cell_rad(LEVEL) + fmin(0.1, orl_fit_cell_rad(level));
        all += d.z;
        if ((double)found.distance2[0] <= far * far)
            seen += d.z;
    }
    return seen / all;
}

/* Returns the angle to the nearest center if it is a gap: wider than the spacing of rows around it
 * and than a degree. Returns 0 otherwise. */
static double hidden_around(const struct orl_fit_rbf *k, struct orl_vec3 in)
{
    struct orl_fit_nearest found;
    orl_fit_kd_tree_find(k, orl_v3(-in.x, -in.y, in.z), &found);
    const double away = sqrt((double)found.distance2[0]);
    const double side = orl_fit_cell_rad(k->centers[found.center[0]].level);
    return away > 1.5 * side && away > ORL_DEG_TO_RAD ? away : 0;
}

static int fail_few(const struct orl_fit_scan *scan, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_INVALID,
                  "light from theta %.6g, phi %.6g is measured in too few exit directions to fit "
                  "its scattering",
                  scan->theta_deg, scan->phi_deg);
    orl_error_hint(err, "at least %d rows are needed, spread over the hemisphere", MIN_CENTERS);
    if (scan->n_rows > 0)
        orl_error_at(err, NULL, (int)scan->rows[0].line, NULL);
    return ORL_ERR_INVALID;
}

static int make_centers(struct orl_fit_scan *scan, uint64_t *keys,
                        const struct orl_fit_rbf_options *options, struct orl_fit_rbf *centers,
                        struct orl_error *err)
{
    struct builder builder = {scan, keys, centers, 0};
    bool fine = sort_rows(scan, keys) && split_cell(&builder, 0, scan->n_rows, 0, 0);
    if (fine && centers->n < MIN_CENTERS)
        return fail_few(scan, err);
    if (orl_is_cancelled(options->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    fine = fine && find_neighbors(centers) && find_noise(centers);
    if (fine && !options->keep_outliers)
        sift_outliers(centers, scan, options);
    fine = fine && correct_centers(centers);
    if (!fine)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    centers->n_rows = scan->n_rows;
    centers->covered = covered_share(centers);
    centers->hidden_rad = hidden_around(centers, scan->in);
    return centers->covered < 0.25 ? fail_few(scan, err) : 0;
}

int orl_fit_rbf_make(struct orl_fit_scan *scan, const struct orl_fit_rbf_options *options,
                     struct orl_fit_rbf *ret_rbf, struct orl_error *err)
{
    struct orl_fit_rbf centers = {0};
    if (scan->n_rows < MIN_CENTERS)
        return fail_few(scan, err);
    uint64_t *keys = malloc(scan->n_rows * sizeof *keys);
    const int code = keys ? make_centers(scan, keys, options, &centers, err)
                          : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for measurements");
    free(keys);
    if (code == 0)
        *ret_rbf = centers;
    else
        orl_fit_rbf_done(&centers);
    return code;
}
