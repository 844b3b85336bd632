#include "photon/density/density_estimate.h"

#include <string.h>

#include "base/multiversion.h"
#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"
#include "photon/surface/footprint.h"

/* Up to this k the search does not start from a small radius. */
enum { FEW = 16 };

struct traversal {
    const struct orl_photon_map *map;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint; /* NULL: the whole disc */
    struct orl_search_candidate *candidates;
    float flat2; /* squared cells: photons nearer than this lie in the surface point's plane */
    /* the query point, in cells, shifted so that cell corners represent centres */
    float at[3];
    float radius2;   /* squared cells */
    float hint2;     /* squared cells: likely radius of the k nearest; 0: unknown */
    uint32_t enough; /* a footprint with this many photons is not enlarged */
    /* room: candidates stored before the list is reduced to the nearest k, > k */
    uint32_t k, found, room;
    float normal_f[3];    /* the query's normal */
    uint16_t normal;      /* its code */
    uint32_t normal_bins; /* mask of the bins of normals to search */
};

static bool is_nearer(const struct orl_search_candidate *a, const struct orl_search_candidate *b)
{
    return a->distance2 < b->distance2 || (a->distance2 == b->distance2 && a->index < b->index);
}

static void swap_candidates(struct orl_search_candidate *a, struct orl_search_candidate *b)
{
    const struct orl_search_candidate t = *a;
    *a = *b;
    *b = t;
}

/* Partially sorts the list: the nth smallest is at list[nth], smaller ones before it (Hoare's
 * quickselect). */
static void select_nth(struct orl_search_candidate *list, int64_t count, int64_t nth)
{
    int64_t low = 0, high = count - 1;
    while (low < high) {
        const struct orl_search_candidate pivot = list[low + (high - low) / 2];
        int64_t i = low, j = high;
        while (i <= j) {
            while (is_nearer(&list[i], &pivot))
                i++;
            while (is_nearer(&pivot, &list[j]))
                j--;
            if (i <= j)
                swap_candidates(&list[i++], &list[j--]);
        }
        if (nth <= j)
            high = j;
        else if (nth >= i)
            low = i;
        else
            return;
    }
}

/* A leaf's photons relative to the query: offsets in cells, and a bit for each that is within the
 * radius and may lie on the point's sheet. */
struct leaf_photons {
    float x[ORL_MAP_LEAF], y[ORL_MAP_LEAF], z[ORL_MAP_LEAF], d2[ORL_MAP_LEAF];
    uint32_t near;
    uint32_t other_codes; /* those whose normal's code is not the query's: orl_same_sheet decides */
};

static inline __attribute__((always_inline)) void
find_offsets(const struct traversal *traversal, uint32_t leaf, struct leaf_photons *ret_photons)
{
    const uint32_t *a = traversal->map->places + (size_t)leaf * ORL_LEAF_WORDS,
                   *b = a + ORL_MAP_LEAF;
    struct leaf_photons *p = ret_photons;
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        p->x[i] = (float)(int32_t)(a[i] & 0xfffffU) - traversal->at[0];
        p->y[i] = (float)(int32_t)(b[i] & 0xfffffU) - traversal->at[1];
        p->z[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20) - traversal->at[2];
        p->d2[i] = p->x[i] * p->x[i] + p->y[i] * p->y[i] + p->z[i] * p->z[i];
    }
}

/* Returns a bit for each photon of a leaf whose coded normal is not the query's: mostly none. */
static inline __attribute__((always_inline)) uint32_t
find_other_codes(const struct traversal *traversal, uint32_t leaf)
{
    const uint16_t *normals = traversal->map->normals + (size_t)leaf * ORL_MAP_LEAF;
    const uint64_t own = traversal->normal * UINT64_C(0x0001000100010001);
    uint64_t four[ORL_MAP_LEAF / 4], differ = 0;
    uint32_t others = 0;
    memcpy(four, normals, sizeof four);
    for (uint32_t i = 0; i < ORL_MAP_LEAF / 4; i++)
        differ |= four[i] ^ own;
    for (uint32_t i = 0; differ != 0 && i < ORL_MAP_LEAF; i++)
        others |= (uint32_t)(normals[i] != traversal->normal) << i;
    return others;
}

/*
 * Sets the bits of a leaf's n photons, by orl_chord_fits with the slope of flat sheets, in float.
 * Close to the query a photon must be in its own plane, within rounding. The loop is for vectors:
 * it is not unrolled, and tests all 16 photons of a leaf.
 */
static inline __attribute__((always_inline)) void
find_near(const struct traversal *traversal, uint32_t leaf, uint32_t n, struct leaf_photons *p)
{
    const float slope2 = (float)(orl_sheet_flat_slope * orl_sheet_flat_slope), rounding = 4;
    const float *normal = traversal->normal_f, radius2 = traversal->radius2;
    const float flat2 = traversal->flat2;
    uint32_t fits = 0, inside = 0;
#pragma GCC unroll 1
    for (uint32_t i = 0; i < ORL_MAP_LEAF; i++) {
        const float d2 = p->d2[i];
        const float off =
            fabsf(p->x[i] * normal[0] + p->y[i] * normal[1] + p->z[i] * normal[2]) - rounding;
        fits |= (uint32_t)((off <= 0) | (off * off <= slope2 * d2)) << i;
        inside |= (uint32_t)((d2 < radius2) & ((d2 >= flat2) | (off <= 0))) << i;
    }
    p->other_codes = find_other_codes(traversal, leaf);
    p->near = inside & (fits | p->other_codes) & ((1U << n) - 1);
}

/* Returns true if a near photon is not the query's own, and is on the point's sheet and in the
 * footprint. */
static bool is_taken(const struct traversal *traversal, const struct leaf_photons *p, uint32_t i,
                     uint32_t photon)
{
    const double cell = traversal->map->header->cell;
    const float chord[3] = {p->x[i], p->y[i], p->z[i]};
    if (traversal->query->at_photon && photon == traversal->query->skip)
        return false;
    if ((p->other_codes >> i & 1) && !orl_same_sheet(traversal->query->normal, traversal->normal,
                                                     traversal->map->normals[photon], chord))
        return false;
    return !traversal->footprint ||
           orl_footprint_contains(traversal->footprint,
                                  orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell));
}

/* Reduces a full list to the nearest k, and the radius to that of the last of them. */
static void keep_nearest(struct traversal *traversal)
{
    select_nth(traversal->candidates, traversal->found, traversal->k - 1);
    traversal->found = traversal->k;
    traversal->radius2 = traversal->candidates[traversal->k - 1].distance2;
}

static inline __attribute__((always_inline)) void scan_leaf(struct traversal *traversal,
                                                            uint32_t leaf)
{
    const uint32_t first = leaf * ORL_MAP_LEAF, n = orl_leaf_photons(traversal->map, leaf);
    const bool test_all = traversal->footprint || traversal->query->at_photon;
    struct leaf_photons p;
    find_offsets(traversal, leaf, &p);
    find_near(traversal, leaf, n, &p);
    const uint32_t tested = test_all ? p.near : p.other_codes;
    for (uint32_t near = p.near; near != 0; near &= near - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(near);
        if (!(p.d2[i] < traversal->radius2) ||
            ((tested >> i & 1) && !is_taken(traversal, &p, i, first + i)))
            continue;
        traversal->candidates[traversal->found++] =
            (struct orl_search_candidate){p.d2[i], first + i};
        if (traversal->found == traversal->room)
            keep_nearest(traversal);
    }
}

/* Prefetches the words and normals of a leaf that will be visited soon. */
static inline void prefetch_leaf(const struct traversal *traversal,
                                 const struct orl_box_visit *visit)
{
    const uint32_t *words = traversal->map->places + (size_t)visit->node * ORL_LEAF_WORDS;
    if (visit->level > 0)
        return;
    __builtin_prefetch(words);
    __builtin_prefetch(words + ORL_MAP_LEAF);
    __builtin_prefetch(traversal->map->normals + (size_t)visit->node * ORL_MAP_LEAF);
}

/* Visits nodes depth first, nearest child first. */
ORL_FOR_WIDE_VECTORS static void walk_boxes(struct traversal *traversal)
{
    struct orl_box_visit stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    if (traversal->map->header->levels == 0)
        return;
    stack[depth++] = (struct orl_box_visit){0, traversal->map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit at = stack[--depth];
        if (!(at.distance2 < traversal->radius2))
            continue;
        if (at.level == 0) {
            scan_leaf(traversal, at.node);
            continue;
        }
        const uint32_t below = depth;
        depth = orl_box_push(traversal->map, at, traversal->at, traversal->normal_bins,
                             traversal->radius2, stack, depth);
        for (uint32_t i = below; i < depth; i++)
            prefetch_leaf(traversal, &stack[i]);
    }
}

static float diagonal2_of(const struct orl_map_group *group, uint32_t child)
{
    float sum = 1;
    for (int i = 0; i < 3; i++) {
        const float side = group->high[i][child] - group->low[i][child];
        sum += side * side;
    }
    return sum;
}

/*
 * Returns an initial squared radius from the leaves around the point: as if the photons of one lay
 * on a square that just fits its box, so k of them take k/16 of its area. The nearest leaf may be
 * two patches far apart; so the smallest one beside it is considered, too. Too small an initial
 * radius costs little, too large a one very much, so it is made for three quarters of k. For small
 * k, chance is too large for that: it is made for twice k, and most photons are left out again.
 */
static float first_radius2(const struct traversal *traversal)
{
    uint32_t node = 0, nearest = 0;
    const struct orl_map_group *group = NULL;
    float smallest2 = INFINITY;
    for (uint32_t level = traversal->map->header->levels; level-- > 0;) {
        float distance2[ORL_MAP_FANOUT];
        group = &traversal->map->levels[level][node];
        orl_box_distances(group, traversal->at, distance2);
        nearest = 0;
        for (uint32_t c = 0; c < ORL_MAP_FANOUT; c++) {
            if (!(group->normal_bins[c] & traversal->normal_bins))
                distance2[c] = INFINITY;
            else if (level == 0)
                smallest2 = fminf(smallest2, diagonal2_of(group, c));
            if (distance2[c] < distance2[nearest])
                nearest = c;
        }
        node = node * ORL_MAP_FANOUT + nearest;
    }
    const float diagonal2 = group ? fminf(diagonal2_of(group, nearest), 3 * smallest2) : 1;
    const float share = traversal->k > FEW ? 0.75F : 2.0F;
    return diagonal2 * share * (float)(1 / (2 * ORL_PI) / ORL_MAP_LEAF) * (float)traversal->k;
}

/* Searches with growing radius until there are k photons, or all within the maximum radius. */
static void search_nearest(struct traversal *traversal)
{
    const float most2 = traversal->radius2;
    float radius2 = traversal->hint2 > 0                 ? traversal->hint2
                    : traversal->map->header->levels > 0 ? first_radius2(traversal)
                                                         : most2;
    for (;;) {
        traversal->radius2 = radius2 < most2 ? radius2 : most2;
        traversal->found = 0;
        walk_boxes(traversal);
        if (traversal->found >= traversal->k || !(radius2 < most2))
            return;
        /* Grows in proportion to the missing photons, and a little more. */
        const float lack = 1.3F * (float)traversal->k / (float)(traversal->found + 1);
        radius2 *= fminf(lack, 8);
    }
}

/* Divides the fluxes of the first density->found photons by the area, in all and by batch. */
static void spread_fluxes(const struct traversal *traversal, struct orl_density *density)
{
    const double unit = traversal->map->header->flux_unit / density->area;
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < density->found; i++) {
        const uint32_t index = traversal->candidates[i].index;
        const struct orl_rgb flux = orl_flux_unpack(traversal->map->fluxes[index]);
        sum = orl_rgb_add(sum, flux);
        density->parts.luma[orl_photon_batch(traversal->map, index)] += unit * orl_luma(flux);
    }
    density->irradiance = orl_rgb_scale(sum, unit);
    density->standard_error = sqrt(orl_batches_variance(&density->parts));
}

/* Finds the nearest photons of the disc, or the footprint, within max_radius. */
static struct orl_density find_within(struct traversal *traversal, double max_radius)
{
    const double cell = traversal->map->header->cell, reach = max_radius / cell;
    struct orl_density density = {.radius = max_radius};
    traversal->radius2 = (float)(reach * reach);
    search_nearest(traversal);
    density.found = traversal->found;
    if (traversal->found >= traversal->k) {
        select_nth(traversal->candidates, traversal->found, traversal->k - 1);
        density.found = traversal->k - 1;
        density.radius = sqrt((double)traversal->candidates[traversal->k - 1].distance2) * cell;
    }
    /* The area of photons at one point is at least that of a cell. */
    density.radius = orl_larger(density.radius, cell);
    density.clearance = density.radius;
    return density;
}

/* Returns the squared radius, in cells, slightly beyond the one at which the footprint has the
 * area of the disc. */
static float hint_of(const struct traversal *traversal, double disc)
{
    const double radius =
        1.1 * orl_footprint_equal_radius(traversal->footprint, disc) / traversal->map->header->cell;
    return (float)(radius * radius);
}

/* Searches the footprint: out to twice the radius of the disc that holds k, or to the maximum
 * radius. */
static struct orl_density find_in_footprint(struct traversal *traversal, double disc,
                                            struct orl_footprint *footprint)
{
    const double most = traversal->query->max_radius;
    struct orl_density density;
    double reach = orl_smaller(2 * disc, most);
    traversal->footprint = footprint;
    for (;;) {
        orl_footprint_make(traversal->query->surface_point, reach, footprint);
        traversal->hint2 = hint_of(traversal, disc);
        density = find_within(traversal, reach);
        density.clearance = orl_smaller(footprint->clearance, density.radius);
        if (!(reach < most) || density.found >= traversal->enough)
            return density;
        reach = most;
    }
}

static struct traversal traversal_of(const struct orl_photon_map *map,
                                     const struct orl_density_query *query,
                                     struct orl_search *search)
{
    struct traversal traversal = {
        .map = map,
        .query = query,
        .candidates = search->candidates,
        .k = query->k < ORL_SEARCH_MOST ? query->k : ORL_SEARCH_MOST,
        .normal_f = {(float)query->normal.x, (float)query->normal.y, (float)query->normal.z},
        .normal = orl_normal_encode(query->normal),
        .normal_bins = orl_normal_bins_mask(&map->normal_bins, query->normal)};
    orl_box_locate(map, query->point, traversal.at);
    if (traversal.k < 2)
        traversal.k = 2;
    traversal.room = traversal.k > FEW ? 4 * traversal.k : 2 * traversal.k;
    if (traversal.room > 2 * ORL_SEARCH_MOST)
        traversal.room = 2 * ORL_SEARCH_MOST;
    if (query->surface_point) {
        const double flat = orl_surface_point_flat_radius(query->surface_point) / map->header->cell;
        traversal.flat2 = (float)orl_smaller(flat * flat, 1e30);
    }
    return traversal;
}

/* Searches the disc first, and if it is cut the footprint. Fills in all but the irradiance. */
static struct orl_density find_photons(struct traversal *traversal, struct orl_footprint *footprint,
                                       struct orl_health *health)
{
    const struct orl_density_query *query = traversal->query;
    struct orl_density density = find_within(traversal, query->max_radius);
    if (query->surface_point && density.found > 0 &&
        !orl_surface_point_is_clear(query->surface_point, density.radius))
        density = find_in_footprint(traversal, density.radius, footprint);
    health->estimates += density.found > 0;
    if (density.found > 0 && density.found < ORL_SEARCH_SPARSE &&
        density.found + 1 < traversal->k && density.found < traversal->map->header->count)
        health->sparse++;
    return density;
}

struct orl_density orl_density_estimate(const struct orl_photon_map *map,
                                        const struct orl_density_query *query,
                                        struct orl_search *search)
{
    struct traversal traversal = traversal_of(map, query, search);
    traversal.enough = (traversal.k + 3) / 4;
    struct orl_footprint footprint;
    struct orl_density density = find_photons(&traversal, &footprint, &search->health);
    const double cell = map->header->cell;
    if (density.found == 0)
        return density;
    const double area = traversal.footprint
                            ? orl_footprint_area(traversal.footprint, density.radius)
                            : ORL_PI * density.radius * density.radius;
    density.area = orl_larger(area, ORL_PI * cell * cell);
    spread_fluxes(&traversal, &density);
    return density;
}

double orl_density_bias(const struct orl_photon_map *map, const struct orl_density_query *query,
                        const struct orl_density *estimate, struct orl_search *search)
{
    static const double least = 1.4; /* minimum ratio of the areas */
    struct orl_density_query other = *query;
    struct orl_health before = search->health;
    if (estimate->found == 0)
        return 0;
    other.k = 2 * query->k;
    struct orl_density second = orl_density_estimate(map, &other, search);
    if (second.area < least * estimate->area) {
        other.max_radius = estimate->radius * sqrt(0.5);
        second = orl_density_estimate(map, &other, search);
    }
    search->health = before; /* this is not an estimate of its own */
    if (orl_larger(second.area, estimate->area) < least * orl_smaller(second.area, estimate->area))
        return 0;
    struct orl_batches difference = second.parts;
    orl_batches_add(&difference, &estimate->parts, -1);
    return orl_batches_shrink(&difference) * estimate->area / (second.area - estimate->area);
}

uint32_t orl_density_nearest(const struct orl_photon_map *map,
                             const struct orl_density_query *query, struct orl_search *search,
                             double *ret_radius)
{
    struct traversal traversal = traversal_of(map, query, search);
    const struct orl_density density = find_within(&traversal, query->max_radius);
    *ret_radius = density.radius;
    return density.found;
}
