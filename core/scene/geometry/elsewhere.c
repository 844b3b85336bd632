/* Accessors for facets that are packed or instanced. */
#include "scene/geometry/packed.h"
#include "scene/geometry/placed.h"

uint32_t orl_facet_surface_elsewhere(const struct orl_geometry *geometry, size_t facet)
{
    if (!orl_facet_is_placed(geometry, facet))
        return orl_facet_surface_unpacked(geometry, facet);
    const struct orl_placed *const placed = orl_placed_of(geometry, (uint32_t)facet);
    return orl_facet_surface(placed->prototype, facet - placed->first_facet);
}

const struct orl_facet *orl_facet_of_elsewhere(const struct orl_geometry *geometry, size_t facet,
                                               struct orl_facet *room)
{
    if (!orl_facet_is_placed(geometry, facet))
        return orl_facet_unpacked(geometry, facet, room);
    const struct orl_placed *const placed = orl_placed_of(geometry, (uint32_t)facet);
    return orl_facet_own(placed->prototype, facet - placed->first_facet, room);
}

enum orl_surface_kind orl_facet_kind_elsewhere(const struct orl_geometry *geometry, size_t facet)
{
    if (orl_facet_is_placed(geometry, facet)) {
        const struct orl_placed *const placed = orl_placed_of(geometry, (uint32_t)facet);
        return orl_facet_kind(placed->prototype, facet - placed->first_facet);
    }
    return geometry->packed->facets[facet].kind;
}

uint32_t orl_facet_material_elsewhere(const struct orl_geometry *geometry, size_t facet)
{
    if (orl_facet_is_placed(geometry, facet)) {
        const struct orl_placed *const placed = orl_placed_of(geometry, (uint32_t)facet);
        return orl_facet_material(placed->prototype, facet - placed->first_facet);
    }
    return geometry->packed->facets[facet].material;
}

double orl_facet_clear_elsewhere(const struct orl_geometry *geometry, uint32_t facet, double side)
{
    const bool placed = orl_facet_is_placed(geometry, facet);
    const double beyond = placed || !geometry->packed->facets[facet].stands_off
                              ? 0
                              : orl_facet_more_of(geometry, facet)->beyond;
    return orl_facet_offset_elsewhere(geometry, facet) + (beyond * side < 0 ? fabs(beyond) : 0);
}

double orl_facet_offset_elsewhere(const struct orl_geometry *geometry, size_t facet)
{
    return orl_facet_is_placed(geometry, facet)
               ? orl_placed_of(geometry, (uint32_t)facet)->offset
               : orl_packed_offset(&geometry->packed->facets[facet]);
}
