#include "annual/sun_squares.h"

enum { MOST_CORNERS = 8, ROUND_COLUMNS = 64, ROUND_ROWS = 32, COLUMN_BITS = 14 };

/* A facet's plane, its first triangle's first side being the first axis. */
struct layout {
    struct orl_vec3 origin, along[2];
};

static struct layout layout_of(const struct orl_geometry *g, const struct orl_facet *f)
{
    const struct orl_triangle *t = &g->triangles[f->first_triangle];
    const struct orl_vec3 side = orl_normalize(orl_sub(t->b, t->a));
    return (struct layout){t->a, {side, orl_cross(f->normal, side)}};
}

static void place_on(const struct layout *layout, struct orl_vec3 point, double ret_at[2])
{
    const struct orl_vec3 from = orl_sub(point, layout->origin);
    for (int i = 0; i < 2; i++)
        ret_at[i] = orl_dot(from, layout->along[i]);
}

/* Which square of its facet, by column and row. */
static void cell_of(const struct orl_sun_squares *s, const struct orl_hit *hit, int64_t ret_cell[2])
{
    const struct orl_facet *f = &s->geometry->facets[hit->facet];
    double at[2];
    if (f->kind == ORL_SURFACE_POLYGON) {
        const struct layout layout = layout_of(s->geometry, f);
        place_on(&layout, hit->point, at);
        for (int i = 0; i < 2; i++)
            ret_cell[i] = (int64_t)floor(at[i] / s->width);
        return;
    }
    orl_hit_uv(s->geometry, hit, at);
    ret_cell[0] = (int64_t)fmin(floor(at[0] * ROUND_COLUMNS), ROUND_COLUMNS - 1);
    ret_cell[1] = (int64_t)fmin(floor(at[1] * ROUND_ROWS), ROUND_ROWS - 1);
}

uint64_t orl_sun_square_of(const struct orl_sun_squares *s, const struct orl_hit *hit)
{
    const uint64_t mask = (1U << COLUMN_BITS) - 1;
    int64_t cell[2];
    cell_of(s, hit, cell);
    return ((uint64_t)hit->facet + 1) << (2 * COLUMN_BITS + 1) |
           ((uint64_t)cell[0] & mask) << (COLUMN_BITS + 1) | ((uint64_t)cell[1] & mask) << 1 |
           hit->front;
}

/* ---- Areas ----------------------------------------------------------------------------------- */

struct outline {
    double at[MOST_CORNERS][2];
    int n;
};

/* What of it is not beyond a line across one axis (Sutherland and Hodgman 1974). */
static void cut(struct outline *o, int axis, double line, double sign)
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

/* Of a round surface: by height, but for a cone's and a ring's widths, which go with the radius. */
static double round_area(const struct orl_facet *f, const int64_t cell[2])
{
    const double whole = f->area / (ROUND_COLUMNS * ROUND_ROWS);
    const bool tapers =
        f->kind == ORL_SURFACE_CONE || f->kind == ORL_SURFACE_CUP || f->kind == ORL_SURFACE_RING;
    if (!tapers)
        return whole;
    const double along = ((double)cell[1] + 0.5) / ROUND_ROWS;
    const double here = f->radius[0] + along * (f->radius[1] - f->radius[0]);
    const double mean = 0.5 * (f->radius[0] + f->radius[1]);
    return mean > 0 ? whole * here / mean : whole;
}

double orl_sun_square_area(const struct orl_sun_squares *s, const struct orl_hit *hit)
{
    const struct orl_geometry *g = s->geometry;
    const struct orl_facet *f = &g->facets[hit->facet];
    int64_t cell[2];
    double sum = 0;
    cell_of(s, hit, cell);
    if (f->kind != ORL_SURFACE_POLYGON)
        return round_area(f, cell);
    const struct layout layout = layout_of(g, f);
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle *t = &g->triangles[f->first_triangle + i];
        struct outline o = {.n = 3};
        place_on(&layout, t->a, o.at[0]);
        place_on(&layout, t->b, o.at[1]);
        place_on(&layout, t->c, o.at[2]);
        for (int axis = 0; axis < 2; axis++) {
            cut(&o, axis, (double)cell[axis] * s->width, 1);
            cut(&o, axis, (double)(cell[axis] + 1) * s->width, -1);
        }
        sum += area_of(&o);
    }
    return sum;
}
