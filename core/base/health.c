#include <oriel/base/health.h>

void orl_health_add(struct orl_health *sum, const struct orl_health *part)
{
    const struct orl_vec3 first = sum->leak_towards;
    sum->non_finite += part->non_finite;
    sum->bsdf_clamped += part->bsdf_clamped;
    sum->bsdf_rescaled += part->bsdf_rescaled;
    sum->degenerate += part->degenerate;
    sum->photons_capped += part->photons_capped;
    sum->paths_capped += part->paths_capped;
    sum->rays_leaked += part->rays_leaked;
    sum->sparse += part->sparse;
    sum->bsdf_values += part->bsdf_values;
    sum->surfaces += part->surfaces;
    sum->instances += part->instances;
    sum->photons += part->photons;
    sum->paths += part->paths;
    sum->rays += part->rays;
    sum->estimates += part->estimates;
    sum->flux_w += part->flux_w;
    sum->flux_capped_w += part->flux_capped_w;
    if (first.x == 0 && first.y == 0 && first.z == 0) {
        sum->leak_from = part->leak_from;
        sum->leak_towards = part->leak_towards;
    }
}
