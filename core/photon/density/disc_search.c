#include "photon/density/nested_discs.h"

#include <stdlib.h>

#include "base/multiversion.h"
#include "photon/map/map_layout.h"
#include "photon/surface/footprint.h"

enum { CAPACITY = ORL_DISC_SEARCH_CAPACITY, BINS = 512, MOST_TURNS = 32 };

/*
 * A leaf is split into photons if its ramp is wider than this share of the smallest disc's radius.
 * With wider ramps the shares within a disc would not add up to its area, or to its moments if it
 * is cut.
 */
static const float widest_ramp = 0.5F, widest_in_cut = 0.3F;
/* Factor on the squared search radius for boxes of leaves, so that the near ends of wide leaves
 * are not missed. */
static const float beyond2 = 1.15F;
/* In cells, across a plane: less than orl_same_sheet allows. */
static const float rounding = 3.9F;

static uint32_t photons_of(const struct orl_disc_search *disc_search, uint32_t patch)
{
    uint32_t lane;
    return orl_patch_find(disc_search->sums, patch, &lane)->count[lane];
}

static bool on_sheet(const struct orl_disc_search *disc_search, uint16_t normal,
                     const float chord[3], float distance2)
{
    /* Most common case: the same plane, within rounding. */
    const float *own = disc_search->direction;
    if (normal == disc_search->normal &&
        fabsf(chord[0] * own[0] + chord[1] * own[1] + chord[2] * own[2]) < rounding)
        return true;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    return orl_same_sheet(disc_search->query->normal, disc_search->normal, normal, chord) &&
           (distance2 >= disc_search->flat2 || fabs(orl_dot(c, disc_search->query->normal)) <= 4);
}

static bool in_footprint(const struct orl_disc_search *disc_search, const float chord[3],
                         float distance2)
{
    const double cell = disc_search->cell;
    bool within = distance2 < disc_search->bound * disc_search->bound;
    for (uint32_t k = 0; within && k < disc_search->n_lines; k++)
        within = chord[0] * disc_search->lines[k][0] + chord[1] * disc_search->lines[k][1] +
                     chord[2] * disc_search->lines[k][2] <
                 disc_search->offsets[k];
    return within || !disc_search->footprint ||
           orl_footprint_contains(disc_search->footprint,
                                  orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell));
}

static void split_patch(struct orl_disc_search *disc_search, uint32_t patch)
{
    const struct orl_photon_map *map = disc_search->sums->map;
    const uint32_t leaf = patch / ORL_PATCHES;
    const uint32_t *a = map->places + (size_t)leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    const uint32_t from = patch % ORL_PATCHES * photons_of(disc_search, patch & ~1U);
    const uint32_t to = from + photons_of(disc_search, patch);
    float x[ORL_MAP_LEAF], y[ORL_MAP_LEAF], z[ORL_MAP_LEAF], d2[ORL_MAP_LEAF];
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        x[i] = (float)(int32_t)(a[i] & 0xfffffU) - disc_search->at[0];
        y[i] = (float)(int32_t)(b[i] & 0xfffffU) - disc_search->at[1];
        z[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20) - disc_search->at[2];
        d2[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    }
    for (uint32_t i = from; i < to; i++) {
        const uint32_t index = leaf * ORL_MAP_LEAF + i;
        const float chord[3] = {x[i], y[i], z[i]};
        if (!(d2[i] < disc_search->radius2) ||
            (disc_search->query->at_photon && index == disc_search->query->skip) ||
            !on_sheet(disc_search, map->normals[index], chord, d2[i]) ||
            !in_footprint(disc_search, chord, d2[i]))
            continue;
        disc_search->single[disc_search->photons++] = (struct orl_search_candidate){d2[i], index};
    }
}

/* Classification of a patch. */
enum patch_class { EXCLUDED, WHOLE, UNCERTAIN, SPLIT };

struct patch_classes {
    float distance2[ORL_LANES];
    uint32_t classes[ORL_LANES];
};

/*
 * Classifies the patches of a group. A patch can count as a whole if it is narrow and on the
 * point's sheet: nearly always on the same plane, within rounding. The loop tests that for eight at
 * once.
 */
static inline void classify_patches(const struct orl_disc_search *disc_search,
                                    const struct orl_patch_group *group,
                                    const struct orl_map_group *boxes,
                                    struct patch_classes *ret_patch_classes)
{
    const float radius = disc_search->radius, radius2 = disc_search->radius2,
                bound = disc_search->bound;
    const float widest = disc_search->widest, near_by = beyond2 * radius2;
    const uint32_t normal = disc_search->normal, normal_bins = disc_search->normal_bins;
    float box2[ORL_LANES];
    uint32_t faces[ORL_LANES];
    orl_box_distances(boxes, disc_search->at, box2);
    for (int i = 0; i < ORL_MAP_FANOUT; i++) {
        box2[i + ORL_MAP_FANOUT] = box2[i];
        faces[i] = faces[i + ORL_MAP_FANOUT] = boxes->normal_bins[i] & normal_bins;
    }
    for (int i = 0; i < ORL_LANES; i++) {
        const float x = group->at[0][i] - disc_search->at[0],
                    y = group->at[1][i] - disc_search->at[1],
                    z = group->at[2][i] - disc_search->at[2];
        const float d2 = x * x + y * y + z * z, reach = group->reach[i], ramp = group->ramp[i];
        const float off = fabsf(x * disc_search->direction[0] + y * disc_search->direction[1] +
                                z * disc_search->direction[2]);
        const float far = radius + reach, within = bound - reach;
        const uint32_t near = (box2[i] < near_by) & (faces[i] != 0);
        const uint32_t parallel = group->normal[i] == normal;
        /* Farther off than the slopes of a sheet allow (orl_same_sheet). */
        const uint32_t other = parallel & (off > 0.05F * far + 2 * rounding);
        const uint32_t level = parallel & (off < rounding);
        const uint32_t whole = level & (within > 0) & (d2 < within * within);
        const uint32_t narrow = (ramp <= widest) & (group->normal[i] < ORL_NO_PLANE);
        const uint32_t touches = d2 - 2 * radius * ramp < radius2;
        const uint32_t as_one = touches ? (whole ? WHOLE : UNCERTAIN) : EXCLUDED;
        const uint32_t in_parts = d2 <= far * far ? SPLIT : EXCLUDED;
        ret_patch_classes->distance2[i] = d2;
        ret_patch_classes->classes[i] =
            near & (other ^ 1) ? (narrow ? as_one : in_parts) : EXCLUDED;
    }
}

/* Downgrades wholes that extend over a line of the footprint. */
static inline void downgrade_cut_patches(const struct orl_disc_search *disc_search,
                                         const struct orl_patch_group *group,
                                         struct patch_classes *patch_classes)
{
    for (uint32_t k = 0; k < disc_search->n_lines; k++) {
        const float nx = disc_search->lines[k][0], ny = disc_search->lines[k][1],
                    nz = disc_search->lines[k][2];
        const float offset = disc_search->offsets[k];
        for (int i = 0; i < ORL_LANES; i++) {
            const float over = (group->at[0][i] - disc_search->at[0]) * nx +
                               (group->at[1][i] - disc_search->at[1]) * ny +
                               (group->at[2][i] - disc_search->at[2]) * nz + group->reach[i];
            const uint32_t crosses = (over > offset) & (patch_classes->classes[i] == WHOLE);
            patch_classes->classes[i] = crosses ? UNCERTAIN : patch_classes->classes[i];
        }
    }
}

static struct orl_vec3 from_point(const struct orl_disc_search *disc_search, float x, float y,
                                  float z)
{
    return orl_v3((x - disc_search->at[0]) * disc_search->cell,
                  (y - disc_search->at[1]) * disc_search->cell,
                  (z - disc_search->at[2]) * disc_search->cell);
}

static enum orl_side side_of(const struct orl_disc_search *disc_search,
                             const struct orl_patch_group *group, uint32_t lane, uint32_t patch)
{
    const struct orl_map_group *box = &disc_search->sums->map->levels[0][patch / ORL_LANES];
    const uint32_t child = lane % ORL_MAP_FANOUT;
    const struct orl_photon_cluster cluster = {
        .middle =
            from_point(disc_search, group->at[0][lane], group->at[1][lane], group->at[2][lane]),
        .low = from_point(disc_search, box->low[0][child], box->low[1][child], box->low[2][child]),
        .high =
            from_point(disc_search, box->high[0][child], box->high[1][child], box->high[2][child]),
        .reach = group->reach[lane] * disc_search->cell,
        .rounding = disc_search->cell};
    return orl_footprint_side(disc_search->footprint, &cluster);
}

static inline void add_whole(struct orl_disc_search *disc_search,
                             const struct orl_patch_group *group, uint32_t lane, float d2,
                             uint32_t patch)
{
    struct orl_whole_patches *whole_patches = disc_search->whole_patches;
    const uint32_t at = disc_search->patches++;
    whole_patches->distance2[at] = d2;
    whole_patches->ramp[at] = group->ramp[lane];
    whole_patches->count[at] = group->count[lane];
    whole_patches->patch[at] = patch;
}

/* Counts a narrow patch as a whole, or leaves it out. Returns false if it must be split into
 * photons. */
static bool add_if_within(struct orl_disc_search *disc_search, const struct orl_patch_group *group,
                          uint32_t lane, float d2, uint32_t patch)
{
    const float chord[3] = {group->at[0][lane] - disc_search->at[0],
                            group->at[1][lane] - disc_search->at[1],
                            group->at[2][lane] - disc_search->at[2]};
    enum orl_side side = ORL_SIDE_INSIDE;
    if (!on_sheet(disc_search, (uint16_t)group->normal[lane], chord, d2))
        return true;
    if (disc_search->footprint)
        side = side_of(disc_search, group, lane, patch);
    if (side == ORL_SIDE_INSIDE)
        add_whole(disc_search, group, lane, d2, patch);
    return side != ORL_SIDE_BOTH;
}

static void add_patch(struct orl_disc_search *disc_search, const struct orl_patch_group *group,
                      uint32_t lane, enum patch_class patch_class, float d2, uint32_t patch)
{
    const bool own = disc_search->query->at_photon &&
                     disc_search->query->skip / ORL_MAP_LEAF == patch / ORL_PATCHES;
    if (patch_class == WHOLE && !own)
        add_whole(disc_search, group, lane, d2, patch);
    else if (own || patch_class == SPLIT || !add_if_within(disc_search, group, lane, d2, patch))
        split_patch(disc_search, patch);
    disc_search->full = disc_search->patches + disc_search->photons + ORL_MAP_LEAF > CAPACITY;
}

static inline void add_group(struct orl_disc_search *disc_search, uint32_t node,
                             const struct patch_classes *patch_classes)
{
    const struct orl_patch_group *group = &disc_search->sums->groups[node];
    uint32_t some = 0;
    for (uint32_t i = 0; i < ORL_LANES; i++)
        some |= (uint32_t)(patch_classes->classes[i] != EXCLUDED) << i;
    for (; some != 0 && !disc_search->full; some &= some - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(some);
        const uint32_t patch = orl_patch_number(node, lane);
        add_patch(disc_search, group, lane, patch_classes->classes[lane],
                  patch_classes->distance2[lane], patch);
    }
}

/* Visits nodes in the order of the map; all of them are needed, so their order does not matter. */
ORL_FOR_WIDE_VECTORS static void find_patches(struct orl_disc_search *disc_search)
{
    const struct orl_photon_map *map = disc_search->sums->map;
    struct {
        uint32_t level, node;
    } stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    disc_search->patches = disc_search->photons = 0;
    disc_search->radius = sqrtf(disc_search->radius2);
    disc_search->widest =
        0.5F * (disc_search->footprint ? widest_in_cut : widest_ramp) * disc_search->radius;
    disc_search->full = false;
    stack[depth].level = map->header->levels - 1;
    stack[depth++].node = 0;
    while (depth > 0 && !disc_search->full) {
        const uint32_t level = stack[--depth].level, node = stack[depth].node;
        const struct orl_map_group *group = &map->levels[level][node];
        float distance2[ORL_MAP_FANOUT];
        struct patch_classes patch_classes;
        if (level == 0) {
            classify_patches(disc_search, &disc_search->sums->groups[node], group, &patch_classes);
            downgrade_cut_patches(disc_search, &disc_search->sums->groups[node], &patch_classes);
            add_group(disc_search, node, &patch_classes);
            continue;
        }
        orl_box_distances(group, disc_search->at, distance2);
        for (uint32_t c = ORL_MAP_FANOUT; c-- > 0;) {
            if (!(distance2[c] < beyond2 * disc_search->radius2) ||
                !(group->normal_bins[c] & disc_search->normal_bins))
                continue;
            stack[depth].level = level - 1;
            stack[depth++].node = node * ORL_MAP_FANOUT + c;
        }
    }
}

uint32_t orl_disc_search_count(const struct orl_disc_search *disc_search)
{
    uint32_t count = disc_search->photons;
    for (uint32_t i = 0; i < disc_search->patches; i++)
        if (disc_search->whole_patches->distance2[i] < disc_search->radius2)
            count += disc_search->whole_patches->count[i];
    return count;
}

/* Returns the squared radius that holds k of the photons found, which are more. */
static float radius2_of(const struct orl_disc_search *disc_search, uint32_t k)
{
    uint32_t bins[BINS + 1] = {0}, sum = 0, bin = 0;
    const float scale = BINS / disc_search->radius2;
    for (uint32_t i = 0; i < disc_search->patches; i++) {
        const float at = disc_search->whole_patches->distance2[i] * scale;
        bins[at < BINS ? (uint32_t)at : BINS] += disc_search->whole_patches->count[i];
    }
    for (uint32_t i = 0; i < disc_search->photons; i++)
        bins[(uint32_t)(disc_search->single[i].distance2 * scale)]++;
    while (bin + 1 < BINS && sum + bins[bin] < k)
        sum += bins[bin++];
    const float part = bins[bin] > 0 ? (float)(k - sum) / (float)bins[bin] : 1;
    return ((float)bin + (part < 1 ? part : 1)) / scale;
}

float orl_disc_search_find(struct orl_disc_search *disc_search, float radius2, float most2)
{
    const uint32_t k = disc_search->query->k;
    bool shrunk = false;
    disc_search->radius2 = fminf(radius2, most2);
    for (int turn = 0; turn < MOST_TURNS; turn++) {
        find_patches(disc_search);
        if (disc_search->full) {
            shrunk = true;
            disc_search->radius2 *= 0.5F;
            continue;
        }
        const uint32_t count = orl_disc_search_count(disc_search);
        if (count < k) {
            if (shrunk || !(disc_search->radius2 < most2))
                return disc_search->radius2;
            const float lack = 1.2F * (float)k / (float)(count + 1);
            disc_search->radius2 = fminf(disc_search->radius2 * fminf(lack, 8), most2);
            continue;
        }
        const float enough2 = radius2_of(disc_search, k);
        if (enough2 > 0.4F * disc_search->radius2 || shrunk)
            return enough2;
        disc_search->radius2 = 1.2F * enough2;
    }
    return disc_search->radius2;
}

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/*
 * Assumes that photons around the point are as dense as in its leaf, on a uniform disc: takes the
 * median of that leaf and its neighbours.
 */
float orl_disc_search_first_radius2(const struct orl_disc_search *disc_search,
                                    const struct orl_zorder *order)
{
    enum { BESIDE = 2 };
    uint32_t cell[3];
    float near2[2 * BESIDE + 1];
    size_t n = 0;
    for (int k = 0; k < 3; k++)
        cell[k] = (uint32_t)fminf(fmaxf(disc_search->at[k] + 0.5F, 0), ORL_POSITION_CELLS - 1);
    const uint64_t leaf = orl_zorder_find(order, orl_zorder_code(cell, disc_search->normal));
    for (uint64_t i = leaf < BESIDE ? 0 : leaf - BESIDE;
         i <= leaf + BESIDE && i < disc_search->sums->count; i++) {
        uint32_t lane;
        const struct orl_patch_group *group =
            orl_patch_find(disc_search->sums, ORL_PATCHES * i, &lane);
        near2[n++] = group->ramp[lane] * group->ramp[lane] / (float)group->count[lane];
    }
    qsort(near2, n, sizeof *near2, compare_floats);
    return fmaxf((float)disc_search->query->k * near2[n / 2], 4);
}

void orl_disc_search_restrict(struct orl_disc_search *disc_search,
                              const struct orl_footprint *footprint)
{
    const struct orl_convex_bound bound = orl_footprint_bound(footprint);
    disc_search->footprint = footprint;
    disc_search->bound = (float)(bound.radius / disc_search->cell);
    disc_search->n_lines = bound.n_lines;
    for (uint32_t i = 0; i < bound.n_lines; i++) {
        disc_search->lines[i][0] = (float)bound.normals[i].x;
        disc_search->lines[i][1] = (float)bound.normals[i].y;
        disc_search->lines[i][2] = (float)bound.normals[i].z;
        disc_search->offsets[i] = (float)(bound.offsets[i] / disc_search->cell);
    }
}

struct orl_disc_search orl_disc_search_of(const struct orl_leaf_sums *sums,
                                          const struct orl_density_query *query,
                                          struct orl_search *search)
{
    struct orl_disc_search disc_search = {
        .sums = sums,
        .query = query,
        .whole_patches = &search->whole_patches,
        .single = search->candidates,
        .bound = INFINITY,
        .cell = sums->map->header->cell,
        .normal = orl_normal_encode(query->normal),
        .normal_bins = orl_normal_bins_mask(&sums->map->normal_bins, query->normal)};
    orl_box_locate(sums->map, query->point, disc_search.at);
    disc_search.direction[0] = (float)query->normal.x;
    disc_search.direction[1] = (float)query->normal.y;
    disc_search.direction[2] = (float)query->normal.z;
    if (query->surface_point) {
        const double flat = orl_surface_point_flat_radius(query->surface_point) / disc_search.cell;
        disc_search.flat2 = (float)orl_smaller(flat * flat, 1e30);
    }
    return disc_search;
}
