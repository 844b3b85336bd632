/* Differences between two BSDFs: see oriel/bsdf/bsdf_convert.h. */
#include <oriel/bsdf/bsdf_convert.h>

#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>
#include <oriel/base/vec.h>

#include "bsdf/bsdf_internal.h"
#include "bsdf/tree/shirley.h"

/* SIDE: cells a side of the square of directions out. REACH: cells that a cone's radius may span.
 * NEAR: cells of a square that contains the cone. */
enum { SIDE = 192, CELLS = SIDE * SIDE, REACH = 4, SPAN = 2 * REACH + 1, NEAR = SPAN * SPAN };
static const double cone_deg = 1;

/* Luma; if coloured also red, green and blue. */
enum { CHANNELS = 4 };

/* Differences of one component for one direction in: albedo, largest of a cone, share of light that
 * moved. */
struct told {
    struct orl_bsdf_angles from, cone_to[CHANNELS];
    double albedo[CHANNELS], cone[CHANNELS], moved;
};

/* Directions out on the front. `near` has, for each, a bit for each cell around it, in row order:
 * set if the cell is in its cone. On the back z is negated and angles are equal. */
struct cells {
    struct orl_vec3 towards[CELLS];
    uint64_t near[CELLS][(NEAR + 63) / 64];
};

struct work {
    const struct orl_bsdf *a, *b;
    const struct cells *cells;
    int channels;
    struct told of[2][ORL_BSDF_COMPARED][2]; /* [front][from][transmitted] */
    atomic_int code;
};

static double of_channel(struct orl_rgb color, int channel)
{
    const double values[CHANNELS] = {orl_luma(color), color.r, color.g, color.b};
    return values[channel];
}

/* Returns test direction i: one near the normal, then five rings of eight. None lies on a border of
 * a basis. */
static struct orl_bsdf_angles place_of(int i)
{
    if (i == 0)
        return (struct orl_bsdf_angles){1.2, 33};
    const int ring = (i - 1) / 8, at = (i - 1) % 8;
    return (struct orl_bsdf_angles){10.7 + 15 * ring, 7.3 + 45 * at};
}

static struct orl_vec3 cell_direction(int x, int y)
{
    return orl_square_to_hemisphere(
        (struct orl_square){2 * (x + 0.5) / SIDE - 1, 2 * (y + 0.5) / SIDE - 1});
}

static struct cells *cells_new(void)
{
    const double least = cos(cone_deg * ORL_DEG_TO_RAD);
    struct cells *cells = calloc(1, sizeof *cells);
    if (!cells)
        return NULL;
    for (int k = 0; k < CELLS; k++)
        cells->towards[k] = cell_direction(k % SIDE, k / SIDE);
    for (int k = 0; k < CELLS; k++)
        for (int at = 0; at < NEAR; at++) {
            const int i = k % SIDE + at % SPAN - REACH, j = k / SIDE + at / SPAN - REACH;
            if (i >= 0 && j >= 0 && i < SIDE && j < SIDE &&
                orl_dot(cells->towards[k], cells->towards[j * SIDE + i]) >= least)
                cells->near[k][at / 64] |= (uint64_t)1 << at % 64;
        }
    return cells;
}

/* Returns the sum of the cells' differences over the cone about cell k. */
static double in_cone(const float *off, const struct cells *cells, int k)
{
    double sum = 0;
    for (int word = 0; word < (NEAR + 63) / 64; word++)
        for (uint64_t left = cells->near[k][word]; left; left &= left - 1) {
            const int at = 64 * word + __builtin_ctzll(left);
            sum += (double)off[k + (at / SPAN - REACH) * SIDE + at % SPAN - REACH];
        }
    return sum;
}

static struct orl_vec3 cell_towards(const struct cells *cells, int k, bool front)
{
    struct orl_vec3 d = cells->towards[k];
    if (!front)
        d.z = -d.z;
    return d;
}

/* Updates the cone with the largest difference, and the amount of light in other places. */
static void find_worst_cone(const float *off, const struct cells *cells, bool front, int channel,
                            struct told *told)
{
    for (int k = 0; k < CELLS; k++) {
        if (off[k] == 0)
            continue;
        const double cone = in_cone(off, cells, k);
        if (channel == 0)
            told->moved += 0.5 * fabs((double)off[k]);
        if (fabs(cone) > fabs(told->cone[channel])) {
            told->cone[channel] = cone;
            told->cone_to[channel] = orl_bsdf_angles_of(cell_towards(cells, k, front));
        }
    }
}

/* Compares one side for light from in, by channel. off: scratch for the differences of all
 * cells. */
static void compare_side(const struct work *w, struct orl_vec3 in, bool transmitted, float *off,
                         struct told *told)
{
    const bool front_out = (in.z > 0) != transmitted;
    const enum orl_bsdf_side side = transmitted ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT;
    const struct orl_rgb a = orl_bsdf_albedo(w->a, in, side), b = orl_bsdf_albedo(w->b, in, side);
    for (int k = 0; k < CELLS; k++) {
        const struct orl_vec3 out = cell_towards(w->cells, k, front_out);
        const struct orl_rgb value_a = orl_bsdf_eval(w->a, in, out);
        const struct orl_rgb value_b = orl_bsdf_eval(w->b, in, out);
        for (int c = 0; c < w->channels; c++)
            off[c * CELLS + k] =
                (float)((of_channel(value_b, c) - of_channel(value_a, c)) * ORL_PI / CELLS);
    }
    for (int c = 0; c < w->channels; c++) {
        told->albedo[c] = of_channel(b, c) - of_channel(a, c);
        find_worst_cone(off + (ptrdiff_t)c * CELLS, w->cells, front_out, c, told);
    }
}

static void compare_from(void *arg, size_t index, uint32_t member)
{
    struct work *w = arg;
    const bool front = index >= ORL_BSDF_COMPARED;
    const size_t i = index % ORL_BSDF_COMPARED;
    const struct orl_bsdf_angles from = place_of((int)i);
    const struct orl_vec3 in = orl_bsdf_direction_at(from.theta_deg, from.phi_deg, front);
    float *off = malloc((size_t)w->channels * CELLS * sizeof *off);
    (void)member;
    if (!off)
        atomic_store(&w->code, ORL_ERR_NOMEM);
    for (int t = 0; t < 2 && off; t++) {
        w->of[front][i][t].from = from;
        compare_side(w, in, t, off, &w->of[front][i][t]);
    }
    free(off);
}

/* Replaces *worst by value if value is larger in magnitude; returns true then. */
static bool update_worst(double *worst, double value)
{
    const bool more = fabs(value) > fabs(*worst);
    if (more)
        *worst = value;
    return more;
}

static void sum_up_color(const struct told *told, int channel,
                         struct orl_bsdf_color_difference *worst)
{
    if (update_worst(&worst->albedo_worst, told->albedo[channel]))
        worst->albedo_from = told->from;
    if (update_worst(&worst->cone_worst, told->cone[channel])) {
        worst->cone_from = told->from;
        worst->cone_to = told->cone_to[channel];
    }
}

static void sum_up_part(const struct work *w, int front, int t, struct orl_bsdf_difference *ret)
{
    struct orl_bsdf_difference d = {.albedo_worst = 0};
    for (int i = 0; i < ORL_BSDF_COMPARED; i++) {
        const struct told *told = &w->of[front][i][t];
        d.albedo_rms += told->albedo[0] * told->albedo[0] / ORL_BSDF_COMPARED;
        d.moved_mean += told->moved / ORL_BSDF_COMPARED;
        if (update_worst(&d.albedo_worst, told->albedo[0]))
            d.albedo_from = told->from;
        if (update_worst(&d.cone_worst, told->cone[0])) {
            d.cone_from = told->from;
            d.cone_to = told->cone_to[0];
        }
        if (update_worst(&d.moved_worst, told->moved))
            d.moved_from = told->from;
        for (int c = w->channels > 1; c < w->channels; c++)
            sum_up_color(told, c, &d.color);
    }
    d.albedo_rms = sqrt(d.albedo_rms);
    *ret = d;
}

int orl_bsdf_compare(const struct orl_bsdf *a, const struct orl_bsdf *b,
                     struct orl_thread_pool *pool, const atomic_bool *cancel,
                     struct orl_bsdf_comparison *ret_comparison, struct orl_error *err)
{
    struct work *work = calloc(1, sizeof *work);
    struct cells *cells = cells_new();
    if (!work || !cells) {
        free(work);
        free(cells);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    work->cells = cells;
    struct orl_bsdf_info infos[2];
    orl_bsdf_describe(a, &infos[0]);
    orl_bsdf_describe(b, &infos[1]);
    work->a = a;
    work->b = b;
    work->channels = infos[0].colored || infos[1].colored ? CHANNELS : 1;
    orl_thread_pool_set_cancel(pool, cancel);
    int code = orl_parallel_try(pool, (size_t)2 * ORL_BSDF_COMPARED, compare_from, work);
    orl_thread_pool_set_cancel(pool, NULL);
    if (code == 0)
        code = atomic_load(&work->code);
    for (int i = 0; i < 2 && code == 0; i++)
        ret_comparison->colored[i] = infos[i].colored;
    for (int part = 0; part < 4 && code == 0; part++)
        sum_up_part(work, part / 2, part % 2, &ret_comparison->of[part / 2][part % 2]);
    free(cells);
    free(work);
    return code < 0
               ? orl_error_set(err, code, code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory")
               : 0;
}
