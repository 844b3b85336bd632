#include "photon/density/disc_search.h"

#include <stdlib.h>

#include "base/vectors.h"
#include "photon/map/boxes.h"
#include "photon/surface/sheet.h"

enum { ROOM = ORL_DISC_SEARCH_ROOM, BINS = 512, MOST_TURNS = 32 };

/*
 * A leaf is split into photons if its ramp is wider than this share of the smallest disc's radius.
 * With wider ramps the shares within a disc would not add up to its area, or to its moments if it
 * is cut.
 */
static const float widest_ramp = 0.5F, widest_in_cut = 0.3F;
/* Factor on the squared search radius for boxes of leaves, so that the near ends of wide leaves
 * are not missed. */
static const float beyond2 = 1.15F;
/* In cells, across a plane: less than sheet.h allows. */
static const float rounding = 3.9F;

static uint32_t photons_of(const struct orl_disc_search *hunt, uint32_t patch)
{
    uint32_t lane;
    return orl_patch_find(hunt->sums, patch, &lane)->count[lane];
}

static bool on_sheet(const struct orl_disc_search *hunt, uint16_t normal, const float chord[3],
                     float distance2)
{
    /* Most common case: the same plane, within rounding (sheet.h). */
    const float *own = hunt->direction;
    if (normal == hunt->normal &&
        fabsf(chord[0] * own[0] + chord[1] * own[1] + chord[2] * own[2]) < rounding)
        return true;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    return orl_same_sheet(hunt->query->normal, hunt->normal, normal, chord) &&
           (distance2 >= hunt->flat2 || fabs(orl_dot(c, hunt->query->normal)) <= 4);
}

static bool in_footprint(const struct orl_disc_search *hunt, const float chord[3], float distance2)
{
    const double cell = hunt->cell;
    bool within = distance2 < hunt->bound * hunt->bound;
    for (uint32_t k = 0; within && k < hunt->n_lines; k++)
        within = chord[0] * hunt->lines[k][0] + chord[1] * hunt->lines[k][1] +
                     chord[2] * hunt->lines[k][2] <
                 hunt->offsets[k];
    return within || !hunt->footprint ||
           orl_footprint_holds(hunt->footprint,
                               orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell));
}

static void split_patch(struct orl_disc_search *hunt, uint32_t patch)
{
    const struct orl_photon_map *map = hunt->sums->map;
    const uint32_t leaf = patch / ORL_PATCHES;
    const uint32_t *a = map->places + (size_t)leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    const uint32_t from = patch % ORL_PATCHES * photons_of(hunt, patch & ~1U);
    const uint32_t to = from + photons_of(hunt, patch);
    float x[ORL_MAP_LEAF], y[ORL_MAP_LEAF], z[ORL_MAP_LEAF], d2[ORL_MAP_LEAF];
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        x[i] = (float)(int32_t)(a[i] & 0xfffffU) - hunt->at[0];
        y[i] = (float)(int32_t)(b[i] & 0xfffffU) - hunt->at[1];
        z[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20) - hunt->at[2];
        d2[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    }
    for (uint32_t i = from; i < to; i++) {
        const uint32_t index = leaf * ORL_MAP_LEAF + i;
        const float chord[3] = {x[i], y[i], z[i]};
        if (!(d2[i] < hunt->radius2) || (hunt->query->at_photon && index == hunt->query->skip) ||
            !on_sheet(hunt, map->normals[index], chord, d2[i]) || !in_footprint(hunt, chord, d2[i]))
            continue;
        hunt->single[hunt->photons++] = (struct orl_search_candidate){d2[i], index};
    }
}

/* Classification of a patch. */
enum sight { NOTHING, WHOLE, DOUBTFUL, APART };

struct sights {
    float distance2[ORL_LANES];
    uint32_t what[ORL_LANES];
};

/*
 * Classifies the patches of a group. A patch can count as a whole if it is narrow and on the
 * point's sheet: nearly always on the same plane, within rounding. The loop tests that for eight at
 * once.
 */
static inline void classify_patches(const struct orl_disc_search *hunt,
                                    const struct orl_patch_group *group,
                                    const struct orl_map_group *boxes, struct sights *ret_sights)
{
    const float radius = hunt->radius, radius2 = hunt->radius2, bound = hunt->bound;
    const float widest = hunt->widest, near_by = beyond2 * radius2;
    const uint32_t normal = hunt->normal, facing = hunt->facing;
    float box2[ORL_LANES];
    uint32_t faces[ORL_LANES];
    orl_box_distances(boxes, hunt->at, box2);
    for (int i = 0; i < ORL_MAP_FANOUT; i++) {
        box2[i + ORL_MAP_FANOUT] = box2[i];
        faces[i] = faces[i + ORL_MAP_FANOUT] = boxes->facing[i] & facing;
    }
    for (int i = 0; i < ORL_LANES; i++) {
        const float x = group->at[0][i] - hunt->at[0], y = group->at[1][i] - hunt->at[1],
                    z = group->at[2][i] - hunt->at[2];
        const float d2 = x * x + y * y + z * z, reach = group->reach[i], ramp = group->ramp[i];
        const float off =
            fabsf(x * hunt->direction[0] + y * hunt->direction[1] + z * hunt->direction[2]);
        const float far = radius + reach, within = bound - reach;
        const uint32_t near = (box2[i] < near_by) & (faces[i] != 0);
        const uint32_t parallel = group->normal[i] == normal;
        /* Farther off than the slopes of a sheet allow (sheet.h). */
        const uint32_t other = parallel & (off > 0.05F * far + 2 * rounding);
        const uint32_t level = parallel & (off < rounding);
        const uint32_t whole = level & (within > 0) & (d2 < within * within);
        const uint32_t narrow = (ramp <= widest) & (group->normal[i] < ORL_NO_PLANE);
        const uint32_t touches = d2 - 2 * radius * ramp < radius2;
        const uint32_t as_one = touches ? (whole ? WHOLE : DOUBTFUL) : NOTHING;
        const uint32_t in_parts = d2 <= far * far ? APART : NOTHING;
        ret_sights->distance2[i] = d2;
        ret_sights->what[i] = near & (other ^ 1) ? (narrow ? as_one : in_parts) : NOTHING;
    }
}

/* Downgrades wholes that extend over a line of the footprint. */
static inline void downgrade_cut_patches(const struct orl_disc_search *hunt,
                                         const struct orl_patch_group *group, struct sights *sights)
{
    for (uint32_t k = 0; k < hunt->n_lines; k++) {
        const float nx = hunt->lines[k][0], ny = hunt->lines[k][1], nz = hunt->lines[k][2];
        const float offset = hunt->offsets[k];
        for (int i = 0; i < ORL_LANES; i++) {
            const float over = (group->at[0][i] - hunt->at[0]) * nx +
                               (group->at[1][i] - hunt->at[1]) * ny +
                               (group->at[2][i] - hunt->at[2]) * nz + group->reach[i];
            const uint32_t crosses = (over > offset) & (sights->what[i] == WHOLE);
            sights->what[i] = crosses ? DOUBTFUL : sights->what[i];
        }
    }
}

static struct orl_vec3 from_point(const struct orl_disc_search *hunt, float x, float y, float z)
{
    return orl_v3((x - hunt->at[0]) * hunt->cell, (y - hunt->at[1]) * hunt->cell,
                  (z - hunt->at[2]) * hunt->cell);
}

static enum orl_side side_of(const struct orl_disc_search *hunt,
                             const struct orl_patch_group *group, uint32_t lane, uint32_t patch)
{
    const struct orl_map_group *box = &hunt->sums->map->levels[0][patch / ORL_LANES];
    const uint32_t child = lane % ORL_MAP_FANOUT;
    const struct orl_spot spot = {
        .middle = from_point(hunt, group->at[0][lane], group->at[1][lane], group->at[2][lane]),
        .low = from_point(hunt, box->low[0][child], box->low[1][child], box->low[2][child]),
        .high = from_point(hunt, box->high[0][child], box->high[1][child], box->high[2][child]),
        .reach = group->reach[lane] * hunt->cell,
        .rounding = hunt->cell};
    return orl_footprint_side(hunt->footprint, &spot);
}

static inline void add_whole(struct orl_disc_search *hunt, const struct orl_patch_group *group,
                             uint32_t lane, float d2, uint32_t patch)
{
    struct orl_search_wholes *wholes = hunt->wholes;
    const uint32_t at = hunt->patches++;
    wholes->distance2[at] = d2;
    wholes->ramp[at] = group->ramp[lane];
    wholes->count[at] = group->count[lane];
    wholes->patch[at] = patch;
}

/* Counts a narrow patch as a whole, or leaves it out. Returns false if it must be split into
 * photons. */
static bool add_if_within(struct orl_disc_search *hunt, const struct orl_patch_group *group,
                          uint32_t lane, float d2, uint32_t patch)
{
    const float chord[3] = {group->at[0][lane] - hunt->at[0], group->at[1][lane] - hunt->at[1],
                            group->at[2][lane] - hunt->at[2]};
    enum orl_side side = ORL_SIDE_WITHIN;
    if (!on_sheet(hunt, (uint16_t)group->normal[lane], chord, d2))
        return true;
    if (hunt->footprint)
        side = side_of(hunt, group, lane, patch);
    if (side == ORL_SIDE_WITHIN)
        add_whole(hunt, group, lane, d2, patch);
    return side != ORL_SIDE_BOTH;
}

static void add_patch(struct orl_disc_search *hunt, const struct orl_patch_group *group,
                      uint32_t lane, enum sight sight, float d2, uint32_t patch)
{
    const bool own =
        hunt->query->at_photon && hunt->query->skip / ORL_MAP_LEAF == patch / ORL_PATCHES;
    if (sight == WHOLE && !own)
        add_whole(hunt, group, lane, d2, patch);
    else if (own || sight == APART || !add_if_within(hunt, group, lane, d2, patch))
        split_patch(hunt, patch);
    hunt->full = hunt->patches + hunt->photons + ORL_MAP_LEAF > ROOM;
}

static inline void add_group(struct orl_disc_search *hunt, uint32_t node,
                             const struct sights *sights)
{
    const struct orl_patch_group *group = &hunt->sums->groups[node];
    uint32_t some = 0;
    for (uint32_t i = 0; i < ORL_LANES; i++)
        some |= (uint32_t)(sights->what[i] != NOTHING) << i;
    for (; some != 0 && !hunt->full; some &= some - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(some);
        const uint32_t patch = orl_patch_number(node, lane);
        add_patch(hunt, group, lane, sights->what[lane], sights->distance2[lane], patch);
    }
}

/* Visits nodes in the order of the map; all of them are needed, so their order does not matter. */
ORL_FOR_WIDE_VECTORS static void find_patches(struct orl_disc_search *hunt)
{
    const struct orl_photon_map *map = hunt->sums->map;
    struct {
        uint32_t level, node;
    } stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    hunt->patches = hunt->photons = 0;
    hunt->radius = sqrtf(hunt->radius2);
    hunt->widest = 0.5F * (hunt->footprint ? widest_in_cut : widest_ramp) * hunt->radius;
    hunt->full = false;
    stack[depth].level = map->header->levels - 1;
    stack[depth++].node = 0;
    while (depth > 0 && !hunt->full) {
        const uint32_t level = stack[--depth].level, node = stack[depth].node;
        const struct orl_map_group *group = &map->levels[level][node];
        float distance2[ORL_MAP_FANOUT];
        struct sights sights;
        if (level == 0) {
            classify_patches(hunt, &hunt->sums->groups[node], group, &sights);
            downgrade_cut_patches(hunt, &hunt->sums->groups[node], &sights);
            add_group(hunt, node, &sights);
            continue;
        }
        orl_box_distances(group, hunt->at, distance2);
        for (uint32_t c = ORL_MAP_FANOUT; c-- > 0;) {
            if (!(distance2[c] < beyond2 * hunt->radius2) || !(group->facing[c] & hunt->facing))
                continue;
            stack[depth].level = level - 1;
            stack[depth++].node = node * ORL_MAP_FANOUT + c;
        }
    }
}

uint32_t orl_disc_search_count(const struct orl_disc_search *hunt)
{
    uint32_t count = hunt->photons;
    for (uint32_t i = 0; i < hunt->patches; i++)
        if (hunt->wholes->distance2[i] < hunt->radius2)
            count += hunt->wholes->count[i];
    return count;
}

/* Returns the squared radius that holds k of the photons found, which are more. */
static float radius2_of(const struct orl_disc_search *hunt, uint32_t k)
{
    uint32_t bins[BINS + 1] = {0}, sum = 0, bin = 0;
    const float scale = BINS / hunt->radius2;
    for (uint32_t i = 0; i < hunt->patches; i++) {
        const float at = hunt->wholes->distance2[i] * scale;
        bins[at < BINS ? (uint32_t)at : BINS] += hunt->wholes->count[i];
    }
    for (uint32_t i = 0; i < hunt->photons; i++)
        bins[(uint32_t)(hunt->single[i].distance2 * scale)]++;
    while (bin + 1 < BINS && sum + bins[bin] < k)
        sum += bins[bin++];
    const float part = bins[bin] > 0 ? (float)(k - sum) / (float)bins[bin] : 1;
    return ((float)bin + (part < 1 ? part : 1)) / scale;
}

float orl_disc_search_enough(struct orl_disc_search *hunt, float radius2, float most2)
{
    const uint32_t k = hunt->query->k;
    bool shrunk = false;
    hunt->radius2 = fminf(radius2, most2);
    for (int turn = 0; turn < MOST_TURNS; turn++) {
        find_patches(hunt);
        if (hunt->full) {
            shrunk = true;
            hunt->radius2 *= 0.5F;
            continue;
        }
        const uint32_t count = orl_disc_search_count(hunt);
        if (count < k) {
            if (shrunk || !(hunt->radius2 < most2))
                return hunt->radius2;
            const float lack = 1.2F * (float)k / (float)(count + 1);
            hunt->radius2 = fminf(hunt->radius2 * fminf(lack, 8), most2);
            continue;
        }
        const float enough2 = radius2_of(hunt, k);
        if (enough2 > 0.4F * hunt->radius2 || shrunk)
            return enough2;
        hunt->radius2 = 1.2F * enough2;
    }
    return hunt->radius2;
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
float orl_disc_search_first_radius2(const struct orl_disc_search *hunt,
                                    const struct orl_zorder *order)
{
    enum { BESIDE = 2 };
    uint32_t cell[3];
    float near2[2 * BESIDE + 1];
    size_t n = 0;
    for (int k = 0; k < 3; k++)
        cell[k] = (uint32_t)fminf(fmaxf(hunt->at[k] + 0.5F, 0), ORL_PLACE_CELLS - 1);
    const uint64_t leaf = orl_zorder_find(order, orl_zorder_code(cell, hunt->normal));
    for (uint64_t i = leaf < BESIDE ? 0 : leaf - BESIDE;
         i <= leaf + BESIDE && i < hunt->sums->count; i++) {
        uint32_t lane;
        const struct orl_patch_group *group = orl_patch_find(hunt->sums, ORL_PATCHES * i, &lane);
        near2[n++] = group->ramp[lane] * group->ramp[lane] / (float)group->count[lane];
    }
    qsort(near2, n, sizeof *near2, compare_floats);
    return fmaxf((float)hunt->query->k * near2[n / 2], 4);
}

void orl_disc_search_keep_to(struct orl_disc_search *hunt, const struct orl_footprint *footprint)
{
    const struct orl_bound bound = orl_footprint_bound(footprint);
    hunt->footprint = footprint;
    hunt->bound = (float)(bound.radius / hunt->cell);
    hunt->n_lines = bound.n_lines;
    for (uint32_t i = 0; i < bound.n_lines; i++) {
        hunt->lines[i][0] = (float)bound.normals[i].x;
        hunt->lines[i][1] = (float)bound.normals[i].y;
        hunt->lines[i][2] = (float)bound.normals[i].z;
        hunt->offsets[i] = (float)(bound.offsets[i] / hunt->cell);
    }
}

struct orl_disc_search orl_disc_search_of(const struct orl_leaf_sums *sums,
                                          const struct orl_density_query *query,
                                          struct orl_search *search)
{
    struct orl_disc_search hunt = {.sums = sums,
                                   .query = query,
                                   .wholes = &search->wholes,
                                   .single = search->candidates,
                                   .bound = INFINITY,
                                   .cell = sums->map->header->cell,
                                   .normal = orl_normal_encode(query->normal),
                                   .facing = orl_facing_mask(&sums->map->facing, query->normal)};
    orl_box_locate(sums->map, query->point, hunt.at);
    hunt.direction[0] = (float)query->normal.x;
    hunt.direction[1] = (float)query->normal.y;
    hunt.direction[2] = (float)query->normal.z;
    if (query->footing) {
        const double flat = orl_footing_flat(query->footing) / hunt.cell;
        hunt.flat2 = (float)orl_smaller(flat * flat, 1e30);
    }
    return hunt;
}
