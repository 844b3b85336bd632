#include "photon/leaves.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "photon/boxes.h"
#include "photon/flux.h"
#include "photon/sheet.h"

/* Where a leaf's estimate is made: at its middle photon. */
struct site {
    float at[3]; /* cells */
    uint16_t normal;
};

struct orl_leaves {
    const struct orl_photon_map *map;
    uint32_t k;
    double max_radius;
    double unit;   /* W/m2: of the values kept */
    float reach2;  /* cells: how far a leaf may be */
    struct site *sites;
    _Atomic uint32_t *values; /* 0: not made yet */
};

/* Stands for zero irradiance: the smallest exponent with an empty mantissa, but not the empty word. */
static const uint32_t value_zero = 1U << 27;

struct orl_leaves *orl_leaves_new(const struct orl_photon_map *map, uint32_t k, double max_radius)
{
    const struct orl_map_header *h = map->header;
    const uint64_t n = (h->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    struct orl_leaves *leaves = calloc(1, sizeof *leaves);
    if (!leaves)
        return NULL;
    leaves->map = map;
    leaves->k = k;
    leaves->max_radius = max_radius;
    leaves->reach2 = (float)(max_radius / h->cell * (max_radius / h->cell));
    leaves->unit = h->flux_unit * k / (ORL_PI * max_radius * max_radius);
    leaves->sites = malloc((n + 1) * sizeof *leaves->sites);
    leaves->values = calloc(n + 1, sizeof *leaves->values);
    if (!leaves->sites || !leaves->values) {
        orl_leaves_free(leaves);
        return NULL;
    }
    for (uint64_t i = 0; i < n; i++) {
        const uint64_t left = h->count - i * ORL_MAP_LEAF;
        const uint32_t middle = (left < ORL_MAP_LEAF ? (uint32_t)left : ORL_MAP_LEAF) / 2;
        const uint32_t *words = map->places + i * ORL_LEAF_WORDS + middle;
        uint32_t cell[3];
        orl_place_unpack(words[0], words[ORL_MAP_LEAF], cell);
        leaves->sites[i] = (struct site){{(float)cell[0], (float)cell[1], (float)cell[2]},
                                         map->normals[i * ORL_MAP_LEAF + middle]};
    }
    return leaves;
}

void orl_leaves_free(struct orl_leaves *leaves)
{
    if (!leaves)
        return;
    free(leaves->sites);
    free(leaves->values);
    free(leaves);
}

static struct orl_rgb estimate(const struct orl_leaves *leaves, struct orl_vec3 point,
                               struct orl_vec3 normal, struct orl_search *search)
{
    const struct orl_density_query query = {
        .point = point, .normal = normal, .k = leaves->k, .max_radius = leaves->max_radius};
    return orl_density_estimate(leaves->map, &query, search).irradiance;
}

/* The leaf's value, made now if nobody has; two that make it at once write the same word. */
static struct orl_rgb value_of(struct orl_leaves *leaves, uint32_t leaf, struct orl_search *search)
{
    uint32_t word = atomic_load_explicit(&leaves->values[leaf], memory_order_relaxed);
    if (word == 0) {
        const struct orl_map_header *h = leaves->map->header;
        const struct site *site = &leaves->sites[leaf];
        const struct orl_vec3 point = orl_v3(h->low[0] + (site->at[0] + 0.5) * h->cell,
                                             h->low[1] + (site->at[1] + 0.5) * h->cell,
                                             h->low[2] + (site->at[2] + 0.5) * h->cell);
        const struct orl_rgb irradiance =
            estimate(leaves, point, orl_normal_decode(site->normal), search);
        word = orl_flux_pack(orl_rgb_scale(irradiance, 1 / leaves->unit), 0.5);
        if (word == 0)
            word = value_zero;
        atomic_store_explicit(&leaves->values[leaf], word, memory_order_relaxed);
    }
    return orl_rgb_scale(orl_flux_unpack(word), leaves->unit);
}

/* The nearest leaf whose site is on the query's sheet; false when none is within reach. */
static bool nearest_leaf(const struct orl_leaves *leaves, struct orl_vec3 point,
                         struct orl_vec3 normal, uint32_t *ret_leaf)
{
    const struct orl_photon_map *map = leaves->map;
    const uint16_t code = orl_normal_encode(normal);
    struct orl_box_visit stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    float at[3], best2 = leaves->reach2;
    bool found = false;
    const uint32_t facing = orl_facing_mask(&map->facing, normal);
    orl_box_locate(map, point, at);
    if (map->header->levels > 0)
        stack[depth++] = (struct orl_box_visit){0, map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit visit = stack[--depth];
        if (!(visit.distance2 < best2))
            continue;
        if (visit.level > 0) {
            depth = orl_box_push(map, visit, at, facing, best2, stack, depth);
            continue;
        }
        const struct site *site = &leaves->sites[visit.node];
        const float chord[3] = {site->at[0] - at[0], site->at[1] - at[1], site->at[2] - at[2]};
        const float d2 = chord[0] * chord[0] + chord[1] * chord[1] + chord[2] * chord[2];
        if (d2 < best2 && orl_same_sheet(normal, code, site->normal, chord)) {
            best2 = d2;
            *ret_leaf = visit.node;
            found = true;
        }
    }
    return found;
}

struct orl_rgb orl_leaves_irradiance(struct orl_leaves *leaves, struct orl_vec3 point,
                                     struct orl_vec3 normal, struct orl_search *search)
{
    uint32_t leaf;
    if (nearest_leaf(leaves, point, normal, &leaf))
        return value_of(leaves, leaf, search);
    return estimate(leaves, point, normal, search);
}
