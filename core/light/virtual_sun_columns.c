#include "light/virtual_sun_columns.h"

#include <math.h>

/* share of the scene's radius: Embree has coordinates as floats */
static const double rounding = 1e-5;

/* A box in the image's frame; axes: u, v (across), n (along). */
struct box {
    double low[3], high[3];
};

static const struct box nothing = {{INFINITY, INFINITY, INFINITY},
                                   {-INFINITY, -INFINITY, -INFINITY}};

static void add_point(struct box *box, const struct orl_frame *frame, struct orl_vec3 p)
{
    const double at[3] = {orl_dot(frame->u, p), orl_dot(frame->v, p), orl_dot(frame->n, p)};
    for (int i = 0; i < 3; i++) {
        box->low[i] = fmin(box->low[i], at[i]);
        box->high[i] = fmax(box->high[i], at[i]);
    }
}

static void grow_box(struct box *box, double by)
{
    for (int i = 0; i < 3; i++) {
        box->low[i] -= by;
        box->high[i] += by;
    }
}

static void add_box(struct box *box, const struct box *other)
{
    for (int i = 0; i < 3; i++) {
        box->low[i] = fmin(box->low[i], other->low[i]);
        box->high[i] = fmax(box->high[i], other->high[i]);
    }
}

/* State for passing the boxes of the mirrors' parts to a callback, one mirror after the other. */
struct drawing {
    const struct orl_geometry *geometry;
    const struct orl_frame *frame;
    const bool *shows;
    double margin;
    struct box all;
    struct orl_virtual_sun_columns *columns;
};

static void add_to_bounds(struct drawing *d, const struct box *part)
{
    add_box(&d->all, part);
}

static int column_of(const struct orl_virtual_sun_columns *columns, int axis, double at)
{
    const double x = (at - columns->low[axis]) * columns->per_unit[axis];
    return x < 0 ? 0 : x >= ORL_VIRTUAL_SUN_COLUMNS ? ORL_VIRTUAL_SUN_COLUMNS - 1 : (int)x;
}

static void mark_columns(struct drawing *d, const struct box *part)
{
    struct orl_virtual_sun_columns *columns = d->columns;
    const int x0 = column_of(columns, 0, part->low[0]), x1 = column_of(columns, 0, part->high[0]);
    const int y0 = column_of(columns, 1, part->low[1]), y1 = column_of(columns, 1, part->high[1]);
    const float far = nextafterf((float)part->high[2], INFINITY);
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            columns->farthest[y][x] = fmaxf(columns->farthest[y][x], far);
}

static void visit_facet_parts(struct drawing *d, const struct orl_facet *f,
                              void (*visit)(struct drawing *, const struct box *))
{
    if (f->kind != ORL_SURFACE_POLYGON) {
        struct box part = nothing;
        add_point(&part, d->frame, f->quadric->center[0]);
        grow_box(&part, fmax(f->quadric->radius[0], f->quadric->radius[1]) + d->margin);
        visit(d, &part);
        return;
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(d->geometry, orl_facet_triangle(f, i));
        struct box part = nothing;
        add_point(&part, d->frame, t.a);
        add_point(&part, d->frame, t.b);
        add_point(&part, d->frame, t.c);
        grow_box(&part, d->margin);
        visit(d, &part);
    }
}

static void visit_parts(struct drawing *d, void (*visit)(struct drawing *, const struct box *))
{
    for (size_t i = 0; i < d->geometry->n_facets; i++) {
        struct orl_facet own;
        if (d->shows[i])
            visit_facet_parts(d, orl_facet_get_own(d->geometry, i, &own), visit);
    }
}

void orl_virtual_sun_columns_build(struct orl_virtual_sun_columns *columns,
                                   const struct orl_geometry *geometry,
                                   const struct orl_frame *frame, double half_angle,
                                   const bool *shows)
{
    /* A ray within the disc leaves its column by at most this distance on its way through the
     * scene. */
    const double margin = 2 * geometry->radius * (tan(half_angle) + rounding);
    struct drawing d = {.geometry = geometry,
                        .frame = frame,
                        .shows = shows,
                        .margin = margin,
                        .all = nothing,
                        .columns = columns};
    for (int y = 0; y < ORL_VIRTUAL_SUN_COLUMNS; y++)
        for (int x = 0; x < ORL_VIRTUAL_SUN_COLUMNS; x++)
            columns->farthest[y][x] = -INFINITY;
    visit_parts(&d, add_to_bounds);
    for (int i = 0; i < 2; i++) {
        columns->low[i] = d.all.low[i];
        columns->per_unit[i] = ORL_VIRTUAL_SUN_COLUMNS / (d.all.high[i] - d.all.low[i]);
    }
    if (d.all.high[0] > d.all.low[0])
        visit_parts(&d, mark_columns);
}
