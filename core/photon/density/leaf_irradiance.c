#include "photon/density/irradiance_tables.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "photon/density/leaf_sites.h"
#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"

/*
 * Near-field occlusion test: places between slats, in a mug, or under a low shelf, where a density
 * estimate is as wide as the gap. There the same objects occlude both the light and the viewer, at
 * the same scale. For example, only the edge of a slat's underside is visible; it is darker or
 * brighter than the slat. An estimate averages over the whole slat and is wrong by that difference,
 * whatever its number of photons. Light is neither created nor lost, but the visible part is not
 * the averaged part. Readers of densities must continue the path from there instead.
 */

enum { RAYS = 16, LEAST_BLOCKED = 3 };

/* Most places are open: if none of the first rays hits anything, the others are not traced. With
 * this step the first rays are distributed as evenly as all of them. */
enum { FIRST = 6, STEP = 5 };

/* Sectors between the azimuths of successive rays: about the golden section of all sectors. */
enum { TURN = 13 };

/* Length of the rays in radii. Farther objects blur shadows and sight over more than the
 * estimate's width. */
static const double reach = 2;

/* Returns true if a ray hits an opaque surface. The rays carry equal shares of the light of a
 * uniform sky. */
static bool ray_is_blocked(const struct orl_surface_point *surface_point,
                           const struct orl_frame *frame, int ray, double length)
{
    const struct orl_lit_scene *lit_scene = surface_point->lit_scene;
    const double *azimuth = orl_footprint_azimuths[ray * TURN % ORL_FOOTPRINT_SECTORS];
    const double sine2 = (ray + 0.5) / RAYS, sine = sqrt(sine2), cosine = sqrt(1 - sine2);
    const struct orl_vec3 flat =
        orl_add(orl_scale(frame->u, azimuth[0] * sine), orl_scale(frame->v, azimuth[1] * sine));
    const struct orl_vec3 direction = orl_madd(flat, surface_point->normal, cosine);
    const struct orl_vec3 start =
        orl_facet_ray_origin(lit_scene->geometry, surface_point->facet, surface_point->point,
                             surface_point->normal, direction);
    struct orl_hit hit;
    return orl_geometry_occluded(lit_scene->geometry, start, direction, length) &&
           orl_geometry_intersect(lit_scene->geometry, start, direction, length, &hit) &&
           !orl_material_is_window(orl_lit_scene_material(lit_scene, &hit));
}

/*
 * Returns true if surfaces nearer than twice `radius` block at least 3/16 of the light of a uniform
 * sky on the surface point, as sampled by rays. Panes do not block.
 */
static bool is_near_occluded(const struct orl_surface_point *surface_point, double radius)
{
    const struct orl_frame frame = orl_frame_about(surface_point->normal);
    int blocked = 0;
    for (int i = 0; i < RAYS && blocked < LEAST_BLOCKED && (i < FIRST || blocked > 0); i++)
        blocked += ray_is_blocked(surface_point, &frame, i * STEP % RAYS, reach * radius);
    return blocked == LEAST_BLOCKED;
}

/* ---- Cache of estimates ---------------------------------------------------------------------- */

enum { SHARE_WORDS = ORL_MAP_BATCHES / sizeof(uint64_t) };

/* Factor on the unit for very bright leaves: where a sunbeam's photons lie dense on a few
 * centimetres, values exceed the range of a word in the usual unit. */
static const double coarser = 0x1p20;

/* A leaf's estimate in the cache. */
struct cached {
    /* 0: not computed yet. Low half: the value. High half: the clear radius, negative for a patch;
     * its last bits code the value's unit and whether the place is occluded in the near field. */
    _Atomic uint64_t value;
    _Atomic uint64_t shares[SHARE_WORDS]; /* shares of the batches; written before the value */
};

struct orl_leaf_irradiance {
    const struct orl_photon_map *map;
    const struct orl_lit_scene *lit_scene;
    uint64_t count;
    uint32_t k;
    double max_radius;
    double unit; /* W/m2: unit of the stored values */
    struct orl_kernel_density *kernel_density;
    struct orl_leaf_sites *sites;
    struct cached *cached;
};

/* A leaf's estimate. */
struct estimate {
    struct orl_rgb irradiance;
    double clearance; /* distance from the site within which there is no wall */
    /* the estimate is that of a small patch as a whole, and is used on no other */
    bool patch;
    bool unreliable; /* near occlusion: the estimate is not the visible radiance */
};

/* Squared cells: spread of photons that are practically at one point. */
static const float spot = 4;

enum { MOST_TRIES = 4, PLACES = 8, COARSE = 1, NEAR_OCCLUDED = 2 };
/* Code for zero irradiance: the smallest exponent with an empty mantissa, because the empty word
 * means "not computed". */
static const uint32_t value_zero = 1U << 27;

static struct orl_density_query query_at(const struct orl_leaf_irradiance *leaf_irradiance,
                                         struct orl_vec3 point, struct orl_vec3 normal)
{
    return (struct orl_density_query){.point = point,
                                      .normal = normal,
                                      .k = leaf_irradiance->k,
                                      .max_radius = leaf_irradiance->max_radius};
}

struct orl_leaf_irradiance *orl_leaf_irradiance_new(const struct orl_photon_map *map,
                                                    const struct orl_lit_scene *lit_scene,
                                                    uint32_t k, double max_radius,
                                                    struct orl_thread_pool *pool)
{
    const struct orl_map_header *h = map->header;
    const uint64_t n = (h->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    struct orl_leaf_irradiance *leaf_irradiance = calloc(1, sizeof *leaf_irradiance);
    if (!leaf_irradiance)
        return NULL;
    leaf_irradiance->map = map;
    leaf_irradiance->lit_scene = lit_scene;
    leaf_irradiance->count = n;
    leaf_irradiance->k = k;
    leaf_irradiance->max_radius = max_radius;
    /* The irradiance of k photons of mean flux; at least that of k photons of one flux unit, so
     * that the brightest is not clamped (quantization.h). */
    leaf_irradiance->unit =
        fmax(h->flux_mean, h->flux_unit) * k / (ORL_PI * max_radius * max_radius);
    leaf_irradiance->cached = calloc(n + 1, sizeof *leaf_irradiance->cached);
    leaf_irradiance->sites = orl_leaf_sites_new(map, lit_scene, max_radius, pool);
    leaf_irradiance->kernel_density = orl_kernel_density_new(map, k, max_radius, pool);
    if (!leaf_irradiance->sites || !leaf_irradiance->cached || !leaf_irradiance->kernel_density) {
        orl_leaf_irradiance_free(leaf_irradiance);
        return NULL;
    }
    return leaf_irradiance;
}

void orl_leaf_irradiance_free(struct orl_leaf_irradiance *leaf_irradiance)
{
    if (!leaf_irradiance)
        return;
    orl_kernel_density_free(leaf_irradiance->kernel_density);
    orl_leaf_sites_free(leaf_irradiance->sites);
    free(leaf_irradiance->cached);
    free(leaf_irradiance);
}

void orl_leaf_irradiance_rebind(struct orl_leaf_irradiance *leaf_irradiance,
                                const struct orl_photon_map *map,
                                const struct orl_lit_scene *lit_scene)
{
    leaf_irradiance->map = map;
    leaf_irradiance->lit_scene = lit_scene;
    orl_leaf_sites_rebind(leaf_irradiance->sites, map, lit_scene);
    orl_kernel_density_rebind(leaf_irradiance->kernel_density, map);
}

uint64_t orl_leaf_irradiance_bytes(const struct orl_leaf_irradiance *leaf_irradiance)
{
    /* Per leaf: the estimate, its kernel radius and the radii of the levels above. */
    const uint64_t each = sizeof *leaf_irradiance->cached + 2 * sizeof(float);
    return orl_leaf_sites_bytes(leaf_irradiance->sites) + leaf_irradiance->count * each +
           sizeof *leaf_irradiance;
}

double orl_leaf_irradiance_filled(const struct orl_leaf_irradiance *leaf_irradiance)
{
    const uint64_t looks = leaf_irradiance->count < 1024 ? leaf_irradiance->count : 1024;
    uint64_t made = 0;
    for (uint64_t i = 0; i < looks; i++)
        made +=
            atomic_load_explicit(&leaf_irradiance->cached[i * leaf_irradiance->count / looks].value,
                                 memory_order_relaxed) != 0;
    return looks > 0 ? (double)made / (double)looks : 0;
}

/*
 * Places the query at a random point among those where the leaf is used, on its own surface. The
 * leaf's value is then right on average, whatever the shapes of leaves. At the centre of its
 * photons it would be low by half a percent in even light, because of the way in which Morton order
 * groups sixteen photons. Uses the site itself if that is a photon, or if no point is found. Also
 * uses it if all photons are within about a cell, because their discs contribute nothing beside it.
 * Returns the distance from the site in metres.
 */
static double place_query(const struct orl_leaf_irradiance *leaf_irradiance, uint32_t leaf,
                          struct orl_density_query *query, struct orl_surface_point *surface_point)
{
    const struct orl_photon_map *map = leaf_irradiance->map;
    const struct orl_leaf_center *site = orl_leaf_sites_of(leaf_irradiance->sites, leaf);
    const struct orl_vec3 point = orl_leaf_center_point(map, site);
    const bool stays = site->at_photon || site->spread2 < spot;
    struct orl_random random = orl_random_stream(map->header->count, ORL_PURPOSE_LEAF, leaf);
    for (int i = 0; i < PLACES && !stays; i++) {
        struct orl_leaf_center place;
        if (!orl_leaf_sites_sample(leaf_irradiance->sites, leaf, &random, &place))
            continue;
        const bool found = orl_leaf_center_set_query(map, &place, leaf, leaf_irradiance->lit_scene,
                                                     query, surface_point);
        if (leaf_irradiance->lit_scene && (!found || surface_point->facet != site->facet ||
                                           !orl_surface_point_unoccluded(surface_point, point)))
            continue;
        return orl_length(orl_sub(query->point, point));
    }
    query->surface_point = NULL;
    orl_leaf_center_set_query(map, site, leaf, leaf_irradiance->lit_scene, query, surface_point);
    return 0;
}

static struct orl_density make_estimate(const struct orl_leaf_irradiance *leaf_irradiance,
                                        uint32_t leaf, struct orl_search *search)
{
    struct orl_density_query query = query_at(leaf_irradiance, orl_v3(0, 0, 0), orl_v3(0, 0, 1));
    struct orl_surface_point surface_point;
    const double off = place_query(leaf_irradiance, leaf, &query, &surface_point);
    struct orl_density density =
        orl_kernel_density_estimate(leaf_irradiance->kernel_density, &query, search);
    density.unreliable = query.surface_point && is_near_occluded(&surface_point, density.radius);
    density.clearance = fmax(density.clearance - off, 0); /* relative to the site */
    return density;
}

static uint64_t pack_estimate(const struct orl_leaf_irradiance *leaf_irradiance,
                              const struct orl_density *density)
{
    const float clearance = density->patch ? -(float)density->clearance : (float)density->clearance;
    const bool coarse = orl_rgb_max(density->irradiance) > ORL_FLUX_MOST * leaf_irradiance->unit;
    const double unit = leaf_irradiance->unit * (coarse ? coarser : 1);
    uint32_t low = orl_flux_pack(orl_rgb_scale(density->irradiance, 1 / unit), 0.5), high;
    if (low == 0)
        low = value_zero;
    memcpy(&high, &clearance, sizeof high);
    high &= ~(uint32_t)(COARSE | NEAR_OCCLUDED);
    high |= (coarse ? COARSE : 0U) | (density->unreliable ? NEAR_OCCLUDED : 0U);
    return (uint64_t)high << 32 | low;
}

static struct estimate unpack_estimate(const struct orl_leaf_irradiance *leaf_irradiance,
                                       uint64_t word)
{
    const uint32_t high = (uint32_t)(word >> 32);
    const double unit = leaf_irradiance->unit * (high & COARSE ? coarser : 1);
    float clearance;
    memcpy(&clearance, &high, sizeof clearance);
    return (struct estimate){orl_rgb_scale(orl_flux_unpack((uint32_t)word), unit),
                             fabs((double)clearance), signbit(clearance) != 0,
                             (high & NEAR_OCCLUDED) != 0};
}

static void cache_shares(struct cached *cached, const struct orl_batches *parts)
{
    uint64_t words[SHARE_WORDS];
    uint8_t shares[ORL_MAP_BATCHES];
    orl_batches_pack(parts, shares);
    memcpy(words, shares, sizeof words);
    for (int i = 0; i < SHARE_WORDS; i++)
        atomic_store_explicit(&cached->shares[i], words[i], memory_order_relaxed);
}

/* Returns the parts of a leaf's value, which must have been computed. */
static struct orl_batches parts_of(const struct cached *cached, double luma)
{
    uint64_t words[SHARE_WORDS];
    uint8_t shares[ORL_MAP_BATCHES];
    for (int i = 0; i < SHARE_WORDS; i++)
        words[i] = atomic_load_explicit(&cached->shares[i], memory_order_relaxed);
    memcpy(shares, words, sizeof shares);
    return orl_batches_unpack(shares, luma);
}

/* Returns the leaf's estimate, and computes it if that was not done. Two threads that compute it
 * at once write the same words. */
static struct estimate estimate_of(struct orl_leaf_irradiance *leaf_irradiance, uint32_t leaf,
                                   struct orl_search *search)
{
    struct cached *cached = &leaf_irradiance->cached[leaf];
    uint64_t word = atomic_load_explicit(&cached->value, memory_order_acquire);
    if (word == 0) {
        const struct orl_health before = search->health;
        const struct orl_density density = make_estimate(leaf_irradiance, leaf, search);
        uint64_t expected = 0;
        word = pack_estimate(leaf_irradiance, &density);
        cache_shares(cached, &density.parts);
        /* The thread that comes second does not count the estimate again. */
        if (!atomic_compare_exchange_strong(&cached->value, &expected, word))
            search->health = before;
    }
    return unpack_estimate(leaf_irradiance, word);
}

/*
 * Returns true if the leaf's site is on the surface point's surface, with no occluder between. An
 * estimate of a patch as a whole is used on its own facet only. It exists because the patch has
 * photons, so patches beside it must use their own.
 */
static bool is_unoccluded(const struct orl_leaf_irradiance *leaf_irradiance,
                          struct orl_near_leaf leaf, const struct estimate *estimate,
                          const struct orl_surface_point *surface_point)
{
    const double cell = leaf_irradiance->map->header->cell,
                 distance = sqrt((double)leaf.distance2) * cell;
    const struct orl_vec3 site = orl_leaf_center_point(
        leaf_irradiance->map, orl_leaf_sites_of(leaf_irradiance->sites, leaf.leaf));
    if (!surface_point)
        return true;
    if (estimate->patch &&
        surface_point->facet != orl_leaf_sites_of(leaf_irradiance->sites, leaf.leaf)->facet)
        return false;
    /* The site is on another, parallel surface close by. */
    if (fabs(orl_dot(orl_sub(site, surface_point->point), surface_point->normal)) > 4 * cell &&
        distance < orl_surface_point_flat_radius(surface_point))
        return false;
    return distance < estimate->clearance || orl_surface_point_unoccluded(surface_point, site);
}

/* Returns true if the leaf is used at the point, and its value. */
static bool read_leaf(struct orl_leaf_irradiance *leaf_irradiance, struct orl_near_leaf leaf,
                      const float at[3], const struct orl_surface_point *surface_point,
                      struct orl_search *search, struct orl_rgb *ret_irradiance,
                      struct orl_batches *ret_parts, bool *ret_near_occluded)
{
    if (!orl_leaf_sites_cover(leaf_irradiance->sites, leaf, at))
        return false;
    const struct estimate estimate = estimate_of(leaf_irradiance, leaf.leaf, search);
    if (!is_unoccluded(leaf_irradiance, leaf, &estimate, surface_point))
        return false;
    if (ret_near_occluded && estimate.unreliable) {
        *ret_near_occluded = true;
        *ret_irradiance = orl_gray(0);
        return true;
    }
    *ret_irradiance = estimate.irradiance;
    if (ret_parts)
        *ret_parts = parts_of(&leaf_irradiance->cached[leaf.leaf], orl_luma(estimate.irradiance));
    return true;
}

struct orl_rgb orl_leaf_irradiance_estimate(struct orl_leaf_irradiance *leaf_irradiance,
                                            struct orl_vec3 point, struct orl_vec3 normal,
                                            const struct orl_surface_point *surface_point,
                                            struct orl_search *search,
                                            struct orl_batches *ret_parts, bool *ret_near_occluded)
{
    struct orl_near_leaf leaf;
    struct orl_rgb irradiance;
    float at[3];
    if (ret_near_occluded)
        *ret_near_occluded = false;
    orl_box_locate(leaf_irradiance->map, point, at);
    if (orl_leaf_sites_nearest(leaf_irradiance->sites, point, normal, &leaf) &&
        read_leaf(leaf_irradiance, leaf, at, surface_point, search, &irradiance, ret_parts,
                  ret_near_occluded))
        return irradiance;
    leaf = (struct orl_near_leaf){-1, 0};
    for (int i = 0;
         i < MOST_TRIES && orl_leaf_sites_next(leaf_irradiance->sites, point, normal, leaf, &leaf);
         i++)
        if (read_leaf(leaf_irradiance, leaf, at, surface_point, search, &irradiance, ret_parts,
                      ret_near_occluded))
            return irradiance;
    struct orl_density_query query = query_at(leaf_irradiance, point, normal);
    query.surface_point = surface_point;
    const struct orl_density density =
        orl_kernel_density_estimate(leaf_irradiance->kernel_density, &query, search);
    if (ret_near_occluded && surface_point && is_near_occluded(surface_point, density.radius)) {
        *ret_near_occluded = true;
        return orl_gray(0);
    }
    if (ret_parts)
        *ret_parts = density.parts;
    return density.irradiance;
}
