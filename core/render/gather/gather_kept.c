/* Results that a final gather has computed from scene and maps, kept from one job to the next. */
#include "render/gather/gather.h"

uint64_t orl_gather_pause(struct orl_gather *gather)
{
    uint64_t bytes = sizeof *gather + gather->bright.count * sizeof *gather->bright.spots;
    gather->world = NULL;
    gather->cancel = NULL;
    gather->aim = NULL;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        gather->maps[kind] = NULL;
    if (gather->leaves) {
        orl_leaves_rebind(gather->leaves, NULL, NULL);
        bytes += orl_leaves_bytes(gather->leaves);
    }
    if (gather->caustic_widths) {
        bytes += orl_kernel_density_bytes(gather->caustic_widths);
        orl_kernel_density_rebind(gather->caustic_widths, NULL);
    }
    if (gather->texels)
        bytes += orl_texels_bytes(gather->texels);
    gather->adapt.sums.map = NULL;
    bytes +=
        orl_leaf_sums_bytes(&gather->adapt.sums) + gather->adapt.sums.count * 2 * sizeof(uint64_t);
    return bytes;
}

void orl_gather_resume(struct orl_gather *gather, const struct orl_world *world,
                       const struct orl_photon_map *const maps[ORL_MAP_KINDS], uint64_t seed)
{
    const int unread = gather->rest == ORL_REST_RECORDS ? ORL_MAP_GLOBAL : ORL_MAP_PRECOMPUTED;
    gather->world = world;
    gather->seed = seed;
    for (int kind = 0; kind < ORL_MAP_KINDS; kind++)
        gather->maps[kind] = kind == unread ? NULL : maps[kind];
    if (gather->leaves)
        orl_leaves_rebind(gather->leaves, gather->maps[ORL_MAP_GLOBAL], world);
    if (gather->caustic_widths)
        orl_kernel_density_rebind(gather->caustic_widths, gather->maps[ORL_MAP_CAUSTIC]);
    if (gather->texels)
        orl_texels_rebind(gather->texels, world);
    gather->adapt.sums.map = gather->maps[ORL_MAP_GLOBAL];
}
