#include "annual/sun_map/sun_map.h"

#include <stdlib.h>

#include "scene/geometry/instances.h"

enum { MOST_CORNERS = 8, ROUND_COLUMNS = 64, ROUND_ROWS = 32, COLUMN_BITS = 14 };

/* Origin and two axes in a facet's plane. */
struct plane_axes {
    struct orl_vec3 origin, along[2];
};

static struct plane_axes plane_axes_of(const struct orl_geometry *g, const struct orl_facet *f,
                                       struct orl_vec3 along)
{
    return (struct plane_axes){orl_triangle_get(g, f->first_triangle).a,
                               {along, orl_cross(f->normal, along)}};
}

static struct plane_axes plane_axes_by(const struct orl_sun_texels *s, const struct orl_facet *f,
                                       const struct orl_sun_texel_grid *texel_grid)
{
    return plane_axes_of(s->geometry, f,
                         orl_v3((double)texel_grid->along[0], (double)texel_grid->along[1],
                                (double)texel_grid->along[2]));
}

static void place_on(const struct plane_axes *plane_axes, struct orl_vec3 point, double ret_at[2])
{
    const struct orl_vec3 from = orl_sub(point, plane_axes->origin);
    for (int i = 0; i < 2; i++)
        ret_at[i] = orl_dot(from, plane_axes->along[i]);
}

/* Returns the direction of the triangle's side of middle length: a leg of a right triangle. */
static struct orl_vec3 axis_of(struct orl_triangle t)
{
    const struct orl_vec3 sides[3] = {orl_sub(t.b, t.a), orl_sub(t.c, t.b), orl_sub(t.a, t.c)};
    int middle = 0;
    for (int i = 0; i < 3; i++) {
        const double here = orl_length(sides[i]);
        const double one = orl_length(sides[(i + 1) % 3]), other = orl_length(sides[(i + 2) % 3]);
        if (here >= fmin(one, other) && here <= fmax(one, other))
            middle = i;
    }
    return orl_normalize(sides[middle]);
}

static bool is_strip(double across, double along, double width)
{
    return across < 3 * width && across < 0.25 * along;
}

/*
 * Number of cells along an axis. Strips may be slats: each shades a part of the next one and hides
 * a part from the room. Both depend on the position across the strip, so a mean across it would mix
 * lit and visible parts. Along the strip nothing changes, so the cells may be long.
 */
static double count_along(double extent, double other, double width)
{
    static const double across_strips = 8, lengthwise = 4;
    if (is_strip(extent, other, width))
        return across_strips;
    return ceil(extent / (is_strip(other, extent, width) ? lengthwise * width : width));
}

static struct orl_sun_texel_grid texel_grid_of(const struct orl_geometry *g,
                                               const struct orl_facet *f, double width)
{
    const struct orl_vec3 along = axis_of(orl_triangle_get(g, f->first_triangle));
    const struct plane_axes plane_axes = plane_axes_of(g, f, along);
    struct orl_sun_texel_grid texel_grid = {
        .along = {(float)along.x, (float)along.y, (float)along.z}};
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        const struct orl_vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 3; k++) {
            double at[2];
            place_on(&plane_axes, corners[k], at);
            for (int axis = 0; axis < 2; axis++) {
                low[axis] = fmin(low[axis], at[axis]);
                high[axis] = fmax(high[axis], at[axis]);
            }
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        const double extent = fmax(high[axis] - low[axis], 1e-30);
        const double other = fmax(high[1 - axis] - low[1 - axis], 1e-30);
        texel_grid.low[axis] = (float)low[axis];
        texel_grid.step[axis] = (float)(extent * (1 + 1e-6) / count_along(extent, other, width));
    }
    return texel_grid;
}

int orl_sun_texels_init(struct orl_sun_texels *s, const struct orl_geometry *g, double width)
{
    *s = (struct orl_sun_texels){.geometry = g,
                                 .width = width,
                                 .texel_grids = calloc(g->n_facets + 1, sizeof *s->texel_grids)};
    if (!s->texel_grids)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet own;
        const struct orl_facet *const f = orl_facet_get_own(g, i, &own);
        if (f->kind == ORL_SURFACE_POLYGON && f->n_triangles > 0)
            s->texel_grids[i] = texel_grid_of(g, f, width);
    }
    return 0;
}

void orl_sun_texels_done(struct orl_sun_texels *s)
{
    free(s->texel_grids);
    *s = (struct orl_sun_texels){.texel_grids = NULL};
}

/* A facet, and the sheet of a polygon. For instanced facets both are computed on each call, into
 * the storage here. */
struct facet_texels {
    const struct orl_facet *facet;
    const struct orl_sun_texel_grid *texel_grid;
    struct orl_facet room;
    struct orl_quadric quadric;
    struct orl_sun_texel_grid placed_texel_grid;
};

static void find_facet_texels(const struct orl_sun_texels *s, uint32_t facet,
                              struct facet_texels *facet_texels)
{
    const struct orl_geometry *const g = s->geometry;
    if (!orl_facet_is_instanced(g, facet)) {
        facet_texels->facet = orl_facet_get_own(g, facet, &facet_texels->room);
        facet_texels->texel_grid = &s->texel_grids[facet];
        return;
    }
    facet_texels->room = orl_instance_facet(g, facet, &facet_texels->quadric);
    if (facet_texels->room.kind == ORL_SURFACE_POLYGON)
        facet_texels->placed_texel_grid = texel_grid_of(g, &facet_texels->room, s->width);
    facet_texels->facet = &facet_texels->room;
    facet_texels->texel_grid = &facet_texels->placed_texel_grid;
}

/* Computes column and row of the texel in its facet. */
static void cell_of(const struct orl_sun_texels *s, const struct orl_hit *hit,
                    const struct facet_texels *facet_texels, int64_t ret_cell[2])
{
    const struct orl_facet *f = facet_texels->facet;
    double at[2];
    if (f->kind == ORL_SURFACE_POLYGON) {
        const struct orl_sun_texel_grid *texel_grid = facet_texels->texel_grid;
        const struct plane_axes plane_axes = plane_axes_by(s, f, texel_grid);
        place_on(&plane_axes, hit->point, at);
        for (int i = 0; i < 2; i++)
            ret_cell[i] = (int64_t)fmax(
                floor((at[i] - (double)texel_grid->low[i]) / (double)texel_grid->step[i]), 0);
        return;
    }
    orl_hit_uv(s->geometry, hit, at);
    ret_cell[0] = (int64_t)fmin(floor(at[0] * ROUND_COLUMNS), ROUND_COLUMNS - 1);
    ret_cell[1] = (int64_t)fmin(floor(at[1] * ROUND_ROWS), ROUND_ROWS - 1);
}

uint64_t orl_sun_texel_of(const struct orl_sun_texels *s, const struct orl_hit *hit)
{
    const uint64_t mask = (1U << COLUMN_BITS) - 1;
    struct facet_texels facet_texels;
    int64_t cell[2];
    find_facet_texels(s, hit->facet, &facet_texels);
    cell_of(s, hit, &facet_texels, cell);
    return ((uint64_t)hit->facet + 1) << (2 * COLUMN_BITS + 1) |
           ((uint64_t)cell[0] & mask) << (COLUMN_BITS + 1) | ((uint64_t)cell[1] & mask) << 1 |
           hit->front;
}

/* ---- Areas ----------------------------------------------------------------------------------- */

struct outline {
    double at[MOST_CORNERS][2];
    int n;
};

/* Clips the outline at a line across one axis, and keeps the side given by sign (Sutherland and
 * Hodgman 1974). */
static void clip_outline(struct outline *o, int axis, double line, double sign)
{
    struct outline left = {.n = 0};
    for (int i = 0; i < o->n; i++) {
        const double *a = o->at[i], *b = o->at[(i + 1) % o->n];
        const double in_a = sign * (a[axis] - line), in_b = sign * (b[axis] - line);
        if (in_a >= 0 && left.n < MOST_CORNERS) {
            left.at[left.n][0] = a[0];
            left.at[left.n++][1] = a[1];
        }
        if ((in_a >= 0) != (in_b >= 0) && left.n < MOST_CORNERS) {
            const double share = in_a / (in_a - in_b);
            left.at[left.n][0] = a[0] + share * (b[0] - a[0]);
            left.at[left.n++][1] = a[1] + share * (b[1] - a[1]);
        }
    }
    *o = left;
}

static double area_of(const struct outline *o)
{
    double twice = 0;
    for (int i = 0; i < o->n; i++) {
        const double *a = o->at[i], *b = o->at[(i + 1) % o->n];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * fabs(twice);
}

/* Area of a cell of a round surface: equal for all heights, except for cones, cups and rings, where
 * it is proportional to the radius. */
static double round_area(const struct orl_facet *f, const int64_t cell[2])
{
    const double whole = f->area / (ROUND_COLUMNS * ROUND_ROWS);
    const bool tapers =
        f->kind == ORL_SURFACE_CONE || f->kind == ORL_SURFACE_CUP || f->kind == ORL_SURFACE_RING;
    if (!tapers)
        return whole;
    const double along = ((double)cell[1] + 0.5) / ROUND_ROWS;
    const double here =
        f->quadric->radius[0] + along * (f->quadric->radius[1] - f->quadric->radius[0]);
    const double mean = 0.5 * (f->quadric->radius[0] + f->quadric->radius[1]);
    return mean > 0 ? whole * here / mean : whole;
}

static double polygon_area(const struct orl_geometry *g, const struct orl_facet *f,
                           const struct plane_axes *plane_axes,
                           const struct orl_sun_texel_grid *texel_grid, const int64_t cell[2])
{
    double sum = 0;
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        struct outline o = {.n = 3};
        place_on(plane_axes, t.a, o.at[0]);
        place_on(plane_axes, t.b, o.at[1]);
        place_on(plane_axes, t.c, o.at[2]);
        for (int axis = 0; axis < 2; axis++) {
            const double low = (double)texel_grid->low[axis], step = (double)texel_grid->step[axis];
            clip_outline(&o, axis, low + (double)cell[axis] * step, 1);
            clip_outline(&o, axis, low + (double)(cell[axis] + 1) * step, -1);
        }
        sum += area_of(&o);
    }
    return sum;
}

double orl_sun_texel_area(const struct orl_sun_texels *s, const struct orl_hit *hit)
{
    struct facet_texels facet_texels;
    int64_t cell[2];
    find_facet_texels(s, hit->facet, &facet_texels);
    cell_of(s, hit, &facet_texels, cell);
    if (facet_texels.facet->kind != ORL_SURFACE_POLYGON)
        return round_area(facet_texels.facet, cell);
    const struct plane_axes plane_axes =
        plane_axes_by(s, facet_texels.facet, facet_texels.texel_grid);
    return polygon_area(s->geometry, facet_texels.facet, &plane_axes, facet_texels.texel_grid,
                        cell);
}
