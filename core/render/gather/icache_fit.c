#include "render/gather/icache.h"

#include <stdlib.h>
#include <string.h>

#include "render/gather/icache_iterator.h"

/* Radii of the discs, in pixels, and the pixels of a record's least radius. */
enum { DISCS = 4, MOST_ABOUT = 256 };
static const double discs[DISCS] = {3, 6, 12, 24}, least_pixels = 1.5 / ORL_ICACHE_ACCURACY;

/* A disc with fewer records is not used. Records whose error is below this share of their value are
 * left as they are. */
enum { FEWEST = 6 };
static const double good_enough = 0.015;

/*
 * Tolerances in standard errors: of a record's own value, and between discs. plane_agrees limits
 * the squared scatter of a disc's records about their plane, relative to the most by chance;
 * records that see more contrast scatter more.
 */
static const double own_agrees = 4, disc_agrees = 2, plane_agrees = 1.25;

/* Limits for neighbours: the cosine between normals, and the height over the plane as a share of
 * the distance. */
static const double turned = 0.95, risen = 0.1;

struct fitting {
    struct orl_icache *cache; /* finds neighbours; its radii are those of the largest disc */
    const struct orl_irradiance_record *records; /* original values */
    struct orl_irradiance_record *fitted;
    const struct orl_geometry *geometry;
};

/* A record near the one that is fitted, and its position along the surface in pixels. */
struct neighbour {
    const struct orl_irradiance_record *record;
    double x, y;
};

struct about {
    struct neighbour list[MOST_ABOUT];
    uint32_t count;
    struct orl_frame frame;
    double pixel;
    double variance; /* variance of one ray's luma, estimated from these records */
};

static bool is_of_surface(const struct orl_irradiance_record *record,
                          const struct orl_irradiance_record *other, struct orl_vec3 shift)
{
    const double away = orl_length(shift);
    return other->place.outside == record->place.outside &&
           other->place.proxied == record->place.proxied &&
           orl_dot(other->place.normal, record->place.normal) > turned &&
           fabs(orl_dot(shift, record->place.normal)) <= risen * away;
}

/* Returns true if nothing stands between two places. */
static bool is_open(const struct orl_geometry *geometry, struct orl_vec3 from,
                    struct orl_vec3 shift)
{
    const double away = orl_length(shift);
    return !(away > 0) || !orl_geometry_occluded(geometry, from, orl_scale(shift, 1 / away), away);
}

/*
 * Returns the variance by rays, pooled over all neighbours. A record that has missed a bright patch
 * has a smaller error than one that has found it; weights by individual errors would favour the
 * wrong ones.
 */
static double ray_variance(const struct about *about)
{
    double sum = 0;
    for (uint32_t i = 0; i < about->count; i++) {
        const struct orl_irradiance_record *record = about->list[i].record;
        sum += record->ray_error * record->ray_error * record->rays / about->count;
    }
    return sum;
}

/* Collects the records within a number of pixels. Returns false if there are too many. */
static bool collect_neighbours(const struct fitting *f, uint32_t index, double pixels,
                               struct about *ret)
{
    const struct orl_irradiance_record *record = &f->records[index];
    struct orl_icache_iterator v = orl_icache_iterator_begin(f->cache, &record->place);
    ret->count = 0;
    ret->pixel = record->least / least_pixels;
    ret->frame = orl_frame_about(record->place.normal);
    for (uint32_t k = orl_icache_iterator_next(&v); k != ORL_ICACHE_END && ret->count < MOST_ABOUT;
         k = orl_icache_iterator_next(&v)) {
        const struct orl_irradiance_record *other = &f->records[k];
        const struct orl_vec3 shift = orl_sub(other->place.point, record->place.point);
        if (orl_length(shift) >= pixels * ret->pixel ||
            (k != index && (!is_of_surface(record, other, shift) ||
                            !is_open(f->geometry, record->place.point, shift))))
            continue;
        ret->list[ret->count++] =
            (struct neighbour){other, orl_dot(shift, ret->frame.u) / ret->pixel,
                               orl_dot(shift, ret->frame.v) / ret->pixel};
    }
    ret->variance = ray_variance(ret);
    return ret->count < MOST_ABOUT;
}

/* A plane over a disc: value at its centre and slopes per pixel, by channel; the standard error of
 * the value's luma by rays; and the squared scatter of the records, relative to their errors. */
struct plane {
    double at[3], x[3], y[3];
    double error, scatter;
};

static double channel(struct orl_rgb c, int i)
{
    return i == 0 ? c.r : i == 1 ? c.g : c.b;
}

/* Returns the weight of a neighbour over a disc of that radius. */
static double weight_of(const struct neighbour *n, double radius)
{
    const double away2 = (n->x * n->x + n->y * n->y) / (radius * radius);
    return away2 < 1 ? (1 - away2) * n->record->rays : 0;
}

/* Inverse of the symmetric moment matrix, by cofactors. */
struct inverse {
    double a00, a01, a02, a11, a12, a22;
};

static struct inverse invert_moments(double s, double sx, double sy, double sxx, double sxy,
                                     double syy)
{
    const double c00 = sxx * syy - sxy * sxy, c01 = sxy * sy - sx * syy, c02 = sx * sxy - sxx * sy;
    const double d = s * c00 + sx * c01 + sy * c02;
    return (struct inverse){c00 / d,
                            c01 / d,
                            c02 / d,
                            (s * syy - sy * sy) / d,
                            (sx * sy - s * sxy) / d,
                            (s * sxx - sx * sx) / d};
}

static struct orl_rgb value_at(const struct plane *plane, double x, double y)
{
    return (struct orl_rgb){plane->at[0] + x * plane->x[0] + y * plane->y[0],
                            plane->at[1] + x * plane->x[1] + y * plane->y[1],
                            plane->at[2] + x * plane->x[2] + y * plane->y[2]};
}

/* Returns the value that chi-square over its degrees of freedom exceeds only beyond three standard
 * deviations: Wilson and Hilferty 1931, Proceedings of the National Academy of Sciences 17, 684. */
static double most_by_chance(double degrees)
{
    const double spread = 2 / (9 * degrees), root = 1 - spread + 3 * sqrt(spread);
    return root * root * root;
}

/*
 * Returns the squared scatter of the records about a plane, which takes three degrees of freedom,
 * relative to the most that their rays explain. Records at the rim weigh less, which reduces the
 * effective number.
 */
static double scatter_about(const struct plane *plane, const struct about *about, double radius)
{
    double squares = 0, expected = 0, sum = 0, sum2 = 0;
    for (uint32_t i = 0; i < about->count; i++) {
        const struct neighbour *n = &about->list[i];
        const double w = weight_of(n, radius) / n->record->rays;
        const double off = orl_luma(n->record->irradiance) - orl_luma(value_at(plane, n->x, n->y));
        sum += w;
        sum2 += w * w;
        squares += w * n->record->rays * off * off;
        expected += w * about->variance;
    }
    const double evenly = sum * sum / sum2, degrees = evenly - 3;
    return degrees > 0 ? squares / expected * evenly / degrees / most_by_chance(degrees) : 0;
}

/*
 * Fits a plane. A ridge term bounds the slopes when the records stand in a line: light then changes
 * over the disc by about its own value. It is negligible when there are many records. Returns false
 * if the disc holds too few.
 */
static bool fit_plane(const struct about *about, double luma, double radius, struct plane *ret)
{
    const double held = about->variance * radius * radius / (luma * luma);
    double s = 0, sx = 0, sy = 0, sxx = held, sxy = 0, syy = held;
    uint32_t within = 0;
    for (uint32_t i = 0; i < about->count; i++) {
        const struct neighbour *n = &about->list[i];
        const double w = weight_of(n, radius);
        within += w > 0;
        s += w;
        sx += w * n->x;
        sy += w * n->y;
        sxx += w * n->x * n->x;
        sxy += w * n->x * n->y;
        syy += w * n->y * n->y;
    }
    const struct inverse a = invert_moments(s, sx, sy, sxx, sxy, syy);
    *ret = (struct plane){.error = 0};
    for (uint32_t i = 0; i < about->count; i++) {
        const struct neighbour *n = &about->list[i];
        const double w = weight_of(n, radius);
        const double at = w * (a.a00 + a.a01 * n->x + a.a02 * n->y);
        const double x = w * (a.a01 + a.a11 * n->x + a.a12 * n->y);
        const double y = w * (a.a02 + a.a12 * n->x + a.a22 * n->y);
        for (int c = 0; c < 3; c++) {
            const double value = channel(n->record->irradiance, c);
            ret->at[c] += at * value;
            ret->x[c] += x * value;
            ret->y[c] += y * value;
        }
        ret->error += at * at * about->variance / n->record->rays;
    }
    ret->error = sqrt(ret->error);
    ret->scatter = scatter_about(ret, about, radius);
    return within >= FEWEST;
}

/* Stores the plane in the record. The value stays at least zero, and the slope within the limit for
 * records. */
static void store_plane(struct orl_irradiance_record *record, const struct plane *plane,
                        const struct about *about)
{
    const double served = fmax(record->radius, record->least);
    for (int c = 0; c < 3; c++) {
        const struct orl_vec3 slope =
            orl_add(orl_scale(about->frame.u, plane->x[c] / about->pixel),
                    orl_scale(about->frame.v, plane->y[c] / about->pixel));
        const double steepest = fmax(plane->at[c], 0) / served, steep = orl_length(slope);
        record->translation_gradient[c] = orl_scale(slope, steep > steepest ? steepest / steep : 1);
    }
    record->irradiance =
        (struct orl_rgb){fmax(plane->at[0], 0), fmax(plane->at[1], 0), fmax(plane->at[2], 0)};
    record->photon_error = hypot(record->photon_error, plane->error);
    record->ray_error = 0;
}

static void fit_record(void *arg, size_t index, uint32_t member)
{
    const struct fitting *f = arg;
    const struct orl_irradiance_record *record = &f->records[index];
    const double luma = orl_luma(record->irradiance);
    struct about about; /* its list stays uninitialised, because it is large */
    struct plane plane;
    (void)member;
    if (!(record->ray_error > good_enough * luma) || !(luma > 0))
        return;
    int n = DISCS;
    while (!collect_neighbours(f, (uint32_t)index, discs[n - 1], &about) && n > 1)
        n--;
    const double own = own_agrees * sqrt(about.variance / record->rays);
    double low = luma - own, high = luma + own;
    for (int i = 0; i < n; i++) {
        if (!fit_plane(&about, luma, discs[i], &plane))
            continue;
        const double at = orl_luma(value_at(&plane, 0, 0));
        low = fmax(low, at - disc_agrees * plane.error);
        high = fmin(high, at + disc_agrees * plane.error);
        if (!(low <= high) || plane.scatter > plane_agrees)
            return;
        f->fitted[index] = *record;
        store_plane(&f->fitted[index], &plane, &about);
    }
}

/* Copies the cache with radii that reach over the largest disc, so that neighbours can be found. */
static int copy_widened(struct orl_icache *wide, const struct orl_icache *cache)
{
    orl_icache_init(wide, cache->channels);
    int code = orl_icache_add(wide, cache->records, cache->count);
    for (size_t i = 0; i < wide->count; i++)
        wide->records[i].radius = discs[DISCS - 1] / least_pixels / ORL_ICACHE_ACCURACY /
                                  ORL_ICACHE_OVERLAP * wide->records[i].least;
    return code < 0 ? code : orl_icache_index(wide);
}

int orl_icache_fit(struct orl_icache *cache, const struct orl_geometry *geometry,
                   struct orl_thread_pool *pool)
{
    struct orl_icache wide;
    struct fitting f = {.cache = &wide, .geometry = geometry};
    if (cache->count == 0)
        return 0;
    struct orl_irradiance_record *fitted = malloc((cache->count + 1) * sizeof *fitted);
    int code = copy_widened(&wide, cache);
    if (!fitted)
        code = ORL_ERR_NOMEM;
    if (code == 0) {
        memcpy(fitted, cache->records, cache->count * sizeof *fitted);
        f.records = cache->records;
        f.fitted = fitted;
        code = orl_parallel_try(pool, cache->count, fit_record, &f);
    }
    if (code == 0)
        memcpy(cache->records, fitted, cache->count * sizeof *fitted);
    free(fitted);
    orl_icache_done(&wide);
    return code;
}
