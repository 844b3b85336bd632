#include "render/gather/gather.h"

#include <stdlib.h>

#include "photon/map/quantization.h"
#include "render/gather/sensor_flux.h"
#include "scene/built/scene.h"

enum { NEIGHBOURS_GLOBAL = 64, NEIGHBOURS_CAUSTIC = 300, NEIGHBOURS_RECORDS = 4 };
enum { RADIUS_PROBES = 256 };

/* Photons of a texel, as a share of an estimate's neighbours. */
static const double texel_share = 0.25;

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Returns the radius of k neighbours at the map's own photons, at a percentile over some of
 * them. */
static double typical_radius(const struct orl_photon_map *map, uint32_t k, double percentile,
                             double widest, struct orl_search *search)
{
    const uint64_t count = orl_photon_map_header(map)->count;
    double radii[RADIUS_PROBES];
    if (count == 0)
        return widest;
    for (uint32_t i = 0; i < RADIUS_PROBES; i++) {
        const struct orl_photon p = orl_photon_map_get(map, count * i / RADIUS_PROBES);
        const struct orl_density_query query = {
            .point = orl_v3(p.position[0], p.position[1], p.position[2]),
            .normal = orl_normal_decode(p.normal),
            .k = k,
            .max_radius = widest};
        radii[i] = orl_density_estimate(map, &query, search).radius;
    }
    qsort(radii, RADIUS_PROBES, sizeof *radii, compare_doubles);
    return radii[(int)(percentile * (RADIUS_PROBES - 1))];
}

/*
 * Chooses the number of neighbours and the largest radius of a map. Global photons of dark corners
 * may need larger radii than most, but not the width of the room. Caustics end abruptly: where
 * photons are few, a wider search would find those of another caustic. Records are few, and stand
 * for 32 photons or more each.
 */
static void choose_radii(struct orl_gather *gather, enum orl_map_kind kind, double bandwidth,
                         double widest, struct orl_search *search)
{
    static const uint32_t neighbours[ORL_MAP_KINDS] = {NEIGHBOURS_GLOBAL, NEIGHBOURS_CAUSTIC,
                                                       NEIGHBOURS_RECORDS};
    const double k = fmax(round(bandwidth * neighbours[kind]), fmin(neighbours[kind], 8));
    gather->k[kind] = (uint32_t)fmin(k, ORL_SEARCH_MOST);
    if (!gather->maps[kind])
        return;
    const double far = typical_radius(gather->maps[kind], gather->k[kind], 0.95, widest, search);
    switch (kind) {
    case ORL_MAP_GLOBAL:
        gather->max_radius[kind] = fmin(4 * far, widest);
        gather->near = 2 * far;
        break;
    case ORL_MAP_PRECOMPUTED:
        gather->max_radius[kind] = fmin(8 * far, widest);
        break;
    default:
        gather->max_radius[kind] = fmin(far, widest);
    }
    /* Few photons in a large scene lie far apart. The limit keeps sensors high above the ground
     * from lying on it. */
    const double near_surface = fmin(0.25 * fmin(gather->max_radius[kind], 4 * far), 0.05 * widest);
    gather->reach = gather->reach > 0 ? fmin(gather->reach, near_surface) : near_surface;
}

/* Returns the error code when building from a map has failed. */
static int build_error(const struct orl_thread_pool *pool)
{
    return orl_thread_pool_cancelled(pool) ? ORL_ERR_CANCELLED : ORL_ERR_NOMEM;
}

/* Sets the maps that the estimator and the caustic part read. */
static void set_maps(struct orl_gather *gather,
                     const struct orl_photon_map *const maps[ORL_MAP_KINDS])
{
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        gather->maps[kind] =
            kind == (int)gather->indirect->map || kind == ORL_MAP_CAUSTIC ? maps[kind] : NULL;
}

int orl_gather_init(struct orl_gather *gather, const struct orl_lit_scene *lit_scene,
                    const struct orl_indirect_estimator *indirect,
                    const struct orl_photon_map *const maps[ORL_MAP_KINDS],
                    const double bandwidths[ORL_MAP_KINDS], uint64_t seed,
                    struct orl_thread_pool *pool, struct orl_search *search)
{
    const double widest = fmax(0.1 * lit_scene->geometry->radius, 1e-9);
    *gather = (struct orl_gather){.lit_scene = lit_scene, .indirect = indirect, .seed = seed};
    orl_sobol_init(&gather->sobol);
    set_maps(gather, maps);
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        choose_radii(gather, (enum orl_map_kind)kind, bandwidths ? bandwidths[kind] : 1, widest,
                     search);
    gather->only_virtual_suns =
        gather->maps[ORL_MAP_CAUSTIC] && orl_sensor_flux_is_virtual_suns(lit_scene);
    if (gather->maps[ORL_MAP_GLOBAL]) {
        gather->leaf_irradiance =
            orl_leaf_irradiance_new(maps[ORL_MAP_GLOBAL], lit_scene, gather->k[ORL_MAP_GLOBAL],
                                    gather->max_radius[ORL_MAP_GLOBAL], pool);
        if (!gather->leaf_irradiance)
            return build_error(pool);
    }
    return indirect->init && gather->maps[indirect->map]
               ? indirect->init(gather, widest, pool, search)
               : 0;
}

int orl_gather_for_views(struct orl_gather *gather, struct orl_thread_pool *pool)
{
    if (gather->maps[ORL_MAP_CAUSTIC] && !gather->caustic_kernels) {
        gather->caustic_kernels =
            orl_kernel_density_new(gather->maps[ORL_MAP_CAUSTIC], gather->k[ORL_MAP_CAUSTIC],
                                   gather->max_radius[ORL_MAP_CAUSTIC], pool);
        if (!gather->caustic_kernels)
            return build_error(pool);
    }
    if (!gather->maps[ORL_MAP_GLOBAL] || !gather->indirect->gathered || gather->texels)
        return 0;
    gather->texels = orl_texels_new(gather->maps[ORL_MAP_GLOBAL], gather->lit_scene,
                                    texel_share * gather->k[ORL_MAP_GLOBAL], pool);
    return gather->texels ? 0 : build_error(pool);
}

void orl_gather_done(struct orl_gather *gather)
{
    orl_leaf_irradiance_free(gather->leaf_irradiance);
    orl_texels_free(gather->texels);
    orl_kernel_density_free(gather->caustic_kernels);
    orl_photon_guide_done(&gather->guide);
    gather->leaf_irradiance = NULL;
    gather->texels = NULL;
    gather->caustic_kernels = NULL;
    orl_adaptive_density_done(&gather->adaptive);
}

bool orl_gather_find_surface(const struct orl_gather *gather, struct orl_vec3 point,
                             struct orl_vec3 normal, struct orl_surface_point *ret_surface_point)
{
    const double rounding = gather->lit_scene->geometry->radius * 0x1p-18;
    return orl_surface_point_find(gather->lit_scene, point, normal, rounding, ret_surface_point);
}

struct orl_density orl_gather_indirect(const struct orl_gather *gather,
                                       const struct orl_surface_point *surface_point,
                                       struct orl_search *search)
{
    const struct orl_indirect_estimator *indirect = gather->indirect;
    return indirect->at_surface && gather->maps[indirect->map]
               ? indirect->at_surface(gather, surface_point, search)
               : (struct orl_density){.found = 0};
}

struct orl_rgb orl_gather_read_leaf(const struct orl_gather *gather,
                                    const struct orl_surface_point *surface_point, bool roughly,
                                    bool *relit, struct orl_search *search, struct orl_tally *tally)
{
    (void)roughly; /* a leaf has one value */
    if (!gather->leaf_irradiance || *relit)
        return orl_gray(0);
    return orl_leaf_irradiance_estimate(gather->leaf_irradiance, surface_point->point,
                                        surface_point->normal, surface_point, search,
                                        &tally->parts[ORL_MAP_GLOBAL], relit);
}

double orl_tally_variance(const struct orl_tally *tally)
{
    double variance = 0;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        variance += orl_batches_variance(&tally->parts[kind]);
    return variance + tally->record_error * tally->record_error;
}

/* Without a caustic map caustics were not requested, so there are none. Outside, rays find them. */
bool orl_gather_has_free_caustics(const struct orl_gather *gather,
                                  const struct orl_shading_point *place)
{
    return place->in_free_space && !place->outside && gather->maps[ORL_MAP_CAUSTIC];
}

/* Returns the scene that lights a place. */
static const struct orl_lit_scene *scene_of(const struct orl_gather *gather,
                                            const struct orl_shading_point *place)
{
    return place->proxied ? orl_lit_scene_seen(gather->lit_scene) : gather->lit_scene;
}

struct orl_rgb orl_gather_direct(const struct orl_gather *gather,
                                 const struct orl_shading_point *place, uint32_t sequence,
                                 uint32_t first, uint32_t rays, double *ret_variance)
{
    double u[2], squares = 0;
    /* Where no caustic photons are used, suns in mirrors are sampled by their images. */
    const struct orl_direct_query query = {
        .point = place->point,
        .normal = place->normal,
        .shading = place->textured ? &place->shading : NULL,
        .through_ports = true,
        .mirrored = place->outside || (orl_gather_has_free_caustics(gather, place) &&
                                       !gather->lit_scene->omit.mirror_caustics),
        .u = u};
    struct orl_random unused = {0}; /* never read: the query has its own numbers */
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = first; i < first + rays; i++) {
        orl_sobol_point(&gather->sobol, i, sequence, 2, u);
        const struct orl_rgb light = orl_direct_light(scene_of(gather, place), &query, &unused);
        sum = orl_rgb_add(sum, light);
        squares += orl_luma(light) * orl_luma(light);
    }
    const struct orl_rgb mean = orl_rgb_scale(sum, 1.0 / rays);
    const double luma = orl_luma(mean);
    if (ret_variance)
        *ret_variance = rays > 1 ? fmax(squares / rays - luma * luma, 0) / (rays - 1) : 0;
    return mean;
}

/* ---- Cache of the results computed from scene and maps, from one job to the next ------------- */

uint64_t orl_gather_detach(struct orl_gather *gather)
{
    uint64_t bytes = sizeof *gather + gather->guide.count * sizeof *gather->guide.patches;
    gather->lit_scene = NULL;
    gather->cancel = NULL;
    gather->importance_sampled = false;
    gather->sampler = NULL;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        gather->maps[kind] = NULL;
    if (gather->leaf_irradiance) {
        orl_leaf_irradiance_rebind(gather->leaf_irradiance, NULL, NULL);
        bytes += orl_leaf_irradiance_bytes(gather->leaf_irradiance);
    }
    if (gather->caustic_kernels) {
        bytes += orl_kernel_density_bytes(gather->caustic_kernels);
        orl_kernel_density_rebind(gather->caustic_kernels, NULL);
    }
    if (gather->texels)
        bytes += orl_texels_bytes(gather->texels);
    gather->adaptive.sums.map = NULL;
    bytes += orl_leaf_sums_bytes(&gather->adaptive.sums) +
             gather->adaptive.sums.count * 2 * sizeof(uint64_t);
    return bytes;
}

void orl_gather_attach(struct orl_gather *gather, const struct orl_lit_scene *lit_scene,
                       const struct orl_photon_map *const maps[ORL_MAP_KINDS], uint64_t seed)
{
    gather->lit_scene = lit_scene;
    gather->seed = seed;
    set_maps(gather, maps);
    if (gather->leaf_irradiance)
        orl_leaf_irradiance_rebind(gather->leaf_irradiance, gather->maps[ORL_MAP_GLOBAL],
                                   lit_scene);
    if (gather->caustic_kernels)
        orl_kernel_density_rebind(gather->caustic_kernels, gather->maps[ORL_MAP_CAUSTIC]);
    if (gather->texels)
        orl_texels_rebind(gather->texels, lit_scene);
    gather->adaptive.sums.map = gather->maps[ORL_MAP_GLOBAL];
}
