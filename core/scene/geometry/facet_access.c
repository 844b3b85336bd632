/* Accessors for facets that are packed or instanced. */
#include "scene/geometry/instances.h"
#include "scene/geometry/packed.h"

uint32_t orl_facet_surface_slow(const struct orl_geometry *geometry, size_t facet)
{
    if (!orl_facet_is_instanced(geometry, facet))
        return orl_facet_surface_packed(geometry, facet);
    const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
    return orl_facet_surface(instance->prototype, facet - instance->first_facet);
}

const struct orl_facet *orl_facet_get_slow(const struct orl_geometry *geometry, size_t facet,
                                           struct orl_facet *room)
{
    if (!orl_facet_is_instanced(geometry, facet))
        return orl_facet_get_packed(geometry, facet, room);
    const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
    return orl_facet_get_own(instance->prototype, facet - instance->first_facet, room);
}

enum orl_surface_kind orl_facet_kind_slow(const struct orl_geometry *geometry, size_t facet)
{
    if (orl_facet_is_instanced(geometry, facet)) {
        const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
        return orl_facet_kind(instance->prototype, facet - instance->first_facet);
    }
    return geometry->packed->facets[facet].kind;
}

uint32_t orl_facet_material_slow(const struct orl_geometry *geometry, size_t facet)
{
    if (orl_facet_is_instanced(geometry, facet)) {
        const struct orl_instance *const instance = orl_instance_of(geometry, (uint32_t)facet);
        return orl_facet_material(instance->prototype, facet - instance->first_facet);
    }
    return geometry->packed->facets[facet].material;
}

double orl_facet_clearance_slow(const struct orl_geometry *geometry, uint32_t facet, double side)
{
    const bool instance = orl_facet_is_instanced(geometry, facet);
    const double proxy_offset = instance || !geometry->packed->facets[facet].has_proxy_offset
                                    ? 0
                                    : orl_facet_extra_of(geometry, facet)->proxy_offset;
    return orl_facet_offset_slow(geometry, facet) +
           (proxy_offset * side < 0 ? fabs(proxy_offset) : 0);
}

double orl_facet_offset_slow(const struct orl_geometry *geometry, size_t facet)
{
    return orl_facet_is_instanced(geometry, facet)
               ? orl_instance_of(geometry, (uint32_t)facet)->offset
               : orl_packed_offset(&geometry->packed->facets[facet]);
}
