/* Scene data that all paths read, and the window groups of its ports. */
#include "annual/year/annual_scene.h"

#include <stdlib.h>
#include <string.h>

#include "annual/panes/bounding_rects.h"
#include "scene/surfaces.h"

uint16_t orl_window_group_of_port(const struct orl_lit_scene *lit_scene, size_t port,
                                  size_t n_groups)
{
    const uint32_t window_group =
        orl_lit_scene_material_of(lit_scene, lit_scene->ports[port].facet)->window_group;
    return (uint16_t)(window_group == 0 || window_group == ORL_WINDOW_GROUP_NONE
                          ? n_groups
                          : window_group - 1);
}

/* ---- Surfaces near ports --------------------------------------------------------------------- */

static bool is_by(const struct orl_bounding_rect *w, struct orl_vec3 p, double slack)
{
    const struct orl_vec3 from = orl_sub(p, w->corner);
    const double reach =
        0.5 * fmax(w->high[0] - w->low[0], w->high[1] - w->low[1]) * (1 + 1e-9) + slack;
    if (fabs(orl_dot(from, w->normal)) > reach)
        return false;
    for (int i = 0; i < 2; i++) {
        const double at = orl_dot(from, w->along[i]);
        if (at < w->low[i] - reach || at > w->high[i] + reach)
            return false;
    }
    return true;
}

/* Polygons are tested by their corners, round surfaces by spheres around their ends. */
static bool facet_is_by(const struct orl_geometry *g, const struct orl_facet *f,
                        const struct orl_bounding_rect *w)
{
    if (f->kind != ORL_SURFACE_POLYGON) {
        const double r = -fmax(f->quadric->radius[0], f->quadric->radius[1]);
        const bool two = f->kind == ORL_SURFACE_CYLINDER || f->kind == ORL_SURFACE_TUBE ||
                         f->kind == ORL_SURFACE_CONE || f->kind == ORL_SURFACE_CUP;
        return is_by(w, f->quadric->center[0], r) && (!two || is_by(w, f->quadric->center[1], r));
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        if (!is_by(w, t.a, 0) || !is_by(w, t.b, 0) || !is_by(w, t.c, 0))
            return false;
    }
    return true;
}

static bool is_near(const struct orl_lit_scene *lit_scene, uint32_t window_group,
                    const struct orl_facet *f)
{
    for (size_t i = 0; i < lit_scene->n_ports; i++) {
        const uint32_t facet = lit_scene->ports[i].facet;
        if (orl_lit_scene_material_of(lit_scene, facet)->window_group != window_group)
            continue;
        const struct orl_bounding_rect w = orl_bounding_rect_of(lit_scene->geometry, facet);
        if (facet_is_by(lit_scene->geometry, f, &w))
            return true;
    }
    return false;
}

int orl_window_group_check_near(const struct orl_lit_scene *lit_scene, uint32_t window_group,
                                const char *name, struct orl_error *err)
{
    for (size_t i = 0; i < lit_scene->geometry->n_facets; i++) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get_own(lit_scene->geometry, i, &own);
        const bool port = lit_scene->port_of_facet && lit_scene->port_of_facet[i] != ORL_NO_PORT;
        if (port || orl_lit_scene_material_of(lit_scene, i)->window_group != window_group ||
            is_near(lit_scene, window_group, f))
            continue;
        const struct orl_surface_label s = orl_scene_label_of(lit_scene->scene, (uint32_t)i);
        orl_error_set(err, ORL_ERR_UNSUPPORTED,
                      "the surface '%.100s' of '%.100s' is not near a window of that group, so "
                      "light cannot be separated by group",
                      s.name, name);
        orl_error_at(err, s.file, s.line, NULL);
        orl_error_hint(err, "keep it in the scene in all states, or use fewer states, so that each "
                            "combination can have its own run");
        return ORL_ERR_UNSUPPORTED;
    }
    return 0;
}

/* Photons of the sun map: default totals without and with BSDF panes, and the least per node. */
enum { PHOTONS = 300000, BSDF_PANE_PHOTONS = 800000, LEAST_PHOTONS = 512 };

/* Returns true if some port is a BSDF pane. */
static bool has_bsdf_panes(const struct orl_lit_scene *lit_scene)
{
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        if (orl_lit_scene_material_of(lit_scene, lit_scene->ports[i].facet)->kind ==
            ORL_MATERIAL_BSDF)
            return true;
    return false;
}

/* asked: total of photons; 0: a default that depends on the scene. */
static uint32_t photons_of_node(const struct orl_lit_scene *lit_scene, size_t n_nodes,
                                uint32_t asked)
{
    const double all = asked > 0 ? asked : has_bsdf_panes(lit_scene) ? BSDF_PANE_PHOTONS : PHOTONS;
    return (uint32_t)fmax(all / fmax((double)n_nodes, 1), LEAST_PHOTONS);
}

double orl_annual_scene_map_core_s(const struct orl_annual_request *request, size_t n_nodes)
{
    /* Time per photon, to the first surface inside, and with interreflection. Measured in an office
     * through glass and through a BSDF pane: 0.6 and 0.64 us, 1.9 and 2.0 us. */
    const double first_s = 0.7e-6, whole_s = 2e-6;
    const double asked = request->photons > 0 ? request->photons : BSDF_PANE_PHOTONS;
    const double photons = fmax(asked, (double)LEAST_PHOTONS * (double)n_nodes);
    return photons * (request->technique == ORL_ANNUAL_PRECOMPUTED ? whole_s : first_s);
}

int orl_annual_scene_init(struct orl_annual_scene *scene, struct orl_thread_pool *pool)
{
    const struct orl_lit_scene *lit_scene = scene->lit_scene;
    orl_sobol_init(&scene->sobol);
    int code = orl_direction_sampler_init(&scene->sampler, lit_scene, &scene->sobol, pool);
    if (code == 0)
        code = orl_port_rects_init(&scene->ports, lit_scene);
    if (code == 0)
        code = orl_mirrors_init(&scene->mirrors, lit_scene, &scene->ports);
    if (code == 0)
        code = orl_sun_grid_subsets_init(&scene->subsets, scene->nodes, scene->n_nodes,
                                         scene->nodes_per_circle);
    if (code < 0 || scene->n_window_groups == 1)
        return code;
    uint16_t *of_port = malloc((lit_scene->n_ports + 1) * sizeof *of_port);
    for (size_t i = 0; of_port && i < lit_scene->n_ports; i++)
        of_port[i] = orl_window_group_of_port(lit_scene, i, scene->n_window_groups - 1);
    scene->window_group_of_port = of_port;
    return of_port ? 0 : ORL_ERR_NOMEM;
}

struct orl_sun_map_request orl_annual_scene_map_request(const struct orl_annual_scene *scene,
                                                        const struct orl_annual_request *request)
{
    return (struct orl_sun_map_request){
        .lit_scene = scene->lit_scene,
        .sobol = &scene->sobol,
        .nodes = scene->nodes,
        .n_nodes = scene->n_nodes,
        .seed = request->seed,
        .photons = photons_of_node(scene->lit_scene, scene->n_nodes, request->photons),
        .of_beam = scene->window_group_of_port ? LEAST_PHOTONS : 0,
        .window_group_of_port = scene->window_group_of_port,
        .interreflection = scene->map_interreflection};
}

void orl_annual_scene_done(struct orl_annual_scene *scene)
{
    orl_direction_sampler_done(&scene->sampler);
    orl_port_rects_done(&scene->ports);
    orl_mirrors_done(&scene->mirrors);
    orl_sun_grid_subsets_done(&scene->subsets);
    orl_sun_map_free(scene->map);
    free(scene->window_group_of_port);
}
