#include "photon/leaves.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "photon/boxes.h"
#include "photon/flux.h"
#include "photon/sheet.h"

/*
 * Where a leaf's estimate is made: amid its photons. Not at one of them, for there density is known
 * to be higher (the photon itself) or lower (evenly emitted ones keep apart); only when the middle
 * is no place on the surface does a photon's own have to do, and is then left out of the count.
 */
struct site {
    float at[3]; /* cells */
    uint16_t normal;
    bool at_photon;
};

struct orl_leaves {
    const struct orl_photon_map *map;
    uint32_t k;
    double max_radius;
    double unit;  /* W/m2: of the values kept */
    float reach2; /* cells: how far a leaf may be */
    struct site *sites;
    _Atomic uint32_t *values; /* 0: not made yet */
};

/* Stands for zero irradiance: the smallest exponent with an empty mantissa, but not the empty word.
 */
static const uint32_t value_zero = 1U << 27;

static struct orl_density_query query_at(const struct orl_leaves *leaves, struct orl_vec3 point,
                                         struct orl_vec3 normal)
{
    return (struct orl_density_query){
        .point = point, .normal = normal, .k = leaves->k, .max_radius = leaves->max_radius};
}

static uint32_t leaf_size(const struct orl_photon_map *map, uint64_t leaf)
{
    const uint64_t left = map->header->count - leaf * ORL_MAP_LEAF;
    return left < ORL_MAP_LEAF ? (uint32_t)left : ORL_MAP_LEAF;
}

static uint32_t middle_photon(const struct orl_photon_map *map, uint64_t leaf)
{
    return (uint32_t)(leaf * ORL_MAP_LEAF + leaf_size(map, leaf) / 2);
}

/* Squared distances of a leaf's photons from a point: the mean, and the least. */
static void spread_about(float (*const photons)[3], uint32_t n, const float at[3], float *ret_mean,
                         float *ret_least)
{
    *ret_mean = 0;
    *ret_least = INFINITY;
    for (uint32_t i = 0; i < n; i++) {
        float d2 = 0;
        for (int k = 0; k < 3; k++)
            d2 += (photons[i][k] - at[k]) * (photons[i][k] - at[k]);
        *ret_mean += d2 / (float)n;
        *ret_least = d2 < *ret_least ? d2 : *ret_least;
    }
}

static struct site make_site(const struct orl_photon_map *map, uint64_t leaf)
{
    const uint32_t n = leaf_size(map, leaf), middle = n / 2;
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    const uint16_t normal = map->normals[leaf * ORL_MAP_LEAF + middle];
    float photons[ORL_MAP_LEAF][3], mean, least;
    struct site site = {{0, 0, 0}, normal, false};
    for (uint32_t i = 0; i < n; i++) {
        uint32_t cell[3];
        orl_place_unpack(words[i], words[i + ORL_MAP_LEAF], cell);
        for (int k = 0; k < 3; k++) {
            photons[i][k] = (float)cell[k];
            site.at[k] += photons[i][k] / (float)n;
        }
    }
    const struct orl_vec3 chord =
        orl_v3(photons[middle][0] - site.at[0], photons[middle][1] - site.at[1],
               photons[middle][2] - site.at[2]);
    spread_about(photons, n, site.at, &mean, &least);
    /* Photons of two patches have their middle between them, where there is nothing. */
    site.at_photon = n < ORL_MAP_LEAF || least > 0.5F * mean ||
                     !orl_chord_fits(orl_normal_decode(normal), chord, 0.1);
    for (int k = 0; k < 3 && site.at_photon; k++)
        site.at[k] = photons[middle][k];
    return site;
}

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
    for (uint64_t i = 0; i < n; i++)
        leaves->sites[i] = make_site(map, i);
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
        struct orl_density_query query = query_at(leaves, point, orl_normal_decode(site->normal));
        query.at_photon = site->at_photon;
        query.skip = middle_photon(leaves->map, leaf);
        const struct orl_health before = search->health;
        const struct orl_rgb irradiance =
            orl_density_estimate(leaves->map, &query, search).irradiance;
        uint32_t expected = 0;
        word = orl_flux_pack(orl_rgb_scale(irradiance, 1 / leaves->unit), 0.5);
        if (word == 0)
            word = value_zero;
        /* Who comes second does not count it again. */
        if (!atomic_compare_exchange_strong(&leaves->values[leaf], &expected, word))
            search->health = before;
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
    const struct orl_density_query query = query_at(leaves, point, normal);
    return orl_density_estimate(leaves->map, &query, search).irradiance;
}
