#include "photon/surface/facet_plane.h"

#include <stdlib.h>

static struct orl_vec3 corner_of(const struct orl_geometry *g, uint32_t triangle, uint32_t k)
{
    return orl_corner_get(g, orl_triangle_corner(g, triangle, k));
}

static void build_plane(struct orl_planes *planes, uint32_t facet, uint32_t first)
{
    const struct orl_geometry *g = planes->geometry;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    struct orl_plane *plane = &planes->planes[facet];
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    *plane = (struct orl_plane){
        .frame = orl_frame_about(f->normal), .first = first, .triangles = f->n_triangles};
    planes->is_flat[facet] = f->n_triangles > 0 && f->area > 0;
    if (!planes->is_flat[facet])
        return;
    for (uint32_t i = 0; i < 3 * f->n_triangles; i++) {
        const struct orl_vec3 a = corner_of(g, orl_facet_triangle(f, i / 3), i % 3);
        const double x = orl_dot(a, plane->frame.u), y = orl_dot(a, plane->frame.v);
        low[0] = orl_smaller(low[0], x);
        low[1] = orl_smaller(low[1], y);
        high[0] = orl_larger(high[0], x);
        high[1] = orl_larger(high[1], y);
    }
    plane->wide = high[0] - low[0];
    plane->high = high[1] - low[1];
    const double level = orl_dot(corner_of(g, orl_facet_triangle(f, 0), 0), f->normal);
    plane->origin =
        orl_add(orl_scale(f->normal, level),
                orl_add(orl_scale(plane->frame.u, low[0]), orl_scale(plane->frame.v, low[1])));
    for (uint32_t i = 0; i < f->n_triangles; i++)
        for (uint32_t k = 0; k < 3; k++)
            planes->plane_triangles[first + i].corners[k] =
                orl_plane_project(plane, corner_of(g, orl_facet_triangle(f, i), k));
}

bool orl_planes_init(struct orl_planes *planes, const struct orl_geometry *geometry)
{
    const size_t most = orl_geometry_triangles_end(geometry);
    uint32_t first = 0;
    *planes =
        (struct orl_planes){.geometry = geometry,
                            .planes = malloc((geometry->n_facets + 1) * sizeof *planes->planes),
                            .plane_triangles = malloc((most + 1) * sizeof *planes->plane_triangles),
                            .is_flat = calloc(geometry->n_facets + 1, sizeof *planes->is_flat)};
    if (!planes->planes || !planes->plane_triangles || !planes->is_flat)
        return false;
    for (size_t i = 0; i < geometry->n_facets; i++) {
        struct orl_facet own;
        build_plane(planes, (uint32_t)i, first);
        first += orl_facet_get_own(geometry, i, &own)->n_triangles;
    }
    return true;
}

void orl_planes_done(struct orl_planes *planes)
{
    free(planes->planes);
    free(planes->plane_triangles);
    free(planes->is_flat);
}
