#include "photon/density/adaptive_density.h"

#include <stdlib.h>

#include "photon/density/nested_discs.h"
#include "photon/map/quantization.h"

/*
 * The smallest disc is one that would hold about twice 256 photons in even light. It is not chosen
 * by its own count, because that would select discs with too many photons. Only if it is almost
 * empty, beside something far brighter, the next larger one is used.
 */
enum { RINGS = ORL_NESTED_DISCS, SMALLEST = 256, LEAST = 8 };
/* With fewer photons in reach there is no smaller disc to test whether light is even. */
enum { FEW = 2 * SMALLEST };

/* Differences between ring and disc, in standard deviations: full agreement up to the first,
 * none from the second. */
static const double agrees = 1.25, differs = 3.25;

/* The curve is subtracted as far as it exceeds this many of its own standard deviations... */
static const double significant = 2;
/* ... and up to this share of the value. */
static const double most_subtracted = 1.0 / 3;

/*
 * Factors on the standard deviation in the first comparisons. A picture has thousands of smallest
 * discs; some would disagree by chance, and their noise would be visible as specks.
 */
enum { NOISE_FACTORS = 2 };
static const double noise_factors[NOISE_FACTORS] = {1.4, 1.2};

/*
 * Weights for the photons of a disc or ring, which depend only on its area inside the footprint.
 * The mean is the sum of fluxes over `level`. The value at the point of the best-fit plane is the
 * sum of (1 - a x - b y) times the fluxes over `plane`; these weights have no first moment. In even
 * light it scatters as a mean over an area `plane` does. If the area is too small to determine a
 * slope, the plane is level.
 */
struct shape {
    double room, level, plane, a, b;
};

/* Sums over the photons of a disc or ring: luma, luma times either coordinate, squared luma. */
struct sum {
    double all, x, y, squares;
};

/* The sums for one estimate: of all photons, or of all batches but one. */
struct sums {
    struct sum rings[RINGS], discs[RINGS];
};

struct shapes {
    struct shape rings[RINGS], discs[RINGS];
    /* first: the disc to begin with; narrowest: the smallest one that is not almost empty */
    int first, narrowest;
};

struct blend {
    double value;
    double bias;   /* bias of the value */
    double curve;  /* the part of the bias that is a curve of the light */
    double radius; /* relative to the radius of the widest disc */
    /* Per disc: its weight in the value, and the plane's share in its own value. */
    double weights[RINGS], planes[RINGS];
};

static struct shape shape_of(const struct orl_moments *m, double least_area)
{
    const double held = 2e-3 * (m->xx + m->yy), xx = m->xx + held, yy = m->yy + held;
    const double determinant = xx * yy - m->xy * m->xy;
    struct shape shape = {.room = m->area, .level = orl_larger(m->area, least_area)};
    if (determinant > 0) {
        shape.a = (yy * m->x - m->xy * m->y) / determinant;
        shape.b = (xx * m->y - m->xy * m->x) / determinant;
    }
    shape.plane = m->area - shape.a * m->x - shape.b * m->y;
    return shape;
}

static struct shapes shapes_of(const struct orl_nested_discs *r, double least_area)
{
    struct shapes shapes = {.narrowest = RINGS - 1};
    float inside = 0;
    for (int i = RINGS - 1; i >= 0; i--) {
        struct orl_moments ring = r->discs[i];
        if (i + 1 < RINGS)
            ring = orl_moments_add(&ring, &r->discs[i + 1], -1);
        shapes.discs[i] = shape_of(&r->discs[i], least_area);
        shapes.rings[i] = shape_of(&ring, least_area);
        inside += r->rings[i].flux_sums[ORL_FLUX_SUMS_COUNT];
        if (inside < LEAST)
            shapes.narrowest = i > 0 ? i - 1 : 0;
    }
    while (shapes.first < shapes.narrowest && r->found >= ldexp(2 * SMALLEST, (int)shapes.first))
        shapes.first++; /* in even light each disc holds half of the one before */
    return shapes;
}

static void fill_discs(struct sums *sums)
{
    sums->discs[RINGS - 1] = sums->rings[RINGS - 1];
    for (int i = RINGS - 2; i >= 0; i--) {
        const struct sum *in = &sums->discs[i + 1], *ring = &sums->rings[i];
        sums->discs[i] = (struct sum){in->all + ring->all, in->x + ring->x, in->y + ring->y,
                                      in->squares + ring->squares};
    }
}

static double plane_of(const struct sum *sum, const struct shape *shape)
{
    return (sum->all - shape->a * sum->x - shape->b * sum->y) / shape->plane;
}

/*
 * Returns how far ring and disc agree, from 1 to 0, as two samples of one density with the scatter
 * of both. step: number of comparisons before this one.
 */
static double agreement(const struct sums *sums, const struct shapes *shapes, int at, int step)
{
    const struct sum *disc = &sums->discs[at + 1], *ring = &sums->rings[at];
    const struct shape *in = &shapes->discs[at + 1], *out = &shapes->rings[at];
    const double luma = disc->all + ring->all;
    if (!(out->room > 1e-6 * in->room) || !(in->room > 0) || !(luma > 0) || !(in->plane > 0) ||
        !(out->plane > 0))
        return 1;
    const double density = luma / (in->room + out->room);
    const double a_photon = (disc->squares + ring->squares) / luma;
    const double variance = density * a_photon * (1 / in->plane + 1 / out->plane);
    const double enough = sqrt(variance) * (step < NOISE_FACTORS ? noise_factors[step] : 1);
    const double off = fabs(plane_of(ring, out) - plane_of(disc, in)) / enough;
    const double x = orl_smaller(orl_larger((differs - off) / (differs - agrees), 0), 1);
    return x * x * (3 - 2 * x);
}

/*
 * Returns a value between the disc's mean and its plane, by their difference relative to its
 * scatter. In even light the mean is far less noisy; where light falls off towards a wall it is
 * biased.
 */
static double value_of(const struct sum *disc, const struct shape *shape, double *ret_plane)
{
    const double level = disc->all / shape->level;
    *ret_plane = 0;
    if (!(shape->room >= shape->level) || !(shape->plane > 0))
        return orl_larger(level, 0);
    const double off = plane_of(disc, shape) - level;
    const double variance = disc->squares / shape->level * (1 / shape->plane - 1 / shape->level);
    if (off * off > 0)
        *ret_plane = off * off / (off * off + variance);
    return orl_larger(level + *ret_plane * off, 0);
}

/* ---- Comparison of discs --------------------------------------------------------------------- */

/*
 * Returns the bias of a disc from the difference of two discs, on the assumption that bias is
 * proportional to area.
 */
static double bias_of(const struct shapes *shapes, const double values[RINGS], int disc, int one,
                      int other)
{
    const double a = shapes->discs[one].room, b = shapes->discs[other].room;
    return fabs(b - a) > 0.3 * orl_smaller(a, b)
               ? (values[other] - values[one]) * shapes->discs[disc].room / (b - a)
               : 0;
}

/*
 * Returns the bias if light is curved around the point. Then two pairs of neighbours among three
 * discs give similar values; this disc is the narrowest if there are two wider ones. Beside an
 * edge, or where a disc is off by chance, one of the pairs gives a small value: the lesser is
 * returned, and 0 if they have opposite signs.
 */
static double curve_of(const struct shapes *shapes, const double values[RINGS], int at)
{
    const int widest = at < 2 ? 0 : at - 2;
    if (widest + 2 > shapes->narrowest)
        return 0;
    const double wide = bias_of(shapes, values, at, widest + 1, widest);
    const double narrow = bias_of(shapes, values, at, widest + 2, widest + 1);
    return wide * narrow > 0 ? copysign(orl_smaller(fabs(wide), fabs(narrow)), wide) : 0;
}

static void blend_towards(struct blend *blend, const double values[RINGS], int to, double share)
{
    blend->value += share * (values[to] - blend->value);
    blend->radius += share * (exp2(-0.5 * to) - blend->radius);
    for (int i = 0; i < RINGS; i++)
        blend->weights[i] *= 1 - share;
    blend->weights[to] += share;
}

/* Starts with the smallest disc that is trusted, and moves outwards as far as rings agree. */
static struct blend blend_discs(const struct sums *sums, const struct shapes *shapes)
{
    double values[RINGS];
    int at = shapes->first, step = 0;
    struct blend blend = {.value = 0};
    for (int i = 0; i < RINGS; i++)
        values[i] = value_of(&sums->discs[i], &shapes->discs[i], &blend.planes[i]);
    blend_towards(&blend, values, at, 1);
    blend.curve = at == 0 ? curve_of(shapes, values, 0) : 0;
    for (double use = 1; at > 0 && use > 0; at--) {
        const double before = use;
        use *= agreement(sums, shapes, at - 1, step++);
        blend_towards(&blend, values, at - 1, use);
        blend.bias += before * bias_of(shapes, values, at, at, at - 1);
        blend.curve += before * curve_of(shapes, values, at);
        blend.bias *= 1 - use;
        blend.curve *= 1 - use;
        if (at == 1) {
            blend.bias += use * bias_of(shapes, values, 0, 0, 1);
            blend.curve += use * curve_of(shapes, values, 0);
        }
    }
    return blend;
}

static struct sums luma_of(const struct orl_nested_discs *rings)
{
    struct sums sums = {.rings = {{0}}};
    for (int i = 0; i < RINGS; i++) {
        const struct orl_nested_disc *ring = &rings->rings[i];
        for (int b = 0; b < ORL_MAP_BATCHES; b++) {
            sums.rings[i].all += (double)ring->flux_sums[b];
            sums.rings[i].x += (double)ring->by_x[b];
            sums.rings[i].y += (double)ring->by_y[b];
        }
        sums.rings[i].squares = (double)ring->flux_sums[ORL_FLUX_SUMS_SQUARES];
    }
    fill_discs(&sums);
    return sums;
}

/* Returns the sums of all batches but one, scaled to the whole. */
static struct sums sums_without_batch(const struct sums *all, const struct orl_nested_discs *rings,
                                      uint32_t batch)
{
    static const double factor = (double)ORL_MAP_BATCHES / (ORL_MAP_BATCHES - 1);
    struct sums sums;
    for (int i = 0; i < RINGS; i++) {
        const struct sum *ring = &all->rings[i];
        const struct orl_nested_disc *r = &rings->rings[i];
        sums.rings[i] =
            (struct sum){factor * orl_larger(ring->all - (double)r->flux_sums[batch], 0),
                         factor * (ring->x - (double)r->by_x[batch]),
                         factor * (ring->y - (double)r->by_y[batch]), factor * ring->squares};
    }
    fill_discs(&sums);
    return sums;
}

/* ---- Estimate -------------------------------------------------------------------------------- */

/* Returns the blend of discs for one colour channel. */
static double channel_of(const struct orl_nested_discs *rings, const struct shapes *shapes,
                         const struct blend *blend, int channel)
{
    struct sum disc = {.all = 0};
    double value = 0;
    for (int i = RINGS - 1; i >= 0; i--) {
        const struct orl_nested_disc *ring = &rings->rings[i];
        const struct shape *shape = &shapes->discs[i];
        disc.all += (double)ring->flux_sums[ORL_FLUX_SUMS_RGB + channel];
        disc.x += (double)ring->by_x[ORL_FLUX_SUMS_RGB + channel];
        disc.y += (double)ring->by_y[ORL_FLUX_SUMS_RGB + channel];
        const double level = disc.all / shape->level;
        const double plane = blend->planes[i] > 0 ? plane_of(&disc, shape) - level : 0;
        value += blend->weights[i] * orl_larger(level + blend->planes[i] * plane, 0);
    }
    return value;
}

/*
 * Subtracts the significant part of the curve; the rest of the bias is reported. In a dark place
 * surrounded by bright ones, where even the smallest disc is wide, the curve is most of the bias.
 */
static void subtract_curve(struct orl_density *density, const struct blend *whole,
                           struct orl_batches *value, const struct orl_batches *curve)
{
    const double square = whole->curve * whole->curve;
    const double chance = significant * significant * orl_batches_variance(curve);
    if (!(square > chance) || !(whole->value > 0))
        return;
    const double share =
        orl_smaller(1 - chance / square, most_subtracted * whole->value / fabs(whole->curve));
    density->irradiance =
        orl_rgb_scale(density->irradiance, 1 - share * whole->curve / whole->value);
    density->bias -= share * whole->curve;
    orl_batches_add(value, curve, -share);
}

/*
 * Computes the parts by batch as Tukey's pseudovalues: the rest without a batch is the estimate
 * from the other batches, with its own choice of discs. The parts add up to the whole.
 */
static void compute_batch_parts(const struct sums *all, const struct orl_nested_discs *rings,
                                const struct shapes *shapes, const struct blend *whole,
                                struct orl_density *density)
{
    static const double left = (ORL_MAP_BATCHES - 1.0) / ORL_MAP_BATCHES;
    struct orl_batches value, bias, curve;
    double mean_value = 0, mean_bias = 0, mean_curve = 0;
    for (uint32_t i = 0; i < ORL_MAP_BATCHES; i++) {
        const struct sums others = sums_without_batch(all, rings, i);
        const struct blend without = blend_discs(&others, shapes);
        value.luma[i] = -left * without.value;
        bias.luma[i] = -left * without.bias;
        curve.luma[i] = -left * without.curve;
        mean_value += value.luma[i] / ORL_MAP_BATCHES;
        mean_bias += bias.luma[i] / ORL_MAP_BATCHES;
        mean_curve += curve.luma[i] / ORL_MAP_BATCHES;
    }
    for (uint32_t i = 0; i < ORL_MAP_BATCHES; i++) {
        value.luma[i] += whole->value / ORL_MAP_BATCHES - mean_value;
        bias.luma[i] += whole->bias / ORL_MAP_BATCHES - mean_bias;
        curve.luma[i] += whole->curve / ORL_MAP_BATCHES - mean_curve;
    }
    density->bias = orl_batches_shrink(&bias);
    subtract_curve(density, whole, &value, &curve);
    density->parts = value;
}

/* Converts from the map's unit of flux to W. */
static void scale_by(struct orl_density *density, double unit)
{
    density->irradiance = orl_rgb_scale(density->irradiance, unit);
    density->bias *= unit;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        density->parts.luma[i] *= unit;
    density->standard_error = sqrt(orl_batches_variance(&density->parts));
}

static void count_health(const struct orl_leaf_sums *sums, const struct orl_density_query *query,
                         uint32_t found, struct orl_health *health)
{
    health->estimates++;
    if (found < ORL_SEARCH_SPARSE && found + 1 < query->k && found < sums->map->header->count)
        health->sparse++;
}

struct orl_density orl_adaptive_density_estimate(const struct orl_adaptive_density *adapt,
                                                 const struct orl_density_query *query,
                                                 struct orl_search *search)
{
    const struct orl_map_header *h = adapt->sums.map->header;
    struct orl_nested_discs rings;
    orl_nested_discs_gather(&adapt->sums, &adapt->order, query, SMALLEST, search, &rings);
    struct orl_density density = {.radius = rings.radius,
                                  .clearance = rings.clearance,
                                  .disc = rings.disc,
                                  .cut = rings.cut,
                                  .found = (uint32_t)lrint(rings.found)};
    density.unreliable = density.found < FEW && density.found < adapt->sums.map->header->count;
    if (density.found == 0)
        return density;
    count_health(&adapt->sums, query, density.found, &search->health);
    const struct shapes shapes = shapes_of(&rings, ORL_PI * h->cell * h->cell);
    const struct sums sums = luma_of(&rings);
    const struct blend blend = blend_discs(&sums, &shapes);
    density.irradiance = (struct orl_rgb){channel_of(&rings, &shapes, &blend, 0),
                                          channel_of(&rings, &shapes, &blend, 1),
                                          channel_of(&rings, &shapes, &blend, 2)};
    density.radius = rings.radius * blend.radius;
    density.evenness = blend.radius;
    density.clearance = orl_smaller(rings.clearance, density.radius);
    compute_batch_parts(&sums, &rings, &shapes, &blend, &density);
    scale_by(&density, h->flux_unit);
    return density;
}

static int compare_radii(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double find_reach(const struct orl_adaptive_density *adapt, double widest,
                         struct orl_search *search)
{
    enum { PROBES = 128 };
    const struct orl_photon_map *map = adapt->sums.map;
    const uint64_t count = map->header->count;
    const double cell = map->header->cell, most = widest / cell;
    double radii[PROBES];
    if (count == 0)
        return widest;
    for (uint32_t i = 0; i < PROBES; i++) {
        const struct orl_photon p = orl_photon_map_get(map, count * i / PROBES);
        const struct orl_density_query query = {
            .point = orl_v3(p.position[0], p.position[1], p.position[2]),
            .normal = orl_normal_decode(p.normal),
            .k = ORL_ADAPTIVE_DENSITY_MOST,
            .max_radius = widest};
        struct orl_disc_search disc_search = orl_disc_search_of(&adapt->sums, &query, search);
        const float first2 = orl_disc_search_first_radius2(&disc_search, &adapt->order);
        radii[i] =
            sqrt((double)orl_disc_search_find(&disc_search, first2, (float)(most * most))) * cell;
    }
    qsort(radii, PROBES, sizeof *radii, compare_radii);
    return orl_smaller(2 * radii[3 * PROBES / 4], widest);
}

int orl_adaptive_density_init(struct orl_adaptive_density *adapt, const struct orl_photon_map *map,
                              double widest, struct orl_thread_pool *pool,
                              struct orl_search *search)
{
    *adapt = (struct orl_adaptive_density){.reach = 0};
    int code = orl_leaf_sums_init(&adapt->sums, map, pool);
    if (code == 0)
        code = orl_zorder_init(&adapt->order, map);
    if (code < 0) {
        orl_adaptive_density_done(adapt);
        return code;
    }
    adapt->reach = find_reach(adapt, widest, search);
    return 0;
}

void orl_adaptive_density_done(struct orl_adaptive_density *adapt)
{
    orl_leaf_sums_done(&adapt->sums);
    orl_zorder_done(&adapt->order);
}
