#include "photon/adapt.h"

#include <stdlib.h>

#include "photon/flux.h"
#include "photon/pack.h"

/*
 * The smallest disc is the one that would hold 256 photons, were light even. It is not chosen by
 * the photons found in it, for that would choose those with too many. Only where it is all but
 * empty, beside something far brighter, the next one is taken.
 */
enum { RINGS = 12, SMALLEST = 256, LEAST = 8 };

/* In standard deviations of ring minus disc: full agreement up to the first, none from the last. */
static const double agrees = 1.25, differs = 3.25;

/* Photons of a ring, or of a disc. */
struct ring {
    struct orl_rgb flux;
    double luma, squares;     /* sums of the photons' luma and of its squares */
    struct orl_batches parts; /* of the luma */
    double area;
    uint32_t found;
};

static void add(struct ring *sum, const struct ring *part)
{
    sum->flux = orl_rgb_add(sum->flux, part->flux);
    sum->luma += part->luma;
    sum->squares += part->squares;
    orl_batches_add(&sum->parts, &part->parts, 1);
    sum->area += part->area;
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

static void fill_rings(const struct orl_photon_map *map, const struct orl_search *search,
                       const struct orl_neighbourhood *n, struct ring rings[RINGS])
{
    const double radius = n->radius / map->header->cell, unit = map->header->flux_unit;
    const double inverse2 = 1 / (radius * radius);
    double outer = 0;
    for (int i = 0; i < RINGS; i++)
        rings[i] = (struct ring){.luma = 0};
    for (uint32_t i = 0; i < n->found; i++) {
        const struct orl_search_candidate *c = &search->candidates[i];
        const struct orl_rgb flux = orl_rgb_scale(orl_flux_unpack(map->fluxes[c->index]), unit);
        const double luma = orl_luma(flux);
        struct ring *ring = &rings[ring_of((double)c->distance2 * inverse2)];
        ring->flux = orl_rgb_add(ring->flux, flux);
        ring->luma += luma;
        ring->squares += luma * luma;
        ring->parts.luma[orl_photon_batch(map, c->index)] += luma;
        ring->found++;
    }
    for (int i = RINGS - 1; i >= 0; i--) {
        const double r = n->radius * exp2(-0.5 * i);
        const double area = n->cut ? orl_footprint_area(&n->footprint, r) : ORL_PI * r * r;
        rings[i].area = fmax(area - outer, 0);
        outer = fmax(outer, area);
    }
}

/* How far ring and disc agree, from 1 to 0: as two draws of one density, by the scatter of both. */
static double agreement(const struct ring *disc, const struct ring *ring)
{
    const double luma = disc->luma + ring->luma;
    if (!(ring->area > 1e-6 * disc->area) || !(luma > 0))
        return 1;
    const double density = luma / (disc->area + ring->area);
    const double a_photon = (disc->squares + ring->squares) / luma;
    const double variance = density * a_photon * (1 / disc->area + 1 / ring->area);
    const double off = fabs(ring->luma / ring->area - disc->luma / disc->area) / sqrt(variance);
    const double x = fmin(fmax((differs - off) / (differs - agrees), 0), 1);
    return x * x * (3 - 2 * x);
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
    struct ring rings[RINGS], disc = {.luma = 0};
    orl_density_neighbourhood(map, query, SMALLEST, search, &n);
    struct orl_density density = {.radius = n.radius, .clear = n.clear, .found = n.found};
    if (n.found == 0)
        return density;
    fill_rings(map, search, &n, rings);
    const double cell2 = ORL_PI * map->header->cell * map->header->cell;
    int ring = RINGS, smallest = 0;
    for (uint32_t even = n.found; even >= 2 * SMALLEST && smallest < RINGS - 1; even /= 2)
        smallest++;
    while (ring > 0 && (ring > smallest || disc.found < LEAST))
        add(&disc, &rings[--ring]);
    density.irradiance = orl_rgb_scale(disc.flux, 1 / fmax(disc.area, cell2));
    orl_batches_add(&density.parts, &disc.parts, 1 / fmax(disc.area, cell2));
    density.radius = n.radius * exp2(-0.5 * ring);
    for (double use = 1; ring > 0 && use > 0;) {
        use *= agreement(&disc, &rings[--ring]);
        add(&disc, &rings[ring]);
        const struct orl_rgb wider = orl_rgb_scale(disc.flux, 1 / fmax(disc.area, cell2));
        density.irradiance =
            orl_rgb_add(orl_rgb_scale(density.irradiance, 1 - use), orl_rgb_scale(wider, use));
        orl_batches_add(&density.parts, &density.parts, -use);
        orl_batches_add(&density.parts, &disc.parts, use / fmax(disc.area, cell2));
        density.radius += use * (n.radius * exp2(-0.5 * ring) - density.radius);
    }
    density.clear = fmin(n.clear, density.radius);
    density.standard_error = sqrt(orl_batches_variance(&density.parts));
    return density;
}
