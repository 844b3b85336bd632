#include "photon/tracing/deposits.h"

#include <stdlib.h>

#include "photon/map/normal_code.h"

bool orl_deposits_reserve(struct orl_deposits *deposits, size_t more)
{
    if (more <= deposits->capacity - deposits->count)
        return true;
    size_t capacity = deposits->capacity ? 2 * deposits->capacity : 4096;
    while (capacity - deposits->count < more)
        capacity *= 2;
    struct orl_photon *grown = realloc(deposits->photons, capacity * sizeof *deposits->photons);
    if (!grown) {
        deposits->out_of_memory = true;
        return false;
    }
    deposits->photons = grown;
    deposits->capacity = capacity;
    return true;
}

void orl_deposit(struct orl_deposits *deposits, const struct orl_hit *hit, struct orl_rgb flux,
                 uint8_t batch, enum orl_photon_class class)
{
    const struct orl_vec3 p = hit->point;
    const float sum = (float)flux.r + (float)flux.g + (float)flux.b + (float)(p.x + p.y + p.z);
    if (!isfinite(sum)) {
        deposits->health.non_finite++;
        return;
    }
    if (!orl_deposits_reserve(deposits, 1))
        return;
    const struct orl_vec3 lit = orl_hit_facing(hit);
    deposits->photons[deposits->count++] =
        (struct orl_photon){.position = {(float)p.x, (float)p.y, (float)p.z},
                            .flux = {(float)flux.r, (float)flux.g, (float)flux.b},
                            .normal = orl_normal_encode(lit),
                            .batch = batch,
                            .tag = (uint8_t) class,
                            .facet = hit->facet};
}

void orl_deposits_count_capped(struct orl_deposits *deposits, struct orl_rgb flux)
{
    deposits->health.photons_capped++;
    orl_sum_add(&deposits->flux_capped, orl_luma(flux));
}

struct orl_health orl_deposits_health(const struct orl_deposits *deposits)
{
    struct orl_health health = deposits->health;
    health.flux_w = orl_sum_value(&deposits->flux);
    health.flux_capped_w = orl_sum_value(&deposits->flux_capped);
    return health;
}
