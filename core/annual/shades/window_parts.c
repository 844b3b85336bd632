#include "annual/shades/window_parts.h"

#include <string.h>

#include "annual/panes/sun_windows.h"
#include "scene/swap.h"

static const struct orl_material *material_of(const struct orl_world *world, uint32_t facet)
{
    return &world->materials[orl_facet_material(world->geometry, facet)];
}

uint16_t orl_part_of_port(const struct orl_world *world, size_t port, size_t n_groups)
{
    const uint32_t part = material_of(world, world->ports[port].facet)->part;
    return (uint16_t)(part == 0 || part == ORL_PART_OF_NONE ? n_groups : part - 1);
}

/* ---- Surfaces near ports --------------------------------------------------------------------- */

static bool is_by(const struct orl_window *w, struct orl_vec3 p, double slack)
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
                        const struct orl_window *w)
{
    if (f->kind != ORL_SURFACE_POLYGON) {
        const double r = -fmax(f->round->radius[0], f->round->radius[1]);
        const bool two = f->kind == ORL_SURFACE_CYLINDER || f->kind == ORL_SURFACE_TUBE ||
                         f->kind == ORL_SURFACE_CONE || f->kind == ORL_SURFACE_CUP;
        return is_by(w, f->round->center[0], r) && (!two || is_by(w, f->round->center[1], r));
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_of(g, orl_facet_triangle(f, i));
        if (!is_by(w, t.a, 0) || !is_by(w, t.b, 0) || !is_by(w, t.c, 0))
            return false;
    }
    return true;
}

static bool is_near(const struct orl_world *world, uint32_t part, const struct orl_facet *f)
{
    for (size_t i = 0; i < world->n_ports; i++) {
        const uint32_t facet = world->ports[i].facet;
        if (material_of(world, facet)->part != part)
            continue;
        const struct orl_window w = orl_window_of(world->geometry, facet);
        if (facet_is_by(world->geometry, f, &w))
            return true;
    }
    return false;
}

int orl_part_admit(const struct orl_world *world, uint32_t part, const char *name,
                   struct orl_error *err)
{
    for (size_t i = 0; i < world->geometry->n_facets; i++) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_own(world->geometry, i, &own);
        const bool port = world->port_of_facet && world->port_of_facet[i] != ORL_NO_PORT;
        if (port || material_of(world, (uint32_t)i)->part != part || is_near(world, part, f))
            continue;
        const struct orl_surface_label s = orl_scene_label_of(world->scene, (uint32_t)i);
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
