#include "render/gather/gather.h"

#include <stdlib.h>

#include "light/proxies.h"
#include "photon/density/records.h"
#include "photon/map/facing.h"
#include "render/gather/air.h"

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
static int build_error(const struct orl_crew *crew)
{
    return orl_crew_cancelled(crew) ? ORL_ERR_CANCELLED : ORL_ERR_NOMEM;
}

int orl_gather_init(struct orl_gather *gather, const struct orl_world *world, enum orl_rest rest,
                    const struct orl_photon_map *const maps[ORL_MAP_KINDS],
                    const double bandwidths[ORL_MAP_KINDS], uint64_t seed, struct orl_crew *crew,
                    struct orl_search *search)
{
    const double widest = fmax(0.1 * world->geometry->radius, 1e-9);
    const int unread = rest == ORL_REST_RECORDS ? ORL_MAP_GLOBAL : ORL_MAP_PRECOMPUTED;
    *gather = (struct orl_gather){.world = world, .rest = rest, .seed = seed};
    orl_sobol_init(&gather->sobol);
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++) {
        gather->maps[kind] = kind == unread ? NULL : maps[kind];
        choose_radii(gather, (enum orl_map_kind)kind, bandwidths ? bandwidths[kind] : 1, widest,
                     search);
    }
    gather->by_images = gather->maps[ORL_MAP_CAUSTIC] && orl_air_is_by_images(world);
    if (gather->maps[ORL_MAP_GLOBAL]) {
        gather->leaves = orl_leaves_new(maps[ORL_MAP_GLOBAL], world, gather->k[ORL_MAP_GLOBAL],
                                        gather->max_radius[ORL_MAP_GLOBAL], crew);
        if (!gather->leaves)
            return build_error(crew);
    }
    if (rest == ORL_REST_GATHERED && gather->maps[ORL_MAP_GLOBAL]) {
        const int code = orl_bright_init(&gather->bright, maps[ORL_MAP_GLOBAL], crew);
        if (code < 0)
            return code;
    }
    if (rest == ORL_REST_DENSITY && gather->maps[ORL_MAP_GLOBAL])
        return orl_adaptive_density_init(&gather->adapt, maps[ORL_MAP_GLOBAL], widest, crew,
                                         search);
    return 0;
}

int orl_gather_for_views(struct orl_gather *gather, struct orl_crew *crew)
{
    if (gather->maps[ORL_MAP_CAUSTIC] && !gather->caustic_widths) {
        gather->caustic_widths =
            orl_kernel_density_new(gather->maps[ORL_MAP_CAUSTIC], gather->k[ORL_MAP_CAUSTIC],
                                   gather->max_radius[ORL_MAP_CAUSTIC], crew);
        if (!gather->caustic_widths)
            return build_error(crew);
    }
    if (!gather->maps[ORL_MAP_GLOBAL] || gather->rest != ORL_REST_GATHERED || gather->texels)
        return 0;
    gather->texels = orl_texels_new(gather->maps[ORL_MAP_GLOBAL], gather->world,
                                    texel_share * gather->k[ORL_MAP_GLOBAL], crew);
    return gather->texels ? 0 : build_error(crew);
}

void orl_gather_done(struct orl_gather *gather)
{
    orl_leaves_free(gather->leaves);
    orl_texels_free(gather->texels);
    orl_kernel_density_free(gather->caustic_widths);
    orl_bright_done(&gather->bright);
    gather->leaves = NULL;
    gather->texels = NULL;
    gather->caustic_widths = NULL;
    orl_adaptive_density_done(&gather->adapt);
}

bool orl_gather_footing(const struct orl_gather *gather, struct orl_vec3 point,
                        struct orl_vec3 normal, struct orl_footing *ret_footing)
{
    const double rounding = gather->world->geometry->radius * 0x1p-18;
    return orl_footing_find(gather->world, point, normal, rounding, ret_footing);
}

/* With an adaptive estimate, found and radius are those of the photons; with records, found only
 * says that there were some. */
struct orl_density orl_gather_rest(const struct orl_gather *gather,
                                   const struct orl_footing *footing, struct orl_search *search)
{
    const struct orl_density density = {.found = 0};
    if (gather->rest == ORL_REST_DENSITY && gather->maps[ORL_MAP_GLOBAL]) {
        const struct orl_density_query query = {.point = footing->point,
                                                .normal = footing->normal,
                                                .k = ORL_ADAPTIVE_DENSITY_MOST,
                                                .max_radius = gather->adapt.reach,
                                                .footing = footing};
        return orl_adaptive_density_estimate(&gather->adapt, &query, search);
    }
    if (gather->rest == ORL_REST_RECORDS && gather->maps[ORL_MAP_PRECOMPUTED])
        return orl_records_estimate(gather->maps[ORL_MAP_PRECOMPUTED], footing,
                                    gather->max_radius[ORL_MAP_PRECOMPUTED], search);
    return density;
}

double orl_tally_variance(const struct orl_tally *tally)
{
    double variance = 0;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        variance += orl_batches_variance(&tally->parts[kind]);
    return variance + tally->known * tally->known;
}

/* Without a caustic map caustics were not requested, so there are none. Outside, rays find them. */
bool orl_gather_catches(const struct orl_gather *gather, const struct orl_place *place)
{
    return place->in_air && !place->outside && gather->maps[ORL_MAP_CAUSTIC];
}

/* Returns the scene that lights a place. */
static const struct orl_world *scene_of(const struct orl_gather *gather,
                                        const struct orl_place *place)
{
    return place->proxied ? orl_world_seen(gather->world) : gather->world;
}

struct orl_rgb orl_gather_direct(const struct orl_gather *gather, const struct orl_place *place,
                                 uint32_t sequence, uint32_t first, uint32_t rays,
                                 double *ret_variance)
{
    double u[2], squares = 0;
    /* Where no caustic photons are used, suns in mirrors are sampled by their images. */
    const struct orl_direct_query query = {
        .point = place->point,
        .normal = place->normal,
        .shading = place->textured ? &place->shading : NULL,
        .through_ports = true,
        .mirrored = place->outside ||
                    (orl_gather_catches(gather, place) && !gather->world->omit.mirror_caustics),
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
