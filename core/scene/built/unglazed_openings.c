#include "scene/built/ports.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>
#include <oriel/base/thread_pool.h>

enum { MOST_PLANE_POLYGONS = 512, MOST_LINES = 160, LEAST_LINES = 4, LEAST_CORNERS = 8 };
static const double most_work = 2e8;      /* edges tested, for all planes together */
static const double same_normal = 1e-6;   /* difference of coordinates of unit normals */
static const double same_distance = 1e-6; /* relative to the size of the scene, or of a plane */
/* length of an opening's side, relative to the plane's polygons */
static const double least_side = 1e-3;
/* Length relative to the scene below which polygons, such as leaves, are not taken for parts of
 * walls. */
static const double least_length = 2e-3;

/* ---- Planes ---------------------------------------------------------------------------------- */

/* A polygon, by its plane. */
struct member {
    double key[4]; /* the plane's normal, with a fixed sign, and its distance; rounded */
    size_t surface;
};

static int compare_members(const void *a, const void *b)
{
    const struct member *x = a, *y = b;
    for (int i = 0; i < 4; i++)
        if (x->key[i] != y->key[i])
            return x->key[i] < y->key[i] ? -1 : 1;
    return (x->surface > y->surface) - (x->surface < y->surface);
}

static bool is_one_plane(const struct member *a, const struct member *b)
{
    for (int i = 0; i < 4; i++)
        if (a->key[i] != b->key[i])
            return false;
    return true;
}

/* Returns true if it is a polygon that rays can hit. */
static bool is_solid(const struct orl_parsed_scene *d, const struct orl_surface *s)
{
    const enum orl_material_kind kind = d->materials[s->material].kind;
    return s->kind == ORL_SURFACE_POLYGON && s->n_vertices >= 3 && kind != ORL_MATERIAL_MIST &&
           kind != ORL_MATERIAL_ANTIMATTER;
}

/* The bounding box of all polygons. */
struct extent {
    struct orl_vec3 middle;
    double size; /* half its longest edge */
};

static bool is_long(const struct orl_surface *s, const struct extent *extent)
{
    const double least = least_length * extent->size;
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        const struct orl_vec3 edge = orl_sub(s->vertices[(i + 1) % s->n_vertices], s->vertices[i]);
        if (orl_dot(edge, edge) >= least * least)
            return true;
    }
    return false;
}

static struct extent extent_of(const struct orl_parsed_scene *d)
{
    struct orl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = orl_neg(low);
    for (size_t i = 0; i < d->n_surfaces; i++)
        for (uint32_t k = 0; is_solid(d, &d->surfaces[i]) && k < d->surfaces[i].n_vertices; k++)
            orl_box_include(d->surfaces[i].vertices[k], &low, &high);
    const struct orl_vec3 span = orl_sub(high, low);
    return (struct extent){orl_scale(orl_add(low, high), 0.5),
                           fmax(fmax(span.x, span.y), fmax(span.z, 1e-9)) / 2};
}

static struct member member_of(const struct orl_surface *s, size_t surface,
                               const struct extent *extent)
{
    struct orl_vec3 n = s->normal;
    const double first = fabs(n.x) > same_normal ? n.x : fabs(n.y) > same_normal ? n.y : n.z;
    if (first < 0)
        n = orl_neg(n);
    const double distance = orl_dot(n, orl_sub(s->vertices[0], extent->middle));
    struct member ret = {.key = {n.x / (4 * same_normal), n.y / (4 * same_normal),
                                 n.z / (4 * same_normal),
                                 distance / (4 * same_distance * extent->size)},
                         .surface = surface};
    for (int i = 0; i < 4; i++)
        ret.key[i] = round(ret.key[i]);
    return ret;
}

/* ---- One plane ------------------------------------------------------------------------------- */

struct cell {
    uint16_t u, v;
};

/* Polygons of a plane, in coordinates along two axes in it. Lines through all corners, parallel to
 * the axes, make a grid of cells. */
struct plane {
    const struct orl_parsed_scene *d;
    const struct member *members;
    size_t n;
    struct orl_vec3 origin, axes[2], normal;
    double lines[2][MOST_LINES];
    size_t n_lines[2];
    unsigned char cells[MOST_LINES][MOST_LINES]; /* [v][u] */
    struct cell stack[MOST_LINES * MOST_LINES];
    size_t n_stack;
    size_t corners; /* number of all its polygons' corners */
    double *work;   /* edges tested so far, for all planes */
};
enum { CELL_FREE, CELL_COVERED, CELL_OUTSIDE, CELL_TAKEN };

static const struct orl_surface *surface_of(const struct plane *p, size_t i)
{
    return &p->d->surfaces[p->members[i].surface];
}

static double along(const struct plane *p, struct orl_vec3 point, int axis)
{
    return orl_dot(orl_sub(point, p->origin), p->axes[axis]);
}

static void find_axes(struct plane *p)
{
    const struct orl_surface *s = surface_of(p, 0);
    double longest = 0;
    p->origin = s->vertices[0];
    p->normal = s->normal;
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        const struct orl_vec3 edge = orl_sub(s->vertices[(i + 1) % s->n_vertices], s->vertices[i]);
        if (orl_length(edge) > longest) {
            longest = orl_length(edge);
            p->axes[0] = orl_scale(edge, 1 / longest);
        }
    }
    p->axes[1] = orl_cross(p->normal, p->axes[0]);
}

static int compare_numbers(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Finds the lines across an axis. Returns false if they are too many, or too few to leave an
 * opening. scratch: room for all corners. */
static bool find_lines(struct plane *p, int axis, double *scratch)
{
    size_t n = 0, kept = 0;
    for (size_t i = 0; i < p->n; i++)
        for (uint32_t k = 0; k < surface_of(p, i)->n_vertices; k++)
            scratch[n++] = along(p, surface_of(p, i)->vertices[k], axis);
    qsort(scratch, n, sizeof *scratch, compare_numbers);
    const double tolerance = 8 * same_distance * (scratch[n - 1] - scratch[0]);
    for (size_t i = 0; i < n; i++) {
        if (kept > 0 && scratch[i] - p->lines[axis][kept - 1] <= tolerance)
            continue;
        if (kept == MOST_LINES)
            return false;
        p->lines[axis][kept++] = scratch[i];
    }
    p->n_lines[axis] = kept;
    return kept >= LEAST_LINES;
}

/* Returns true if the polygon covers the point: a ray from it along the first axis crosses an odd
 * number of edges. */
static bool covers(const struct plane *p, const struct orl_surface *s, double u, double v)
{
    bool inside = false;
    double u0 = along(p, s->vertices[s->n_vertices - 1], 0);
    double v0 = along(p, s->vertices[s->n_vertices - 1], 1);
    for (uint32_t i = 0; i < s->n_vertices; i++) {
        const double u1 = along(p, s->vertices[i], 0), v1 = along(p, s->vertices[i], 1);
        if ((v0 > v) != (v1 > v) && u < u0 + (v - v0) / (v1 - v0) * (u1 - u0))
            inside = !inside;
        u0 = u1;
        v0 = v1;
    }
    return inside;
}

/* Cells along an axis whose centres lie between two coordinates. */
struct span {
    size_t first, end;
};

static struct span span_of(const struct plane *p, int axis, double low, double high)
{
    const double *lines = p->lines[axis];
    struct span span = {0, p->n_lines[axis] - 1};
    while (span.first < span.end && (lines[span.first] + lines[span.first + 1]) / 2 < low)
        span.first++;
    while (span.end > span.first && (lines[span.end] + lines[span.end - 1]) / 2 > high)
        span.end--;
    return span;
}

/* Marks the cells whose centres a polygon covers. Returns false if that would be too much work. */
static bool cover_cells(struct plane *p, const struct orl_surface *s)
{
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (uint32_t i = 0; i < s->n_vertices; i++)
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], along(p, s->vertices[i], axis));
            high[axis] = fmax(high[axis], along(p, s->vertices[i], axis));
        }
    const struct span us = span_of(p, 0, low[0], high[0]), vs = span_of(p, 1, low[1], high[1]);
    *p->work += (double)((us.end - us.first) * (vs.end - vs.first)) * s->n_vertices;
    if (*p->work > most_work)
        return false;
    for (size_t v = vs.first; v < vs.end; v++)
        for (size_t u = us.first; u < us.end; u++)
            if (p->cells[v][u] == CELL_FREE &&
                covers(p, s, (p->lines[0][u] + p->lines[0][u + 1]) / 2,
                       (p->lines[1][v] + p->lines[1][v + 1]) / 2))
                p->cells[v][u] = CELL_COVERED;
    return true;
}

static bool fill_cells(struct plane *p)
{
    for (size_t v = 0; v + 1 < p->n_lines[1]; v++)
        memset(p->cells[v], CELL_FREE, p->n_lines[0]);
    for (size_t i = 0; i < p->n; i++)
        if (!cover_cells(p, surface_of(p, i)))
            return false;
    return true;
}

/* Marks a free cell as outside, and puts it on the stack. */
static void mark_cell(struct plane *p, size_t u, size_t v)
{
    if (u + 1 >= p->n_lines[0] || v + 1 >= p->n_lines[1] || p->cells[v][u] != CELL_FREE)
        return;
    p->cells[v][u] = CELL_OUTSIDE;
    p->stack[p->n_stack++] = (struct cell){(uint16_t)u, (uint16_t)v};
}

/* Marks the free cells that are connected to the rim. */
static void mark_outside(struct plane *p)
{
    const size_t nu = p->n_lines[0] - 1, nv = p->n_lines[1] - 1;
    for (size_t u = 0; u < nu; u++) {
        mark_cell(p, u, 0);
        mark_cell(p, u, nv - 1);
    }
    for (size_t v = 0; v < nv; v++) {
        mark_cell(p, 0, v);
        mark_cell(p, nu - 1, v);
    }
    while (p->n_stack > 0) {
        const struct cell at = p->stack[--p->n_stack];
        mark_cell(p, at.u + 1U, at.v);
        mark_cell(p, at.u - 1U, at.v);
        mark_cell(p, at.u, at.v + 1U);
        mark_cell(p, at.u, at.v - 1U);
    }
}

/* Returns true if an edge goes through the inside of the rectangle, so that a cell of it is not
 * completely free; or if testing would be too much work. */
static bool is_crossed(const struct plane *p, const double low[2], const double high[2])
{
    const double inset = 1e-3 * fmin(high[0] - low[0], high[1] - low[1]);
    *p->work += (double)p->corners;
    if (*p->work > most_work)
        return true;
    for (size_t i = 0; i < p->n; i++) {
        const struct orl_surface *s = surface_of(p, i);
        for (uint32_t k = 0; k < s->n_vertices; k++) {
            const struct orl_vec3 a = s->vertices[k], b = s->vertices[(k + 1) % s->n_vertices];
            double from = 0, to = 1;
            for (int axis = 0; axis < 2; axis++) {
                const double x = along(p, a, axis), d = along(p, b, axis) - x;
                const double l = low[axis] + inset, h = high[axis] - inset;
                if (d == 0 && (x <= l || x >= h))
                    to = -1;
                else if (d != 0) {
                    from = fmax(from, fmin((l - x) / d, (h - x) / d));
                    to = fmin(to, fmax((l - x) / d, (h - x) / d));
                }
            }
            if (from < to)
                return true;
        }
    }
    return false;
}

static void add_opening(const struct plane *p, const double low[2], const double high[2],
                        struct orl_unglazed_opening *openings, size_t *n)
{
    const double length = fmax(p->lines[0][p->n_lines[0] - 1] - p->lines[0][0],
                               p->lines[1][p->n_lines[1] - 1] - p->lines[1][0]);
    if (*n == ORL_UNGLAZED_OPENINGS_MAX ||
        fmin(high[0] - low[0], high[1] - low[1]) < least_side * length || is_crossed(p, low, high))
        return;
    openings[(*n)++] = (struct orl_unglazed_opening){
        .corner = orl_madd(orl_madd(p->origin, p->axes[0], low[0]), p->axes[1], low[1]),
        .sides = {orl_scale(p->axes[0], high[0] - low[0]), orl_scale(p->axes[1], high[1] - low[1])},
        .normal = p->normal,
        .surface = p->members[0].surface};
}

/* Lists rectangles of free cells, each extended first in width and then in height. */
static void list_rectangles(struct plane *p, struct orl_unglazed_opening *openings, size_t *n)
{
    const size_t nu = p->n_lines[0] - 1, nv = p->n_lines[1] - 1;
    for (size_t v = 0; v < nv; v++)
        for (size_t u = 0; u < nu; u++) {
            size_t right = u, top = v + 1;
            while (right < nu && p->cells[v][right] == CELL_FREE)
                right++;
            if (right == u)
                continue;
            for (bool whole = true; top < nv && whole;) {
                for (size_t k = u; k < right; k++)
                    whole = whole && p->cells[top][k] == CELL_FREE;
                top += whole;
            }
            for (size_t i = v; i < top; i++)
                memset(&p->cells[i][u], CELL_TAKEN, right - u);
            const double low[2] = {p->lines[0][u], p->lines[1][v]};
            const double high[2] = {p->lines[0][right], p->lines[1][top]};
            add_opening(p, low, high, openings, n);
        }
}

/* Lists the openings of a plane. scratch: room for all its corners. */
static void search_plane(struct plane *p, double *scratch, struct orl_unglazed_opening *openings,
                         size_t *n)
{
    p->n_stack = 0;
    p->corners = 0;
    for (size_t i = 0; i < p->n; i++)
        p->corners += surface_of(p, i)->n_vertices;
    if (p->corners < LEAST_CORNERS || p->n > MOST_PLANE_POLYGONS)
        return;
    find_axes(p);
    if (!find_lines(p, 0, scratch) || !find_lines(p, 1, scratch) || !fill_cells(p))
        return;
    mark_outside(p);
    list_rectangles(p, openings, n);
}

/* ---- All planes ------------------------------------------------------------------------------ */

static size_t list_members(const struct orl_parsed_scene *d, struct member *ret_members,
                           size_t *ret_corners)
{
    const struct extent extent = extent_of(d);
    size_t n = 0;
    *ret_corners = 0;
    for (size_t i = 0; i < d->n_surfaces; i++) {
        const struct orl_surface *s = &d->surfaces[i];
        if (!is_solid(d, s) || !is_long(s, &extent))
            continue;
        *ret_corners += s->n_vertices;
        ret_members[n++] = member_of(s, i, &extent);
    }
    qsort(ret_members, n, sizeof *ret_members, compare_members);
    return n;
}

int orl_unglazed_find(const struct orl_parsed_scene *parsed_scene,
                      struct orl_unglazed_opening *ret_openings, size_t *ret_n)
{
    struct member *const members = malloc((parsed_scene->n_surfaces + 1) * sizeof *members);
    struct plane *const plane = malloc(sizeof *plane);
    size_t corners = 0;
    double work = 0;
    const size_t n = members ? list_members(parsed_scene, members, &corners) : 0;
    double *const scratch = malloc((corners + 1) * sizeof *scratch);
    int code = members && plane && scratch ? 0 : ORL_ERR_NOMEM;
    *ret_n = 0;
    for (size_t first = 0, end; first < n && code == 0; first = end) {
        for (end = first + 1; end < n && is_one_plane(&members[first], &members[end]);)
            end++;
        plane->d = parsed_scene;
        plane->members = members + first;
        plane->n = end - first;
        plane->work = &work;
        search_plane(plane, scratch, ret_openings, ret_n);
        if (orl_is_cancelled(parsed_scene->cancel))
            code = ORL_ERR_CANCELLED;
    }
    free(scratch);
    free(plane);
    free(members);
    return code;
}
