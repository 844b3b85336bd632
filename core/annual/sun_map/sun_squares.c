#include "annual/sun_map/sun_squares.h"

#include <stdlib.h>

#include "scene/geometry/placed.h"

enum { MOST_CORNERS = 8, ROUND_COLUMNS = 64, ROUND_ROWS = 32, COLUMN_BITS = 14 };

/* Origin and two axes in a facet's plane. */
struct layout {
    struct orl_vec3 origin, along[2];
};

static struct layout layout_of(const struct orl_geometry *g, const struct orl_facet *f,
                               struct orl_vec3 along)
{
    return (struct layout){orl_triangle_of(g, f->first_triangle).a,
                           {along, orl_cross(f->normal, along)}};
}

static struct layout layout_by(const struct orl_sun_squares *s, const struct orl_facet *f,
                               const struct orl_sun_sheet *sheet)
{
    return layout_of(
        s->geometry, f,
        orl_v3((double)sheet->along[0], (double)sheet->along[1], (double)sheet->along[2]));
}

static void place_on(const struct layout *layout, struct orl_vec3 point, double ret_at[2])
{
    const struct orl_vec3 from = orl_sub(point, layout->origin);
    for (int i = 0; i < 2; i++)
        ret_at[i] = orl_dot(from, layout->along[i]);
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

static struct orl_sun_sheet sheet_of(const struct orl_geometry *g, const struct orl_facet *f,
                                     double width)
{
    const struct orl_vec3 along = axis_of(orl_triangle_of(g, f->first_triangle));
    const struct layout layout = layout_of(g, f, along);
    struct orl_sun_sheet sheet = {.along = {(float)along.x, (float)along.y, (float)along.z}};
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_of(g, orl_facet_triangle(f, i));
        const struct orl_vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 3; k++) {
            double at[2];
            place_on(&layout, corners[k], at);
            for (int axis = 0; axis < 2; axis++) {
                low[axis] = fmin(low[axis], at[axis]);
                high[axis] = fmax(high[axis], at[axis]);
            }
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        const double extent = fmax(high[axis] - low[axis], 1e-30);
        const double other = fmax(high[1 - axis] - low[1 - axis], 1e-30);
        sheet.low[axis] = (float)low[axis];
        sheet.step[axis] = (float)(extent * (1 + 1e-6) / count_along(extent, other, width));
    }
    return sheet;
}

int orl_sun_squares_init(struct orl_sun_squares *s, const struct orl_geometry *g, double width)
{
    *s = (struct orl_sun_squares){
        .geometry = g, .width = width, .sheets = calloc(g->n_facets + 1, sizeof *s->sheets)};
    if (!s->sheets)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < g->n_facets; i++) {
        struct orl_facet own;
        const struct orl_facet *const f = orl_facet_own(g, i, &own);
        if (f->kind == ORL_SURFACE_POLYGON && f->n_triangles > 0)
            s->sheets[i] = sheet_of(g, f, width);
    }
    return 0;
}

void orl_sun_squares_done(struct orl_sun_squares *s)
{
    free(s->sheets);
    *s = (struct orl_sun_squares){.sheets = NULL};
}

/* A facet, and the sheet of a polygon. For instanced facets both are computed on each call, into
 * the storage here. */
struct met {
    const struct orl_facet *facet;
    const struct orl_sun_sheet *sheet;
    struct orl_facet room;
    struct orl_curved round;
    struct orl_sun_sheet placed_sheet;
};

static void look_up(const struct orl_sun_squares *s, uint32_t facet, struct met *met)
{
    const struct orl_geometry *const g = s->geometry;
    if (!orl_facet_is_placed(g, facet)) {
        met->facet = orl_facet_own(g, facet, &met->room);
        met->sheet = &s->sheets[facet];
        return;
    }
    met->room = orl_facet_at(g, facet, &met->round);
    if (met->room.kind == ORL_SURFACE_POLYGON)
        met->placed_sheet = sheet_of(g, &met->room, s->width);
    met->facet = &met->room;
    met->sheet = &met->placed_sheet;
}

/* Computes column and row of the square in its facet. */
static void cell_of(const struct orl_sun_squares *s, const struct orl_hit *hit,
                    const struct met *met, int64_t ret_cell[2])
{
    const struct orl_facet *f = met->facet;
    double at[2];
    if (f->kind == ORL_SURFACE_POLYGON) {
        const struct orl_sun_sheet *sheet = met->sheet;
        const struct layout layout = layout_by(s, f, sheet);
        place_on(&layout, hit->point, at);
        for (int i = 0; i < 2; i++)
            ret_cell[i] =
                (int64_t)fmax(floor((at[i] - (double)sheet->low[i]) / (double)sheet->step[i]), 0);
        return;
    }
    orl_hit_uv(s->geometry, hit, at);
    ret_cell[0] = (int64_t)fmin(floor(at[0] * ROUND_COLUMNS), ROUND_COLUMNS - 1);
    ret_cell[1] = (int64_t)fmin(floor(at[1] * ROUND_ROWS), ROUND_ROWS - 1);
}

uint64_t orl_sun_square_of(const struct orl_sun_squares *s, const struct orl_hit *hit)
{
    const uint64_t mask = (1U << COLUMN_BITS) - 1;
    struct met met;
    int64_t cell[2];
    look_up(s, hit->facet, &met);
    cell_of(s, hit, &met, cell);
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
    const double here = f->round->radius[0] + along * (f->round->radius[1] - f->round->radius[0]);
    const double mean = 0.5 * (f->round->radius[0] + f->round->radius[1]);
    return mean > 0 ? whole * here / mean : whole;
}

static double polygon_area(const struct orl_geometry *g, const struct orl_facet *f,
                           const struct layout *layout, const struct orl_sun_sheet *sheet,
                           const int64_t cell[2])
{
    double sum = 0;
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_of(g, orl_facet_triangle(f, i));
        struct outline o = {.n = 3};
        place_on(layout, t.a, o.at[0]);
        place_on(layout, t.b, o.at[1]);
        place_on(layout, t.c, o.at[2]);
        for (int axis = 0; axis < 2; axis++) {
            const double low = (double)sheet->low[axis], step = (double)sheet->step[axis];
            clip_outline(&o, axis, low + (double)cell[axis] * step, 1);
            clip_outline(&o, axis, low + (double)(cell[axis] + 1) * step, -1);
        }
        sum += area_of(&o);
    }
    return sum;
}

double orl_sun_square_area(const struct orl_sun_squares *s, const struct orl_hit *hit)
{
    struct met met;
    int64_t cell[2];
    look_up(s, hit->facet, &met);
    cell_of(s, hit, &met, cell);
    if (met.facet->kind != ORL_SURFACE_POLYGON)
        return round_area(met.facet, cell);
    const struct layout layout = layout_by(s, met.facet, met.sheet);
    return polygon_area(s->geometry, met.facet, &layout, met.sheet, cell);
}
