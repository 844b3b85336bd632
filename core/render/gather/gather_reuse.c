/* Results that a final gather has computed from scene and maps, kept from one job to the next. */
#include "render/gather/gather.h"

uint64_t orl_gather_detach(struct orl_gather *gather)
{
    uint64_t bytes = sizeof *gather + gather->guide.count * sizeof *gather->guide.patches;
    gather->lit_scene = NULL;
    gather->cancel = NULL;
    gather->sampler = NULL;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        gather->maps[kind] = NULL;
    if (gather->leaf_irradiance) {
        orl_leaf_irradiance_rebind(gather->leaf_irradiance, NULL, NULL);
        bytes += orl_leaf_irradiance_bytes(gather->leaf_irradiance);
    }
    if (gather->caustic_kernels) {
        bytes += orl_kernel_density_bytes(gather->caustic_kernels);
        orl_kernel_density_rebind(gather->caustic_kernels, NULL);
    }
    if (gather->texels)
        bytes += orl_texels_bytes(gather->texels);
    gather->adaptive.sums.map = NULL;
    bytes += orl_leaf_sums_bytes(&gather->adaptive.sums) +
             gather->adaptive.sums.count * 2 * sizeof(uint64_t);
    return bytes;
}

void orl_gather_attach(struct orl_gather *gather, const struct orl_lit_scene *lit_scene,
                       const struct orl_photon_map *const maps[ORL_MAP_KINDS], uint64_t seed)
{
    const int unread =
        gather->indirect == ORL_INDIRECT_PRECOMPUTED ? ORL_MAP_GLOBAL : ORL_MAP_PRECOMPUTED;
    gather->lit_scene = lit_scene;
    gather->seed = seed;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        gather->maps[kind] = kind == unread ? NULL : maps[kind];
    if (gather->leaf_irradiance)
        orl_leaf_irradiance_rebind(gather->leaf_irradiance, gather->maps[ORL_MAP_GLOBAL],
                                   lit_scene);
    if (gather->caustic_kernels)
        orl_kernel_density_rebind(gather->caustic_kernels, gather->maps[ORL_MAP_CAUSTIC]);
    if (gather->texels)
        orl_texels_rebind(gather->texels, lit_scene);
    gather->adaptive.sums.map = gather->maps[ORL_MAP_GLOBAL];
}
