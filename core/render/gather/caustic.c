/* The caustic part, by density estimation. */
#include <stdlib.h>

#include "render/gather/gather.h"
#include "scene/geometry/geometry.h"

enum { WIDTH_PROBES = 31, BLUR_GROUPS = 16, BLUR_POINTS = 8 /* points in each group */ };

/* The estimate is repeated with a smaller disc if the normal radius is less than this share of its
 * radius. */
static const double much_wider = 0.8;

static struct orl_density_query caustic_query(const struct orl_gather *gather,
                                              const struct orl_surface_point *surface_point,
                                              uint32_t k)
{
    return (struct orl_density_query){.point = surface_point->point,
                                      .normal = surface_point->normal,
                                      .k = k,
                                      .max_radius = gather->max_radius[ORL_MAP_CAUSTIC],
                                      .surface_point = surface_point};
}

struct orl_density orl_gather_caustic_k(const struct orl_gather *gather,
                                        const struct orl_surface_point *surface_point, uint32_t k,
                                        struct orl_search *search)
{
    const struct orl_density_query query = caustic_query(gather, surface_point, k);
    return gather->maps[ORL_MAP_CAUSTIC]
               ? orl_density_estimate(gather->maps[ORL_MAP_CAUSTIC], &query, search)
               : (struct orl_density){.found = 0};
}

/* Returns the caustic part from the usual number of photons. */
static struct orl_density orl_gather_caustic(const struct orl_gather *gather,
                                             const struct orl_surface_point *surface_point,
                                             struct orl_search *search)
{
    return orl_gather_caustic_k(gather, surface_point, gather->k[ORL_MAP_CAUSTIC], search);
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the median kernel radius over some of the photons that a search has left. */
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

struct orl_density orl_gather_caustic_for_view(const struct orl_gather *gather,
                                               const struct orl_surface_point *surface_point,
                                               struct orl_search *search)
{
    struct orl_density density = orl_gather_caustic(gather, surface_point, search);
    if (!gather->caustic_kernels || density.found == 0)
        return density;
    const double radius = normal_radius(gather->caustic_kernels, search, density.found);
    if (radius > much_wider * density.radius)
        return density;
    struct orl_density_query query =
        caustic_query(gather, surface_point, gather->k[ORL_MAP_CAUSTIC]);
    const struct orl_health before = search->health;
    query.max_radius = radius;
    density = orl_density_estimate(gather->maps[ORL_MAP_CAUSTIC], &query, search);
    search->health = before; /* the repetition does not count as another estimate */
    return density;
}

struct orl_density orl_gather_caustic_with_bias(const struct orl_gather *gather,
                                                const struct orl_surface_point *surface_point,
                                                struct orl_search *search)
{
    const struct orl_density_query query =
        caustic_query(gather, surface_point, gather->k[ORL_MAP_CAUSTIC]);
    struct orl_density density = orl_gather_caustic(gather, surface_point, search);
    if (density.found > 0)
        density.bias = orl_density_bias(gather->maps[ORL_MAP_CAUSTIC], &query, &density, search);
    return density;
}

/* A disc whose points see the images of suns. */
struct blur_disc {
    const struct orl_gather *gather;
    const struct orl_surface_point *surface_point;
    struct orl_footprint footprint;
    double radius;
};

/* Returns the light of suns in flat mirrors at a point of the surface. */
static struct orl_rgb virtual_suns_at(const struct blur_disc *disc, struct orl_vec3 point,
                                      double *u)
{
    const struct orl_direct_query query = {
        .point = orl_offset_from_surface(disc->gather->lit_scene->geometry, point,
                                         disc->surface_point->normal),
        .normal = disc->surface_point->normal,
        .through_ports = true,
        .mirrored = true,
        .u = u};
    struct orl_random unused = {0}; /* never read: the query has its own numbers */
    return orl_direct_by_virtual_suns(disc->gather->lit_scene, &query, &unused);
}

/* Returns the mean excess of a group of points. The disc's centre is evaluated with the same sample
 * of the sun's disc, so that under uniform light the difference has no noise. */
static struct orl_rgb blur_of_group(const struct blur_disc *disc, uint32_t sequence, uint32_t group,
                                    struct orl_virtual_sun_blur *blur)
{
    struct orl_rgb sum = orl_gray(0);
    double u[4];
    uint32_t n = 0;
    for (uint32_t i = 0; i < BLUR_POINTS; i++) {
        orl_sobol_point(&disc->gather->sobol, i, sequence + group * 0x9e3779b9U, 4, u);
        const double r = disc->radius * sqrt(u[2]), turn = 2 * ORL_PI * u[3];
        const struct orl_frame *frame = &disc->footprint.frame;
        const struct orl_vec3 chord =
            orl_add(orl_scale(frame->u, r * cos(turn)), orl_scale(frame->v, r * sin(turn)));
        if (!orl_footprint_contains(&disc->footprint, chord))
            continue;
        const struct orl_rgb there =
            virtual_suns_at(disc, orl_add(disc->surface_point->point, chord), u);
        const struct orl_rgb here = virtual_suns_at(disc, disc->surface_point->point, u);
        sum = orl_rgb_add(sum, orl_rgb_add(there, orl_rgb_scale(here, -1)));
        blur->mean += orl_luma(there);
        n++;
    }
    blur->found += n;
    return orl_rgb_scale(sum, n > 0 ? 1.0 / n : 0);
}

struct orl_virtual_sun_blur
orl_gather_virtual_sun_blur(const struct orl_gather *gather,
                            const struct orl_surface_point *surface_point, double radius,
                            uint32_t sequence)
{
    const struct orl_lit_scene *lit_scene = gather->lit_scene;
    struct blur_disc disc = {.gather = gather, .surface_point = surface_point, .radius = radius};
    struct orl_virtual_sun_blur blur = {.found = 0};
    struct orl_rgb groups[BLUR_GROUPS];
    if (lit_scene->images.n_nodes == 0 || lit_scene->omit.mirror_caustics ||
        !(orl_surface_point_flat_radius(surface_point) > 0))
        return blur;
    orl_footprint_make(surface_point, radius, &disc.footprint);
    for (uint32_t group = 0; group < BLUR_GROUPS; group++)
        groups[group] = blur_of_group(&disc, sequence, group, &blur);
    blur.excess = orl_estimate_of_mean(groups, BLUR_GROUPS);
    blur.mean /= blur.found > 0 ? blur.found : 1;
    return blur;
}
