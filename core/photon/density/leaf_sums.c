#include "photon/density/nested_discs.h"

#include <stdlib.h>
#include <string.h>

#include "base/multiversion.h"
#include "photon/map/quantization.h"

enum { CHUNK = 1 << 12 };

/* Tolerance across a plane for positions rounded to cells. */
static const float flat_within = 3;
/* A leaf is split if that reduces its photons' spread to this share: two adjacent places, each
 * as wide as uniformly distributed photons, have a quarter of it. */
static const float split_threshold = 0.25F;

static const float far_away = 1e9F;

/* A leaf's photons, and prefix sums over them, relative to the first photon. */
struct leaf_photons {
    uint32_t n;
    float at[ORL_MAP_LEAF][3];
    const uint16_t *normals;
    float sums[ORL_MAP_LEAF + 1][4]; /* positions, and squared distances */
};

static void read_leaf_photons(const struct orl_photon_map *map, uint64_t leaf,
                              struct leaf_photons *leaf_photons)
{
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    uint32_t first[3], cell[3];
    leaf_photons->n = orl_leaf_photons(map, leaf);
    leaf_photons->normals = map->normals + leaf * ORL_MAP_LEAF;
    orl_position_unpack(words[0], words[ORL_MAP_LEAF], first);
    memset(leaf_photons->sums[0], 0, sizeof leaf_photons->sums[0]);
    for (uint32_t i = 0; i < leaf_photons->n; i++) {
        float *sum = leaf_photons->sums[i + 1], square = 0;
        orl_position_unpack(words[i], words[i + ORL_MAP_LEAF], cell);
        for (int k = 0; k < 3; k++) {
            const float off = (float)cell[k] - (float)first[k];
            leaf_photons->at[i][k] = (float)cell[k];
            sum[k] = leaf_photons->sums[i][k] + off;
            square += off * off;
        }
        sum[3] = leaf_photons->sums[i][3] + square;
    }
}

/* Returns the sum of squared distances from their centre for photons `from` to before `to`. */
static float spread_of(const struct leaf_photons *leaf_photons, uint32_t from, uint32_t to)
{
    const float *a = leaf_photons->sums[from], *b = leaf_photons->sums[to];
    const float x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return fmaxf(b[3] - a[3] - (x * x + y * y + z * z) / (float)(to - from), 0);
}

/* Returns the number of successive photons on the plane of photon `from`, counted from it in
 * steps. */
static uint32_t count_on_plane(const struct leaf_photons *leaf_photons, uint32_t from, int step)
{
    const struct orl_vec3 normal = orl_normal_decode(leaf_photons->normals[from]);
    const float nx = (float)normal.x, ny = (float)normal.y, nz = (float)normal.z;
    uint32_t count = 0;
    for (uint32_t i = from; i < leaf_photons->n; i += (uint32_t)step, count++) {
        const float x = leaf_photons->at[i][0] - leaf_photons->at[from][0],
                    y = leaf_photons->at[i][1] - leaf_photons->at[from][1],
                    z = leaf_photons->at[i][2] - leaf_photons->at[from][2];
        if (leaf_photons->normals[i] != leaf_photons->normals[from] ||
            fabsf(x * nx + y * ny + z * nz) > flat_within)
            break;
    }
    return count;
}

/* Returns the photon after the widest gap between successive photons, with at most `before`
 * photons before it and at most `after` from it on; n if there is none. */
static uint32_t find_widest_gap(const struct leaf_photons *leaf_photons, uint32_t before,
                                uint32_t after)
{
    const uint32_t n = leaf_photons->n;
    uint32_t best = n;
    float widest = 0;
    for (uint32_t i = n > after ? n - after : 1; i < n && i <= before; i++) {
        const float x = leaf_photons->at[i][0] - leaf_photons->at[i - 1][0],
                    y = leaf_photons->at[i][1] - leaf_photons->at[i - 1][1],
                    z = leaf_photons->at[i][2] - leaf_photons->at[i - 1][2],
                    d2 = x * x + y * y + z * z;
        if (d2 > widest) {
            widest = d2;
            best = i;
        }
    }
    return best;
}

/* Returns the first photon of the leaf's second patch; n if the leaf is one patch. */
static uint32_t find_second_patch(const struct leaf_photons *leaf_photons, bool *ret_flat)
{
    const uint32_t n = leaf_photons->n, before = count_on_plane(leaf_photons, 0, 1);
    const uint32_t after = before < n ? count_on_plane(leaf_photons, n - 1, -1) : n;
    const uint32_t part = find_widest_gap(leaf_photons, before, after);
    *ret_flat = before == n;
    if (part == n ||
        (before == n && !(spread_of(leaf_photons, 0, part) + spread_of(leaf_photons, part, n) <
                          split_threshold * spread_of(leaf_photons, 0, n))))
        return n;
    *ret_flat = true;
    return part;
}

static void place_patch(const struct leaf_photons *leaf_photons, uint32_t from, uint32_t to,
                        bool flat, struct orl_patch_group *group, uint32_t lane)
{
    const float n = (float)(to - from);
    float at[3], most2 = 0;
    for (int k = 0; k < 3; k++)
        group->at[k][lane] = at[k] =
            leaf_photons->at[0][k] + (leaf_photons->sums[to][k] - leaf_photons->sums[from][k]) / n;
    for (uint32_t i = from; i < to; i++) {
        const float x = leaf_photons->at[i][0] - at[0], y = leaf_photons->at[i][1] - at[1],
                    z = leaf_photons->at[i][2] - at[2];
        most2 = fmaxf(most2, x * x + y * y + z * z);
    }
    group->reach[lane] = sqrtf(most2);
    group->ramp[lane] = sqrtf(1.5F * spread_of(leaf_photons, from, to) / n);
    group->normal[lane] = flat ? leaf_photons->normals[from] : ORL_NO_PLANE;
    group->count[lane] = to - from;
}

static void clear_patch(struct orl_patch_group *group, uint32_t lane)
{
    for (int k = 0; k < 3; k++)
        group->at[k][lane] = far_away;
    group->normal[lane] = ORL_NO_PLANE;
}

/* Fluxes of a leaf's photons. */
struct fluxes {
    float red[ORL_MAP_LEAF], green[ORL_MAP_LEAF], blue[ORL_MAP_LEAF], luma[ORL_MAP_LEAF];
};

ORL_FOR_WIDE_VECTORS static void read_fluxes(const struct orl_photon_map *map, uint64_t leaf,
                                             uint32_t n, struct fluxes *restrict fluxes)
{
    uint32_t codes[ORL_MAP_LEAF] = {0};
    memcpy(codes, map->fluxes + leaf * ORL_MAP_LEAF, n * sizeof *codes);
    for (int i = 0; i < ORL_MAP_LEAF; i++) {
        const struct orl_rgb flux = orl_flux_unpack(codes[i]);
        fluxes->red[i] = (float)flux.r;
        fluxes->green[i] = (float)flux.g;
        fluxes->blue[i] = (float)flux.b;
        fluxes->luma[i] = (float)orl_luma(flux);
    }
}

static void add_fluxes(const struct fluxes *fluxes, const uint32_t *words, uint32_t from,
                       uint32_t to, float flux_sums[ORL_FLUX_SUMS])
{
    float red = 0, green = 0, blue = 0, squares = 0;
    for (uint32_t i = from; i < to; i++) {
        flux_sums[words[i] >> 20 & (ORL_MAP_BATCHES - 1)] += fluxes->luma[i];
        red += fluxes->red[i];
        green += fluxes->green[i];
        blue += fluxes->blue[i];
        squares += fluxes->luma[i] * fluxes->luma[i];
    }
    flux_sums[ORL_FLUX_SUMS_RGB] = red;
    flux_sums[ORL_FLUX_SUMS_RGB + 1] = green;
    flux_sums[ORL_FLUX_SUMS_RGB + 2] = blue;
    flux_sums[ORL_FLUX_SUMS_SQUARES] = squares;
    flux_sums[ORL_FLUX_SUMS_COUNT] = (float)(to - from);
}

static void sum_leaf(const struct orl_leaf_sums *sums, uint64_t leaf)
{
    struct orl_patch_group *group = &sums->groups[leaf / ORL_MAP_FANOUT];
    const uint32_t lane = leaf % ORL_MAP_FANOUT;
    const uint32_t *words = sums->map->places + leaf * ORL_LEAF_WORDS;
    struct fluxes fluxes;
    struct leaf_photons leaf_photons = {.n = 0};
    bool flat;
    read_leaf_photons(sums->map, leaf, &leaf_photons);
    read_fluxes(sums->map, leaf, leaf_photons.n, &fluxes);
    const uint32_t part = find_second_patch(&leaf_photons, &flat);
    place_patch(&leaf_photons, 0, part, flat, group, lane);
    add_fluxes(&fluxes, words, 0, part, sums->patch_sums[ORL_PATCHES * leaf]);
    if (part == leaf_photons.n) {
        clear_patch(group, lane + ORL_MAP_FANOUT);
        return;
    }
    place_patch(&leaf_photons, part, leaf_photons.n, flat, group, lane + ORL_MAP_FANOUT);
    add_fluxes(&fluxes, words, part, leaf_photons.n, sums->patch_sums[ORL_PATCHES * leaf + 1]);
}

static void clear_absent_patches(const struct orl_leaf_sums *sums)
{
    for (uint64_t i = sums->count; i % ORL_MAP_FANOUT != 0; i++)
        for (uint32_t lane = i % ORL_MAP_FANOUT; lane < ORL_LANES; lane += ORL_MAP_FANOUT)
            clear_patch(&sums->groups[i / ORL_MAP_FANOUT], lane);
}

static void sum_chunk(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_leaf_sums *sums = arg;
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < sums->count; i++) {
        sum_leaf(sums, i);
    }
}

int orl_leaf_sums_init(struct orl_leaf_sums *sums, const struct orl_photon_map *map,
                       struct orl_thread_pool *pool)
{
    const uint64_t count = (map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    *sums = (struct orl_leaf_sums){.map = map, .count = count};
    sums->groups = calloc(count / ORL_MAP_FANOUT + 1, sizeof *sums->groups);
    sums->patch_sums = calloc(ORL_PATCHES * (count + 1), sizeof *sums->patch_sums);
    if (!sums->groups || !sums->patch_sums) {
        orl_leaf_sums_done(sums);
        return ORL_ERR_NOMEM;
    }
    clear_absent_patches(sums);
    const int code = orl_parallel_try(pool, (count + CHUNK - 1) / CHUNK, sum_chunk, sums);
    if (code < 0)
        orl_leaf_sums_done(sums);
    return code;
}

uint64_t orl_leaf_sums_bytes(const struct orl_leaf_sums *sums)
{
    return (sums->count / ORL_MAP_FANOUT + 1) * sizeof *sums->groups +
           ORL_PATCHES * (sums->count + 1) * sizeof *sums->patch_sums;
}

void orl_leaf_sums_done(struct orl_leaf_sums *sums)
{
    free(sums->groups);
    free(sums->patch_sums);
    *sums = (struct orl_leaf_sums){.count = 0};
}
