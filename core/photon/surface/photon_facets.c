#include "photon/surface/photon_facets.h"

#include "photon/map/map_layout.h"

enum { LEAVES_A_CHUNK = 1024, RECENT = 4 };

/* The facets on which the last photons landed, and their coded normals. */
struct recent {
    uint32_t facets[RECENT];
    uint16_t codes[RECENT]; /* normals of the side that was lit */
    uint32_t count;
};

static bool is_on(const struct orl_planes *planes, uint32_t facet,
                  const struct orl_stored_photon *photon, double rounding)
{
    const struct orl_plane *plane = &planes->planes[facet];
    const struct orl_vec3 way = orl_sub(photon->point, plane->origin);
    if (fabs(orl_dot(way, plane->frame.n)) > rounding)
        return false;
    const struct orl_plane_point at = orl_plane_project(plane, photon->point);
    for (uint32_t i = 0; i < plane->triangles; i++)
        if (orl_plane_triangle_contains(&planes->plane_triangles[plane->first + i], at))
            return true;
    return false;
}

/* Returns a recent facet that the photon lies on; or ORL_NO_FACET_SIDE. */
static uint32_t find_recent(const struct orl_planes *planes, struct recent *recent,
                            const struct orl_stored_photon *photon, double rounding)
{
    for (uint32_t i = 0; i < recent->count; i++)
        if (recent->codes[i] == photon->code && is_on(planes, recent->facets[i], photon, rounding))
            return recent->facets[i];
    return ORL_NO_FACET_SIDE;
}

static void add_recent(struct recent *recent, uint32_t facet, uint16_t code)
{
    if (recent->count < RECENT)
        recent->count++;
    for (uint32_t i = recent->count; --i > 0;) {
        recent->facets[i] = recent->facets[i - 1];
        recent->codes[i] = recent->codes[i - 1];
    }
    recent->facets[0] = facet;
    recent->codes[0] = code;
}

/* Returns the facet that a ray from above the photon hits; or ORL_NO_FACET_SIDE. */
static uint32_t trace_facet(const struct orl_geometry *g, const struct orl_stored_photon *photon,
                            double rounding)
{
    const struct orl_vec3 start = orl_madd(photon->point, photon->normal, 4 * rounding);
    struct orl_hit hit;
    return orl_geometry_intersect(g, start, orl_neg(photon->normal), 8 * rounding, &hit)
               ? hit.facet
               : ORL_NO_FACET_SIDE;
}

struct orl_stored_photon orl_stored_photon_get(const struct orl_photon_map *map, uint64_t index)
{
    const struct orl_map_header *h = map->header;
    const uint32_t *words = map->places + index / ORL_MAP_LEAF * ORL_LEAF_WORDS;
    const uint32_t at = (uint32_t)(index % ORL_MAP_LEAF);
    uint32_t cell[3];
    orl_position_unpack(words[at], words[at + ORL_MAP_LEAF], cell);
    const uint16_t code = map->normals[index];
    return (struct orl_stored_photon){orl_v3(h->low[0] + (cell[0] + 0.5) * h->cell,
                                             h->low[1] + (cell[1] + 0.5) * h->cell,
                                             h->low[2] + (cell[2] + 0.5) * h->cell),
                                      orl_normal_decode(code), code};
}

/*
 * Returns the facet of a photon. For the first photon of every leaf a ray is traced. If a recent
 * facet holds the photon and the ray hits another, the two coincide, and neither can have texels.
 */
static uint32_t facet_of(const struct orl_photon_facets *photon_facets,
                         const struct orl_stored_photon *photon, bool verify, struct recent *recent)
{
    const struct orl_planes *planes = photon_facets->planes;
    const double rounding =
        2 * photon_facets->map->header->cell + planes->geometry->radius * 0x1p-20;
    const uint32_t recent_facet = find_recent(planes, recent, photon, rounding);
    if (recent_facet != ORL_NO_FACET_SIDE && !verify)
        return recent_facet;
    const uint32_t hit_facet = trace_facet(planes->geometry, photon, rounding);
    if (hit_facet == ORL_NO_FACET_SIDE)
        return recent_facet;
    if (recent_facet != ORL_NO_FACET_SIDE && hit_facet != recent_facet) {
        atomic_store_explicit(&photon_facets->coincident[recent_facet], true, memory_order_relaxed);
        if (!orl_facet_is_instanced(planes->geometry, hit_facet))
            atomic_store_explicit(&photon_facets->coincident[hit_facet], true,
                                  memory_order_relaxed);
    }
    if (hit_facet != recent_facet && orl_planes_has(planes, hit_facet))
        add_recent(recent, hit_facet, photon->code);
    return hit_facet;
}

static void find_facets(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_photon_facets *photon_facets = arg;
    const uint64_t photons = photon_facets->map->header->count;
    const uint64_t first = chunk * LEAVES_A_CHUNK * ORL_MAP_LEAF;
    const uint64_t end = first + (uint64_t)LEAVES_A_CHUNK * ORL_MAP_LEAF;
    struct recent recent = {.count = 0};
    (void)member;
    for (uint64_t i = first; i < end && i < photons; i++) {
        const struct orl_stored_photon photon = orl_stored_photon_get(photon_facets->map, i);
        const uint32_t facet = facet_of(photon_facets, &photon, i % ORL_MAP_LEAF == 0, &recent);
        photon_facets->places[i] = ORL_NO_FACET_SIDE;
        if (facet == ORL_NO_FACET_SIDE || !orl_planes_has(photon_facets->planes, facet))
            continue;
        const bool front = orl_dot(photon.normal, photon_facets->planes->planes[facet].frame.n) > 0;
        photon_facets->places[i] = 2 * facet + front;
    }
}

int orl_photon_facets_find(struct orl_photon_facets *photon_facets, struct orl_thread_pool *pool)
{
    const uint64_t leaves = (photon_facets->map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    return orl_parallel_try(pool, (leaves + LEAVES_A_CHUNK - 1) / LEAVES_A_CHUNK, find_facets,
                            photon_facets);
}
