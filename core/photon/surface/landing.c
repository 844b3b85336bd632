#include "photon/surface/landing.h"

#include "photon/map/map_layout.h"

enum { LEAVES_A_CHUNK = 1024, RECENT = 4 };

/* The facets on which the last photons landed, and their coded normals. */
struct recent {
    uint32_t facets[RECENT];
    uint16_t codes[RECENT]; /* normals of the side that was lit */
    uint32_t count;
};

static bool is_on(const struct orl_planes *planes, uint32_t facet, const struct orl_landed *photon,
                  double rounding)
{
    const struct orl_plane *plane = &planes->planes[facet];
    const struct orl_vec3 way = orl_sub(photon->point, plane->origin);
    if (fabs(orl_dot(way, plane->frame.n)) > rounding)
        return false;
    const struct orl_corner at = orl_plane_corner(plane, photon->point);
    for (uint32_t i = 0; i < plane->triangles; i++)
        if (orl_flat_holds(&planes->flats[plane->first + i], at))
            return true;
    return false;
}

/* Returns a recent facet that the photon lies on; or ORL_NOWHERE. */
static uint32_t find_recent(const struct orl_planes *planes, struct recent *recent,
                            const struct orl_landed *photon, double rounding)
{
    for (uint32_t i = 0; i < recent->count; i++)
        if (recent->codes[i] == photon->code && is_on(planes, recent->facets[i], photon, rounding))
            return recent->facets[i];
    return ORL_NOWHERE;
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

/* Returns the facet that a ray from above the photon hits; or ORL_NOWHERE. */
static uint32_t trace_facet(const struct orl_geometry *g, const struct orl_landed *photon,
                            double rounding)
{
    const struct orl_vec3 start = orl_madd(photon->point, photon->normal, 4 * rounding);
    struct orl_hit hit;
    return orl_geometry_intersect(g, start, orl_neg(photon->normal), 8 * rounding, &hit)
               ? hit.facet
               : ORL_NOWHERE;
}

struct orl_landed orl_landed_of(const struct orl_photon_map *map, uint64_t index)
{
    const struct orl_map_header *h = map->header;
    const uint32_t *words = map->places + index / ORL_MAP_LEAF * ORL_LEAF_WORDS;
    const uint32_t at = (uint32_t)(index % ORL_MAP_LEAF);
    uint32_t cell[3];
    orl_place_unpack(words[at], words[at + ORL_MAP_LEAF], cell);
    const uint16_t code = map->normals[index];
    return (struct orl_landed){orl_v3(h->low[0] + (cell[0] + 0.5) * h->cell,
                                      h->low[1] + (cell[1] + 0.5) * h->cell,
                                      h->low[2] + (cell[2] + 0.5) * h->cell),
                               orl_normal_decode(code), code};
}

/*
 * Returns the facet of a photon. For the first photon of every leaf a ray is traced. If a recent
 * facet holds the photon and the ray hits another, the two coincide, and neither can have texels.
 */
static uint32_t facet_of(const struct orl_landing *landing, const struct orl_landed *photon,
                         bool sure, struct recent *recent)
{
    const struct orl_planes *planes = landing->planes;
    const double rounding = 2 * landing->map->header->cell + planes->geometry->radius * 0x1p-20;
    const uint32_t known = find_recent(planes, recent, photon, rounding);
    if (known != ORL_NOWHERE && !sure)
        return known;
    const uint32_t met = trace_facet(planes->geometry, photon, rounding);
    if (met == ORL_NOWHERE)
        return known;
    if (known != ORL_NOWHERE && met != known) {
        atomic_store_explicit(&landing->doubtful[known], true, memory_order_relaxed);
        if (!orl_facet_is_placed(planes->geometry, met))
            atomic_store_explicit(&landing->doubtful[met], true, memory_order_relaxed);
    }
    if (met != known && orl_planes_have(planes, met))
        add_recent(recent, met, photon->code);
    return met;
}

static void find_facets(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_landing *landing = arg;
    const uint64_t photons = landing->map->header->count;
    const uint64_t first = chunk * LEAVES_A_CHUNK * ORL_MAP_LEAF;
    const uint64_t end = first + (uint64_t)LEAVES_A_CHUNK * ORL_MAP_LEAF;
    struct recent recent = {.count = 0};
    (void)member;
    for (uint64_t i = first; i < end && i < photons; i++) {
        const struct orl_landed photon = orl_landed_of(landing->map, i);
        const uint32_t facet = facet_of(landing, &photon, i % ORL_MAP_LEAF == 0, &recent);
        landing->places[i] = ORL_NOWHERE;
        if (facet == ORL_NOWHERE || !orl_planes_have(landing->planes, facet))
            continue;
        const bool front = orl_dot(photon.normal, landing->planes->planes[facet].frame.n) > 0;
        landing->places[i] = 2 * facet + front;
    }
}

int orl_landing_find(struct orl_landing *landing, struct orl_crew *crew)
{
    const uint64_t leaves = (landing->map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    return orl_crew_try(crew, (leaves + LEAVES_A_CHUNK - 1) / LEAVES_A_CHUNK, find_facets, landing);
}
