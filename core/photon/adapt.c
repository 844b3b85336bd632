#include "photon/adapt.h"

#include <stdlib.h>

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

/* Photons' sums, by colour, and of their luma by batch. */
struct sums {
    struct orl_rgb flux;
    struct orl_batches parts;
};

/* Photons of a ring, or of a disc: as far as the surface goes. */
struct ring {
    struct sums all, by_x, by_y; /* of fluxes, and of fluxes times either coordinate */
    double squares;              /* of the photons' luma */
    struct orl_moments room;
    uint32_t found;
};

/* Values at the point, W/m2, and the area that as certain a mean would take. */
struct reading {
    struct sums value;
    double area;
};

static void add_sums(struct sums *sum, const struct sums *more, double factor)
{
    sum->flux = orl_rgb_add(sum->flux, orl_rgb_scale(more->flux, factor));
    orl_batches_add(&sum->parts, &more->parts, factor);
}

static void add_photon(struct sums *sum, struct orl_rgb flux, uint32_t batch)
{
    sum->flux = orl_rgb_add(sum->flux, flux);
    sum->parts.luma[batch] += orl_luma(flux);
}

static void add(struct ring *sum, const struct ring *part)
{
    add_sums(&sum->all, &part->all, 1);
    add_sums(&sum->by_x, &part->by_x, 1);
    add_sums(&sum->by_y, &part->by_y, 1);
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
                        struct orl_vec3 point, uint32_t index, struct ring *ring)
{
    const struct orl_rgb flux =
        orl_rgb_scale(orl_flux_unpack(map->fluxes[index]), map->header->flux_unit);
    const uint32_t batch = orl_photon_batch(map, index);
    add_photon(&ring->all, flux, batch);
    ring->squares += orl_luma(flux) * orl_luma(flux);
    ring->found++;
    if (!n->cut)
        return;
    const struct orl_photon p = orl_photon_map_get(map, index);
    const struct orl_vec3 chord =
        orl_sub(orl_v3(p.position[0], p.position[1], p.position[2]), point);
    const struct orl_frame *frame = &n->footprint.frame;
    add_photon(&ring->by_x, orl_rgb_scale(flux, orl_dot(chord, frame->u)), batch);
    add_photon(&ring->by_y, orl_rgb_scale(flux, orl_dot(chord, frame->v)), batch);
}

static void fill_rings(const struct orl_photon_map *map, const struct orl_search *search,
                       const struct orl_neighbourhood *n, struct orl_vec3 point,
                       struct ring rings[RINGS])
{
    const double radius = n->radius / map->header->cell, inverse2 = 1 / (radius * radius);
    struct orl_moments inner = {0};
    for (int i = 0; i < RINGS; i++)
        rings[i] = (struct ring){.found = 0};
    for (uint32_t i = 0; i < n->found; i++) {
        const struct orl_search_candidate *c = &search->candidates[i];
        take_photon(map, n, point, c->index, &rings[ring_of((double)c->distance2 * inverse2)]);
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
    struct reading level = {.area = area};
    add_sums(&level.value, &ring->all, 1 / area);
    return level;
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
    add_sums(&plane.value, &ring->by_x, -a / plane.area);
    add_sums(&plane.value, &ring->by_y, -b / plane.area);
    return plane;
}

static double luma_of(const struct reading *reading)
{
    return orl_luma(reading->value.flux);
}

/* Moves on to another reading, by a share of the way. */
static void move_on(struct reading *reading, const struct reading *to, double share)
{
    add_sums(&reading->value, &reading->value, -share);
    add_sums(&reading->value, &to->value, share);
}

/* How far ring and disc agree, from 1 to 0: as two draws of one density, by the scatter of both. */
static double agreement(const struct ring *disc, const struct ring *ring)
{
    const double luma = orl_luma(disc->all.flux) + orl_luma(ring->all.flux);
    if (!(ring->room.area > 1e-6 * disc->room.area) || !(disc->room.area > 0) || !(luma > 0))
        return 1;
    const struct reading in = read_plane(disc), out = read_plane(ring);
    if (!(in.area > 0) || !(out.area > 0))
        return 1;
    const double density = luma / (disc->room.area + ring->room.area);
    const double a_photon = (disc->squares + ring->squares) / luma;
    const double variance = density * a_photon * (1 / in.area + 1 / out.area);
    const double off = fabs(luma_of(&out) - luma_of(&in)) / sqrt(variance);
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
        move_on(&level, &plane, off * off / (off * off + variance));
    const struct orl_rgb value = level.value.flux;
    level.value.flux = (struct orl_rgb){fmax(value.r, 0), fmax(value.g, 0), fmax(value.b, 0)};
    return level;
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
    struct ring rings[RINGS], disc = {.found = 0};
    orl_density_neighbourhood(map, query, SMALLEST, search, &n);
    struct orl_density density = {.radius = n.radius, .clear = n.clear, .found = n.found};
    if (n.found == 0)
        return density;
    fill_rings(map, search, &n, query->point, rings);
    const double cell2 = ORL_PI * map->header->cell * map->header->cell;
    int ring = RINGS, smallest = 0;
    for (uint32_t even = n.found; even >= 2 * SMALLEST && smallest < RINGS - 1; even /= 2)
        smallest++;
    while (ring > 0 && (ring > smallest || disc.found < LEAST))
        add(&disc, &rings[--ring]);
    struct reading value = estimate_of(&disc, cell2);
    density.radius = n.radius * exp2(-0.5 * ring);
    for (double use = 1; ring > 0 && use > 0;) {
        use *= agreement(&disc, &rings[--ring]);
        add(&disc, &rings[ring]);
        const struct reading wider = estimate_of(&disc, cell2);
        move_on(&value, &wider, use);
        density.radius += use * (n.radius * exp2(-0.5 * ring) - density.radius);
    }
    density.irradiance = value.value.flux;
    density.parts = value.value.parts;
    density.clear = fmin(n.clear, density.radius);
    density.standard_error = sqrt(orl_batches_variance(&density.parts));
    return density;
}
