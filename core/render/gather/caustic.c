/* The caustic part, by density. */
#include <stdlib.h>

#include "render/gather/gather.h"

enum { WIDTH_PROBES = 31 };

/* A disc is made anew where what is normal is less than this share of its radius. */
static const double much_wider = 0.8;

static struct orl_density_query caustic_query(const struct orl_gather *gather,
                                              const struct orl_footing *footing, uint32_t k)
{
    return (struct orl_density_query){.point = footing->point,
                                      .normal = footing->normal,
                                      .k = k,
                                      .max_radius = gather->max_radius[ORL_MAP_CAUSTIC],
                                      .footing = footing};
}

struct orl_density orl_gather_caustic_by(const struct orl_gather *gather,
                                         const struct orl_footing *footing, uint32_t k,
                                         struct orl_search *search)
{
    const struct orl_density_query query = caustic_query(gather, footing, k);
    return gather->maps[ORL_MAP_CAUSTIC]
               ? orl_density_estimate(gather->maps[ORL_MAP_CAUSTIC], &query, search)
               : (struct orl_density){.found = 0};
}

struct orl_density orl_gather_caustic(const struct orl_gather *gather,
                                      const struct orl_footing *footing, struct orl_search *search)
{
    return orl_gather_caustic_by(gather, footing, gather->k[ORL_MAP_CAUSTIC], search);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The median radius of the photons that a search has left: of some of them. */
static double normal_radius(const struct orl_kernel_density *widths,
                            const struct orl_search *search, uint32_t found)
{
    double radii[WIDTH_PROBES];
    const uint32_t n = found < WIDTH_PROBES ? found : WIDTH_PROBES;
    for (uint32_t i = 0; i < n; i++)
        radii[i] =
            orl_kernel_density_radius(widths, search->candidates[(uint64_t)found * i / n].index);
    qsort(radii, n, sizeof *radii, compare_doubles);
    return radii[n / 2];
}

struct orl_density orl_gather_caustic_seen(const struct orl_gather *gather,
                                           const struct orl_footing *footing,
                                           struct orl_search *search)
{
    struct orl_density density = orl_gather_caustic(gather, footing, search);
    if (!gather->caustic_widths || density.found == 0)
        return density;
    const double radius = normal_radius(gather->caustic_widths, search, density.found);
    if (radius > much_wider * density.radius)
        return density;
    struct orl_density_query query = caustic_query(gather, footing, gather->k[ORL_MAP_CAUSTIC]);
    const struct orl_health before = search->health;
    query.max_radius = radius;
    density = orl_density_estimate(gather->maps[ORL_MAP_CAUSTIC], &query, search);
    search->health = before; /* it is no estimate of its own */
    return density;
}

struct orl_density orl_gather_caustic_with_bias(const struct orl_gather *gather,
                                                const struct orl_footing *footing,
                                                struct orl_search *search)
{
    const struct orl_density_query query =
        caustic_query(gather, footing, gather->k[ORL_MAP_CAUSTIC]);
    struct orl_density density = orl_gather_caustic(gather, footing, search);
    if (density.found > 0)
        density.bias = orl_density_bias(gather->maps[ORL_MAP_CAUSTIC], &query, &density, search);
    return density;
}
