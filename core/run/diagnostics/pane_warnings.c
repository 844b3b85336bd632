/* Warnings about panes: those on an opaque surface, and BSDF panes whose front is outdoors. */
#include <math.h>
#include <stdio.h>

#include <oriel/bsdf/bsdf.h>

#include "base/sampling/sampling.h"
#include "run/cache/scene_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "scene/built/scene.h"
#include "scene/material/scatter.h"

/* Finds panes that lie on an opaque surface, such as panes drawn before a wall without an
 * opening. */

enum { POINTS = 8, MOST_PANES = 20000 };
/* A surface within this share of the pane's size (the root of its area) lies on it. */
static const double on_it = 5e-4;
static const double parallel = 0.99;

struct covered {
    size_t count;
    uint32_t pane, surface; /* the first such pane, and its surface */
    double distance;
};

/* Returns true for panes that must not lie on a surface. Solids may, and BSDFs with a thickness
 * stand for what lies behind them. */
static bool is_pane(const struct orl_scene *scene, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(scene->geometry, facet, &own);
    const struct orl_material *m = orl_scene_material(scene, facet);
    return f->kind == ORL_SURFACE_POLYGON && f->area > 0 && orl_material_is_window(m) &&
           m->kind != ORL_MATERIAL_DIELECTRIC && m->kind != ORL_MATERIAL_PRISM &&
           orl_material_thickness(m) == 0;
}

/* Returns true if an opaque surface lies on a pane at a point of the pane. */
static bool is_covered_at(const struct orl_scene *scene, uint32_t pane, struct orl_vec3 point,
                          struct orl_vec3 direction, struct orl_hit *ret_hit)
{
    const struct orl_geometry *g = scene->geometry;
    const struct orl_vec3 normal = orl_facet_normal(g, pane);
    const double reach = on_it * sqrt(orl_facet_area(g, pane));
    const struct orl_vec3 start = orl_facet_ray_origin(g, pane, point, normal, direction);
    return orl_geometry_intersect(g, start, direction, reach, ret_hit) &&
           !orl_material_is_window(orl_scene_material(scene, ret_hit->facet)) &&
           fabs(orl_dot(ret_hit->normal, normal)) > parallel;
}

/* Returns true if opaque surfaces cover one side of a pane at all points that are tried. */
static bool is_covered(const struct orl_scene *scene, uint32_t pane, struct orl_hit *ret_hit,
                       double *ret_distance)
{
    const struct orl_geometry *g = scene->geometry;
    const struct orl_vec3 normal = orl_facet_normal(g, pane);
    for (int side = 0; side < 2; side++) {
        struct orl_random random = orl_random_stream(4, ORL_PURPOSE_PILOT, pane);
        const struct orl_vec3 direction = side == 0 ? normal : orl_neg(normal);
        bool covered = true;
        for (int i = 0; i < POINTS && covered; i++) {
            const double first = orl_random_uniform(&random);
            const double u[2] = {first, orl_random_uniform(&random)};
            struct orl_vec3 point, unused;
            orl_facet_sample(g, pane, u, &point, &unused);
            covered = is_covered_at(scene, pane, point, direction, ret_hit);
            if (covered)
                *ret_distance = fabs(orl_dot(orl_sub(ret_hit->point, point), normal));
        }
        if (covered)
            return true;
    }
    return false;
}

static void find_covered_panes(const struct orl_scene *scene, struct covered *found)
{
    size_t panes = 0;
    for (uint32_t i = 0; i < scene->geometry->n_facets && panes < MOST_PANES; i++) {
        struct orl_hit hit;
        double distance = 0;
        if (!is_pane(scene, i))
            continue;
        panes++;
        if (!is_covered(scene, i, &hit, &distance) || found->count++ > 0)
            continue;
        found->pane = i;
        found->surface = hit.facet;
        found->distance = distance;
    }
}

void orl_run_warn_of_covered_panes(struct orl_run_state *state)
{
    const struct orl_scene *scene = state->scene;
    struct covered found = {.count = 0};
    char others[48] = "";
    find_covered_panes(scene, &found);
    if (found.count == 0)
        return;
    const struct orl_surface_label pane = orl_scene_label_of(scene, found.pane);
    const struct orl_surface_label surface = orl_scene_label_of(scene, found.surface);
    if (found.count > 1)
        snprintf(others, sizeof others, " (as on %zu other panes)", found.count - 1);
    orl_run_warn(
        state,
        "the opaque surface '%.100s' (%.200s:%d) covers the whole pane '%.100s' (%.200s:%d) at a "
        "distance of %.2g%s: no light gets through; cut a hole for the pane",
        surface.name, surface.file, surface.line, pane.name, pane.file, pane.line, found.distance,
        others);
}

/* Finds BSDF panes whose front faces outdoors. By Radiance's convention the front of a window faces
 * the room. */

enum { DIRECTIONS = 16 }; /* number of azimuths, and of steps in the square of the sine */
/* Tolerated differences: of the transmittance, relative to it, and of the reflectance. */
static const double small_transmitted = 0.05, small_reflected = 0.05;

/* Returns the direction, in the frame of the data, that replaces a direction when the pane is
 * turned about its up direction. */
static struct orl_vec3 turned(struct orl_vec3 in)
{
    return orl_v3(-in.x, in.y, -in.z);
}

/* Returns true if a BSDF transmits or reflects other light when its pane is turned round. */
static bool differs_when_turned(const struct orl_bsdf *bsdf)
{
    double transmitted = 0, transmitted_off = 0, reflected_off = 0;
    for (int i = 0; i < DIRECTIONS; i++)
        for (int k = 0; k < DIRECTIONS; k++) {
            const struct orl_vec3 in =
                orl_hemisphere_point((i + 0.5) / DIRECTIONS, (k + 0.5) / DIRECTIONS);
            const double t = orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT));
            const double u = orl_luma(orl_bsdf_albedo(bsdf, turned(in), ORL_BSDF_TRANSMIT));
            const double r = orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_REFLECT));
            const double s = orl_luma(orl_bsdf_albedo(bsdf, turned(in), ORL_BSDF_REFLECT));
            transmitted += (t + u) / 2;
            transmitted_off += fabs(t - u);
            reflected_off += fabs(r - s);
        }
    return transmitted_off > small_transmitted * transmitted ||
           reflected_off > small_reflected * DIRECTIONS * DIRECTIONS;
}

void orl_run_warn_of_turned_panes(struct orl_run_state *state)
{
    const struct orl_scene *scene = state->scene;
    const struct orl_bsdf *last = NULL;
    bool differs = false;
    size_t count = 0;
    uint32_t first = 0;
    char others[48] = "";
    for (size_t i = 0; i < scene->n_ports; i++) {
        const struct orl_material *m = orl_scene_material(scene, scene->ports[i].facet);
        if (!scene->ports[i].outside_is_front || m->kind != ORL_MATERIAL_BSDF)
            continue;
        if (orl_material_bsdf(m) != last)
            differs = differs_when_turned(orl_material_bsdf(m));
        last = orl_material_bsdf(m);
        if (differs && count++ == 0)
            first = scene->ports[i].facet;
    }
    if (count == 0)
        return;
    const struct orl_surface_label pane = orl_scene_label_of(scene, first);
    if (count > 1)
        snprintf(others, sizeof others, " (as on %zu other panes)", count - 1);
    orl_run_warn(
        state,
        "the BSDF pane '%.100s' (%.200s:%d) has its front outdoors%s: Radiance and Oriel use the "
        "front as the room side of the data, so the exterior side is indoors here; if this is not "
        "intended, reverse the order of the corners, or exchange front and back in the BSDF file",
        pane.name, pane.file, pane.line, others);
}
