#include "bsdf/make/panel/unit_cell.h"

#include "scene/geometry/instances.h"

enum { MOST_SIDES = 1 << 16, MARGIN = 4 };

struct orl_gonio_unit_cell orl_gonio_unit_cell_around(const struct orl_geometry *geometry,
                                                      const double sides[4])
{
    double offset = 0;
    for (size_t i = 0; i < geometry->n_facets; i++)
        offset = fmax(offset, orl_facet_offset(geometry, i));
    for (size_t i = 0; i < geometry->n_instances; i++)
        offset = fmax(offset, geometry->instance[i].offset);
    const double m = MARGIN * offset;
    return (struct orl_gonio_unit_cell){
        .low = {sides[0] - m, sides[2] - m, geometry->low.z - m},
        .high = {sides[1] + m, sides[3] + m, geometry->high.z + m},
        .margin = m,
    };
}

struct orl_vec3 orl_gonio_unit_cell_entry(const struct orl_gonio_unit_cell *cell, bool front,
                                          const double u[2])
{
    const double width = cell->high.x - cell->low.x - 2 * cell->margin;
    const double height = cell->high.y - cell->low.y - 2 * cell->margin;
    return orl_v3(cell->low.x + cell->margin + u[0] * width,
                  cell->low.y + cell->margin + u[1] * height, front ? cell->high.z : cell->low.z);
}

/* Returns the distance to the side that faces the ray; 0 if the ray is beyond it. */
static double distance_to_side(double from, double along, double low, double high)
{
    if (along == 0)
        return INFINITY;
    const double distance = ((along > 0 ? high : low) - from) / along;
    return distance > 0 ? distance : 0;
}

enum orl_gonio_crossing orl_gonio_unit_cell_intersect(const struct orl_gonio_unit_cell *cell,
                                                      const struct orl_lit_scene *lit_scene,
                                                      struct orl_path *path,
                                                      struct orl_hit *ret_hit)
{
    const struct orl_vec3 d = path->direction;
    struct orl_vec3 *const o = &path->origin;
    double travelled = 0;
    for (int sides = 0; sides < MOST_SIDES; sides++) {
        const double x = distance_to_side(o->x, d.x, cell->low.x, cell->high.x);
        const double y = distance_to_side(o->y, d.y, cell->low.y, cell->high.y);
        const double z = distance_to_side(o->z, d.z, cell->low.z, cell->high.z);
        const double distance = fmin(x, fmin(y, z));
        if (distance > 0 && orl_geometry_intersect(lit_scene->geometry, *o, d, distance, ret_hit)) {
            ret_hit->distance += travelled;
            return ORL_GONIO_HIT_SURFACE;
        }
        if (distance == z)
            return d.z > 0 ? ORL_GONIO_LEFT_FRONT : ORL_GONIO_LEFT_BACK;
        *o = orl_madd(*o, d, distance);
        travelled += distance;
        if (distance == x)
            o->x = d.x > 0 ? cell->low.x : cell->high.x;
        else
            o->y = d.y > 0 ? cell->low.y : cell->high.y;
    }
    return ORL_GONIO_MANY_CROSSINGS;
}
