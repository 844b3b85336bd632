#include "photon/sums.h"

#include <stdlib.h>

#include "photon/flux.h"

enum { CHUNK = 1 << 12 };

/* Of rounding to cells, across a plane. */
static const double flat_within = 3;

static void place_photons(const struct orl_photon_map *map, uint64_t leaf, struct orl_leaf_sum *sum)
{
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    const uint16_t *normals = map->normals + leaf * ORL_MAP_LEAF;
    const struct orl_vec3 normal = orl_normal_decode(normals[0]);
    float at[ORL_MAP_LEAF][3], mean2 = 0, most2 = 0;
    bool flat = true;
    for (uint32_t i = 0; i < sum->count; i++) {
        uint32_t cell[3];
        orl_place_unpack(words[i], words[i + ORL_MAP_LEAF], cell);
        for (int k = 0; k < 3; k++) {
            at[i][k] = (float)cell[k];
            sum->at[k] += at[i][k] / (float)sum->count;
        }
    }
    for (uint32_t i = 0; i < sum->count; i++) {
        const float x = at[i][0] - sum->at[0], y = at[i][1] - sum->at[1], z = at[i][2] - sum->at[2];
        const float d2 = x * x + y * y + z * z;
        mean2 += d2 / (float)sum->count;
        most2 = d2 > most2 ? d2 : most2;
        flat = flat && normals[i] == normals[0] &&
               fabs(x * normal.x + y * normal.y + z * normal.z) <= flat_within;
    }
    sum->normal = normals[0];
    sum->ramp = sqrtf(1.5F * mean2);
    sum->reach = flat ? sqrtf(most2) : INFINITY;
}

static void add_fluxes(const struct orl_photon_map *map, uint64_t leaf, struct orl_leaf_sum *sum)
{
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    for (uint32_t i = 0; i < sum->count; i++) {
        const struct orl_rgb flux = orl_flux_unpack(map->fluxes[leaf * ORL_MAP_LEAF + i]);
        const float luma = (float)orl_luma(flux);
        sum->flux[0] += (float)flux.r;
        sum->flux[1] += (float)flux.g;
        sum->flux[2] += (float)flux.b;
        sum->squares += luma * luma;
        sum->luma[words[i] >> 20 & (ORL_MAP_BATCHES - 1)] += luma;
    }
}

static void sum_chunk(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_sums *sums = arg;
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < sums->count; i++) {
        sums->leaves[i].count = (uint16_t)orl_leaf_photons(sums->map, i);
        place_photons(sums->map, i, &sums->leaves[i]);
        add_fluxes(sums->map, i, &sums->leaves[i]);
    }
}

int orl_sums_init(struct orl_sums *sums, const struct orl_photon_map *map, struct orl_crew *crew)
{
    const uint64_t count = (map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    *sums = (struct orl_sums){.map = map, .count = count};
    sums->leaves = calloc(count + 1, sizeof *sums->leaves);
    if (!sums->leaves)
        return ORL_ERR_NOMEM;
    orl_crew_for(crew, (count + CHUNK - 1) / CHUNK, sum_chunk, sums);
    return 0;
}

void orl_sums_done(struct orl_sums *sums)
{
    free(sums->leaves);
    *sums = (struct orl_sums){.count = 0};
}
