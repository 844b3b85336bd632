#include "annual/windows.h"

#include <stdlib.h>

#include "annual/pane_tree.h"

static void widen(struct orl_window *w, struct orl_vec3 corner)
{
    const struct orl_vec3 from = orl_sub(corner, w->corner);
    for (int i = 0; i < 2; i++) {
        w->low[i] = fmin(w->low[i], orl_dot(from, w->along[i]));
        w->high[i] = fmax(w->high[i], orl_dot(from, w->along[i]));
    }
}

/* A polygon's rectangle has the direction of a side of its first triangle. */
static struct orl_window of_polygon(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_own(g, facet, &own);
    const struct orl_triangle t = orl_triangle_of(g, f->first_triangle);
    const struct orl_vec3 sides[3] = {orl_sub(t.b, t.a), orl_sub(t.c, t.b), orl_sub(t.a, t.c)};
    struct orl_window w = {.facet = facet, .corner = t.a, .normal = f->normal};
    /* The middle one: of a right angle the longer leg, never its diagonal. */
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (orl_length(sides[order[k]]) > orl_length(sides[order[k + 1]])) {
                const int other = order[k];
                order[k] = order[k + 1];
                order[k + 1] = other;
            }
    w.along[0] = orl_normalize(sides[order[1]]);
    w.along[1] = orl_cross(w.normal, w.along[0]);
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle part = orl_triangle_of(g, orl_facet_triangle(f, i));
        widen(&w, part.a);
        widen(&w, part.b);
        widen(&w, part.c);
    }
    return w;
}

static struct orl_window of_ring(const struct orl_facet *f, uint32_t facet)
{
    const struct orl_frame frame = orl_frame_about(f->normal);
    const double r = fmax(f->round->radius[0], f->round->radius[1]);
    return (struct orl_window){.facet = facet,
                               .corner = f->round->center[0],
                               .normal = f->normal,
                               .along = {frame.u, frame.v},
                               .low = {-r, -r},
                               .high = {r, r}};
}

struct orl_window orl_window_of(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_own(g, facet, &own);
    struct orl_window w = f->kind == ORL_SURFACE_POLYGON ? of_polygon(g, facet) : of_ring(f, facet);
    const double margin = 4 * f->offset + g->radius * 0x1p-18;
    for (int i = 0; i < 2; i++) {
        w.low[i] -= margin;
        w.high[i] += margin;
    }
    return w;
}

void orl_window_widen(struct orl_window *window, const struct orl_window *other)
{
    for (int i = 0; i < 4; i++)
        widen(window, orl_window_corner(other, i));
}

static int make_room(struct orl_windows *windows, size_t most)
{
    windows->at = malloc((most + 1) * sizeof *windows->at);
    windows->tree = calloc(1, sizeof *windows->tree);
    return windows->at && windows->tree ? 0 : ORL_ERR_NOMEM;
}

static void add(struct orl_windows *windows, const struct orl_geometry *g, uint32_t facet)
{
    if (orl_facet_kind(g, facet) != ORL_SURFACE_POLYGON)
        windows->all = true;
    else
        windows->at[windows->count++] = orl_window_of(g, facet);
}

int orl_windows_of_ports(struct orl_windows *windows, const struct orl_world *world)
{
    *windows = (struct orl_windows){.all = world->open};
    if (windows->all)
        return 0;
    const int code = make_room(windows, world->n_ports);
    for (size_t i = 0; i < world->n_ports && code == 0; i++)
        add(windows, world->geometry, world->ports[i].facet);
    return code == 0 ? orl_pane_tree_init(windows->tree, windows->at, NULL, windows->count) : code;
}

void orl_windows_done(struct orl_windows *windows)
{
    if (windows->tree)
        orl_pane_tree_done(windows->tree);
    free(windows->tree);
    free(windows->at);
    *windows = (struct orl_windows){.at = NULL};
}

bool orl_window_passed(const struct orl_window *w, struct orl_vec3 origin,
                       struct orl_vec3 direction, double slack, double *ret_distance)
{
    const struct orl_vec3 from = orl_sub(origin, w->corner);
    const double height = orl_dot(from, w->normal), fall = -orl_dot(direction, w->normal);
    if (!(height * fall > 0)) /* it goes away, or along: along within the slack is as good */
        return false;
    const double distance = height / fall, room = slack * distance / fmax(fabs(fall), 1e-3);
    for (int i = 0; i < 2; i++) {
        const double at = orl_dot(from, w->along[i]) + distance * orl_dot(direction, w->along[i]);
        if (at < w->low[i] - room || at > w->high[i] + room)
            return false;
    }
    if (ret_distance)
        *ret_distance = distance;
    return true;
}

struct orl_cone orl_window_cone(const struct orl_window *window, struct orl_vec3 point)
{
    struct orl_vec3 corners[4], axis = {0, 0, 0};
    double least = 1;
    for (int i = 0; i < 4; i++) {
        corners[i] = orl_normalize(orl_sub(orl_window_corner(window, i), point));
        axis = orl_add(axis, corners[i]);
    }
    const double length = orl_length(axis);
    if (!(length > 1e-6)) /* all around the point */
        return (struct orl_cone){{0, 0, 1}, ORL_PI};
    axis = orl_scale(axis, 1 / length);
    for (int i = 0; i < 4; i++)
        least = fmin(least, orl_dot(axis, corners[i]));
    /* A cone about the corners holds the window as long as it is narrower than a half space. */
    return (struct orl_cone){axis, least > 1e-3 ? acos(fmin(least, 1)) : ORL_PI};
}

bool orl_windows_passed(const struct orl_windows *windows, struct orl_vec3 origin,
                        struct orl_vec3 direction, double slack)
{
    return windows->all ||
           orl_pane_tree_passed(windows->tree, windows->at, origin, direction, slack, INFINITY);
}

bool orl_windows_passed_before(const struct orl_windows *windows, struct orl_vec3 origin,
                               struct orl_vec3 direction, double before)
{
    return windows->all ||
           orl_pane_tree_passed(windows->tree, windows->at, origin, direction, 0, before);
}
