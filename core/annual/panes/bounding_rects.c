/* Bounding rectangles, the tree that searches them, and the rectangles of ports. */
#include "annual/panes/bounding_rects.h"

#include <stdlib.h>

static void widen_to_corner(struct orl_bounding_rect *w, struct orl_vec3 corner)
{
    const struct orl_vec3 from = orl_sub(corner, w->corner);
    for (int i = 0; i < 2; i++) {
        w->low[i] = fmin(w->low[i], orl_dot(from, w->along[i]));
        w->high[i] = fmax(w->high[i], orl_dot(from, w->along[i]));
    }
}

/* The rectangle is aligned with a side of the polygon's first triangle. */
static struct orl_bounding_rect of_polygon(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    const struct orl_triangle t = orl_triangle_get(g, f->first_triangle);
    const struct orl_vec3 sides[3] = {orl_sub(t.b, t.a), orl_sub(t.c, t.b), orl_sub(t.a, t.c)};
    struct orl_bounding_rect w = {.facet = facet, .corner = t.a, .normal = f->normal};
    /* The side of middle length: the longer leg of a right triangle, never its hypotenuse. */
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
        const struct orl_triangle part = orl_triangle_get(g, orl_facet_triangle(f, i));
        widen_to_corner(&w, part.a);
        widen_to_corner(&w, part.b);
        widen_to_corner(&w, part.c);
    }
    return w;
}

static struct orl_bounding_rect of_ring(const struct orl_facet *f, uint32_t facet)
{
    const struct orl_frame frame = orl_frame_about(f->normal);
    const double r = fmax(f->quadric->radius[0], f->quadric->radius[1]);
    return (struct orl_bounding_rect){.facet = facet,
                                      .corner = f->quadric->center[0],
                                      .normal = f->normal,
                                      .along = {frame.u, frame.v},
                                      .low = {-r, -r},
                                      .high = {r, r}};
}

struct orl_bounding_rect orl_bounding_rect_of(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    struct orl_bounding_rect w =
        f->kind == ORL_SURFACE_POLYGON ? of_polygon(g, facet) : of_ring(f, facet);
    const double margin = 4 * f->offset + g->radius * 0x1p-18;
    for (int i = 0; i < 2; i++) {
        w.low[i] -= margin;
        w.high[i] += margin;
    }
    return w;
}

void orl_bounding_rect_widen(struct orl_bounding_rect *window,
                             const struct orl_bounding_rect *other)
{
    for (int i = 0; i < 4; i++)
        widen_to_corner(window, orl_bounding_rect_corner(other, i));
}

bool orl_bounding_rect_passed(const struct orl_bounding_rect *w, struct orl_vec3 origin,
                              struct orl_vec3 direction, double slack, double *ret_distance)
{
    const struct orl_vec3 from = orl_sub(origin, w->corner);
    const double height = orl_dot(from, w->normal), fall = -orl_dot(direction, w->normal);
    /* The ray points away from the plane, or runs along it, even within the slack. */
    if (!(height * fall > 0))
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

/* Cone of a distant window: around the sphere whose diameter is the rectangle's diagonal. */
static bool find_far_cone(const struct orl_bounding_rect *w, struct orl_vec3 point,
                          struct orl_cone *ret_cone)
{
    const struct orl_vec3 center =
        orl_madd(orl_madd(w->corner, w->along[0], 0.5 * (w->low[0] + w->high[0])), w->along[1],
                 0.5 * (w->low[1] + w->high[1]));
    const double a = w->high[0] - w->low[0], b = w->high[1] - w->low[1];
    const double square = 0.25 * (a * a + b * b);
    const struct orl_vec3 way = orl_sub(center, point);
    const double far = orl_dot(way, way);
    if (!(far > 16 * square))
        return false;
    *ret_cone = (struct orl_cone){orl_scale(way, 1 / sqrt(far)), sqrt(1 - square / far)};
    return true;
}

struct orl_cone orl_bounding_rect_cone(const struct orl_bounding_rect *window,
                                       struct orl_vec3 point)
{
    struct orl_vec3 corners[4], axis = {0, 0, 0};
    struct orl_cone cone = {{0, 0, 1}, -1};
    double least = 1;
    if (find_far_cone(window, point, &cone))
        return cone;
    for (int i = 0; i < 4; i++) {
        corners[i] = orl_normalize(orl_sub(orl_bounding_rect_corner(window, i), point));
        axis = orl_add(axis, corners[i]);
    }
    const double length = orl_length(axis);
    if (!(length > 1e-6)) /* the window surrounds the point */
        return cone;
    axis = orl_scale(axis, 1 / length);
    for (int i = 0; i < 4; i++)
        least = fmin(least, orl_dot(axis, corners[i]));
    /* A cone around the corners contains the window if it is narrower than a half space. */
    return (struct orl_cone){axis, least > 1e-3 ? fmin(least, 1) : -1};
}

enum { MOST_DEPTH = 64 };

/* Solid angle below which one child is drawn. A node of the sun stands for about 0.01 sr, so a pane
 * of this size covers a few of them. */
static const double smallest_split_sr = 0.06;
/* Least survival probability of smaller panes, or groups of panes, in Russian roulette. */
static const double least_chance = 0.25;

/* ---- Building -------------------------------------------------------------------------------- */

struct item {
    struct orl_vec3 low, high;
    double area;
    uint32_t index;
};

static struct orl_vec3 min_corner(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_v3(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
}

static struct orl_vec3 max_corner(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_v3(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

static struct item item_of(const struct orl_bounding_rect *w, size_t index, double strength)
{
    struct item item = {.low = {INFINITY, INFINITY, INFINITY},
                        .high = {-INFINITY, -INFINITY, -INFINITY},
                        .area = (w->high[0] - w->low[0]) * (w->high[1] - w->low[1]) * strength,
                        .index = (uint32_t)index};
    for (int i = 0; i < 4; i++) {
        const struct orl_vec3 corner = orl_bounding_rect_corner(w, i);
        item.low = min_corner(item.low, corner);
        item.high = max_corner(item.high, corner);
    }
    return item;
}

static int compare_centers(const void *a, const void *b, void *axis)
{
    const struct item *x = a, *y = b;
    const int i = *(int *)axis;
    const double p = orl_along(x->low, i) + orl_along(x->high, i);
    const double q = orl_along(y->low, i) + orl_along(y->high, i);
    return p != q ? (p < q ? -1 : 1) : (x->index > y->index) - (x->index < y->index);
}

static struct orl_pane_bvh_node node_about(const struct item *items, size_t n)
{
    struct orl_pane_bvh_node node = {
        .low = items[0].low, .high = items[0].high, .item = UINT32_MAX};
    for (size_t i = 0; i < n; i++) {
        node.low = min_corner(node.low, items[i].low);
        node.high = max_corner(node.high, items[i].high);
        node.area += items[i].area;
    }
    const struct orl_vec3 size = orl_sub(node.high, node.low);
    const double margin = 1e-9 * (orl_length(node.low) + orl_length(node.high));
    const struct orl_vec3 room = orl_v3(margin, margin, margin);
    node.center = orl_madd(node.low, size, 0.5);
    node.radius = 0.5 * orl_length(size) + margin;
    node.low = orl_sub(node.low, room);
    node.high = orl_add(node.high, room);
    return node;
}

/* Builds a subtree. Items are split into equal halves along the longest side of the box, so the
 * depth is logarithmic. */
static void build_subtree(struct orl_pane_bvh *tree, struct item *items, size_t n)
{
    const size_t at = tree->count++;
    struct orl_pane_bvh_node node = node_about(items, n);
    if (n == 1) {
        node.item = items[0].index;
        tree->nodes[at] = node;
        return;
    }
    int axis = 0;
    const struct orl_vec3 size = orl_sub(node.high, node.low);
    for (int i = 1; i < 3; i++)
        axis = orl_along(size, i) > orl_along(size, axis) ? i : axis;
    qsort_r(items, n, sizeof *items, compare_centers, &axis);
    build_subtree(tree, items, n / 2);
    node.second_child = (uint32_t)tree->count;
    build_subtree(tree, items + n / 2, n - n / 2);
    tree->nodes[at] = node;
}

int orl_pane_bvh_init(struct orl_pane_bvh *tree, const struct orl_bounding_rect *panes,
                      const double *strengths, size_t n)
{
    struct item *items = malloc((n + 1) * sizeof *items);
    *tree = (struct orl_pane_bvh){.nodes = malloc((2 * n + 1) * sizeof *tree->nodes)};
    const bool room = items && tree->nodes;
    for (size_t i = 0; room && i < n; i++)
        items[i] = item_of(&panes[i], i, strengths ? strengths[i] : 1);
    if (room && n > 0)
        build_subtree(tree, items, n);
    free(items);
    return room ? 0 : ORL_ERR_NOMEM;
}

void orl_pane_bvh_done(struct orl_pane_bvh *tree)
{
    free(tree->nodes);
    *tree = (struct orl_pane_bvh){.nodes = NULL};
}

/* ---- Rays ------------------------------------------------------------------------------------ */

struct ray {
    struct orl_vec3 origin, direction, inverse; /* inverse: the reciprocal of each coordinate */
};

/* Box test of Williams et al. 2005; a ray within a slab's plane counts as inside it. The margin of
 * the boxes exceeds the rounding of products with the inverse. */
static inline bool ray_meets(const struct orl_pane_bvh_node *node, const struct ray *ray,
                             double before)
{
    double near = 0, far = before;
    for (int i = 0; i < 3; i++) {
        const double o = orl_along(ray->origin, i);
        const double low = orl_along(node->low, i) - o, high = orl_along(node->high, i) - o;
        if (orl_along(ray->direction, i) == 0) {
            if (low > 0 || high < 0)
                return false;
            continue;
        }
        const double a = low * orl_along(ray->inverse, i), b = high * orl_along(ray->inverse, i);
        const double first = a < b ? a : b, last = a < b ? b : a;
        near = first > near ? first : near;
        far = last < far ? last : far;
    }
    return near <= far;
}

/* A cone of rays from a point; its half angle is at most a right angle. */
struct beam {
    struct orl_vec3 origin, axis;
    double cosine, sine; /* cosine and sine of the half angle */
};

/* Returns true if rays of the beam may meet the node's sphere: the cone around the sphere may
 * overlap the beam. */
static bool beam_meets(const struct orl_pane_bvh_node *node, const struct beam *beam)
{
    const struct orl_vec3 way = orl_sub(node->center, beam->origin);
    const double distance = orl_length(way);
    if (distance <= node->radius)
        return true;
    const double sine = node->radius / distance, cosine = sqrt(1 - sine * sine);
    return orl_dot(orl_scale(way, 1 / distance), beam->axis) >=
           beam->cosine * cosine - beam->sine * sine - 1e-9;
}

bool orl_pane_bvh_passed(const struct orl_pane_bvh *tree, const struct orl_bounding_rect *panes,
                         struct orl_vec3 origin, struct orl_vec3 direction, double slack,
                         double before)
{
    const double sine = fmin(slack, 1);
    const struct beam beam = {origin, direction, sqrt(1 - sine * sine), sine};
    const struct ray ray = {origin, direction,
                            orl_v3(1 / direction.x, 1 / direction.y, 1 / direction.z)};
    uint32_t stack[MOST_DEPTH];
    stack[0] = 0;
    for (int depth = tree->count > 0; depth > 0;) {
        const uint32_t at = stack[--depth];
        const struct orl_pane_bvh_node *node = &tree->nodes[at];
        double distance;
        if (!(slack > 0 ? beam_meets(node, &beam) : ray_meets(node, &ray, before)))
            continue;
        if (node->item == UINT32_MAX) {
            stack[depth++] = node->second_child;
            stack[depth++] = at + 1;
        } else if (orl_bounding_rect_passed(&panes[node->item], origin, direction, slack,
                                            &distance) &&
                   distance < before) {
            return true;
        }
    }
    return false;
}

/* ---- Sampling -------------------------------------------------------------------------------- */

/* Returns true if the whole node lies behind the plane of a surface point. */
static bool is_behind(const struct orl_pane_bvh_node *node, struct orl_vec3 point,
                      struct orl_vec3 normal)
{
    const struct orl_vec3 ahead =
        orl_v3(normal.x > 0 ? node->high.x : node->low.x, normal.y > 0 ? node->high.y : node->low.y,
               normal.z > 0 ? node->high.z : node->low.z);
    return orl_dot(orl_sub(ahead, point), normal) <= 0;
}

/* Distance of x from an interval. */
static double distance_outside(double x, double low, double high)
{
    return x < low ? low - x : x > high ? x - high : 0;
}

static double squared_distance(const struct orl_pane_bvh_node *node, struct orl_vec3 p)
{
    const struct orl_vec3 off = orl_v3(distance_outside(p.x, node->low.x, node->high.x),
                                       distance_outside(p.y, node->low.y, node->high.y),
                                       distance_outside(p.z, node->low.z, node->high.z));
    return orl_dot(off, off);
}

/* Estimates the node's share of the view; 0 if it lies behind the surface. */
static double weight_of(const struct orl_pane_bvh_node *node, struct orl_vec3 point,
                        struct orl_vec3 normal)
{
    const struct orl_vec3 way = orl_sub(node->center, point);
    if (is_behind(node, point, normal))
        return 0;
    return node->area / fmax(orl_dot(way, way), node->radius * node->radius);
}

size_t orl_pane_bvh_sample(const struct orl_pane_bvh *tree, struct orl_vec3 point,
                           struct orl_vec3 normal, struct orl_random *random, orl_pane_visit visit,
                           void *ctx)
{
    struct branch {
        uint32_t at;
        double probability;
        /* True once the roulette has been survived: below this node one child is drawn. */
        bool drawn;
    } stack[MOST_DEPTH] = {{0, 1, false}};
    size_t looked = 0;
    for (int depth = tree->count > 0; depth > 0;) {
        struct branch b = stack[--depth];
        const struct orl_pane_bvh_node *node = &tree->nodes[b.at];
        looked++;
        if (is_behind(node, point, normal))
            continue;
        if (!b.drawn) {
            const double enough = smallest_split_sr * squared_distance(node, point);
            const bool large = node->area > enough;
            if (large && node->item == UINT32_MAX) {
                stack[depth++] = (struct branch){node->second_child, b.probability, false};
                stack[depth++] = (struct branch){b.at + 1, b.probability, false};
                continue;
            }
            const double chance =
                large ? 1 : least_chance + (1 - least_chance) * node->area / enough;
            if (chance < 1 && !(orl_random_uniform(random) < chance))
                continue;
            b.probability *= chance;
        }
        if (node->item != UINT32_MAX) {
            visit(ctx, node->item, b.probability);
            continue;
        }
        const double first = weight_of(&tree->nodes[b.at + 1], point, normal);
        const double second = weight_of(&tree->nodes[node->second_child], point, normal);
        if (!(first + second > 0))
            continue;
        const double share = first / (first + second);
        const bool take = share >= 1 || (share > 0 && orl_random_uniform(random) < share);
        stack[depth++] =
            take ? (struct branch){b.at + 1, b.probability * share, true}
                 : (struct branch){node->second_child, b.probability * (1 - share), true};
    }
    return looked;
}

static void add_port_rect(struct orl_port_rects *windows, const struct orl_lit_scene *lit_scene,
                          uint32_t facet)
{
    if (orl_facet_kind(lit_scene->geometry, facet) != ORL_SURFACE_POLYGON) {
        windows->all = true;
        return;
    }
    const struct orl_bounding_rect window = orl_bounding_rect_of(lit_scene->geometry, facet);
    const struct orl_material *m = orl_lit_scene_material_of(lit_scene, facet);
    windows->at[windows->count++] = window;
    if (m->kind != ORL_MATERIAL_BSDF || orl_bsdf_surface_of(m)->peak) /* it transmits straight */
        windows->clear[windows->n_clear++] = window;
}

int orl_port_rects_init(struct orl_port_rects *windows, const struct orl_lit_scene *lit_scene)
{
    *windows = (struct orl_port_rects){.all = lit_scene->open};
    if (windows->all)
        return 0;
    windows->at = calloc(lit_scene->n_ports + 1, sizeof *windows->at);
    windows->clear = calloc(lit_scene->n_ports + 1, sizeof *windows->clear);
    if (!windows->at || !windows->clear)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        add_port_rect(windows, lit_scene, lit_scene->ports[i].facet);
    return orl_pane_bvh_init(&windows->tree, windows->clear, NULL, windows->n_clear);
}

void orl_port_rects_done(struct orl_port_rects *windows)
{
    orl_pane_bvh_done(&windows->tree);
    free(windows->at);
    free(windows->clear);
    *windows = (struct orl_port_rects){.at = NULL};
}

bool orl_port_rects_passed(const struct orl_port_rects *windows, struct orl_vec3 origin,
                           struct orl_vec3 direction, double slack, double before)
{
    return windows->all ||
           orl_pane_bvh_passed(&windows->tree, windows->clear, origin, direction, slack, before);
}
