/* Virtual suns: the columns from which an image may be visible, shadow rays to images, and suns
 * that rays hit by chance. */
#include <math.h>

#include "light/path.h"
#include "light/virtual_suns.h"

/* share of the scene's radius: Embree has coordinates as floats */
static const double rounding = 1e-5;

/* A box in the image's frame; axes: u, v (across), n (along). */
struct box {
    double low[3], high[3];
};

static const struct box nothing = {{INFINITY, INFINITY, INFINITY},
                                   {-INFINITY, -INFINITY, -INFINITY}};

static void add_box(struct box *box, const struct box *other)
{
    for (int i = 0; i < 3; i++) {
        box->low[i] = fmin(box->low[i], other->low[i]);
        box->high[i] = fmax(box->high[i], other->high[i]);
    }
}

static void add_point(struct box *box, const struct orl_frame *frame, struct orl_vec3 p)
{
    const double x = orl_dot(frame->u, p), y = orl_dot(frame->v, p), z = orl_dot(frame->n, p);
    add_box(box, &(struct box){{x, y, z}, {x, y, z}});
}

/* State while the boxes of the mirrors' parts are drawn, one mirror after the other. */
struct drawing {
    const struct orl_geometry *geometry;
    const struct orl_frame *frame;
    const bool *shows;
    double margin;
    struct box all;
    struct orl_virtual_sun_columns *columns; /* NULL: the boxes are added to `all` */
};

static int column_of(const struct orl_virtual_sun_columns *columns, int axis, double at)
{
    const double x = (at - columns->low[axis]) * columns->per_unit[axis];
    return x < 0 ? 0 : x >= ORL_VIRTUAL_SUN_COLUMNS ? ORL_VIRTUAL_SUN_COLUMNS - 1 : (int)x;
}

static void draw_part(struct drawing *d, struct box part, double margin)
{
    struct orl_virtual_sun_columns *columns = d->columns;
    for (int i = 0; i < 3; i++) {
        part.low[i] -= margin;
        part.high[i] += margin;
    }
    if (!columns) {
        add_box(&d->all, &part);
        return;
    }
    const int x0 = column_of(columns, 0, part.low[0]), x1 = column_of(columns, 0, part.high[0]);
    const int y0 = column_of(columns, 1, part.low[1]), y1 = column_of(columns, 1, part.high[1]);
    const float far = nextafterf((float)part.high[2], INFINITY);
    for (int y = y0; y <= y1; y++)
        for (int x = x0; x <= x1; x++)
            columns->farthest[y][x] = fmaxf(columns->farthest[y][x], far);
}

static void draw_facet(struct drawing *d, const struct orl_facet *f)
{
    if (f->kind != ORL_SURFACE_POLYGON) {
        struct box part = nothing;
        add_point(&part, d->frame, f->quadric->center[0]);
        draw_part(d, part, fmax(f->quadric->radius[0], f->quadric->radius[1]) + d->margin);
        return;
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(d->geometry, orl_facet_triangle(f, i));
        struct box part = nothing;
        add_point(&part, d->frame, t.a);
        add_point(&part, d->frame, t.b);
        add_point(&part, d->frame, t.c);
        draw_part(d, part, d->margin);
    }
}

static void draw_facets(struct drawing *d)
{
    for (size_t i = 0; i < d->geometry->n_facets; i++) {
        struct orl_facet own;
        if (d->shows[i])
            draw_facet(d, orl_facet_get_own(d->geometry, i, &own));
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
    struct drawing d = {
        .geometry = geometry, .frame = frame, .shows = shows, .margin = margin, .all = nothing};
    for (int y = 0; y < ORL_VIRTUAL_SUN_COLUMNS; y++)
        for (int x = 0; x < ORL_VIRTUAL_SUN_COLUMNS; x++)
            columns->farthest[y][x] = -INFINITY;
    draw_facets(&d);
    for (int i = 0; i < 2; i++) {
        columns->low[i] = d.all.low[i];
        columns->per_unit[i] = ORL_VIRTUAL_SUN_COLUMNS / (d.all.high[i] - d.all.low[i]);
    }
    d.columns = columns;
    if (d.all.high[0] > d.all.low[0])
        draw_facets(&d);
}

/* Shadow rays to the suns' images, and the test whether they have counted the light of a ray that
 * hit a sun by chance. */

enum { MOST_BRANCHES = 16, MOST_STEPS = 256 };

/* ---- Shadow rays ----------------------------------------------------------------------------- */

/* A ray towards an image, or its continuation after mirrors. */
struct chain {
    struct orl_path path;
    int16_t node;
    uint8_t reflections;
    bool outside;
};

struct chains {
    const struct orl_lit_scene *lit_scene;
    bool through_ports;
    int steps;
    uint32_t depth;
    struct chain stack[MOST_BRANCHES];
};

static void push_reflection(struct chains *chains, const struct chain *c, const struct orl_hit *hit,
                            const struct orl_material *m)
{
    const struct orl_lit_scene *lit_scene = chains->lit_scene;
    const struct orl_virtual_suns *images = &lit_scene->images;
    const int16_t class = orl_virtual_suns_class(images, hit->facet);
    const int next = class < 0 ? -1 : orl_virtual_suns_next(images, c->node, class);
    if (next < 0 || c->reflections == ORL_MOST_SUN_REFLECTIONS || chains->depth == MOST_BRANCHES ||
        (c->outside && lit_scene->omit.exterior))
        return;
    struct chain on = *c;
    on.path.weight =
        orl_rgb_mul(c->path.weight, orl_material_mirrored(m, hit, orl_path_back(&c->path)));
    if (!(orl_rgb_max(on.path.weight) > ORL_VIRTUAL_SUN_LEAST))
        return;
    on.path.direction = orl_virtual_sun_reflect(c->path.direction, images->mirrors[class]);
    orl_path_skip_surface(&on.path, lit_scene, hit);
    on.node = (int16_t)next;
    on.reflections++;
    chains->stack[chains->depth++] = on;
}

/* Follows one branch to its end, and pushes the others on the stack. Returns the branch's
 * transmittance if it arrives at the sun, else zero. */
static struct orl_rgb follow_chain(struct chains *chains, struct chain c)
{
    const struct orl_lit_scene *lit_scene = chains->lit_scene;
    const struct orl_rgb none = orl_gray(0);
    while (chains->steps++ < MOST_STEPS) {
        const bool arrives = c.reflections > 0 && lit_scene->images.nodes[c.node].is_sun;
        struct orl_hit hit;
        if (!orl_path_intersect(lit_scene, &c.path, &hit))
            return arrives ? c.path.weight : none;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        const enum orl_port_crossing crossing = orl_lit_scene_crossing(lit_scene, &hit);
        push_reflection(chains, &c, &hit, m);
        if (!orl_path_transmit_straight(&c.path, m, &hit) ||
            (!chains->through_ports && crossing != ORL_CROSSING_NONE))
            return none;
        if (orl_lit_scene_leaves_clear(lit_scene, &hit))
            return arrives ? c.path.weight : none;
        if (crossing != ORL_CROSSING_NONE)
            c.outside = crossing == ORL_CROSSING_OUTWARDS;
        orl_path_skip_surface(&c.path, lit_scene, &hit);
    }
    return none;
}

struct orl_vec3 orl_virtual_sun_sample(const struct orl_lit_scene *lit_scene,
                                       const struct orl_virtual_sun *image, const double u[2])
{
    struct orl_sun disc = lit_scene->suns[image->sun];
    disc.frame = image->frame;
    return orl_sun_sample(&disc, u);
}

struct orl_rgb orl_virtual_sun_transmittance(const struct orl_lit_scene *lit_scene,
                                             struct orl_vec3 origin, struct orl_vec3 direction,
                                             const struct orl_virtual_sun *image,
                                             bool through_ports)
{
    struct chains chains = {.lit_scene = lit_scene, .through_ports = through_ports};
    const size_t node = (size_t)(image - lit_scene->images.nodes);
    struct orl_rgb sum = orl_gray(0);
    if (!orl_virtual_suns_may_show(&lit_scene->images, node, origin))
        return sum;
    chains.stack[chains.depth++] = (struct chain){
        .path = orl_path_from(origin, direction), .node = (int16_t)node, .outside = !through_ports};
    while (chains.depth > 0) {
        const struct chain c = chains.stack[--chains.depth];
        sum = orl_rgb_add(sum, follow_chain(&chains, c));
    }
    return sum;
}

/* ---- Suns hit by chance ---------------------------------------------------------------------- */

void orl_mirror_history_add(struct orl_mirror_history *history,
                            const struct orl_virtual_suns *images, uint32_t facet)
{
    const int16_t class = orl_virtual_suns_class(images, facet);
    if (history->reflections == ORL_MOST_SUN_REFLECTIONS || class < 0) {
        history->left_classes = true;
        return;
    }
    history->classes[history->reflections++] = class;
}

/* Returns true if the mirrors of a history lead from the node to the sun itself. */
static bool leads_to_sun(const struct orl_virtual_suns *images, size_t node,
                         const struct orl_mirror_history *history)
{
    int at = (int)node;
    for (uint8_t i = 0; i < history->reflections && at >= 0; i++)
        at = orl_virtual_suns_next(images, at, history->classes[i]);
    return at >= 0 && images->nodes[at].is_sun;
}

bool orl_virtual_suns_counted(const struct orl_lit_scene *lit_scene,
                              const struct orl_mirror_history *history)
{
    const struct orl_virtual_suns *images = &lit_scene->images;
    if (history->left_classes)
        return false;
    for (size_t i = 0; i < images->n_nodes; i++) {
        const struct orl_virtual_sun *image = &images->nodes[i];
        /* The disc, widened by the tolerance of a class. */
        const double nearest = lit_scene->suns[image->sun].cos_half_angle - 1e-5;
        if (image->shown && orl_dot(image->frame.n, history->start) > nearest &&
            leads_to_sun(images, i, history))
            return true;
    }
    return false;
}
