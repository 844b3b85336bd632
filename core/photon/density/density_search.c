#include "photon/density/density_estimate.h"

#include "base/multiversion.h"
#include "photon/density/leaf_photons.h"

/* Up to this k the search does not start from a small radius. */
enum { FEW = 16 };

struct traversal {
    struct orl_photon_filter filter;
    struct orl_search_candidate *candidates;
    float radius2;   /* squared cells */
    float hint2;     /* squared cells: likely radius of the k nearest; 0: unknown */
    uint32_t enough; /* a footprint with this many photons is not enlarged */
    /* room: candidates stored before the list is reduced to the nearest k, > k */
    uint32_t k, found, room;
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

/* Reduces a full list to the nearest k, and the radius to that of the last of them. */
static void keep_nearest(struct traversal *traversal)
{
    select_nth(traversal->candidates, traversal->found, traversal->k - 1);
    traversal->found = traversal->k;
    traversal->radius2 = traversal->candidates[traversal->k - 1].distance2;
}

ORL_ALWAYS_INLINE void scan_leaf(struct traversal *traversal, uint32_t leaf)
{
    const uint32_t first = leaf * ORL_MAP_LEAF;
    struct orl_leaf_matches photons;
    orl_leaf_find_near(&traversal->filter, leaf, traversal->radius2, &photons);
    for (uint32_t near = photons.near; near != 0; near &= near - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(near);
        if (!(photons.d2[i] < traversal->radius2) ||
            ((photons.to_be_tested >> i & 1) &&
             !orl_photon_counts(&traversal->filter, &photons, i, first + i)))
            continue;
        traversal->candidates[traversal->found++] =
            (struct orl_search_candidate){photons.d2[i], first + i};
        if (traversal->found == traversal->room)
            keep_nearest(traversal);
    }
}

/* Prefetches the words and normals of a leaf that will be visited soon. */
static inline void prefetch_leaf(const struct traversal *traversal,
                                 const struct orl_box_visit *visit)
{
    const uint32_t *words = traversal->filter.map->places + (size_t)visit->node * ORL_LEAF_WORDS;
    if (visit->level > 0)
        return;
    __builtin_prefetch(words);
    __builtin_prefetch(words + ORL_MAP_LEAF);
    __builtin_prefetch(traversal->filter.map->normals + (size_t)visit->node * ORL_MAP_LEAF);
}

/* Visits nodes depth first, nearest child first. */
ORL_FOR_WIDE_VECTORS static void walk_boxes(struct traversal *traversal)
{
    struct orl_box_visit stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    if (traversal->filter.map->header->levels == 0)
        return;
    stack[depth++] = (struct orl_box_visit){0, traversal->filter.map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit at = stack[--depth];
        if (!(at.distance2 < traversal->radius2))
            continue;
        if (at.level == 0) {
            scan_leaf(traversal, at.node);
            continue;
        }
        const uint32_t below = depth;
        depth = orl_box_push(traversal->filter.map, at, traversal->filter.at,
                             traversal->filter.normal_bins, traversal->radius2, stack, depth);
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
    for (uint32_t level = traversal->filter.map->header->levels; level-- > 0;) {
        float distance2[ORL_MAP_FANOUT];
        group = &traversal->filter.map->levels[level][node];
        orl_box_distances(group, traversal->filter.at, distance2);
        nearest = 0;
        for (uint32_t c = 0; c < ORL_MAP_FANOUT; c++) {
            if (!(group->normal_bins[c] & traversal->filter.normal_bins))
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
    float radius2 = traversal->hint2 > 0                        ? traversal->hint2
                    : traversal->filter.map->header->levels > 0 ? first_radius2(traversal)
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
    const double unit = traversal->filter.map->header->flux_unit / density->area;
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < density->found; i++) {
        const uint32_t index = traversal->candidates[i].index;
        const struct orl_rgb flux = orl_flux_unpack(traversal->filter.map->fluxes[index]);
        sum = orl_rgb_add(sum, flux);
        density->parts.luma[orl_photon_batch(traversal->filter.map, index)] +=
            unit * orl_luma(flux);
    }
    density->irradiance = orl_rgb_scale(sum, unit);
    density->standard_error = sqrt(orl_batches_variance(&density->parts));
}

/* Finds the nearest photons of the disc, or the footprint, within max_radius. */
static struct orl_density find_within(struct traversal *traversal, double max_radius)
{
    const double cell = traversal->filter.map->header->cell, reach = max_radius / cell;
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
    const double radius = 1.1 * orl_footprint_equal_radius(traversal->filter.footprint, disc) /
                          traversal->filter.map->header->cell;
    return (float)(radius * radius);
}

/* Searches the footprint: out to twice the radius of the disc that holds k, or to the maximum
 * radius. */
static struct orl_density find_in_footprint(struct traversal *traversal, double disc,
                                            struct orl_footprint *footprint)
{
    const double most = traversal->filter.query->max_radius;
    struct orl_density density;
    double reach = orl_smaller(2 * disc, most);
    traversal->filter.footprint = footprint;
    for (;;) {
        orl_footprint_make(traversal->filter.query->surface_point, reach, footprint);
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
    struct traversal traversal = {.filter = orl_photon_filter_make(map, query),
                                  .candidates = search->candidates,
                                  .k = query->k < ORL_SEARCH_MOST ? query->k : ORL_SEARCH_MOST};
    if (traversal.k < 2)
        traversal.k = 2;
    traversal.room = traversal.k > FEW ? 4 * traversal.k : 2 * traversal.k;
    if (traversal.room > 2 * ORL_SEARCH_MOST)
        traversal.room = 2 * ORL_SEARCH_MOST;
    return traversal;
}

/* Searches the disc first, and if it is cut the footprint. Fills in all but the irradiance. */
static struct orl_density find_photons(struct traversal *traversal, struct orl_footprint *footprint,
                                       struct orl_health *health)
{
    const struct orl_density_query *query = traversal->filter.query;
    struct orl_density density = find_within(traversal, query->max_radius);
    if (query->surface_point && density.found > 0 &&
        !orl_surface_point_is_clear(query->surface_point, density.radius))
        density = find_in_footprint(traversal, density.radius, footprint);
    health->estimates += density.found > 0;
    if (density.found > 0 && density.found < ORL_SEARCH_SPARSE &&
        density.found + 1 < traversal->k && density.found < traversal->filter.map->header->count)
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
    const double area = traversal.filter.footprint
                            ? orl_footprint_area(traversal.filter.footprint, density.radius)
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
