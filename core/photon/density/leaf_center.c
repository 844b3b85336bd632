#include "photon/density/leaf_center.h"

#include "photon/map/map_layout.h"
#include "photon/surface/sheet.h"

static uint32_t middle_photon(const struct orl_photon_map *map, uint64_t leaf)
{
    return (uint32_t)(leaf * ORL_MAP_LEAF + orl_leaf_photons(map, leaf) / 2);
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

struct orl_leaf_center orl_leaf_center_make(const struct orl_photon_map *map, uint64_t leaf)
{
    const uint32_t n = orl_leaf_photons(map, leaf), middle = n / 2;
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    const uint16_t normal = map->normals[leaf * ORL_MAP_LEAF + middle];
    float photons[ORL_MAP_LEAF][3] = {{0}}, mean, least;
    struct orl_leaf_center site = {{0, 0, 0}, 0, normal, false, UINT32_MAX};
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
    site.spread2 = mean;
    /* Photons of two patches have their middle between them, where there is nothing. */
    site.at_photon = n < ORL_MAP_LEAF || least > 0.5F * mean ||
                     !orl_chord_fits(orl_normal_decode(normal), chord, 0.1);
    for (int k = 0; k < 3 && site.at_photon; k++)
        site.at[k] = photons[middle][k];
    return site;
}

struct orl_vec3 orl_leaf_center_point(const struct orl_photon_map *map,
                                      const struct orl_leaf_center *site)
{
    const struct orl_map_header *h = map->header;
    return orl_v3(h->low[0] + (site->at[0] + 0.5) * h->cell,
                  h->low[1] + (site->at[1] + 0.5) * h->cell,
                  h->low[2] + (site->at[2] + 0.5) * h->cell);
}

/* How far a site may be off the surface: on a curved one it lies inside the curve. */
static double tolerance_at(const struct orl_photon_map *map, uint64_t leaf, struct orl_vec3 point)
{
    const struct orl_photon p = orl_photon_map_get(map, middle_photon(map, leaf));
    const struct orl_vec3 way = orl_sub(orl_v3(p.position[0], p.position[1], p.position[2]), point);
    return 0.2 * orl_length(way) + 16 * map->header->cell;
}

static bool find_facet(const struct orl_photon_map *map, struct orl_leaf_center *site,
                       uint64_t leaf, const struct orl_world *world)
{
    const struct orl_vec3 point = orl_leaf_center_point(map, site);
    struct orl_footing footing;
    if (!orl_footing_find(world, point, orl_normal_decode(site->normal),
                          tolerance_at(map, leaf, point), &footing))
        return false;
    site->facet = footing.facet;
    return true;
}

void orl_leaf_center_settle(const struct orl_photon_map *map, struct orl_leaf_center *site,
                            uint64_t leaf, const struct orl_world *world)
{
    const uint32_t middle = middle_photon(map, leaf) % ORL_MAP_LEAF;
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    uint32_t cell[3];
    if (!world || find_facet(map, site, leaf, world) || site->at_photon)
        return;
    orl_place_unpack(words[middle], words[middle + ORL_MAP_LEAF], cell);
    for (int k = 0; k < 3; k++)
        site->at[k] = (float)cell[k];
    site->at_photon = true;
    find_facet(map, site, leaf, world);
}

bool orl_leaf_center_ask(const struct orl_photon_map *map, const struct orl_leaf_center *site,
                         uint64_t leaf, const struct orl_world *world,
                         struct orl_density_query *query, struct orl_footing *ret_footing)
{
    query->point = orl_leaf_center_point(map, site);
    query->normal = orl_normal_decode(site->normal);
    query->at_photon = site->at_photon;
    query->skip = middle_photon(map, leaf);
    if (!world || !orl_footing_find(world, query->point, query->normal,
                                    tolerance_at(map, leaf, query->point), ret_footing))
        return false;
    query->point = ret_footing->point;
    query->normal = ret_footing->normal;
    query->footing = ret_footing;
    return true;
}
