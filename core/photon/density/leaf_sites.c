#include "photon/density/leaf_sites.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "base/multiversion.h"
#include "base/sampling/sampling.h"
#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

enum { NEIGHBOURS = 8, LINE = 64, CHUNK = 1 << 12 };

/*
 * The leaves of a leaf's sheet whose sites are nearest to its own, itself first: indices plus 1,
 * padded with zeros, and sites. They fill two cache lines, so that a look-up waits for memory once.
 * The first index is 0 until the neighbours were searched, and is written last.
 */
struct neighbours {
    _Atomic uint32_t leaf[NEIGHBOURS];
    _Atomic float at[3][NEIGHBOURS];
};

struct orl_leaf_sites {
    const struct orl_photon_map *map;
    const struct orl_lit_scene *lit_scene;
    uint64_t count;
    float reach2; /* squared cells: maximum distance of a leaf that is used */
    struct orl_zorder order;
    struct orl_leaf_center *sites;
    struct neighbours *neighbours; /* in `memory` below, aligned to a cache line */
    void *memory;
};

/*
 * A leaf is used at points within its spread times this; a uniform disc ends at 1.41. With 1.41 the
 * uncovered points are the gaps: leaves cover points with photons and not those without, so values
 * read are low by half a percent. With 3 they are high by as much. This value in between conserves
 * light, as measured in the integrating sphere.
 */
static const float reach_of_leaf = 1.85F;
/*
 * Beyond this multiple of its spread, half the side of a square, a leaf is used only if another
 * leaf reaches the point, too. At the edge of a shadow none reaches it from the dark side. Leaves
 * with few photons would add light beyond the edge otherwise.
 */
static const float alone_reach_of_leaf = 1.2247449F;

static void make_sites(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_leaf_sites *all = arg;
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < all->count; i++) {
        all->sites[i] = orl_leaf_center_make(all->map, i);
        orl_leaf_center_use_densest(all->map, &all->sites[i], i);
        orl_leaf_center_find_facet(all->map, &all->sites[i], i, all->lit_scene);
    }
}

struct orl_leaf_sites *orl_leaf_sites_new(const struct orl_photon_map *map,
                                          const struct orl_lit_scene *lit_scene, double max_radius,
                                          struct orl_thread_pool *pool)
{
    const struct orl_map_header *h = map->header;
    const uint64_t n = (h->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    struct orl_leaf_sites *all = calloc(1, sizeof *all);
    if (!all)
        return NULL;
    all->map = map;
    all->lit_scene = lit_scene;
    all->count = n;
    all->reach2 = (float)(max_radius / h->cell * (max_radius / h->cell));
    all->sites = malloc((n + 1) * sizeof *all->sites);
    all->memory = calloc(n + 1, sizeof *all->neighbours);
    if (!all->sites || !all->memory || orl_zorder_init(&all->order, map) < 0) {
        orl_leaf_sites_free(all);
        return NULL;
    }
    all->neighbours = (void *)(((uintptr_t)all->memory + LINE - 1) / LINE * LINE);
    if (orl_parallel_try(pool, (n + CHUNK - 1) / CHUNK, make_sites, all) < 0) {
        orl_leaf_sites_free(all);
        return NULL;
    }
    return all;
}

void orl_leaf_sites_free(struct orl_leaf_sites *all)
{
    if (!all)
        return;
    orl_zorder_done(&all->order);
    free(all->sites);
    free(all->memory);
    free(all);
}

void orl_leaf_sites_rebind(struct orl_leaf_sites *all, const struct orl_photon_map *map,
                           const struct orl_lit_scene *lit_scene)
{
    all->map = map;
    all->lit_scene = lit_scene;
}

uint64_t orl_leaf_sites_bytes(const struct orl_leaf_sites *all)
{
    /* Per leaf: its site, its neighbours, its code and the codes of the levels above. */
    return all->count * (sizeof *all->sites + sizeof *all->neighbours + 2 * sizeof(uint64_t)) +
           sizeof *all;
}

const struct orl_leaf_center *orl_leaf_sites_of(const struct orl_leaf_sites *all, uint32_t leaf)
{
    return &all->sites[leaf];
}

static bool comes_before(struct orl_near_leaf a, struct orl_near_leaf b)
{
    return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && a.leaf < b.leaf);
}

static float distance2_to(const struct orl_leaf_sites *all, uint32_t leaf, const float at[3],
                          float ret_chord[3])
{
    const float *site = all->sites[leaf].at;
    for (int k = 0; k < 3; k++)
        ret_chord[k] = site[k] - at[k];
    return ret_chord[0] * ret_chord[0] + ret_chord[1] * ret_chord[1] + ret_chord[2] * ret_chord[2];
}

ORL_FOR_WIDE_VECTORS bool orl_leaf_sites_next(const struct orl_leaf_sites *all,
                                              struct orl_vec3 point, struct orl_vec3 normal,
                                              struct orl_near_leaf last,
                                              struct orl_near_leaf *ret_next)
{
    const struct orl_photon_map *map = all->map;
    const uint16_t code = orl_normal_encode(normal);
    struct orl_box_visit stack[ORL_BOX_STACK];
    struct orl_near_leaf best = {all->reach2, 0};
    uint32_t depth = 0;
    float at[3];
    bool found = false;
    const uint32_t normal_bins = orl_normal_bins_mask(&map->normal_bins, normal);
    orl_box_locate(map, point, at);
    if (map->header->levels > 0)
        stack[depth++] = (struct orl_box_visit){0, map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit visit = stack[--depth];
        if (!(visit.distance2 <= best.distance2))
            continue;
        if (visit.level > 0) {
            depth = orl_box_push(map, visit, at, normal_bins, best.distance2, stack, depth);
            continue;
        }
        float chord[3];
        const struct orl_near_leaf here = {distance2_to(all, visit.node, at, chord), visit.node};
        if (comes_before(here, best) && comes_before(last, here) &&
            orl_same_sheet(normal, code, all->sites[visit.node].normal, chord)) {
            best = here;
            found = true;
        }
    }
    *ret_next = best;
    return found;
}

/* Finds a leaf and its neighbours, the nearest first; returns their number. */
ORL_FOR_WIDE_VECTORS static uint32_t
find_neighbours(const struct orl_leaf_sites *all, uint32_t leaf,
                struct orl_near_leaf ret_neighbours[NEIGHBOURS])
{
    const struct orl_photon_map *map = all->map;
    const struct orl_leaf_center *own = &all->sites[leaf];
    const struct orl_vec3 normal = orl_normal_decode(own->normal);
    const uint32_t normal_bins = orl_normal_bins_mask(&map->normal_bins, normal);
    struct orl_box_visit stack[ORL_BOX_STACK];
    uint32_t depth = 0, found = 0;
    float within2 = all->reach2;
    stack[depth++] = (struct orl_box_visit){0, map->header->levels, 0};
    while (depth > 0) {
        const struct orl_box_visit visit = stack[--depth];
        if (!(visit.distance2 < within2))
            continue;
        if (visit.level > 0) {
            depth = orl_box_push(map, visit, own->at, normal_bins, within2, stack, depth);
            continue;
        }
        float chord[3];
        const struct orl_near_leaf here = {distance2_to(all, visit.node, own->at, chord),
                                           visit.node};
        if (!(here.distance2 < within2) ||
            !orl_same_sheet(normal, own->normal, all->sites[visit.node].normal, chord))
            continue;
        uint32_t place = found < NEIGHBOURS ? found++ : NEIGHBOURS - 1;
        for (; place > 0 && comes_before(here, ret_neighbours[place - 1]); place--)
            ret_neighbours[place] = ret_neighbours[place - 1];
        ret_neighbours[place] = here;
        if (found == NEIGHBOURS)
            within2 = ret_neighbours[NEIGHBOURS - 1].distance2;
    }
    return found;
}

/* Returns the neighbours of a leaf, and searches them if that was not done. Two threads that
 * search at once find the same. */
static struct neighbours *get_neighbours(const struct orl_leaf_sites *all, uint32_t leaf)
{
    struct neighbours *neighbours = &all->neighbours[leaf];
    struct orl_near_leaf found[NEIGHBOURS];
    if (atomic_load_explicit(&neighbours->leaf[0], memory_order_acquire) != 0)
        return neighbours;
    uint32_t n = find_neighbours(all, leaf, found);
    if (n == 0)
        found[n++] = (struct orl_near_leaf){0, leaf};
    for (uint32_t i = n; i-- > 0;) {
        for (int k = 0; k < 3; k++)
            atomic_store_explicit(&neighbours->at[k][i], all->sites[found[i].leaf].at[k],
                                  memory_order_relaxed);
        atomic_store_explicit(&neighbours->leaf[i], found[i].leaf + 1, memory_order_release);
    }
    return neighbours;
}

/*
 * Returns true if the leaf covers the point. In a sun patch leaves are small and many. If the
 * nearest leaf were used whatever its size, they would light the dark around them, half way to its
 * sparse leaves.
 */
static bool leaf_covers(const struct orl_leaf_sites *all, struct orl_near_leaf leaf, float reach)
{
    return leaf.distance2 <= reach * reach * (all->sites[leaf.leaf].spread2 + 1);
}

bool orl_leaf_sites_cover(const struct orl_leaf_sites *all, struct orl_near_leaf leaf,
                          const float at[3])
{
    if (leaf_covers(all, leaf, alone_reach_of_leaf))
        return true;
    if (!leaf_covers(all, leaf, reach_of_leaf))
        return false;
    const struct neighbours *neighbours = get_neighbours(all, leaf.leaf);
    for (int i = 1; i < NEIGHBOURS; i++) {
        struct orl_near_leaf other = {
            0, atomic_load_explicit(&neighbours->leaf[i], memory_order_relaxed)};
        for (int k = 0; k < 3; k++) {
            const float off =
                atomic_load_explicit(&neighbours->at[k][i], memory_order_relaxed) - at[k];
            other.distance2 += off * off;
        }
        if (other.leaf-- != 0 && leaf_covers(all, other, reach_of_leaf))
            return true;
    }
    return false;
}

bool orl_leaf_sites_nearest(const struct orl_leaf_sites *all, struct orl_vec3 point,
                            struct orl_vec3 normal, struct orl_near_leaf *ret_leaf)
{
    const uint16_t code = orl_normal_encode(normal);
    struct orl_near_leaf best = {INFINITY, 0};
    uint32_t cell[3];
    float at[3], chord[3];
    if (all->map->header->count == 0)
        return false;
    orl_box_locate(all->map, point, at);
    for (int k = 0; k < 3; k++)
        cell[k] = (uint32_t)fminf(fmaxf(at[k] + 0.5F, 0), ORL_POSITION_CELLS - 1);
    const uint64_t own_leaf = orl_zorder_find(&all->order, orl_zorder_code(cell, code));
    struct neighbours *neighbours = get_neighbours(all, (uint32_t)own_leaf);
    for (int i = 0; i < NEIGHBOURS; i++) {
        const uint32_t leaf = atomic_load_explicit(&neighbours->leaf[i], memory_order_relaxed);
        struct orl_near_leaf here = {0, leaf - 1};
        for (int k = 0; k < 3; k++) {
            const float off =
                atomic_load_explicit(&neighbours->at[k][i], memory_order_relaxed) - at[k];
            here.distance2 += off * off;
        }
        if (leaf != 0 && comes_before(here, best))
            best = here;
    }
    distance2_to(all, best.leaf, at, chord);
    *ret_leaf = best;
    return orl_same_sheet(normal, code, all->sites[best.leaf].normal, chord);
}

bool orl_leaf_sites_sample(const struct orl_leaf_sites *all, uint32_t leaf,
                           struct orl_random *random, struct orl_leaf_center *ret_place)
{
    const struct orl_leaf_center *site = &all->sites[leaf];
    const struct orl_vec3 normal = orl_normal_decode(site->normal);
    const struct orl_frame frame = orl_frame_about(normal);
    const double reach = (double)reach_of_leaf * sqrt((double)site->spread2 + 1);
    const double radius = reach * sqrt(orl_random_uniform(random));
    const struct orl_sincos way = orl_sincos_turn(orl_random_uniform(random));
    const struct orl_vec3 off =
        orl_to_world(&frame, orl_v3(radius * way.cosine, radius * way.sine, 0));
    struct orl_near_leaf near;
    *ret_place = *site;
    ret_place->at[0] += (float)off.x;
    ret_place->at[1] += (float)off.y;
    ret_place->at[2] += (float)off.z;
    return orl_leaf_sites_nearest(all, orl_leaf_center_point(all->map, ret_place), normal, &near) &&
           near.leaf == leaf && orl_leaf_sites_cover(all, near, ret_place->at);
}
