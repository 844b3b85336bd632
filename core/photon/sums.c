#include "photon/sums.h"

#include <stdlib.h>

#include "photon/flux.h"

enum { CHUNK = 1 << 12 };

/* Of rounding to cells, across a plane. */
static const double flat_within = 3;

static void place_photons(const struct orl_sums *sums, uint64_t leaf)
{
    const struct orl_photon_map *map = sums->map;
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    const uint32_t count = orl_leaf_photons(map, leaf), lane = leaf % ORL_MAP_FANOUT;
    const uint16_t *normals = map->normals + leaf * ORL_MAP_LEAF;
    const struct orl_vec3 normal = orl_normal_decode(normals[0]);
    struct orl_leaf_group *group = &sums->groups[leaf / ORL_MAP_FANOUT];
    float at[ORL_MAP_LEAF][3], mean[3] = {0}, mean2 = 0, most2 = 0;
    bool flat = true;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t cell[3];
        orl_place_unpack(words[i], words[i + ORL_MAP_LEAF], cell);
        for (int k = 0; k < 3; k++) {
            at[i][k] = (float)cell[k];
            mean[k] += at[i][k] / (float)count;
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        const float x = at[i][0] - mean[0], y = at[i][1] - mean[1], z = at[i][2] - mean[2];
        const float d2 = x * x + y * y + z * z;
        mean2 += d2 / (float)count;
        most2 = d2 > most2 ? d2 : most2;
        flat = flat && normals[i] == normals[0] &&
               fabs(x * normal.x + y * normal.y + z * normal.z) <= flat_within;
    }
    for (int k = 0; k < 3; k++)
        group->at[k][lane] = mean[k];
    group->reach[lane] = sqrtf(most2);
    group->ramp[lane] = sqrtf(1.5F * mean2);
    group->normal[lane] = flat ? normals[0] : ORL_NO_PLANE;
}

static void add_fluxes(const struct orl_photon_map *map, uint64_t leaf, float *mass)
{
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    const uint32_t count = orl_leaf_photons(map, leaf);
    for (uint32_t i = 0; i < count; i++) {
        const struct orl_rgb flux = orl_flux_unpack(map->fluxes[leaf * ORL_MAP_LEAF + i]);
        const float luma = (float)orl_luma(flux);
        mass[words[i] >> 20 & (ORL_MAP_BATCHES - 1)] += luma;
        mass[ORL_MASS_FLUX] += (float)flux.r;
        mass[ORL_MASS_FLUX + 1] += (float)flux.g;
        mass[ORL_MASS_FLUX + 2] += (float)flux.b;
        mass[ORL_MASS_SQUARES] += luma * luma;
    }
    mass[ORL_MASS_COUNT] = (float)count;
}

static void sum_chunk(void *arg, size_t chunk, uint32_t member)
{
    const struct orl_sums *sums = arg;
    (void)member;
    for (uint64_t i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < sums->count; i++) {
        place_photons(sums, i);
        add_fluxes(sums->map, i, sums->masses[i]);
    }
}

int orl_sums_init(struct orl_sums *sums, const struct orl_photon_map *map, struct orl_crew *crew)
{
    const uint64_t count = (map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    *sums = (struct orl_sums){.map = map, .count = count};
    sums->groups = calloc(count / ORL_MAP_FANOUT + 1, sizeof *sums->groups);
    sums->masses = calloc(count + 1, sizeof *sums->masses);
    if (!sums->groups || !sums->masses) {
        orl_sums_done(sums);
        return ORL_ERR_NOMEM;
    }
    orl_crew_for(crew, (count + CHUNK - 1) / CHUNK, sum_chunk, sums);
    return 0;
}

uint64_t orl_sums_bytes(const struct orl_sums *sums)
{
    return (sums->count / ORL_MAP_FANOUT + 1) * sizeof *sums->groups +
           (sums->count + 1) * sizeof *sums->masses;
}

void orl_sums_done(struct orl_sums *sums)
{
    free(sums->groups);
    free(sums->masses);
    *sums = (struct orl_sums){.count = 0};
}
