#include "annual/shades/window_group_ports.h"

#include <string.h>

#include "annual/panes/bounding_rects.h"
#include "scene/material_override.h"

static const struct orl_material *material_of(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    return &lit_scene->materials[orl_facet_material(lit_scene->geometry, facet)];
}

uint16_t orl_window_group_of_port(const struct orl_lit_scene *lit_scene, size_t port,
                                  size_t n_groups)
{
    const uint32_t window_group =
        material_of(lit_scene, lit_scene->ports[port].facet)->window_group;
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
        if (material_of(lit_scene, facet)->window_group != window_group)
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
        if (port || material_of(lit_scene, (uint32_t)i)->window_group != window_group ||
            is_near(lit_scene, window_group, f))
            continue;
        const struct orl_surface_label s = orl_scene_label_of(lit_scene->scene, (uint32_t)i);
        orl_error_set(err, ORL_ERR_UNSUPPORTED,
                      "the surface '%.100s' of '%.100s' is not by a window of that group: light of "
                      "several groups is not the sum of theirs then",
                      s.name, name);
        orl_error_at(err, s.file, s.line, NULL);
        orl_error_hint(err, "leave it in the scene, or have so few states that each combination of "
                            "them can be a run");
        return ORL_ERR_UNSUPPORTED;
    }
    return 0;
}
