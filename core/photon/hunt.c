#include "photon/hunt.h"

#include <stdlib.h>

#include "base/vectors.h"
#include "photon/boxes.h"
#include "photon/sheet.h"
#include "photon/sides.h"

enum { ROOM = ORL_HUNT_ROOM, BINS = 512, MOST_TURNS = 32 };

/*
 * A leaf is taken apart where its ramp is wider than that share of the smallest disc's radius: with
 * wider ones the shares within a disc would not add up to its area, or, of a cut one, its moments.
 */
static const float widest_ramp = 0.5F, widest_in_cut = 0.3F;
/* Over the radius asked about: as far, squared, as leaves are looked for, lest their near ends be
 * missed. */
static const float beyond2 = 1.15F;
/* Of cells, across a plane: less than sheet.h allows. */
static const float rounding = 3.9F;

static bool on_sheet(const struct orl_hunt *hunt, uint16_t normal, const float chord[3],
                     float distance2)
{
    /* Nearly always: the same plane, within rounding (sheet.h). */
    const float *own = hunt->direction;
    if (normal == hunt->normal &&
        fabsf(chord[0] * own[0] + chord[1] * own[1] + chord[2] * own[2]) < rounding)
        return true;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    return orl_same_sheet(hunt->query->normal, hunt->normal, normal, chord) &&
           (distance2 >= hunt->flat2 || fabs(orl_dot(c, hunt->query->normal)) <= 4);
}

static bool in_footprint(const struct orl_hunt *hunt, const float chord[3], float distance2)
{
    const double cell = hunt->cell;
    return !hunt->footprint || distance2 < hunt->inner * hunt->inner ||
           orl_footprint_holds(hunt->footprint,
                               orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell));
}

static void take_apart(struct orl_hunt *hunt, uint32_t leaf)
{
    const struct orl_photon_map *map = hunt->sums->map;
    const uint32_t *a = map->places + (size_t)leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    const uint32_t n = orl_leaf_photons(map, leaf);
    float x[ORL_MAP_LEAF], y[ORL_MAP_LEAF], z[ORL_MAP_LEAF], d2[ORL_MAP_LEAF];
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        x[i] = (float)(int32_t)(a[i] & 0xfffffU) - hunt->at[0];
        y[i] = (float)(int32_t)(b[i] & 0xfffffU) - hunt->at[1];
        z[i] = (float)(int32_t)((a[i] >> 24) << 12 | b[i] >> 20) - hunt->at[2];
        d2[i] = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    }
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t index = leaf * ORL_MAP_LEAF + i;
        const float chord[3] = {x[i], y[i], z[i]};
        if (!(d2[i] < hunt->radius2) || (hunt->query->at_photon && index == hunt->query->skip) ||
            !on_sheet(hunt, map->normals[index], chord, d2[i]) || !in_footprint(hunt, chord, d2[i]))
            continue;
        hunt->list[ROOM - 1 - hunt->photons++] = (struct orl_search_candidate){d2[i], index};
    }
}

/* What a leaf is, at first sight. */
enum sight { NOTHING, WHOLE, DOUBTFUL, APART };

struct sights {
    float distance2[ORL_MAP_FANOUT];
    uint32_t what[ORL_MAP_FANOUT];
};

/*
 * Leaves are wholes that are narrow, and of the point's sheet: nearly always of the same plane,
 * within rounding. Those are told from others by eight at once.
 */
static inline void look_at(const struct orl_hunt *hunt, const struct orl_leaf_group *group,
                           const struct orl_map_group *boxes, struct sights *ret_sights)
{
    const float radius = hunt->radius, radius2 = hunt->radius2, inner = hunt->inner;
    const float widest = hunt->widest, near_by = beyond2 * radius2;
    const uint32_t normal = hunt->normal, facing = hunt->facing;
    float box2[ORL_MAP_FANOUT];
    orl_box_distances(boxes, hunt->at, box2);
    for (int i = 0; i < ORL_MAP_FANOUT; i++) {
        const float x = group->at[0][i] - hunt->at[0], y = group->at[1][i] - hunt->at[1],
                    z = group->at[2][i] - hunt->at[2];
        const float d2 = x * x + y * y + z * z, reach = group->reach[i], ramp = group->ramp[i];
        const float off =
            fabsf(x * hunt->direction[0] + y * hunt->direction[1] + z * hunt->direction[2]);
        const float far = radius + reach, within = inner - reach;
        const uint32_t near = (box2[i] < near_by) & ((boxes->facing[i] & facing) != 0);
        const uint32_t parallel = group->normal[i] == normal;
        /* Further off than the slopes of a sheet reach (sheet.h). */
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

static struct orl_vec3 from_point(const struct orl_hunt *hunt, float x, float y, float z)
{
    return orl_v3((x - hunt->at[0]) * hunt->cell, (y - hunt->at[1]) * hunt->cell,
                  (z - hunt->at[2]) * hunt->cell);
}

static enum orl_side side_of(const struct orl_hunt *hunt, const struct orl_leaf_group *group,
                             uint32_t lane, uint32_t leaf)
{
    const struct orl_map_group *box = &hunt->sums->map->levels[0][leaf / ORL_MAP_FANOUT];
    const struct orl_patch patch = {
        .middle = from_point(hunt, group->at[0][lane], group->at[1][lane], group->at[2][lane]),
        .low = from_point(hunt, box->low[0][lane], box->low[1][lane], box->low[2][lane]),
        .high = from_point(hunt, box->high[0][lane], box->high[1][lane], box->high[2][lane]),
        .reach = group->reach[lane] * hunt->cell,
        .rounding = hunt->cell};
    return orl_footprint_side(hunt->footprint, &patch);
}

/* A narrow leaf: takes it as a whole, or leaves it out; false: it has to be taken apart. */
static bool take_whole(struct orl_hunt *hunt, const struct orl_leaf_group *group, uint32_t lane,
                       float d2, uint32_t leaf)
{
    const float chord[3] = {group->at[0][lane] - hunt->at[0], group->at[1][lane] - hunt->at[1],
                            group->at[2][lane] - hunt->at[2]};
    enum orl_side side = ORL_SIDE_WITHIN;
    if (!on_sheet(hunt, (uint16_t)group->normal[lane], chord, d2))
        return true;
    if (hunt->footprint && !(sqrtf(d2) + group->reach[lane] < hunt->inner))
        side = side_of(hunt, group, lane, leaf);
    if (side == ORL_SIDE_WITHIN)
        hunt->list[hunt->leaves++] = (struct orl_search_candidate){d2, leaf};
    return side != ORL_SIDE_BOTH;
}

static void take_group(struct orl_hunt *hunt, uint32_t node, const struct sights *sights)
{
    const struct orl_leaf_group *group = &hunt->sums->groups[node];
    for (uint32_t i = 0; i < ORL_MAP_FANOUT && !hunt->full; i++) {
        const uint32_t leaf = node * ORL_MAP_FANOUT + i;
        const bool own = hunt->query->at_photon && hunt->query->skip / ORL_MAP_LEAF == leaf;
        if (sights->what[i] == NOTHING)
            continue;
        if (own || sights->what[i] == APART)
            take_apart(hunt, leaf);
        else if (sights->what[i] == WHOLE)
            hunt->list[hunt->leaves++] = (struct orl_search_candidate){sights->distance2[i], leaf};
        else if (!take_whole(hunt, group, i, sights->distance2[i], leaf))
            take_apart(hunt, leaf);
        hunt->full = hunt->leaves + hunt->photons + ORL_MAP_LEAF > ROOM;
    }
}

/* In the order of the map: whatever comes first, all of it is looked at. */
ORL_FOR_WIDE_VECTORS static void find_all(struct orl_hunt *hunt)
{
    const struct orl_photon_map *map = hunt->sums->map;
    struct {
        uint32_t level, node;
    } stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    hunt->leaves = hunt->photons = 0;
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
            look_at(hunt, &hunt->sums->groups[node], group, &sights);
            take_group(hunt, node, &sights);
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

static uint32_t photons_of(const struct orl_hunt *hunt, uint32_t leaf)
{
    return orl_leaf_photons(hunt->sums->map, leaf);
}

uint32_t orl_hunt_count(const struct orl_hunt *hunt)
{
    uint32_t count = hunt->photons;
    for (uint32_t i = 0; i < hunt->leaves; i++)
        if (hunt->list[i].distance2 < hunt->radius2)
            count += photons_of(hunt, hunt->list[i].index);
    return count;
}

/* The squared radius that holds k of what was found, which is more. */
static float radius2_of(const struct orl_hunt *hunt, uint32_t k)
{
    uint32_t bins[BINS + 1] = {0}, sum = 0, bin = 0;
    const float scale = BINS / hunt->radius2;
    for (uint32_t i = 0; i < hunt->leaves; i++) {
        const float at = hunt->list[i].distance2 * scale;
        bins[at < BINS ? (uint32_t)at : BINS] += photons_of(hunt, hunt->list[i].index);
    }
    for (uint32_t i = 0; i < hunt->photons; i++)
        bins[(uint32_t)(hunt->list[ROOM - 1 - i].distance2 * scale)]++;
    while (bin + 1 < BINS && sum + bins[bin] < k)
        sum += bins[bin++];
    const float part = bins[bin] > 0 ? (float)(k - sum) / (float)bins[bin] : 1;
    return ((float)bin + (part < 1 ? part : 1)) / scale;
}

float orl_hunt_enough(struct orl_hunt *hunt, float radius2, float most2)
{
    const uint32_t k = hunt->query->k;
    bool shrunk = false;
    hunt->radius2 = fminf(radius2, most2);
    for (int turn = 0; turn < MOST_TURNS; turn++) {
        find_all(hunt);
        if (hunt->full) {
            shrunk = true;
            hunt->radius2 *= 0.5F;
            continue;
        }
        const uint32_t count = orl_hunt_count(hunt);
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

static int compare(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/*
 * Where to begin: as if about the point photons lay as they do in the leaf it falls in, by the
 * median of that and its neighbours, on an even disc.
 */
float orl_hunt_first_radius2(const struct orl_hunt *hunt, const struct orl_zorder *order)
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
        const float ramp = hunt->sums->groups[i / ORL_MAP_FANOUT].ramp[i % ORL_MAP_FANOUT];
        near2[n++] = ramp * ramp / (float)photons_of(hunt, (uint32_t)i);
    }
    qsort(near2, n, sizeof *near2, compare);
    return fmaxf((float)hunt->query->k * near2[n / 2], 4);
}

struct orl_hunt orl_hunt_of(const struct orl_sums *sums, const struct orl_density_query *query,
                            struct orl_search *search)
{
    struct orl_hunt hunt = {.sums = sums,
                            .query = query,
                            .list = search->candidates,
                            .inner = INFINITY,
                            .cell = sums->map->header->cell,
                            .normal = orl_normal_encode(query->normal),
                            .facing = orl_facing_mask(&sums->map->facing, query->normal)};
    orl_box_locate(sums->map, query->point, hunt.at);
    hunt.direction[0] = (float)query->normal.x;
    hunt.direction[1] = (float)query->normal.y;
    hunt.direction[2] = (float)query->normal.z;
    if (query->footing) {
        const double flat = orl_footing_flat(query->footing) / hunt.cell;
        hunt.flat2 = (float)fmin(flat * flat, 1e30);
    }
    return hunt;
}
