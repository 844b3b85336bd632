#include "photon/density/leaf_sites.h"

#include <math.h>
#include <string.h>

#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

enum { HALF = ORL_MAP_LEAF / 2 };

/* Mean and median of squared distances are equal for photons of a uniform disc. For few photons
 * their ratio rarely exceeds this. */
static const float uneven = 2.5F;

/* Positions of photons of a leaf, in cells. */
typedef float positions[ORL_MAP_LEAF][3];

/* Squared distances of photons from their centre. */
struct distance_stats {
    float mean, least, median;
};

static float distance2(const float a[3], const float b[3])
{
    float d2 = 0;
    for (int k = 0; k < 3; k++)
        d2 += (a[k] - b[k]) * (a[k] - b[k]);
    return d2;
}

static void insert_sorted(float sorted[ORL_MAP_LEAF], uint32_t n, float value)
{
    for (; n > 0 && sorted[n - 1] > value; n--)
        sorted[n] = sorted[n - 1];
    sorted[n] = value;
}

static struct distance_stats distance_stats_about(positions photons, uint32_t n, const float at[3])
{
    struct distance_stats distance_stats = {.mean = 0};
    float sorted[ORL_MAP_LEAF];
    for (uint32_t i = 0; i < n; i++) {
        const float d2 = distance2(photons[i], at);
        distance_stats.mean += d2 / (float)n;
        insert_sorted(sorted, i, d2);
    }
    distance_stats.least = sorted[0];
    distance_stats.median = sorted[n / 2];
    return distance_stats;
}

static void middle_of(positions photons, uint32_t n, float ret_at[3])
{
    for (int k = 0; k < 3; k++)
        ret_at[k] = 0;
    for (uint32_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            ret_at[k] += photons[i][k] / (float)n;
}

static uint32_t unpack_leaf(const struct orl_photon_map *map, uint64_t leaf, positions ret_photons)
{
    const uint32_t n = orl_leaf_photons(map, leaf);
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    for (uint32_t i = 0; i < n; i++) {
        uint32_t cell[3];
        orl_position_unpack(words[i], words[i + ORL_MAP_LEAF], cell);
        for (int k = 0; k < 3; k++)
            ret_photons[i][k] = (float)cell[k];
    }
    return n;
}

static bool is_off_plane(const struct orl_leaf_center *site, const float photon[3])
{
    const struct orl_vec3 chord =
        orl_v3((double)(photon[0] - site->at[0]), (double)(photon[1] - site->at[1]),
               (double)(photon[2] - site->at[2]));
    return !orl_chord_fits(orl_normal_decode(site->normal), chord, 0.1);
}

struct orl_leaf_center orl_leaf_center_make(const struct orl_photon_map *map, uint64_t leaf)
{
    positions photons;
    const uint32_t n = unpack_leaf(map, leaf, photons), middle = n / 2;
    struct orl_leaf_center site = {.normal = map->normals[leaf * ORL_MAP_LEAF + middle],
                                   .photon = (uint8_t)middle,
                                   .facet = UINT32_MAX};
    middle_of(photons, n, site.at);
    const struct distance_stats distance_stats = distance_stats_about(photons, n, site.at);
    site.spread2 = distance_stats.mean;
    /* The centre of photons in two places lies between them, where there is no surface. */
    site.at_photon = n < ORL_MAP_LEAF || distance_stats.least > 0.5F * distance_stats.mean ||
                     is_off_plane(&site, photons[middle]);
    for (int k = 0; k < 3 && site.at_photon; k++)
        site.at[k] = photons[middle][k];
    return site;
}

/* Returns the photon with the smallest radius that contains half of the leaf; *ret_reach2 is
 * that radius squared. */
static uint32_t closest_together(positions photons, float *ret_reach2)
{
    uint32_t best = 0;
    *ret_reach2 = INFINITY;
    for (uint32_t i = 0; i < ORL_MAP_LEAF; i++) {
        float sorted[ORL_MAP_LEAF];
        for (uint32_t j = 0; j < ORL_MAP_LEAF; j++)
            insert_sorted(sorted, j, distance2(photons[i], photons[j]));
        best = sorted[HALF - 1] < *ret_reach2 ? i : best;
        *ret_reach2 = fminf(*ret_reach2, sorted[HALF - 1]);
    }
    return best;
}

void orl_leaf_center_use_densest(const struct orl_photon_map *map, struct orl_leaf_center *site,
                                 uint64_t leaf)
{
    positions photons, half;
    float middle[3], reach2;
    if (unpack_leaf(map, leaf, photons) < ORL_MAP_LEAF)
        return;
    middle_of(photons, ORL_MAP_LEAF, middle);
    const struct distance_stats whole = distance_stats_about(photons, ORL_MAP_LEAF, middle);
    if (whole.mean <= uneven * whole.median && whole.least <= 0.5F * whole.mean)
        return;
    const uint32_t about = closest_together(photons, &reach2);
    uint32_t n = 0;
    for (uint32_t i = 0; i < ORL_MAP_LEAF && n < HALF; i++)
        if (distance2(photons[i], photons[about]) <= reach2)
            memcpy(half[n++], photons[i], sizeof half[0]);
    site->photon = (uint8_t)about;
    site->normal = map->normals[leaf * ORL_MAP_LEAF + about];
    middle_of(half, n, site->at);
    const struct distance_stats distance_stats = distance_stats_about(half, n, site->at);
    site->spread2 = distance_stats.mean;
    site->at_photon =
        distance_stats.least > 0.5F * distance_stats.mean || is_off_plane(site, photons[about]);
    for (int k = 0; k < 3 && site->at_photon; k++)
        site->at[k] = photons[about][k];
}

struct orl_vec3 orl_leaf_center_point(const struct orl_photon_map *map,
                                      const struct orl_leaf_center *site)
{
    const struct orl_map_header *h = map->header;
    return orl_v3(h->low[0] + (site->at[0] + 0.5) * h->cell,
                  h->low[1] + (site->at[1] + 0.5) * h->cell,
                  h->low[2] + (site->at[2] + 0.5) * h->cell);
}

/* Returns how far a site may be off the surface: on a curved surface it lies inside the curve. */
static double tolerance_at(const struct orl_photon_map *map, const struct orl_leaf_center *site,
                           uint64_t leaf, struct orl_vec3 point)
{
    const struct orl_photon p = orl_photon_map_get(map, leaf * ORL_MAP_LEAF + site->photon);
    const struct orl_vec3 way = orl_sub(orl_v3(p.position[0], p.position[1], p.position[2]), point);
    return 0.2 * orl_length(way) + 16 * map->header->cell;
}

static bool find_facet(const struct orl_photon_map *map, struct orl_leaf_center *site,
                       uint64_t leaf, const struct orl_lit_scene *lit_scene)
{
    const struct orl_vec3 point = orl_leaf_center_point(map, site);
    struct orl_surface_point surface_point;
    if (!orl_surface_point_find(lit_scene, point, orl_normal_decode(site->normal),
                                tolerance_at(map, site, leaf, point), &surface_point))
        return false;
    site->facet = surface_point.facet;
    return true;
}

void orl_leaf_center_find_facet(const struct orl_photon_map *map, struct orl_leaf_center *site,
                                uint64_t leaf, const struct orl_lit_scene *lit_scene)
{
    const uint32_t own = site->photon;
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    uint32_t cell[3];
    if (!lit_scene || find_facet(map, site, leaf, lit_scene) || site->at_photon)
        return;
    orl_position_unpack(words[own], words[own + ORL_MAP_LEAF], cell);
    for (int k = 0; k < 3; k++)
        site->at[k] = (float)cell[k];
    site->at_photon = true;
    find_facet(map, site, leaf, lit_scene);
}

bool orl_leaf_center_set_query(const struct orl_photon_map *map, const struct orl_leaf_center *site,
                               uint64_t leaf, const struct orl_lit_scene *lit_scene,
                               struct orl_density_query *query,
                               struct orl_surface_point *ret_surface_point)
{
    query->point = orl_leaf_center_point(map, site);
    query->normal = orl_normal_decode(site->normal);
    query->at_photon = site->at_photon;
    query->skip = (uint32_t)(leaf * ORL_MAP_LEAF + site->photon);
    if (!lit_scene ||
        !orl_surface_point_find(lit_scene, query->point, query->normal,
                                tolerance_at(map, site, leaf, query->point), ret_surface_point))
        return false;
    query->point = ret_surface_point->point;
    query->normal = ret_surface_point->normal;
    query->surface_point = ret_surface_point;
    return true;
}
