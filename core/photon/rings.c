#include "photon/rings.h"

#include <stdlib.h>
#include <string.h>

#include "photon/boxes.h"
#include "photon/flux.h"
#include "photon/sheet.h"
#include "photon/sides.h"

enum { ROOM = 2 * ORL_SEARCH_MOST, BINS = 512, MOST_TURNS = 32 };

/*
 * A leaf is taken apart where its ramp is wider than that share of the smallest disc's radius: with
 * wider ones the shares within a disc would not add up to its area, or, of a cut one, its moments.
 */
static const float widest_ramp = 0.5F, widest_in_cut = 0.3F;
/* Over the radius asked about: as far, squared, as leaves are looked for, lest their near ends be
 * missed. */
static const float beyond2 = 1.15F;
/* Over the area that another estimate close by took. */
static const float first_beyond = 1.15F;

/* Leaves fill the candidates from the front, single photons from the back. */
struct hunt {
    const struct orl_sums *sums;
    const struct orl_density_query *query;
    const struct orl_footprint *footprint; /* NULL: the whole disc */
    struct orl_search_candidate *list;
    double cell;
    float at[3];           /* cells */
    float direction[3];    /* the query's normal */
    float radius2, radius; /* cells */
    float flat2;           /* nearer than this photons lie in the footing's plane */
    float inner;           /* cells: within this the footprint is whole */
    uint32_t leaves, photons, facing;
    uint16_t normal;
    bool full;
};

/* ---- Finding --------------------------------------------------------------------------------- */

static bool on_sheet(const struct hunt *hunt, uint16_t normal, const float chord[3],
                     float distance2)
{
    /* Nearly always: the same plane, within rounding (sheet.h). */
    const float *own = hunt->direction;
    if (normal == hunt->normal &&
        fabsf(chord[0] * own[0] + chord[1] * own[1] + chord[2] * own[2]) < 3.9F)
        return true;
    const struct orl_vec3 c = orl_v3(chord[0], chord[1], chord[2]);
    return orl_same_sheet(hunt->query->normal, hunt->normal, normal, chord) &&
           (distance2 >= hunt->flat2 || fabs(orl_dot(c, hunt->query->normal)) <= 4);
}

static bool in_footprint(const struct hunt *hunt, const float chord[3], float distance2)
{
    const double cell = hunt->cell;
    return !hunt->footprint || distance2 < hunt->inner * hunt->inner ||
           orl_footprint_holds(hunt->footprint,
                               orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell));
}

static void take_apart(struct hunt *hunt, uint32_t leaf)
{
    const struct orl_photon_map *map = hunt->sums->map;
    const uint32_t *a = map->places + (size_t)leaf * ORL_LEAF_WORDS, *b = a + ORL_MAP_LEAF;
    const uint32_t n = orl_leaf_photons(map, leaf);
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t index = leaf * ORL_MAP_LEAF + i;
        uint32_t cell[3];
        orl_place_unpack(a[i], b[i], cell);
        const float chord[3] = {(float)cell[0] - hunt->at[0], (float)cell[1] - hunt->at[1],
                                (float)cell[2] - hunt->at[2]};
        const float d2 = chord[0] * chord[0] + chord[1] * chord[1] + chord[2] * chord[2];
        if (!(d2 < hunt->radius2) || (hunt->query->at_photon && index == hunt->query->skip) ||
            !on_sheet(hunt, map->normals[index], chord, d2) || !in_footprint(hunt, chord, d2))
            continue;
        hunt->list[ROOM - 1 - hunt->photons++] = (struct orl_search_candidate){d2, index};
    }
}

static void take_leaf(struct hunt *hunt, uint32_t leaf)
{
    const struct orl_leaf_sum *sum = &hunt->sums->leaves[leaf];
    const float chord[3] = {sum->at[0] - hunt->at[0], sum->at[1] - hunt->at[1],
                            sum->at[2] - hunt->at[2]};
    const float d2 = chord[0] * chord[0] + chord[1] * chord[1] + chord[2] * chord[2];
    const float widest = 0.5F * (hunt->footprint ? widest_in_cut : widest_ramp) * hunt->radius;
    enum orl_side side = ORL_SIDE_WITHIN;
    if (!(sum->reach < INFINITY) || sum->ramp > widest ||
        (hunt->query->at_photon && hunt->query->skip / ORL_MAP_LEAF == leaf)) {
        take_apart(hunt, leaf);
        return;
    }
    if (d2 - 2 * hunt->radius * sum->ramp >= hunt->radius2 ||
        !on_sheet(hunt, sum->normal, chord, d2))
        return;
    if (hunt->footprint && !(sqrtf(d2) + sum->reach < hunt->inner)) {
        const double cell = hunt->cell;
        side = orl_footprint_side(hunt->footprint,
                                  orl_v3(chord[0] * cell, chord[1] * cell, chord[2] * cell),
                                  sum->reach * cell);
    }
    if (side == ORL_SIDE_BOTH)
        take_apart(hunt, leaf);
    else if (side == ORL_SIDE_WITHIN)
        hunt->list[hunt->leaves++] = (struct orl_search_candidate){d2, leaf};
}

/* In the order of the map: whatever comes first, all of it is looked at. */
static void find_all(struct hunt *hunt)
{
    const struct orl_photon_map *map = hunt->sums->map;
    struct {
        uint32_t level, node;
    } stack[ORL_BOX_STACK];
    uint32_t depth = 0;
    hunt->leaves = hunt->photons = 0;
    hunt->radius = sqrtf(hunt->radius2);
    hunt->full = false;
    stack[depth].level = map->header->levels - 1;
    stack[depth++].node = 0;
    while (depth > 0) {
        const uint32_t level = stack[--depth].level, node = stack[depth].node;
        const struct orl_map_group *group = &map->levels[level][node];
        float distance2[ORL_MAP_FANOUT];
        orl_box_distances(group, hunt->at, distance2);
        for (uint32_t c = 0; c < ORL_MAP_FANOUT && !hunt->full; c++) {
            if (!(distance2[c] < beyond2 * hunt->radius2) || !(group->facing[c] & hunt->facing))
                continue;
            if (level > 0) {
                stack[depth].level = level - 1;
                stack[depth++].node = node * ORL_MAP_FANOUT + c;
                continue;
            }
            take_leaf(hunt, node * ORL_MAP_FANOUT + c);
            hunt->full = hunt->leaves + hunt->photons + ORL_MAP_LEAF > ROOM;
        }
    }
}

static uint32_t count_within(const struct hunt *hunt)
{
    uint32_t count = hunt->photons;
    for (uint32_t i = 0; i < hunt->leaves; i++)
        if (hunt->list[i].distance2 < hunt->radius2)
            count += hunt->sums->leaves[hunt->list[i].index].count;
    return count;
}

/* The squared radius that holds k of what was found, which is more. */
static float radius2_of(const struct hunt *hunt, uint32_t k)
{
    uint32_t bins[BINS + 1] = {0}, sum = 0, bin = 0;
    const float scale = BINS / hunt->radius2;
    for (uint32_t i = 0; i < hunt->leaves; i++) {
        const float at = hunt->list[i].distance2 * scale;
        bins[at < BINS ? (uint32_t)at : BINS] += hunt->sums->leaves[hunt->list[i].index].count;
    }
    for (uint32_t i = 0; i < hunt->photons; i++)
        bins[(uint32_t)(hunt->list[ROOM - 1 - i].distance2 * scale)]++;
    while (bin + 1 < BINS && sum + bins[bin] < k)
        sum += bins[bin++];
    const float part = bins[bin] > 0 ? (float)(k - sum) / (float)bins[bin] : 1;
    return ((float)bin + (part < 1 ? part : 1)) / scale;
}

/*
 * Finds k within the radius allowed, or all. radius2: where to begin. What was found reaches not
 * much further than the radius returned, so that leaves are as narrow as they should be for it.
 */
static float find_enough(struct hunt *hunt, float radius2, float most2)
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
        const uint32_t count = count_within(hunt);
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
static float first_radius2(const struct hunt *hunt, const struct orl_zorder *order)
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
        const struct orl_leaf_sum *sum = &hunt->sums->leaves[i];
        near2[n++] = sum->ramp * sum->ramp / (float)sum->count;
    }
    qsort(near2, n, sizeof *near2, compare);
    return fmaxf((float)hunt->query->k * near2[n / 2], 4);
}

/* ---- Adding up ------------------------------------------------------------------------------- */

/* Fluxes and all, at a place of the tangent plane. */
struct mass {
    const float *flux, *luma;
    float squares, count, x, y;
};

static void add_mass(struct orl_ring *ring, const struct mass *m, float share, float by_moment)
{
    ring->squares += share * m->squares;
    ring->found += share * m->count;
    for (int c = 0; c < 3; c++)
        ring->flux[c] += share * m->flux[c];
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        ring->batch[i] += share * m->luma[i];
    if (!(by_moment > 0))
        return;
    const float x = by_moment * m->x, y = by_moment * m->y;
    for (int c = 0; c < 3; c++) {
        ring->by_x[c] += x * m->flux[c];
        ring->by_y[c] += y * m->flux[c];
    }
    for (int i = 0; i < ORL_MAP_BATCHES; i++) {
        ring->batch_by_x[i] += x * m->luma[i];
        ring->batch_by_y[i] += y * m->luma[i];
    }
}

/*
 * What share of a leaf lies within a radius, linear in the area; and for first moments, linear in
 * the third power: then sums over even light are those of the disc.
 */
struct share {
    float area, moment;
};

static float ramp_of(float off, float half)
{
    return off >= half ? 1 : off <= -half ? 0 : 0.5F + 0.5F * off / half;
}

static struct share share_within(float radius, float distance2, float ramp, bool cut)
{
    const float radius2 = radius * radius;
    struct share share = {ramp_of(radius2 - distance2, 2 * radius * ramp), 0};
    if (cut)
        share.moment = ramp_of(radius2 * radius - distance2 * sqrtf(distance2), 3 * radius2 * ramp);
    return share;
}

static void place(const struct hunt *hunt, const struct orl_frame *frame, const float at[3],
                  struct mass *mass)
{
    const struct orl_vec3 chord =
        orl_v3(at[0] - hunt->at[0], at[1] - hunt->at[1], at[2] - hunt->at[2]);
    mass->x = (float)(orl_dot(chord, frame->u) * hunt->cell);
    mass->y = (float)(orl_dot(chord, frame->v) * hunt->cell);
}

static void add_leaves(const struct hunt *hunt, const struct orl_frame *frame, float radius,
                       struct orl_ring rings[ORL_RINGS])
{
    static const float narrower = 0.70710678F;
    for (uint32_t n = 0; n < hunt->leaves; n++) {
        const float distance2 = hunt->list[n].distance2;
        const struct orl_leaf_sum *sum = &hunt->sums->leaves[hunt->list[n].index];
        struct mass mass = {sum->flux, sum->luma, sum->squares, sum->count, 0, 0};
        float disc = radius;
        struct share share = share_within(disc, distance2, sum->ramp, frame != NULL);
        if (frame && share.area > 0)
            place(hunt, frame, sum->at, &mass);
        for (int i = 0; i < ORL_RINGS && share.area > 0; i++) {
            struct share inside = {0, 0};
            disc *= narrower;
            if (i + 1 < ORL_RINGS)
                inside = share_within(disc, distance2, sum->ramp, frame != NULL);
            add_mass(&rings[i], &mass, share.area - inside.area, share.moment - inside.moment);
            share = inside;
        }
    }
}

static void add_photons(const struct hunt *hunt, const struct orl_frame *frame, float radius2,
                        struct orl_ring rings[ORL_RINGS])
{
    const struct orl_photon_map *map = hunt->sums->map;
    for (uint32_t n = 0; n < hunt->photons; n++) {
        const struct orl_search_candidate c = hunt->list[ROOM - 1 - n];
        if (!(c.distance2 < radius2))
            continue;
        const struct orl_rgb rgb = orl_flux_unpack(map->fluxes[c.index]);
        const float flux[3] = {(float)rgb.r, (float)rgb.g, (float)rgb.b};
        const float luma = (float)orl_luma(rgb);
        const uint32_t batch = orl_photon_batch(map, c.index);
        struct orl_ring *ring = &rings[c.distance2 >= radius2 / 2   ? 0
                                       : c.distance2 >= radius2 / 4 ? 1
                                                                    : 2];
        ring->squares += luma * luma;
        ring->found += 1;
        ring->batch[batch] += luma;
        for (int i = 0; i < 3; i++)
            ring->flux[i] += flux[i];
        if (!frame)
            continue;
        const uint32_t *leaf = map->places + (size_t)(c.index / ORL_MAP_LEAF) * ORL_LEAF_WORDS +
                               c.index % ORL_MAP_LEAF;
        uint32_t cell[3];
        struct mass mass;
        orl_place_unpack(leaf[0], leaf[ORL_MAP_LEAF], cell);
        place(hunt, frame, (const float[3]){(float)cell[0], (float)cell[1], (float)cell[2]}, &mass);
        ring->batch_by_x[batch] += luma * mass.x;
        ring->batch_by_y[batch] += luma * mass.y;
        for (int i = 0; i < 3; i++) {
            ring->by_x[i] += flux[i] * mass.x;
            ring->by_y[i] += flux[i] * mass.y;
        }
    }
}

static void add_up(const struct hunt *hunt, float radius2, struct orl_rings *rings)
{
    const struct orl_frame *frame = hunt->footprint ? &hunt->footprint->frame : NULL;
    rings->radius = fmax(sqrt((double)radius2), 1) * hunt->cell;
    rings->cut = hunt->footprint != NULL;
    memset(rings->rings, 0, sizeof rings->rings);
    add_leaves(hunt, frame, sqrtf(radius2), rings->rings);
    add_photons(hunt, frame, radius2, rings->rings);
    for (int i = 0; i < ORL_RINGS; i++) {
        const double radius = rings->radius * exp2(-0.5 * i);
        rings->discs[i] = hunt->footprint ? orl_footprint_moments(hunt->footprint, radius)
                                          : orl_disc_moments(radius);
        rings->found += (double)rings->rings[i].found;
    }
}

/* ---- The footprint --------------------------------------------------------------------------- */

/* Of the footprint: out to twice the disc that holds k, or as far as allowed. */
static float find_in_footprint(struct hunt *hunt, double disc, double least,
                               struct orl_footprint *footprint)
{
    const double most = hunt->query->max_radius;
    double reach = fmin(2 * disc, most);
    hunt->footprint = footprint;
    for (;;) {
        orl_footprint_make(hunt->query->footing, reach, footprint);
        hunt->inner = (float)(orl_footprint_inner(footprint) / hunt->cell);
        const float hint = (float)(1.05 * orl_footprint_even(footprint, disc) / hunt->cell);
        const float most2 = (float)(reach / hunt->cell * (reach / hunt->cell));
        const float radius2 = find_enough(hunt, hint * hint, most2);
        if (!(reach < most) || count_within(hunt) >= least)
            return radius2;
        reach = most;
    }
}

static struct hunt hunt_of(const struct orl_sums *sums, const struct orl_density_query *query,
                           struct orl_search *search)
{
    struct hunt hunt = {.sums = sums,
                        .query = query,
                        .list = search->candidates,
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

void orl_rings_gather(const struct orl_sums *sums, const struct orl_zorder *order,
                      const struct orl_density_query *query, double least,
                      struct orl_search *search, struct orl_rings *ret_rings)
{
    struct hunt hunt = hunt_of(sums, query, search);
    struct orl_footprint footprint;
    const double reach = query->max_radius / hunt.cell;
    *ret_rings = (struct orl_rings){.radius = query->max_radius};
    if (sums->count == 0)
        return;
    const float hint = (float)(query->hint / hunt.cell);
    float radius2 =
        find_enough(&hunt, hint > 0 ? first_beyond * hint * hint : first_radius2(&hunt, order),
                    (float)(reach * reach));
    const double disc = fmax(sqrt((double)radius2), 1) * hunt.cell;
    ret_rings->clear = ret_rings->disc = disc;
    if (query->footing && hunt.leaves + hunt.photons > 0 &&
        !orl_footing_is_free(query->footing, disc)) {
        radius2 = find_in_footprint(&hunt, disc, least, &footprint);
        ret_rings->clear = footprint.clear;
    }
    add_up(&hunt, radius2, ret_rings);
    ret_rings->clear = fmin(ret_rings->clear, ret_rings->radius);
}
