#include "photon/density/leaves.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "photon/density/crowd.h"
#include "photon/density/leaf_sites.h"
#include "photon/map/boxes.h"
#include "photon/map/flux.h"

enum { SHARE_WORDS = ORL_MAP_BATCHES / sizeof(uint64_t) };

/* Factor on the unit for very bright leaves: where a sunbeam's photons lie dense on a few
 * centimetres, values exceed the range of a word in the usual unit. */
static const double coarser = 0x1p20;

/* A leaf's estimate in the cache. */
struct kept {
    /* 0: not computed yet. Low half: the value. High half: the clear radius, negative for a
     * patch; its last bits say the value's unit and whether the place is crowded. */
    _Atomic uint64_t value;
    _Atomic uint64_t shares[SHARE_WORDS]; /* shares of the batches; written before the value */
};

struct orl_leaves {
    const struct orl_photon_map *map;
    const struct orl_world *world;
    uint64_t count;
    uint32_t k;
    double max_radius;
    double unit; /* W/m2: unit of the stored values */
    struct orl_kernel_density *spread;
    struct orl_leaf_sites *sites;
    struct kept *kept;
};

/* A leaf's estimate. */
struct estimate {
    struct orl_rgb irradiance;
    double clear; /* distance from the site within which there is no wall */
    /* the estimate is that of a small patch as a whole, and is used on no other */
    bool patch;
    bool crowded; /* near occlusion (crowd.h): the estimate is not the visible radiance */
};

/* Squared cells: spread of photons that are practically at one point. */
static const float spot = 4;

enum { MOST_TRIES = 4, PLACES = 8, COARSE = 1, CROWDED = 2 };
/* Code for zero irradiance: the smallest exponent with an empty mantissa, because the empty word
 * means "not computed". */
static const uint32_t value_zero = 1U << 27;

static struct orl_density_query query_at(const struct orl_leaves *leaves, struct orl_vec3 point,
                                         struct orl_vec3 normal)
{
    return (struct orl_density_query){
        .point = point, .normal = normal, .k = leaves->k, .max_radius = leaves->max_radius};
}

struct orl_leaves *orl_leaves_new(const struct orl_photon_map *map, const struct orl_world *world,
                                  uint32_t k, double max_radius, struct orl_crew *crew)
{
    const struct orl_map_header *h = map->header;
    const uint64_t n = (h->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    struct orl_leaves *leaves = calloc(1, sizeof *leaves);
    if (!leaves)
        return NULL;
    leaves->map = map;
    leaves->world = world;
    leaves->count = n;
    leaves->k = k;
    leaves->max_radius = max_radius;
    /* The irradiance of k photons of mean flux; at least that of k photons of one flux unit, so
     * that the brightest is not clamped (flux.h). */
    leaves->unit = fmax(h->flux_mean, h->flux_unit) * k / (ORL_PI * max_radius * max_radius);
    leaves->kept = calloc(n + 1, sizeof *leaves->kept);
    leaves->sites = orl_leaf_sites_new(map, world, max_radius, crew);
    leaves->spread = orl_kernel_density_new(map, k, max_radius, crew);
    if (!leaves->sites || !leaves->kept || !leaves->spread) {
        orl_leaves_free(leaves);
        return NULL;
    }
    return leaves;
}

void orl_leaves_free(struct orl_leaves *leaves)
{
    if (!leaves)
        return;
    orl_kernel_density_free(leaves->spread);
    orl_leaf_sites_free(leaves->sites);
    free(leaves->kept);
    free(leaves);
}

void orl_leaves_rebind(struct orl_leaves *leaves, const struct orl_photon_map *map,
                       const struct orl_world *world)
{
    leaves->map = map;
    leaves->world = world;
    orl_leaf_sites_rebind(leaves->sites, map, world);
    orl_kernel_density_rebind(leaves->spread, map);
}

uint64_t orl_leaves_bytes(const struct orl_leaves *leaves)
{
    /* Per leaf: the estimate, its kernel radius and the radii of the levels above. */
    const uint64_t each = sizeof *leaves->kept + 2 * sizeof(float);
    return orl_leaf_sites_bytes(leaves->sites) + leaves->count * each + sizeof *leaves;
}

double orl_leaves_made(const struct orl_leaves *leaves)
{
    const uint64_t looks = leaves->count < 1024 ? leaves->count : 1024;
    uint64_t made = 0;
    for (uint64_t i = 0; i < looks; i++)
        made += atomic_load_explicit(&leaves->kept[i * leaves->count / looks].value,
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
static double place_query(const struct orl_leaves *leaves, uint32_t leaf,
                          struct orl_density_query *query, struct orl_footing *footing)
{
    const struct orl_photon_map *map = leaves->map;
    const struct orl_leaf_center *site = orl_leaf_sites_of(leaves->sites, leaf);
    const struct orl_vec3 point = orl_leaf_center_point(map, site);
    const bool stays = site->at_photon || site->spread2 < spot;
    struct orl_random random = orl_random_stream(map->header->count, ORL_PURPOSE_LEAF, leaf);
    for (int i = 0; i < PLACES && !stays; i++) {
        struct orl_leaf_center place;
        if (!orl_leaf_sites_draw(leaves->sites, leaf, &random, &place))
            continue;
        const bool found = orl_leaf_center_ask(map, &place, leaf, leaves->world, query, footing);
        if (leaves->world &&
            (!found || footing->facet != site->facet || !orl_footing_joins(footing, point)))
            continue;
        return orl_length(orl_sub(query->point, point));
    }
    query->footing = NULL;
    orl_leaf_center_ask(map, site, leaf, leaves->world, query, footing);
    return 0;
}

static struct orl_density make_estimate(const struct orl_leaves *leaves, uint32_t leaf,
                                        struct orl_search *search)
{
    struct orl_density_query query = query_at(leaves, orl_v3(0, 0, 0), orl_v3(0, 0, 1));
    struct orl_footing footing;
    const double off = place_query(leaves, leaf, &query, &footing);
    struct orl_density density = orl_kernel_density_estimate(leaves->spread, &query, search);
    density.crowded = query.footing && orl_is_crowded(&footing, density.radius);
    density.clear = fmax(density.clear - off, 0); /* relative to the site */
    return density;
}

static uint64_t pack_estimate(const struct orl_leaves *leaves, const struct orl_density *density)
{
    const float clear = density->patch ? -(float)density->clear : (float)density->clear;
    const bool coarse = orl_rgb_max(density->irradiance) > ORL_FLUX_MOST * leaves->unit;
    const double unit = leaves->unit * (coarse ? coarser : 1);
    uint32_t low = orl_flux_pack(orl_rgb_scale(density->irradiance, 1 / unit), 0.5), high;
    if (low == 0)
        low = value_zero;
    memcpy(&high, &clear, sizeof high);
    high &= ~(uint32_t)(COARSE | CROWDED);
    high |= (coarse ? COARSE : 0U) | (density->crowded ? CROWDED : 0U);
    return (uint64_t)high << 32 | low;
}

static struct estimate unpack_estimate(const struct orl_leaves *leaves, uint64_t word)
{
    const uint32_t high = (uint32_t)(word >> 32);
    const double unit = leaves->unit * (high & COARSE ? coarser : 1);
    float clear;
    memcpy(&clear, &high, sizeof clear);
    return (struct estimate){orl_rgb_scale(orl_flux_unpack((uint32_t)word), unit),
                             fabs((double)clear), signbit(clear) != 0, (high & CROWDED) != 0};
}

static void keep_shares(struct kept *kept, const struct orl_batches *parts)
{
    uint64_t words[SHARE_WORDS];
    uint8_t shares[ORL_MAP_BATCHES];
    orl_batches_pack(parts, shares);
    memcpy(words, shares, sizeof words);
    for (int i = 0; i < SHARE_WORDS; i++)
        atomic_store_explicit(&kept->shares[i], words[i], memory_order_relaxed);
}

/* Returns the parts of a leaf's value, which must have been computed. */
static struct orl_batches parts_of(const struct kept *kept, double luma)
{
    uint64_t words[SHARE_WORDS];
    uint8_t shares[ORL_MAP_BATCHES];
    for (int i = 0; i < SHARE_WORDS; i++)
        words[i] = atomic_load_explicit(&kept->shares[i], memory_order_relaxed);
    memcpy(shares, words, sizeof shares);
    return orl_batches_unpack(shares, luma);
}

/* Returns the leaf's estimate, and computes it if that was not done. Two threads that compute it
 * at once write the same words. */
static struct estimate estimate_of(struct orl_leaves *leaves, uint32_t leaf,
                                   struct orl_search *search)
{
    struct kept *kept = &leaves->kept[leaf];
    uint64_t word = atomic_load_explicit(&kept->value, memory_order_acquire);
    if (word == 0) {
        const struct orl_health before = search->health;
        const struct orl_density density = make_estimate(leaves, leaf, search);
        uint64_t expected = 0;
        word = pack_estimate(leaves, &density);
        keep_shares(kept, &density.parts);
        /* The thread that comes second does not count the estimate again. */
        if (!atomic_compare_exchange_strong(&kept->value, &expected, word))
            search->health = before;
    }
    return unpack_estimate(leaves, word);
}

/*
 * Returns true if the leaf's site is on the footing's surface, with no occluder between. An
 * estimate of a patch as a whole is used on its own facet only. It exists because the patch has
 * photons, so patches beside it must use their own.
 */
static bool is_joined(const struct orl_leaves *leaves, struct orl_leaf_near leaf,
                      const struct estimate *estimate, const struct orl_footing *footing)
{
    const double cell = leaves->map->header->cell, distance = sqrt((double)leaf.distance2) * cell;
    const struct orl_vec3 site =
        orl_leaf_center_point(leaves->map, orl_leaf_sites_of(leaves->sites, leaf.leaf));
    if (!footing)
        return true;
    if (estimate->patch && footing->facet != orl_leaf_sites_of(leaves->sites, leaf.leaf)->facet)
        return false;
    /* The site is on another, parallel surface close by. */
    if (fabs(orl_dot(orl_sub(site, footing->point), footing->normal)) > 4 * cell &&
        distance < orl_footing_flat(footing))
        return false;
    return distance < estimate->clear || orl_footing_joins(footing, site);
}

/* Returns true if the leaf is used at the point, and its value. */
static bool read_leaf(struct orl_leaves *leaves, struct orl_leaf_near leaf, const float at[3],
                      const struct orl_footing *footing, struct orl_search *search,
                      struct orl_rgb *ret_irradiance, struct orl_batches *ret_parts,
                      bool *ret_crowded)
{
    if (!orl_leaf_sites_serve(leaves->sites, leaf, at))
        return false;
    const struct estimate estimate = estimate_of(leaves, leaf.leaf, search);
    if (!is_joined(leaves, leaf, &estimate, footing))
        return false;
    if (ret_crowded && estimate.crowded) {
        *ret_crowded = true;
        *ret_irradiance = orl_gray(0);
        return true;
    }
    *ret_irradiance = estimate.irradiance;
    if (ret_parts)
        *ret_parts = parts_of(&leaves->kept[leaf.leaf], orl_luma(estimate.irradiance));
    return true;
}

struct orl_rgb orl_leaves_irradiance(struct orl_leaves *leaves, struct orl_vec3 point,
                                     struct orl_vec3 normal, const struct orl_footing *footing,
                                     struct orl_search *search, struct orl_batches *ret_parts,
                                     bool *ret_crowded)
{
    struct orl_leaf_near leaf;
    struct orl_rgb irradiance;
    float at[3];
    if (ret_crowded)
        *ret_crowded = false;
    orl_box_locate(leaves->map, point, at);
    if (orl_leaf_sites_about(leaves->sites, point, normal, &leaf) &&
        read_leaf(leaves, leaf, at, footing, search, &irradiance, ret_parts, ret_crowded))
        return irradiance;
    leaf = (struct orl_leaf_near){-1, 0};
    for (int i = 0;
         i < MOST_TRIES && orl_leaf_sites_next(leaves->sites, point, normal, leaf, &leaf); i++)
        if (read_leaf(leaves, leaf, at, footing, search, &irradiance, ret_parts, ret_crowded))
            return irradiance;
    struct orl_density_query query = query_at(leaves, point, normal);
    query.footing = footing;
    const struct orl_density density = orl_kernel_density_estimate(leaves->spread, &query, search);
    if (ret_crowded && footing && orl_is_crowded(footing, density.radius)) {
        *ret_crowded = true;
        return orl_gray(0);
    }
    if (ret_parts)
        *ret_parts = density.parts;
    return density.irradiance;
}
