#include "plan/outdoors.h"

#include "scene/geometry/instances.h"
#include "scene/material/bounds.h"

/* Limit of facets times port planes; beyond it the test would take longer than it may save. */
static const double most_tests = 2e7;
/* Tolerance relative to the scene's size: a smaller distance counts as within the plane. Rays are
 * floats. */
static const double in_plane = 1e-7;

static bool may_continue(const struct orl_thread_pool *pool, size_t facet)
{
    return facet % 4096 != 0 || !orl_thread_pool_cancelled(pool);
}

static double box_extent(struct orl_vec3 low, struct orl_vec3 high, struct orl_vec3 d)
{
    return fmax(low.x * d.x, high.x * d.x) + fmax(low.y * d.y, high.y * d.y) +
           fmax(low.z * d.z, high.z * d.z);
}

/* Returns the extent of a facet in a direction; for a curved one, an upper bound. */
static double facet_extent(const struct orl_geometry *g, const struct orl_facet *f,
                           struct orl_vec3 d)
{
    double most = -INFINITY;
    switch (f->kind) {
    case ORL_SURFACE_POLYGON:
        for (uint32_t i = 0; i < f->n_triangles; i++) {
            const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
            most = fmax(most, fmax(orl_dot(t.a, d), fmax(orl_dot(t.b, d), orl_dot(t.c, d))));
        }
        return most;
    case ORL_SURFACE_CYLINDER:
    case ORL_SURFACE_TUBE:
        return fmax(orl_dot(f->quadric->center[0], d), orl_dot(f->quadric->center[1], d)) +
               f->quadric->radius[0];
    case ORL_SURFACE_CONE:
    case ORL_SURFACE_CUP:
        return fmax(orl_dot(f->quadric->center[0], d) + f->quadric->radius[0],
                    orl_dot(f->quadric->center[1], d) + f->quadric->radius[1]);
    case ORL_SURFACE_SPHERE:
    case ORL_SURFACE_BUBBLE:
        return orl_dot(f->quadric->center[0], d) + f->quadric->radius[0];
    case ORL_SURFACE_RING:
        return orl_dot(f->quadric->center[0], d) + f->quadric->radius[1];
    }
    return INFINITY;
}

/* Returns the outer plane of a port's pane. */
static double plane_of(const struct orl_lit_scene *lit_scene, const struct orl_port *port)
{
    struct orl_facet own;
    return facet_extent(lit_scene->geometry,
                        orl_facet_get_own(lit_scene->geometry, port->facet, &own), port->outward);
}

/* Tests a facet of one of the scene's two geometries: that for light, or that for views. */
static bool reaches_beyond(const struct orl_geometry *g, size_t facet, struct orl_vec3 outward,
                           double plane)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    return f->area > 0 && facet_extent(g, f, outward) > plane + in_plane * g->radius;
}

/* Tests a placed instance by its bounding box. */
static bool is_instance_beyond(const struct orl_geometry *g, const struct orl_instance *instance,
                               struct orl_vec3 outward, double plane)
{
    return box_extent(instance->low, instance->high, outward) > plane + in_plane * g->radius;
}

static bool is_clear(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                     const struct orl_thread_pool *pool)
{
    const struct orl_geometry *g = lit_scene->geometry;
    const double plane = plane_of(lit_scene, port);
    if (box_extent(g->low, g->high, port->outward) <= plane + in_plane * g->radius)
        return true;
    for (size_t i = 0; i < g->n_facets && may_continue(pool, i); i++)
        if (reaches_beyond(g, i, port->outward, plane) ||
            (lit_scene->seen && reaches_beyond(lit_scene->seen->geometry, i, port->outward, plane)))
            return false;
    for (size_t i = 0; i < g->n_instances; i++)
        if (is_instance_beyond(g, &g->instance[i], port->outward, plane))
            return false;
    return true;
}

/* Returns the number of tests per port; a facet counts as one, or as a quarter of its triangles. */
static size_t count_tests(const struct orl_geometry *g)
{
    const size_t of_triangles = orl_geometry_triangles_end(g) / 4;
    size_t n = of_triangles > g->n_facets ? of_triangles : g->n_facets;
    n += g->n_instances * (g->n_prototypes + 1);
    for (size_t i = 0; i < g->n_prototypes; i++)
        n += g->prototypes[i]->n_facets;
    return n;
}

/* Finds an earlier port in the same plane, which has the same outside. */
static bool same_outside(const struct orl_lit_scene *lit_scene, size_t port, size_t *ret_same)
{
    const struct orl_port *p = &lit_scene->ports[port];
    for (size_t i = 0; i < port; i++) {
        const struct orl_port *q = &lit_scene->ports[i];
        if (orl_dot(p->outward, q->outward) == 1 &&
            plane_of(lit_scene, p) == plane_of(lit_scene, q)) {
            *ret_same = i;
            return true;
        }
    }
    return false;
}

bool orl_outdoors_find_clear(const struct orl_lit_scene *lit_scene,
                             const struct orl_thread_pool *pool, bool *ret_clear)
{
    const double facets = (double)count_tests(lit_scene->geometry), most = most_tests;
    double tests = 0;
    for (size_t i = 0; i < lit_scene->n_ports; i++) {
        size_t same;
        tests += (double)i;
        if (same_outside(lit_scene, i, &same)) {
            ret_clear[i] = ret_clear[same];
            continue;
        }
        tests += facets;
        if (tests > most) {
            for (size_t k = 0; k < lit_scene->n_ports; k++)
                ret_clear[k] = false;
            return false;
        }
        ret_clear[i] = is_clear(lit_scene, &lit_scene->ports[i], pool);
    }
    return true;
}

static double reflected_share(const struct orl_material *m)
{
    const enum orl_lobes back = (enum orl_lobes)(ORL_LOBE_DIFFUSE | ORL_LOBE_REFLECTED);
    const double most = fmax(orl_material_max_albedo(m, true, 0.5, back),
                             orl_material_max_albedo(m, false, 0.5, back));
    return orl_material_emits(m) ? fmax(most, 1) : most;
}

/* Returns the largest reflectance of a prototype's facets, if a placement of it reaches beyond. */
static double reflected_share_placed(const struct orl_lit_scene *lit_scene,
                                     const struct orl_geometry *prototype, struct orl_vec3 outward,
                                     double plane)
{
    const struct orl_geometry *const g = lit_scene->geometry;
    bool beyond = false;
    double most = 0;
    for (size_t i = 0; i < g->n_instances && !beyond; i++)
        beyond = g->instance[i].prototype == prototype &&
                 is_instance_beyond(g, &g->instance[i], outward, plane);
    for (size_t i = 0; i < prototype->n_facets && beyond; i++)
        most = fmax(most, reflected_share(&lit_scene->materials[orl_facet_material(prototype, i)]));
    return most;
}

double orl_outdoors_reflectance(const struct orl_lit_scene *lit_scene,
                                const struct orl_thread_pool *pool)
{
    const struct orl_geometry *g = lit_scene->geometry;
    double most = 0, tests = 0;
    for (size_t p = 0; p < lit_scene->n_ports; p++) {
        const struct orl_port *port = &lit_scene->ports[p];
        const double plane = plane_of(lit_scene, port);
        if (port->clear)
            continue;
        tests += (double)count_tests(g);
        if (tests > most_tests)
            return 1;
        for (size_t i = 0; i < g->n_prototypes; i++)
            most = fmax(most,
                        reflected_share_placed(lit_scene, g->prototypes[i], port->outward, plane));
        for (size_t i = 0; i < g->n_facets && may_continue(pool, i); i++)
            if (reaches_beyond(g, i, port->outward, plane))
                most = fmax(most, reflected_share(&lit_scene->materials[orl_facet_material(g, i)]));
    }
    return most;
}

double orl_panes_reflectance(const struct orl_lit_scene *lit_scene)
{
    double most = 0;
    for (size_t p = 0; p < lit_scene->n_ports; p++)
        most = fmax(most, reflected_share(&lit_scene->materials[orl_facet_material(
                              lit_scene->geometry, lit_scene->ports[p].facet)]));
    return most;
}
