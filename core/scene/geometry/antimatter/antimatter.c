#include "scene/geometry/antimatter/antimatter.h"

#include "scene/geometry/intersect.h"

/* ---- Inside and outside ---------------------------------------------------------------------- */

const struct orl_vec3 orl_hole_skew = {0.2672612419124244, 0.5345224838248488, 0.8017837257372732};

int orl_hole_winding_number(const struct orl_geometry *shell, struct orl_vec3 point,
                            struct orl_vec3 direction)
{
    const size_t most = 2 * shell->n_facets + 2 * orl_geometry_triangles_end(shell);
    struct orl_hit hit;
    int out = 0;
    for (size_t i = 0; i < most && orl_intersect_uncut(shell, point, direction, INFINITY, &hit);
         i++) {
        out += hit.front ? -1 : 1;
        point = orl_hit_ray_origin(shell, &hit, direction);
    }
    return out;
}

bool orl_hole_is_inside(const struct orl_hole *hole, struct orl_vec3 point)
{
    const struct orl_geometry *const s = hole->shell;
    return point.x > s->low.x && point.x < s->high.x && point.y > s->low.y && point.y < s->high.y &&
           point.z > s->low.z && point.z < s->high.z &&
           orl_hole_winding_number(s, point, orl_hole_skew) > 0;
}

static bool is_cut(const struct orl_holes *holes, const struct orl_geometry *geometry,
                   uint32_t material, const struct orl_hit *hit, const struct orl_hole *but)
{
    const struct orl_vec3 above = orl_hit_ray_origin(geometry, hit, hit->normal);
    const struct orl_vec3 below = orl_hit_ray_origin(geometry, hit, orl_neg(hit->normal));
    for (size_t i = 0; i < holes->n; i++) {
        const struct orl_hole *const hole = &holes->items[i];
        if (hole != but && hole->cuts[material] &&
            (orl_hole_is_inside(hole, above) || orl_hole_is_inside(hole, below)))
            return true;
    }
    return false;
}

bool orl_hole_is_lining(const struct orl_geometry *geometry, const struct orl_hole *hole,
                        const struct orl_hit *hit)
{
    const struct orl_vec3 behind = orl_hit_ray_origin(geometry, hit, hit->normal);
    struct orl_hit next;
    if (!orl_intersect_uncut(hole->matter, behind, hit->normal, INFINITY, &next) || next.front)
        return false;
    return !is_cut(geometry->holes, geometry, orl_facet_material(geometry, next.facet), hit, hole);
}

bool orl_holes_hit_remains(const struct orl_geometry *geometry, const struct orl_hit *hit)
{
    const struct orl_holes *const holes = geometry->holes;
    const int32_t own = holes->of_facet[hit->facet];
    if (own == ORL_HOLE_UNTOUCHED)
        return true;
    if (own == ORL_HOLE_NONE)
        return !is_cut(geometry->holes, geometry, orl_facet_material(geometry, hit->facet), hit,
                       NULL);
    const struct orl_hole *const hole = &holes->items[own];
    return hole->has_lining && !hit->front && orl_hole_is_lining(geometry, hole, hit);
}

bool orl_geometry_is_cut(const struct orl_geometry *geometry, uint32_t facet)
{
    return geometry->holes && geometry->holes->of_facet[facet] != ORL_HOLE_UNTOUCHED;
}
