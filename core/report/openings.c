/* Finds the openings of a scene: clear panes, joined if their ports lie side by side in one plane.
 * Also finds its ground. */
#include "report/report_internal.h"

#include "scene/geometry/instances.h"

static const double widest_bar = 0.3, same_plane = 0.1; /* m */
static const double same_normal = 0.9998;               /* cosine: one degree */
static const double least_level = 0.98481;              /* cosine: 10 degrees */
static const double highest_ground = 0.5;               /* m, above the lowest point of the scene */

/* ---- Names ----------------------------------------------------------------------------------- */

/* Returns true if an instanced surface or its modifier has the name. */
static bool is_name_placed(const struct orl_scene *scene, const char *name)
{
    const struct orl_geometry *const g = scene->geometry;
    for (size_t i = 0; i < g->n_instances; i++)
        for (uint32_t k = 0; k < g->instance[i].prototype->n_facets; k++)
            if (orl_scene_has_name(scene, g->instance[i].first_facet + k, name))
                return true;
    return false;
}

/* Marks facets whose surface or modifier has the name; returns false if nothing has it. */
static bool mark_name(const struct orl_scene *scene, const char *name, bool *marks)
{
    bool met = false;
    for (size_t i = 0; i < scene->geometry->n_facets; i++)
        if (orl_scene_has_name(scene, (uint32_t)i, name))
            met = marks[i] = true;
    return met || is_name_placed(scene, name);
}

static int mark_names(const struct orl_scene *scene, char *const *names, size_t n, bool *marks,
                      struct orl_error *err)
{
    for (size_t i = 0; i < n; i++)
        if (!mark_name(scene, names[i], marks))
            return orl_error_set(err, ORL_ERR_NOT_FOUND,
                                 "the view out names '%.100s', but the scene has no surface or "
                                 "modifier of that name",
                                 names[i]);
    return 0;
}

static bool is_ground(const struct orl_geometry *g, const struct orl_facet *f)
{
    double top = -INFINITY;
    if (!orl_surface_kind_is_flat(f->kind))
        return false;
    if (fabs(f->normal.z) < least_level)
        return false;
    if (f->kind == ORL_SURFACE_RING)
        top = f->quadric->center[0].z + f->quadric->radius[0] * sqrt(1 - f->normal.z * f->normal.z);
    for (uint32_t t = 0; t < f->n_triangles; t++) {
        const struct orl_triangle triangle = orl_triangle_get(g, orl_facet_triangle(f, t));
        top = fmax(top, fmax(triangle.a.z, fmax(triangle.b.z, triangle.c.z)));
    }
    return top <= g->low.z + highest_ground;
}

bool orl_openings_is_ground(const struct orl_openings *openings, uint32_t facet)
{
    const struct orl_scene *const scene = openings->scene;
    const struct orl_view_out_request *const view_out_request = openings->view_out_request;
    struct orl_quadric room;
    if (!orl_facet_is_instanced(scene->geometry, facet))
        return openings->ground[facet];
    if (view_out_request->n_ground == 0) {
        const struct orl_facet f = orl_instance_facet(scene->geometry, facet, &room);
        return is_ground(scene->geometry, &f);
    }
    for (size_t i = 0; i < view_out_request->n_ground; i++)
        if (orl_scene_has_name(scene, facet, view_out_request->ground[i]))
            return true;
    return false;
}

static int mark_facets(const struct orl_view_out_request *view_out_request, struct orl_openings *o,
                       struct orl_error *err)
{
    const struct orl_scene *scene = o->scene;
    const size_t n = scene->geometry->n_facets;
    int code =
        mark_names(scene, view_out_request->openings, view_out_request->n_openings, o->clear, err);
    if (code == 0)
        code =
            mark_names(scene, view_out_request->ground, view_out_request->n_ground, o->ground, err);
    for (size_t i = 0; i < n; i++) {
        const struct orl_material *material = orl_scene_material(scene, i);
        if (view_out_request->n_openings == 0)
            o->clear[i] =
                material->kind == ORL_MATERIAL_GLASS || (material->kind == ORL_MATERIAL_GLAZING &&
                                                         orl_glazing_of(material)->transmitted > 0);
        o->clear[i] = o->clear[i] && orl_material_is_window(material);
        struct orl_facet own;
        if (view_out_request->n_ground == 0)
            o->ground[i] = is_ground(scene->geometry, orl_facet_get_own(scene->geometry, i, &own));
    }
    return code;
}

/* ---- Ports side by side ---------------------------------------------------------------------- */

/* Bounding box of a port, sorted by its lowest x to find neighbours. */
struct pane {
    uint32_t port;
    struct orl_vec3 low, high;
    double plane; /* offset of the plane along the outward normal */
};

static struct pane pane_of(const struct orl_scene *scene, uint32_t index)
{
    const struct orl_port *port = &scene->ports[index];
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(scene->geometry, port->facet, &own);
    struct pane pane = {
        index, {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};
    for (uint32_t t = 0; t < f->n_triangles; t++) {
        const struct orl_triangle triangle =
            orl_triangle_get(scene->geometry, orl_facet_triangle(f, t));
        const struct orl_vec3 corners[3] = {triangle.a, triangle.b, triangle.c};
        for (int i = 0; i < 3; i++) {
            pane.low = orl_v3(fmin(pane.low.x, corners[i].x), fmin(pane.low.y, corners[i].y),
                              fmin(pane.low.z, corners[i].z));
            pane.high = orl_v3(fmax(pane.high.x, corners[i].x), fmax(pane.high.y, corners[i].y),
                               fmax(pane.high.z, corners[i].z));
        }
        pane.plane = orl_dot(triangle.a, port->outward);
    }
    return pane;
}

static int by_low(const void *a, const void *b)
{
    const struct pane *x = a, *y = b;
    if (x->low.x != y->low.x)
        return x->low.x < y->low.x ? -1 : 1;
    return x->port < y->port ? -1 : 1;
}

static bool is_near(const struct pane *a, const struct pane *b)
{
    return a->low.y <= b->high.y + widest_bar && b->low.y <= a->high.y + widest_bar &&
           a->low.z <= b->high.z + widest_bar && b->low.z <= a->high.z + widest_bar &&
           fabs(a->plane - b->plane) <= same_plane;
}

static uint32_t root_of(uint32_t *parents, uint32_t i)
{
    while (parents[i] != i)
        i = parents[i] = parents[parents[i]];
    return i;
}

static int join_panes(struct orl_openings *o, const struct pane *panes, const atomic_bool *cancel,
                      struct orl_error *err)
{
    const struct orl_scene *scene = o->scene;
    for (uint32_t i = 0; i < scene->n_ports; i++)
        o->of_port[i] = i;
    for (size_t i = 0; i < scene->n_ports; i++) {
        if (orl_is_cancelled(cancel))
            return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
        const struct pane *a = &panes[i];
        for (size_t k = i + 1; k < scene->n_ports && panes[k].low.x <= a->high.x + widest_bar;
             k++) {
            const struct pane *b = &panes[k];
            if (is_near(a, b) && orl_dot(scene->ports[a->port].outward,
                                         scene->ports[b->port].outward) >= same_normal)
                o->of_port[root_of(o->of_port, b->port)] = root_of(o->of_port, a->port);
        }
    }
    return 0;
}

/* Numbers the roots from 0, in the order of ports, and stores each port's number. */
static int number_openings(struct orl_openings *o, struct orl_error *err)
{
    uint32_t *number = calloc(o->scene->n_ports + 1, sizeof *number);
    if (!number)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (uint32_t i = 0; i < o->scene->n_ports; i++)
        if (root_of(o->of_port, i) == i)
            number[i] = (uint32_t)o->count++;
    for (uint32_t i = 0; i < o->scene->n_ports; i++)
        /* All roots are resolved before any is replaced by its number. */
        o->of_port[i] = root_of(o->of_port, i);
    for (uint32_t i = 0; i < o->scene->n_ports; i++)
        o->of_port[i] = number[o->of_port[i]];
    free(number);
    return 0;
}

static int find_openings(struct orl_openings *o, const atomic_bool *cancel, struct orl_error *err)
{
    struct pane *panes = calloc(o->scene->n_ports + 1, sizeof *panes);
    if (!panes)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (uint32_t i = 0; i < o->scene->n_ports; i++)
        panes[i] = pane_of(o->scene, i);
    qsort(panes, o->scene->n_ports, sizeof *panes, by_low);
    const int code = join_panes(o, panes, cancel, err);
    free(panes);
    return code < 0 ? code : number_openings(o, err);
}

/* ---- All of it ------------------------------------------------------------------------------- */

int orl_openings_find(const struct orl_view_out_request *view_out_request,
                      const struct orl_scene *scene, const atomic_bool *cancel,
                      struct orl_openings *ret_openings, struct orl_error *err)
{
    const size_t n = scene->geometry->n_facets;
    struct orl_openings o = {.scene = scene,
                             .view_out_request = view_out_request,
                             .clear = calloc(n + 1, sizeof *o.clear),
                             .ground = calloc(n + 1, sizeof *o.ground),
                             .of_port = calloc(scene->n_ports + 1, sizeof *o.of_port)};
    if (!o.clear || !o.ground || !o.of_port) {
        orl_openings_done(&o);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    int code = mark_facets(view_out_request, &o, err);
    if (code == 0)
        code = find_openings(&o, cancel, err);
    if (code < 0)
        orl_openings_done(&o);
    else
        *ret_openings = o;
    return code;
}

void orl_openings_done(struct orl_openings *openings)
{
    free(openings->clear);
    free(openings->ground);
    free(openings->of_port);
    *openings = (struct orl_openings){.count = 0};
}
