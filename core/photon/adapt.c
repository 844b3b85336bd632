#include "photon/adapt.h"

#include <stdlib.h>
#include <string.h>

#include "photon/flux.h"
#include "photon/moments.h"
#include "photon/pack.h"

/*
 * The smallest disc is the one that would hold 256 photons, were light even. It is not chosen by
 * the photons found in it, for that would choose those with too many. Only where it is all but
 * empty, beside something far brighter, the next one is taken.
 */
enum { RINGS = 12, SMALLEST = 256, LEAST = 8 };

/* In standard deviations of ring minus disc: full agreement up to the first, none from the last. */
static const double agrees = 1.25, differs = 3.25;

/* A curve is taken out in so far as it is beyond that many standard deviations of its own... */
static const double surely = 2;
/* ... and up to this share of what there is. */
static const double most_taken = 1.0 / 3;

/*
 * Of the smallest discs a picture holds thousands, so that some disagree by chance alone and would
 * be left alone with their noise, as specks. The first comparisons ask for so many times that much.
 */
enum { DOUBTED = 2 };
static const double doubt[DOUBTED] = {1.4, 1.2};

/* Photons of a ring, or of a disc: as far as the surface goes. */
struct ring {
    struct orl_rgb all, by_x, by_y; /* sums of fluxes, and of fluxes times either coordinate */
    double squares;                 /* of the photons' luma */
    struct orl_moments room;
    uint32_t found;
};

/* The same sums, of luma, by batch. */
struct batch_ring {
    struct orl_batches all, by_x, by_y, squares;
};

/* Values at the point, W/m2, and the area that as certain a mean would take. */
struct reading {
    struct orl_rgb value;
    double area;
};

static void add(struct ring *sum, const struct ring *part)
{
    sum->all = orl_rgb_add(sum->all, part->all);
    sum->by_x = orl_rgb_add(sum->by_x, part->by_x);
    sum->by_y = orl_rgb_add(sum->by_y, part->by_y);
    sum->squares += part->squares;
    sum->room = orl_moments_add(&sum->room, &part->room, 1);
    sum->found += part->found;
}

/* Ring 0 lies between the whole radius and 1 / sqrt 2 of it, and so on inwards. */
static int ring_of(double share2)
{
    int exponent;
    frexp(share2, &exponent);
    if (!(share2 > 0) || exponent <= -RINGS)
        return RINGS - 1;
    return exponent < 0 ? -exponent : 0;
}

static void take_photon(const struct orl_photon_map *map, const struct orl_neighbourhood *n,
                        struct orl_vec3 point, uint32_t index, struct ring *ring,
                        struct batch_ring *by_batch)
{
    const struct orl_rgb flux =
        orl_rgb_scale(orl_flux_unpack(map->fluxes[index]), map->header->flux_unit);
    const double luma = orl_luma(flux);
    const uint32_t batch = orl_photon_batch(map, index);
    ring->all = orl_rgb_add(ring->all, flux);
    ring->squares += luma * luma;
    ring->found++;
    by_batch->all.luma[batch] += luma;
    by_batch->squares.luma[batch] += luma * luma;
    if (!n->cut)
        return;
    const struct orl_photon p = orl_photon_map_get(map, index);
    const struct orl_vec3 chord =
        orl_sub(orl_v3(p.position[0], p.position[1], p.position[2]), point);
    const double x = orl_dot(chord, n->footprint.frame.u);
    const double y = orl_dot(chord, n->footprint.frame.v);
    ring->by_x = orl_rgb_add(ring->by_x, orl_rgb_scale(flux, x));
    ring->by_y = orl_rgb_add(ring->by_y, orl_rgb_scale(flux, y));
    by_batch->by_x.luma[batch] += luma * x;
    by_batch->by_y.luma[batch] += luma * y;
}

static void fill_rings(const struct orl_photon_map *map, const struct orl_search *search,
                       const struct orl_neighbourhood *n, struct orl_vec3 point,
                       struct ring rings[RINGS], struct batch_ring by_batch[RINGS])
{
    const double radius = n->radius / map->header->cell, inverse2 = 1 / (radius * radius);
    struct orl_moments inner = {0};
    memset(rings, 0, RINGS * sizeof *rings);
    memset(by_batch, 0, RINGS * sizeof *by_batch);
    for (uint32_t i = 0; i < n->found; i++) {
        const struct orl_search_candidate *c = &search->candidates[i];
        const int ring = ring_of((double)c->distance2 * inverse2);
        take_photon(map, n, point, c->index, &rings[ring], &by_batch[ring]);
    }
    for (int i = RINGS - 1; i >= 0; i--) {
        const double r = n->radius * exp2(-0.5 * i);
        const struct orl_moments disc =
            n->cut ? orl_footprint_moments(&n->footprint, r) : orl_disc_moments(r);
        rings[i].room = orl_moments_add(&disc, &inner, -1);
        inner = disc;
    }
}

/* The mean over the ring. */
static struct reading read_level(const struct ring *ring, double area)
{
    return (struct reading){orl_rgb_scale(ring->all, 1 / area), area};
}

/*
 * The value at the point of the plane that fits best. Its weights, (1 - a x - b y) / area, have no
 * first moment; in even light it scatters as a mean over `area` does. Where the ring is too
 * narrow to tell a slope the plane is held level.
 */
static struct reading read_plane(const struct ring *ring)
{
    const struct orl_moments *m = &ring->room;
    const double held = 2e-3 * (m->xx + m->yy), xx = m->xx + held, yy = m->yy + held;
    const double determinant = xx * yy - m->xy * m->xy;
    const double a = (yy * m->x - m->xy * m->y) / determinant;
    const double b = (xx * m->y - m->xy * m->x) / determinant;
    struct reading plane = read_level(ring, m->area - a * m->x - b * m->y);
    plane.value = orl_rgb_add(plane.value, orl_rgb_scale(ring->by_x, -a / plane.area));
    plane.value = orl_rgb_add(plane.value, orl_rgb_scale(ring->by_y, -b / plane.area));
    return plane;
}

static double luma_of(const struct reading *reading)
{
    return orl_luma(reading->value);
}

/* From one value to another, by a share of the way. */
static struct orl_rgb move_on(struct orl_rgb value, struct orl_rgb to, double share)
{
    return orl_rgb_add(orl_rgb_scale(value, 1 - share), orl_rgb_scale(to, share));
}

/*
 * How far ring and disc agree, from 1 to 0: as two draws of one density, by the scatter of both.
 * Step is how many comparisons came before.
 */
static double agreement(const struct ring *disc, const struct ring *ring, int step)
{
    const double luma = orl_luma(disc->all) + orl_luma(ring->all);
    if (!(ring->room.area > 1e-6 * disc->room.area) || !(disc->room.area > 0) || !(luma > 0))
        return 1;
    const struct reading in = read_plane(disc), out = read_plane(ring);
    if (!(in.area > 0) || !(out.area > 0))
        return 1;
    const double density = luma / (disc->room.area + ring->room.area);
    const double a_photon = (disc->squares + ring->squares) / luma;
    const double variance = density * a_photon * (1 / in.area + 1 / out.area);
    const double enough = sqrt(variance) * (step < DOUBTED ? doubt[step] : 1);
    const double off = fabs(luma_of(&out) - luma_of(&in)) / enough;
    const double x = fmin(fmax((differs - off) / (differs - agrees), 0), 1);
    return x * x * (3 - 2 * x);
}

/*
 * From mean to plane by how far the two are apart, against what chance does: where light is even
 * the mean is far quieter, and where it falls off towards a wall it is off.
 */
static struct reading estimate_of(const struct ring *disc, double least_area)
{
    struct reading level = read_level(disc, fmax(disc->room.area, least_area));
    if (!(disc->room.area > least_area))
        return level;
    const struct reading plane = read_plane(disc);
    const double off = luma_of(&plane) - luma_of(&level);
    const double variance = disc->squares / level.area * (1 / plane.area - 1 / level.area);
    if (off * off > 0 && plane.area > 0)
        level.value = move_on(level.value, plane.value, off * off / (off * off + variance));
    const struct orl_rgb value = level.value;
    level.value = (struct orl_rgb){fmax(value.r, 0), fmax(value.g, 0), fmax(value.b, 0)};
    return level;
}

/* ---- From disc to disc ----------------------------------------------------------------------- */

struct blend {
    struct orl_rgb value;
    double bias;   /* of its luma */
    double curve;  /* what of that is a curve of the light's, if it is */
    double radius; /* over that of the widest disc */
};

/* A disc: what is read of it, and how large it is. */
struct disc {
    struct reading reading;
    double area;
};

/*
 * The bias of a disc is taken to be in proportion to its area: then what a pair of others, or it
 * and another, differ by tells it.
 */
static double bias_of(const struct disc *disc, const struct disc *one, const struct disc *other)
{
    const double more = other->area - one->area;
    return fabs(more) > 0.3 * fmin(one->area, other->area)
               ? (luma_of(&other->reading) - luma_of(&one->reading)) * disc->area / more
               : 0;
}

/*
 * The same where light is curved about the point: then two pairs of neighbours among three discs,
 * this one the narrowest if there are two wider, tell it alike. Beside an edge, or where a disc is
 * off by chance, one of the pairs sees little: the lesser is taken, and nothing where they
 * contradict each other.
 */
static double curve_of(const struct disc discs[RINGS], int at, int narrowest)
{
    const int widest = at < 2 ? 0 : at - 2;
    if (widest + 2 > narrowest)
        return 0;
    const double wide = bias_of(&discs[at], &discs[widest + 1], &discs[widest]);
    const double narrow = bias_of(&discs[at], &discs[widest + 2], &discs[widest + 1]);
    return wide * narrow > 0 ? copysign(fmin(fabs(wide), fabs(narrow)), wide) : 0;
}

/* Sums over discs, and what is read of them, from the narrowest that is not all but empty: which
 * is returned. */
static int fill_discs(const struct ring rings[RINGS], double least_area, struct ring sums[RINGS],
                      struct disc discs[RINGS])
{
    struct ring sum = {.found = 0};
    int narrowest = RINGS - 1;
    for (int i = RINGS - 1; i >= 0; i--) {
        add(&sum, &rings[i]);
        if (sum.found < LEAST)
            narrowest = i > 0 ? i - 1 : 0;
        if (sum.found >= LEAST || i == 0)
            discs[i] = (struct disc){estimate_of(&sum, least_area), sum.room.area};
        sums[i] = sum;
    }
    return narrowest;
}

/* From the smallest disc that is trusted outwards, as far as rings agree. */
static struct blend blend_discs(const struct ring rings[RINGS], uint32_t found, double least_area)
{
    struct ring sums[RINGS];
    struct disc discs[RINGS];
    const int narrowest = fill_discs(rings, least_area, sums, discs);
    int ring = 0, step = 0;
    for (uint32_t even = found; even >= 2 * SMALLEST && ring < narrowest; even /= 2)
        ring++;
    struct blend blend = {.value = discs[ring].reading.value,
                          .curve = ring == 0 ? curve_of(discs, 0, narrowest) : 0,
                          .radius = exp2(-0.5 * ring)};
    for (double use = 1; ring > 0 && use > 0; ring--) {
        const double before = use;
        use *= agreement(&sums[ring], &rings[ring - 1], step++);
        blend.value = move_on(blend.value, discs[ring - 1].reading.value, use);
        blend.radius += use * (exp2(-0.5 * (ring - 1)) - blend.radius);
        blend.bias += before * bias_of(&discs[ring], &discs[ring], &discs[ring - 1]);
        blend.curve += before * curve_of(discs, ring, narrowest);
        blend.bias *= 1 - use;
        blend.curve *= 1 - use;
        if (ring == 1) {
            blend.bias += use * bias_of(&discs[0], &discs[0], &discs[1]);
            blend.curve += use * curve_of(discs, 0, narrowest);
        }
    }
    return blend;
}

/* What the rings' luma would be by all batches but one, which the others stand for. */
static void leave_out(const struct ring rings[RINGS], const struct batch_ring by_batch[RINGS],
                      uint32_t batch, struct ring ret_rings[RINGS])
{
    static const double factor = (double)ORL_MAP_BATCHES / (ORL_MAP_BATCHES - 1);
    for (int i = 0; i < RINGS; i++) {
        const struct ring *ring = &rings[i];
        const struct batch_ring *b = &by_batch[i];
        const double all = orl_luma(ring->all) - b->all.luma[batch];
        const double by_x = orl_luma(ring->by_x) - b->by_x.luma[batch];
        const double by_y = orl_luma(ring->by_y) - b->by_y.luma[batch];
        const double squares = ring->squares - b->squares.luma[batch];
        ret_rings[i] = (struct ring){.all = orl_gray(factor * fmax(all, 0)),
                                     .by_x = orl_gray(factor * by_x),
                                     .by_y = orl_gray(factor * by_y),
                                     .squares = factor * factor * fmax(squares, 0),
                                     .room = ring->room,
                                     .found = ring->found};
    }
}

/*
 * Takes out what chance can hardly have made of the curve; the rest of the bias is told. In a dark
 * place amid bright ones, where even the smallest disc is wide, it is most of it.
 */
static void take_curve_out(struct orl_density *density, const struct blend *whole,
                           struct orl_batches *value, const struct orl_batches *curve)
{
    const double luma = orl_luma(whole->value), square = whole->curve * whole->curve;
    const double chance = surely * surely * orl_batches_variance(curve);
    if (!(square > chance) || !(luma > 0))
        return;
    const double share = fmin(1 - chance / square, most_taken * luma / fabs(whole->curve));
    density->irradiance = orl_rgb_scale(whole->value, 1 - share * whole->curve / luma);
    density->bias -= share * whole->curve;
    orl_batches_add(value, curve, -share);
}

/*
 * The batches' parts, such that what is left without one of them is what the others alone would
 * make of it, choice of discs and all (Tukey's pseudovalues), and their sum the whole.
 */
static void part_by_batch(const struct ring rings[RINGS], const struct batch_ring by_batch[RINGS],
                          const struct blend *whole, double least_area, struct orl_density *density)
{
    static const double left = (ORL_MAP_BATCHES - 1.0) / ORL_MAP_BATCHES;
    struct orl_batches value, bias, curve;
    double mean_value = 0, mean_bias = 0, mean_curve = 0;
    for (uint32_t i = 0; i < ORL_MAP_BATCHES; i++) {
        struct ring others[RINGS];
        leave_out(rings, by_batch, i, others);
        const struct blend without = blend_discs(others, density->found, least_area);
        value.luma[i] = -left * orl_luma(without.value);
        bias.luma[i] = -left * without.bias;
        curve.luma[i] = -left * without.curve;
        mean_value += value.luma[i] / ORL_MAP_BATCHES;
        mean_bias += bias.luma[i] / ORL_MAP_BATCHES;
        mean_curve += curve.luma[i] / ORL_MAP_BATCHES;
    }
    for (uint32_t i = 0; i < ORL_MAP_BATCHES; i++) {
        value.luma[i] += orl_luma(whole->value) / ORL_MAP_BATCHES - mean_value;
        bias.luma[i] += whole->bias / ORL_MAP_BATCHES - mean_bias;
        curve.luma[i] += whole->curve / ORL_MAP_BATCHES - mean_curve;
    }
    density->bias = orl_batches_beyond_scatter(&bias);
    take_curve_out(density, whole, &value, &curve);
    density->parts = value;
    density->standard_error = sqrt(orl_batches_variance(&value));
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double orl_adapt_reach(const struct orl_photon_map *map, double widest, struct orl_search *search)
{
    enum { PROBES = 128 };
    const uint64_t count = map->header->count;
    double radii[PROBES];
    if (count == 0)
        return widest;
    for (uint32_t i = 0; i < PROBES; i++) {
        const struct orl_photon p = orl_photon_map_get(map, count * i / PROBES);
        const struct orl_density_query query = {
            .point = orl_v3(p.position[0], p.position[1], p.position[2]),
            .normal = orl_normal_decode(p.normal),
            .k = ORL_ADAPT_MOST,
            .max_radius = widest};
        orl_density_nearest(map, &query, search, &radii[i]);
    }
    qsort(radii, PROBES, sizeof *radii, compare);
    return fmin(2 * radii[3 * PROBES / 4], widest);
}

struct orl_density orl_adapt_estimate(const struct orl_photon_map *map,
                                      const struct orl_density_query *query,
                                      struct orl_search *search)
{
    struct orl_neighbourhood n;
    struct ring rings[RINGS];
    struct batch_ring by_batch[RINGS];
    orl_density_neighbourhood(map, query, SMALLEST, search, &n);
    struct orl_density density = {.radius = n.radius, .clear = n.clear, .found = n.found};
    if (n.found == 0)
        return density;
    fill_rings(map, search, &n, query->point, rings, by_batch);
    const double least_area = ORL_PI * map->header->cell * map->header->cell;
    const struct blend blend = blend_discs(rings, n.found, least_area);
    density.irradiance = blend.value;
    density.radius = n.radius * blend.radius;
    density.clear = fmin(n.clear, density.radius);
    part_by_batch(rings, by_batch, &blend, least_area, &density);
    return density;
}
