#include "photon/search.h"

#include "photon/pack.h"

/* The same surface: normals within 45 degrees, chord within 0.05 of square to their mean. */
static const double same_side = 0.7071067811865476;
static const double same_sheet = 0.05;

struct walk {
    const struct orl_photon_map *map;
    const struct orl_density_query *query;
    struct orl_search_candidate *candidates;
    float at[3]; /* the query point, in cells, moved so that cell corners stand for centres */
    float radius2; /* in cells */
    uint32_t k, found;
};

static bool nearer(const struct orl_search_candidate *a, const struct orl_search_candidate *b)
{
    return a->distance2 < b->distance2 || (a->distance2 == b->distance2 && a->index < b->index);
}

static void swap(struct orl_search_candidate *a, struct orl_search_candidate *b)
{
    const struct orl_search_candidate t = *a;
    *a = *b;
    *b = t;
}

/* Puts the nth smallest at list[nth], smaller ones before it (Hoare's find). */
static void select_nth(struct orl_search_candidate *list, int64_t count, int64_t nth)
{
    int64_t low = 0, high = count - 1;
    while (low < high) {
        const struct orl_search_candidate pivot = list[low + (high - low) / 2];
        int64_t i = low, j = high;
        while (i <= j) {
            while (nearer(&list[i], &pivot))
                i++;
            while (nearer(&pivot, &list[j]))
                j--;
            if (i <= j)
                swap(&list[i++], &list[j--]);
        }
        if (nth <= j)
            high = j;
        else if (nth >= i)
            low = i;
        else
            return;
    }
}

static bool on_same_sheet(const struct walk *walk, uint32_t index, const float chord[3])
{
    const struct orl_vec3 n = orl_octahedral_decode(walk->map->normals[index]);
    const struct orl_vec3 q = walk->query->normal;
    if (orl_dot(n, q) < same_side)
        return false;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    const double off = 0.5 * fabs(orl_dot(c, orl_add(n, q)));
    return off <= same_sheet * orl_length(c) + 4; /* four cells for rounding */
}

static void scan_leaf(struct walk *walk, uint32_t leaf)
{
    const uint32_t *a = walk->map->places + (size_t)leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    const uint64_t first = (uint64_t)leaf * ORL_MAP_LEAF;
    const uint64_t left = walk->map->header->count - first;
    const uint32_t n = left < ORL_MAP_LEAF ? (uint32_t)left : ORL_MAP_LEAF;
    float dx[ORL_MAP_LEAF], dy[ORL_MAP_LEAF], dz[ORL_MAP_LEAF], d2[ORL_MAP_LEAF];
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        dx[i] = (float)(int32_t)(a[i] & 0xfffffU) - walk->at[0];
        dy[i] = (float)(int32_t)(b[i] & 0xfffffU) - walk->at[1];
        dz[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20) - walk->at[2];
        d2[i] = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
    }
    for (uint32_t i = 0; i < n; i++) {
        const float chord[3] = {dx[i], dy[i], dz[i]};
        const uint32_t index = (uint32_t)(first + i);
        if (!(d2[i] < walk->radius2) || !on_same_sheet(walk, index, chord))
            continue;
        walk->candidates[walk->found++] = (struct orl_search_candidate){d2[i], index};
        if (walk->found == 2 * walk->k) {
            /* Full: keep the nearest k, and look no further than the last of them. */
            select_nth(walk->candidates, walk->found, walk->k - 1);
            walk->found = walk->k;
            walk->radius2 = walk->candidates[walk->k - 1].distance2;
        }
    }
}

/* Squared distance from the point to each child's box. */
static void box_distances(const struct orl_map_group *group, const float at[3],
                          float ret_distance2[ORL_MAP_FANOUT])
{
    for (int c = 0; c < ORL_MAP_FANOUT; c++) {
        float sum = 0;
        for (int k = 0; k < 3; k++) {
            const float below = group->low[k][c] - at[k], above = at[k] - group->high[k][c];
            float out = below > above ? below : above;
            out = out > 0 ? out : 0;
            sum += out * out;
        }
        ret_distance2[c] = sum;
    }
}

struct visit {
    float distance2;
    uint32_t level, node;
};

/* Depth first, nearest child first. */
static void walk_boxes(struct walk *walk)
{
    struct visit stack[ORL_MAP_LEVELS * ORL_MAP_FANOUT];
    uint32_t depth = 0;
    if (walk->map->header->levels == 0)
        return;
    stack[depth++] = (struct visit){0, walk->map->header->levels, 0};
    while (depth > 0) {
        const struct visit at = stack[--depth];
        if (!(at.distance2 < walk->radius2))
            continue;
        if (at.level == 0) {
            scan_leaf(walk, at.node);
            continue;
        }
        float distance2[ORL_MAP_FANOUT];
        const uint32_t bottom = depth;
        box_distances(&walk->map->levels[at.level - 1][at.node], walk->at, distance2);
        for (uint32_t c = 0; c < ORL_MAP_FANOUT; c++) {
            if (!(distance2[c] < walk->radius2))
                continue;
            const struct visit child = {distance2[c], at.level - 1, at.node * ORL_MAP_FANOUT + c};
            uint32_t place = depth++;
            while (place > bottom && stack[place - 1].distance2 < child.distance2) {
                stack[place] = stack[place - 1];
                place--;
            }
            stack[place] = child;
        }
    }
}

static struct orl_rgb sum_fluxes(const struct walk *walk, uint32_t count)
{
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t i = 0; i < count; i++)
        sum = orl_rgb_add(sum, orl_flux_unpack(walk->map->fluxes[walk->candidates[i].index]));
    return orl_rgb_scale(sum, walk->map->header->flux_unit);
}

struct orl_density orl_density_estimate(const struct orl_photon_map *map,
                                        const struct orl_density_query *query,
                                        struct orl_search *search)
{
    const struct orl_map_header *h = map->header;
    const double point[3] = {query->point.x, query->point.y, query->point.z};
    const double reach = query->max_radius / h->cell;
    struct walk walk = {.map = map,
                        .query = query,
                        .candidates = search->candidates,
                        .radius2 = (float)(reach * reach),
                        .k = query->k < ORL_SEARCH_MOST ? query->k : ORL_SEARCH_MOST};
    struct orl_density density = {.radius = query->max_radius};
    for (int i = 0; i < 3; i++)
        walk.at[i] = (float)((point[i] - h->low[i]) / h->cell - 0.5);
    if (walk.k < 2)
        walk.k = 2;
    walk_boxes(&walk);
    density.found = walk.found;
    if (walk.found >= walk.k) {
        select_nth(walk.candidates, walk.found, walk.k - 1);
        density.found = walk.k - 1;
        density.radius = sqrt((double)walk.candidates[walk.k - 1].distance2) * h->cell;
    }
    if (density.found == 0)
        return density;
    /* Photons on one spot have no area to spread over but a cell's. */
    density.radius = fmax(density.radius, h->cell);
    density.irradiance = orl_rgb_scale(sum_fluxes(&walk, density.found),
                                       1 / (ORL_PI * density.radius * density.radius));
    return density;
}
