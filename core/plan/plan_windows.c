#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "light/exterior.h"
#include "plan/decide.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

/* ---- Objects outside ------------------------------------------------------------------------- */

/*
 * Tests for objects outside a window: facets that reach beyond the plane of the port's pane.
 * Without them, only domes and suns are visible through the pane. The tests are geometric and check
 * every facet; they do not depend on random rays.
 *
 * pool: polled for cancellation; after it the results are meaningless.
 */

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

/* Fills ret_clear, one entry per port: true if no facet reaches beyond it. Returns false, with all
 * entries false, if there are too many facets to check. */
static bool find_clear_ports(const struct orl_lit_scene *lit_scene,
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

/* Returns the largest share of light that a facet beyond any port reflects. */
static double outdoor_reflectance(const struct orl_lit_scene *lit_scene,
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

/* Returns the largest share of light that a port reflects. */
static double pane_reflectance(const struct orl_lit_scene *lit_scene)
{
    double most = 0;
    for (size_t p = 0; p < lit_scene->n_ports; p++)
        most = fmax(most, reflected_share(&lit_scene->materials[orl_facet_material(
                              lit_scene->geometry, lit_scene->ports[p].facet)]));
    return most;
}

/* Decides on effects of windows: outdoor surfaces, ports that send light, suns that reach in. */

enum { REACH_PATHS = 2048, REACH_BOUNCES = 8, PILOT_PATHS = 2048 };

/* Returns true if a sun faces a pane. Half the disc is added: a sun in the pane's plane is partly
 * in front. */
static bool sun_faces(const struct orl_sun *sun, struct orl_vec3 outward)
{
    const double half = sqrt(fmax(0, 1 - sun->cos_half_angle * sun->cos_half_angle));
    return orl_dot(sun->frame.n, outward) >= -half;
}

/* ---- Exterior -------------------------------------------------------------------------------- */

/* Returns the share of the light at ports, seen from inside, that comes by way of outdoor
 * surfaces. */
static double share_reflected(const struct orl_plan_survey *survey)
{
    struct orl_lit_scene straight = *survey->lit_scene;
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    double all = 0, direct = 0;
    straight.omit.exterior = true;
    for (uint32_t i = 0; i < PILOT_PATHS && lit_scene->n_ports > 0; i++) {
        const struct orl_port *port = &lit_scene->ports[i % lit_scene->n_ports];
        struct orl_random random = orl_random_stream(4, ORL_PURPOSE_PILOT, i), same;
        struct orl_health ignored = {0};
        struct orl_vec3 point, normal;
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        const double a = orl_random_uniform(&random), b = orl_random_uniform(&random);
        const struct orl_vec3 out = orl_hemisphere_about(port->outward, a, b);
        orl_facet_sample(lit_scene->geometry, port->facet, u, &point, &normal);
        point =
            orl_facet_ray_origin(lit_scene->geometry, port->facet, point, normal, port->outward);
        same = random;
        all += port->area *
               orl_luma(orl_exterior_radiance(lit_scene, point, out, orl_mis_pdf_infinite(),
                                              &random, &ignored, NULL));
        direct += port->area *
                  orl_luma(orl_exterior_radiance(&straight, point, out, orl_mis_pdf_infinite(),
                                                 &same, &ignored, NULL));
    }
    return all > 0 ? fmax(0, 1 - direct / all) : 0;
}

static void decide_exterior(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    struct orl_decision *decision = &plan->effects[ORL_EFFECT_EXTERIOR];
    const bool looks = decision->override != ORL_OVERRIDE_FORCE && lit_scene->n_ports > 0;
    double rho = looks && survey->n_clear < lit_scene->n_ports
                     ? outdoor_reflectance(lit_scene, survey->request->pool)
                     : 0;
    if (looks && !(rho > 0) && orl_plan_survey_is_outdoor(survey))
        rho = pane_reflectance(lit_scene);
    const double direct = survey->sun_lx + survey->sky_lx + survey->lamp_lx;
    struct orl_finding finding = {
        .needed = lit_scene->n_ports > 0 && rho > 0,
        .unit = ORL_BOUND_LX,
        .bound = rho > 0 ? rho * (direct + orl_plan_survey_reflected_lx(survey, direct)) : 0,
        .saved_s = (double)plan->photons_global * survey->ray_s};
    if (lit_scene->n_ports == 0) {
        orl_decision_fill(decision, &finding,
                          "the scene has %zu windows, so objects outdoors are lit like all others",
                          lit_scene->n_ports);
        return;
    }
    if (lit_scene->open)
        finding.needed = true;
    if (!looks)
        orl_decision_fill(decision, &finding, "all light in front of the %zu window%s is simulated",
                          lit_scene->n_ports, orl_plural(lit_scene->n_ports));
    else if (rho > 0)
        orl_decision_fill(decision, &finding,
                          "surfaces extend outdoors beyond %zu of %zu window%s and reflect up to "
                          "%.3g %%; they add %.2g %% of the sky's light",
                          lit_scene->n_ports - survey->n_clear, lit_scene->n_ports,
                          orl_plural(lit_scene->n_ports), 100 * rho, 100 * share_reflected(survey));
    else
        orl_decision_fill(decision, &finding,
                          "no reflecting surface lies beyond the plane of any of the %zu window%s",
                          lit_scene->n_ports, orl_plural(lit_scene->n_ports));
    if (!decision->simulated)
        lit_scene->omit.exterior = survey->n_clear < lit_scene->n_ports;
}

/* ---- Ports ----------------------------------------------------------------------------------- */

/* Returns true if a port gets no light: nothing lies beyond its plane, and no dome or sun in front
 * of it. */
static bool is_silent(const struct orl_lit_scene *lit_scene, const struct orl_port *port)
{
    if (!port->clear)
        return false;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        if (sun_faces(&lit_scene->suns[i], port->outward))
            return false;
    for (size_t i = 0; i < lit_scene->n_domes; i++) {
        const struct orl_dome *dome = &lit_scene->domes[i];
        const double sine = sqrt(fmax(0, 1 - dome->cos_half_angle * dome->cos_half_angle));
        if (dome->cos_half_angle < 0 || orl_dot(dome->direction, port->outward) > -sine)
            return false;
    }
    return true;
}

static void decide_ports(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    size_t silent = 0;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        silent += is_silent(lit_scene, &lit_scene->ports[i]);
    const struct orl_finding finding = {
        .needed = silent < lit_scene->n_ports,
        .unit = ORL_BOUND_LX,
        .bound = silent < lit_scene->n_ports ? survey->sun_lx + survey->sky_lx : 0};
    const bool all = plan->effects[ORL_EFFECT_PORTS].override == ORL_OVERRIDE_FORCE;
    const bool some = orl_decision_fill(
        &plan->effects[ORL_EFFECT_PORTS], &finding,
        "%zu of %zu window%s face%s a sky, a sun, or surfaces outside", lit_scene->n_ports - silent,
        lit_scene->n_ports, orl_plural(lit_scene->n_ports),
        lit_scene->n_ports - silent == 1 ? "s" : "");
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        lit_scene->ports[i].silent = !some || (!all && is_silent(lit_scene, &lit_scene->ports[i]));
}

/* ---- Suns ------------------------------------------------------------------------------------ */

/* Returns true if rays from inside find the sun through holes that are too small to make the
 * building open. */
static bool sun_found_inside(const struct orl_lit_scene *lit_scene, struct orl_vec3 sun)
{
    const struct orl_geometry *g = lit_scene->geometry;
    for (uint32_t path = 0; path < REACH_PATHS; path++) {
        const struct orl_port *port = &lit_scene->ports[path % lit_scene->n_ports];
        struct orl_random random = orl_random_stream(5, ORL_PURPOSE_PILOT, path);
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal = orl_neg(port->outward), ignored;
        orl_facet_sample(g, port->facet, u, &point, &ignored);
        point =
            orl_facet_ray_origin(g, port->facet, point, orl_facet_normal(g, port->facet), normal);
        for (int bounce = 0; bounce < REACH_BOUNCES; bounce++) {
            struct orl_hit hit;
            const double a = orl_random_uniform(&random), b = orl_random_uniform(&random);
            const struct orl_vec3 d = orl_hemisphere_about(normal, a, b);
            if (!orl_geometry_intersect(g, point, d, INFINITY, &hit))
                break;
            normal = orl_hit_facing(&hit);
            point = orl_hit_ray_origin(g, &hit, normal);
            if (orl_rgb_max(orl_transmittance(lit_scene, point, sun, INFINITY, true)) > 0)
                return true;
        }
    }
    return false;
}

/*
 * Returns false for a sun behind the planes of all windows if nothing outdoors can send its light
 * in. It lights only the outside, which no sensor or view of the job sees.
 */
static bool can_reach(const struct orl_plan_survey *survey, const struct orl_sun *sun)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    if (!(orl_rgb_max(sun->irradiance) > 0))
        return false;
    if (lit_scene->n_ports == 0 || lit_scene->open || survey->n_clear < lit_scene->n_ports)
        return true;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        if (sun_faces(sun, lit_scene->ports[i].outward))
            return true;
    return orl_plan_survey_is_outdoor(survey) || sun_found_inside(lit_scene, sun->frame.n);
}

static void decide_suns(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    struct orl_decision *decision = &plan->effects[ORL_EFFECT_SUNS];
    struct orl_decision *sun = &plan->effects[ORL_EFFECT_SUN];
    const bool forced =
        decision->override == ORL_OVERRIDE_FORCE || sun->override == ORL_OVERRIDE_FORCE;
    const size_t all = lit_scene->n_suns;
    bool *keep = calloc(all + 1, sizeof *keep);
    size_t kept = all;
    for (size_t i = 0; keep && i < all && !orl_thread_pool_cancelled(survey->request->pool); i++) {
        keep[i] = forced || (decision->override == ORL_OVERRIDE_AUTO &&
                             can_reach(survey, &lit_scene->suns[i]));
        kept -= !keep[i];
    }
    const struct orl_finding finding = {
        .needed = kept > 0,
        .unit = ORL_BOUND_LX,
        .bound = decision->override == ORL_OVERRIDE_SKIP || kept == all ? survey->sun_lx : 0,
        .saved_s = (double)(all - kept) * survey->sensor_rays * survey->ray_s / 3};
    if (keep)
        orl_lit_scene_select_suns(lit_scene, keep);
    free(keep);
    orl_decision_fill(
        decision, &finding,
        "%zu of %zu sun%s %s in front of a window, or visible from a sensor or viewpoint", kept,
        all, orl_plural(all), kept == 1 ? "is" : "are");
    if (kept == 0 && all > 0 && sun->override == ORL_OVERRIDE_AUTO)
        orl_decision_fill(sun, &finding,
                          "none of the %zu sun%s is in front of a window, and no surface outdoors "
                          "reflects sunlight",
                          all, orl_plural(all));
}

void orl_decide_windows(struct orl_plan_survey *survey, struct orl_plan *plan)
{
    struct orl_lit_scene *lit_scene = survey->lit_scene;
    bool *clear = calloc(lit_scene->n_ports + 1, sizeof *clear);
    if (clear && plan->effects[ORL_EFFECT_EXTERIOR].override != ORL_OVERRIDE_FORCE)
        find_clear_ports(lit_scene, survey->request->pool, clear);
    for (size_t i = 0; clear && i < lit_scene->n_ports; i++) {
        lit_scene->ports[i].clear = clear[i];
        survey->n_clear += clear[i];
    }
    free(clear);
    decide_exterior(survey, plan);
    decide_suns(survey, plan);
    decide_ports(survey, plan);
    orl_plan_survey_measure(survey);
}
