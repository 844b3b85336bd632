#include "photon/density/leaves.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/vectors.h"
#include "photon/density/crowd.h"
#include "photon/density/leaf_center.h"
#include "photon/map/boxes.h"
#include "photon/map/flux.h"
#include "photon/map/zorder.h"
#include "photon/surface/sheet.h"

enum { SHARE_WORDS = ORL_MAP_BATCHES / sizeof(uint64_t), BESIDE = 8, LINE = 64, CHUNK = 1 << 12 };

/* Of the unit that very bright leaves are kept in: where a sunbeam's photons crowd on a few
 * centimetres there is more than a word holds of the usual one. */
static const double coarser = 0x1p20;

/* A leaf's estimate as it is kept. */
struct kept {
    _Atomic uint64_t value; /* 0: not made yet; else the value, and above it the clear radius, which
                               is less than 0 of a patch; its last bits tell the value's unit,
                               and whether the place is crowded */
    _Atomic uint64_t shares[SHARE_WORDS]; /* of the batches; there before the value is */
};

/*
 * The leaves of a leaf's sheet whose sites are nearest to its own, itself first: numbers plus 1,
 * with zeros to end with, and sites. Two cache lines, so that a look-up waits for memory once. All
 * is there before the first number is, which is 0 while none were sought.
 */
struct beside {
    _Atomic uint32_t leaf[BESIDE];
    _Atomic float at[3][BESIDE];
};

struct orl_leaves {
    const struct orl_photon_map *map;
    const struct orl_world *world;
    uint64_t count;
    uint32_t k;
    double max_radius;
    double unit;  /* W/m2: of the values kept */
    float reach2; /* cells: how far a leaf may be */
    struct orl_kernel_density *spread;
    struct orl_zorder order;
    struct orl_leaf_center *sites;
    struct kept *kept;
    struct beside *beside; /* in the room below, from a cache line's beginning on */
    void *room;
};

/* A leaf's estimate. */
struct estimate {
    struct orl_rgb irradiance;
    double clear; /* no wall is nearer to the site */
    bool patch;   /* it is a small patch's as a whole, and speaks for no other */
    bool crowded; /* it is not what one sees */
};

enum { MOST_TRIES = 4, COARSE = 1, CROWDED = 2 };
/*
 * A leaf serves points within its spread times this. An even disc ends at 1.41. Served no further,
 * the points left over are the gaps, and what the leaves read is low by half a percent, for they
 * took the points where photons are and left those where they are not; served to 3 it is high by as
 * much. In between nothing is lost or made: measured in the integrating sphere.
 */
static const float reach_of_leaf = 1.85F;
/*
 * Beyond so many of its spreads, the half side of a square, a leaf serves a point only if another
 * one reaches it, too: at the edge of a shadow none does from the dark side, and what leaves there
 * served beyond would be light out of nothing, wherever their photons are few.
 */
static const float alone_reach_of_leaf = 1.2247449F;

/* Stands for zero irradiance: the smallest exponent with an empty mantissa, but not the empty word.
 */
static const uint32_t value_zero = 1U << 27;

static struct orl_density_query query_at(const struct orl_leaves *leaves, struct orl_vec3 point,
                                         struct orl_vec3 normal)
{
    return (struct orl_density_query){
        .point = point, .normal = normal, .k = leaves->k, .max_radius = leaves->max_radius};
}

static void make_sites(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_leaves *leaves = arg;
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < leaves->count; i++) {
        leaves->sites[i] = orl_leaf_center_make(leaves->map, i);
        orl_leaf_center_condense(leaves->map, &leaves->sites[i], i);
        orl_leaf_center_settle(leaves->map, &leaves->sites[i], i, leaves->world);
    }
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
    leaves->reach2 = (float)(max_radius / h->cell * (max_radius / h->cell));
    /* What k photons of mean flux make; or more, lest what the brightest makes be cut (flux.h). */
    leaves->unit = fmax(h->flux_mean, h->flux_unit) * k / (ORL_PI * max_radius * max_radius);
    leaves->sites = malloc((n + 1) * sizeof *leaves->sites);
    leaves->kept = calloc(n + 1, sizeof *leaves->kept);
    leaves->room = calloc(n + 1, sizeof *leaves->beside);
    leaves->spread = orl_kernel_density_new(map, k, max_radius, crew);
    if (!leaves->sites || !leaves->kept || !leaves->room || !leaves->spread ||
        orl_zorder_init(&leaves->order, map) < 0) {
        orl_leaves_free(leaves);
        return NULL;
    }
    leaves->beside = (void *)(((uintptr_t)leaves->room + LINE - 1) / LINE * LINE);
    orl_crew_for(crew, (n + CHUNK - 1) / CHUNK, make_sites, leaves);
    return leaves;
}

void orl_leaves_free(struct orl_leaves *leaves)
{
    if (!leaves)
        return;
    orl_kernel_density_free(leaves->spread);
    orl_zorder_done(&leaves->order);
    free(leaves->sites);
    free(leaves->kept);
    free(leaves->room);
    free(leaves);
}

void orl_leaves_rebind(struct orl_leaves *leaves, const struct orl_photon_map *map,
                       const struct orl_world *world)
{
    leaves->map = map;
    leaves->world = world;
    orl_kernel_density_rebind(leaves->spread, map);
}

uint64_t orl_leaves_bytes(const struct orl_leaves *leaves)
{
    /* Of a leaf, and beside it its radius and its code, with the eighths above them. */
    const uint64_t each = sizeof *leaves->sites + sizeof *leaves->kept + sizeof *leaves->beside +
                          2 * (sizeof(float) + sizeof(uint64_t));
    return leaves->count * each + sizeof *leaves;
}

static struct orl_density make_estimate(const struct orl_leaves *leaves, uint32_t leaf,
                                        struct orl_search *search)
{
    struct orl_density_query query = query_at(leaves, orl_v3(0, 0, 0), orl_v3(0, 0, 1));
    struct orl_footing footing;
    orl_leaf_center_ask(leaves->map, &leaves->sites[leaf], leaf, leaves->world, &query, &footing);
    struct orl_density density = orl_kernel_density_estimate(leaves->spread, &query, search);
    density.crowded = query.footing && orl_is_crowded(&footing, density.radius);
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

/* The parts of a leaf's value, which has been made. */
static struct orl_batches parts_of(const struct kept *kept, double luma)
{
    uint64_t words[SHARE_WORDS];
    uint8_t shares[ORL_MAP_BATCHES];
    for (int i = 0; i < SHARE_WORDS; i++)
        words[i] = atomic_load_explicit(&kept->shares[i], memory_order_relaxed);
    memcpy(shares, words, sizeof shares);
    return orl_batches_unpack(shares, luma);
}

/* The leaf's estimate, made now if nobody has; two that make it at once make the same words. */
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
        /* Who comes second does not count it again. */
        if (!atomic_compare_exchange_strong(&kept->value, &expected, word))
            search->health = before;
    }
    return unpack_estimate(leaves, word);
}

/* A leaf and its site's squared distance, in cells. */
struct candidate {
    float distance2;
    uint32_t leaf;
};

static bool comes_before(struct candidate a, struct candidate b)
{
    return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && a.leaf < b.leaf);
}

static float distance2_to(const struct orl_leaves *leaves, uint32_t leaf, const float at[3],
                          float ret_chord[3])
{
    const float *site = leaves->sites[leaf].at;
    for (int k = 0; k < 3; k++)
        ret_chord[k] = site[k] - at[k];
    return ret_chord[0] * ret_chord[0] + ret_chord[1] * ret_chord[1] + ret_chord[2] * ret_chord[2];
}

/*
 * The nearest leaf whose site is on the query's sheet, of those that come after `last`; false when
 * none is within reach.
 */
ORL_FOR_WIDE_VECTORS static bool next_leaf(const struct orl_leaves *leaves, struct orl_vec3 point,
                                           struct orl_vec3 normal, struct candidate last,
                                           struct candidate *ret_next)
{
    const struct orl_photon_map *map = leaves->map;
    const uint16_t code = orl_normal_encode(normal);
    struct orl_box_visit stack[ORL_BOX_STACK];
    struct candidate best = {leaves->reach2, 0};
    uint32_t depth = 0;
    float at[3];
    bool found = false;
    const uint32_t facing = orl_facing_mask(&map->facing, normal);
    orl_box_locate(map, point, at);
    if (map->header->levels > 0)
        stack[depth++] = (struct orl_box_visit){0, map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit visit = stack[--depth];
        if (!(visit.distance2 <= best.distance2))
            continue;
        if (visit.level > 0) {
            depth = orl_box_push(map, visit, at, facing, best.distance2, stack, depth);
            continue;
        }
        float chord[3];
        const struct candidate here = {distance2_to(leaves, visit.node, at, chord), visit.node};
        if (comes_before(here, best) && comes_before(last, here) &&
            orl_same_sheet(normal, code, leaves->sites[visit.node].normal, chord)) {
            best = here;
            found = true;
        }
    }
    *ret_next = best;
    return found;
}

/* A leaf and those beside it, the nearest first; returns how many. */
ORL_FOR_WIDE_VECTORS static uint32_t find_beside(const struct orl_leaves *leaves, uint32_t leaf,
                                                 struct candidate ret_beside[BESIDE])
{
    const struct orl_photon_map *map = leaves->map;
    const struct orl_leaf_center *own = &leaves->sites[leaf];
    const struct orl_vec3 normal = orl_normal_decode(own->normal);
    const uint32_t facing = orl_facing_mask(&map->facing, normal);
    struct orl_box_visit stack[ORL_BOX_STACK];
    uint32_t depth = 0, found = 0;
    float within2 = leaves->reach2;
    stack[depth++] = (struct orl_box_visit){0, map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit visit = stack[--depth];
        if (!(visit.distance2 < within2))
            continue;
        if (visit.level > 0) {
            depth = orl_box_push(map, visit, own->at, facing, within2, stack, depth);
            continue;
        }
        float chord[3];
        const struct candidate here = {distance2_to(leaves, visit.node, own->at, chord),
                                       visit.node};
        if (!(here.distance2 < within2) ||
            !orl_same_sheet(normal, own->normal, leaves->sites[visit.node].normal, chord))
            continue;
        uint32_t place = found < BESIDE ? found++ : BESIDE - 1;
        for (; place > 0 && comes_before(here, ret_beside[place - 1]); place--)
            ret_beside[place] = ret_beside[place - 1];
        ret_beside[place] = here;
        if (found == BESIDE)
            within2 = ret_beside[BESIDE - 1].distance2;
    }
    return found;
}

/* Seeks the leaves beside a leaf if nobody has; two that do it at once find the same. */
static struct beside *know_beside(const struct orl_leaves *leaves, uint32_t leaf)
{
    struct beside *beside = &leaves->beside[leaf];
    struct candidate found[BESIDE];
    if (atomic_load_explicit(&beside->leaf[0], memory_order_acquire) != 0)
        return beside;
    uint32_t n = find_beside(leaves, leaf, found);
    if (n == 0)
        found[n++] = (struct candidate){0, leaf};
    for (uint32_t i = n; i-- > 0;) {
        for (int k = 0; k < 3; k++)
            atomic_store_explicit(&beside->at[k][i], leaves->sites[found[i].leaf].at[k],
                                  memory_order_relaxed);
        atomic_store_explicit(&beside->leaf[i], found[i].leaf + 1, memory_order_release);
    }
    return beside;
}

/*
 * Whether the leaf covers the place. In a sun patch leaves are small and many: were the nearest to
 * serve whatever its size, they would light the dark around them, half way to its sparse leaves.
 */
static bool covers(const struct orl_leaves *leaves, struct candidate leaf, float reach)
{
    return leaf.distance2 <= reach * reach * (leaves->sites[leaf.leaf].spread2 + 1);
}

/* Whether it may serve the place: it covers that amply, or another one beside it does so, too. */
static bool covers_well(const struct orl_leaves *leaves, struct candidate leaf, const float at[3])
{
    if (covers(leaves, leaf, alone_reach_of_leaf))
        return true;
    if (!covers(leaves, leaf, reach_of_leaf))
        return false;
    const struct beside *beside = know_beside(leaves, leaf.leaf);
    for (int i = 1; i < BESIDE; i++) {
        struct candidate other = {0, atomic_load_explicit(&beside->leaf[i], memory_order_relaxed)};
        for (int k = 0; k < 3; k++) {
            const float off = atomic_load_explicit(&beside->at[k][i], memory_order_relaxed) - at[k];
            other.distance2 += off * off;
        }
        if (other.leaf-- != 0 && covers(leaves, other, reach_of_leaf))
            return true;
    }
    return false;
}

/*
 * Whether the leaf's site is on the footing's surface, and nothing stands between. Of a patch that
 * was taken in as a whole the estimate holds its own photons, that there are any being why one
 * asked there: patches beside it are to have theirs.
 */
static bool is_joined(const struct orl_leaves *leaves, struct candidate leaf,
                      const struct estimate *estimate, const struct orl_footing *footing)
{
    const double cell = leaves->map->header->cell, distance = sqrt((double)leaf.distance2) * cell;
    const struct orl_vec3 site = orl_leaf_center_point(leaves->map, &leaves->sites[leaf.leaf]);
    if (!footing)
        return true;
    if (estimate->patch && footing->facet != leaves->sites[leaf.leaf].facet)
        return false;
    /* On another, parallel surface close by. */
    if (fabs(orl_dot(orl_sub(site, footing->point), footing->normal)) > 4 * cell &&
        distance < orl_footing_flat(footing))
        return false;
    return distance < estimate->clear || orl_footing_joins(footing, site);
}

/* Whether the leaf serves the point: then what it has to say. */
static bool reads(struct orl_leaves *leaves, struct candidate leaf, const float at[3],
                  const struct orl_footing *footing, struct orl_search *search,
                  struct orl_rgb *ret_irradiance, struct orl_batches *ret_parts, bool *ret_crowded)
{
    if (!covers_well(leaves, leaf, at))
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

/*
 * The leaf whose site is nearest to the point, of those beside the one that it would stand in by
 * the order of the map.
 */
static bool leaf_about(const struct orl_leaves *leaves, struct orl_vec3 point,
                       struct orl_vec3 normal, struct candidate *ret_leaf)
{
    const uint16_t code = orl_normal_encode(normal);
    struct candidate best = {INFINITY, 0};
    uint32_t cell[3];
    float at[3], chord[3];
    if (leaves->map->header->count == 0)
        return false;
    orl_box_locate(leaves->map, point, at);
    for (int k = 0; k < 3; k++)
        cell[k] = (uint32_t)fminf(fmaxf(at[k] + 0.5F, 0), ORL_PLACE_CELLS - 1);
    const uint64_t home = orl_zorder_find(&leaves->order, orl_zorder_code(cell, code));
    struct beside *beside = know_beside(leaves, (uint32_t)home);
    for (int i = 0; i < BESIDE; i++) {
        const uint32_t leaf = atomic_load_explicit(&beside->leaf[i], memory_order_relaxed);
        struct candidate here = {0, leaf - 1};
        for (int k = 0; k < 3; k++) {
            const float off = atomic_load_explicit(&beside->at[k][i], memory_order_relaxed) - at[k];
            here.distance2 += off * off;
        }
        if (leaf != 0 && comes_before(here, best))
            best = here;
    }
    distance2_to(leaves, best.leaf, at, chord);
    *ret_leaf = best;
    return orl_same_sheet(normal, code, leaves->sites[best.leaf].normal, chord);
}

struct orl_rgb orl_leaves_irradiance(struct orl_leaves *leaves, struct orl_vec3 point,
                                     struct orl_vec3 normal, const struct orl_footing *footing,
                                     struct orl_search *search, struct orl_batches *ret_parts,
                                     bool *ret_crowded)
{
    struct candidate leaf;
    struct orl_rgb irradiance;
    float at[3];
    if (ret_crowded)
        *ret_crowded = false;
    orl_box_locate(leaves->map, point, at);
    if (leaf_about(leaves, point, normal, &leaf) &&
        reads(leaves, leaf, at, footing, search, &irradiance, ret_parts, ret_crowded))
        return irradiance;
    leaf = (struct candidate){-1, 0};
    for (int i = 0; i < MOST_TRIES && next_leaf(leaves, point, normal, leaf, &leaf); i++)
        if (reads(leaves, leaf, at, footing, search, &irradiance, ret_parts, ret_crowded))
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
