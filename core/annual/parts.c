#include "annual/parts.h"

#include <stdlib.h>
#include <string.h>

#include "annual/windows.h"
#include "scene/material/hemisphere.h"
#include "scene/swap.h"

static const struct orl_material *material_of(const struct orl_world *world, uint32_t facet)
{
    return &world->materials[orl_facet_material(world->geometry, facet)];
}

void orl_ports_count(const struct orl_world *world, struct orl_ports_of_parts *ret_counts)
{
    ret_counts->of_none = 0;
    ret_counts->open = world->open;
    memset(ret_counts->of_part, 0, ret_counts->n_parts * sizeof *ret_counts->of_part);
    for (size_t i = 0; i < world->n_ports; i++) {
        const uint32_t part = material_of(world, world->ports[i].facet)->part;
        if (part == ORL_PART_OF_NONE)
            ret_counts->of_none++;
        else if (part > 0 && part <= ret_counts->n_parts)
            ret_counts->of_part[part - 1]++;
    }
}

/* ---- Closing --------------------------------------------------------------------------------- */

/* What a port makes of light that is the same from all directions inside. */
static struct orl_rgb reflectance(const struct orl_world *world, const struct orl_port *port)
{
    enum { SIDE = 8 };
    const struct orl_material *m = material_of(world, port->facet);
    const struct orl_vec3 inward = orl_neg(port->outward);
    const struct orl_hit hit =
        orl_hit_anywhere(orl_facet_normal(world->geometry, port->facet), !port->outside_is_front);
    struct orl_rgb sum = orl_gray(0);
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int row = i / SIDE;
        const struct orl_vec3 light =
            orl_hemisphere_about(inward, (row + 0.5) / SIDE, (i % SIDE + 0.5) / SIDE);
        sum = orl_rgb_add(
            sum, orl_material_albedo(m, &hit, light,
                                     (enum orl_lobes)(ORL_LOBE_DIFFUSE | ORL_LOBE_REFLECTED)));
    }
    return orl_rgb_scale(sum, 1.0 / (SIDE * SIDE));
}

static bool is_shut(const struct orl_world *world, const struct orl_port *port, uint32_t part)
{
    return material_of(world, port->facet)->part != part;
}

/* Glass that lets nothing through, and mirrors as much straight back as the pane did: its own
 * first surface alone would be half of that. */
static struct orl_material blind_glass(const struct orl_world *world, const struct orl_port *port)
{
    const struct orl_material *m = material_of(world, port->facet);
    const struct orl_hit hit = orl_hit_anywhere(port->outward, true);
    const double back =
        sqrt(fmin(orl_luma(orl_material_albedo(m, &hit, port->outward, ORL_LOBE_REFLECTED)), 0.9));
    return (struct orl_material){.kind = ORL_MATERIAL_GLASS, .ior = (1 + back) / (1 - back)};
}

static struct orl_material blind_wall(const struct orl_world *world, const struct orl_port *port)
{
    return (struct orl_material){.kind = ORL_MATERIAL_PLASTIC, .color = reflectance(world, port)};
}

/* BSDFs stay the scene's to free. */
static void shut(struct orl_world *world, const struct orl_port *port, bool *done)
{
    const uint32_t at = orl_facet_material(world->geometry, port->facet);
    struct orl_material *m = &world->materials[at];
    if (done[at])
        return;
    struct orl_material blind = m->kind == ORL_MATERIAL_GLASS || m->kind == ORL_MATERIAL_GLAZING
                                    ? blind_glass(world, port)
                                    : blind_wall(world, port);
    blind.name = m->name;
    blind.part = m->part;
    blind.seen_as = ORL_SEEN_AS_ITSELF;
    blind.sky = -1;
    *m = blind;
    done[at] = true;
}

int orl_ports_close(struct orl_world *world, uint32_t part, int32_t **ret_port_of_facet)
{
    const size_t facets = world->geometry->n_facets;
    int32_t *port_of = malloc((facets + 1) * sizeof *port_of);
    bool *done = calloc(world->n_materials + 1, sizeof *done);
    if (!port_of || !done) {
        free(port_of);
        free(done);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < facets; i++)
        port_of[i] = ORL_NO_PORT;
    size_t kept = 0;
    for (size_t i = 0; i < world->n_ports; i++) {
        const struct orl_port port = world->ports[i];
        if (is_shut(world, &port, part)) {
            shut(world, &port, done);
            continue;
        }
        port_of[port.facet] = (int32_t)kept;
        world->ports[kept++] = port;
    }
    free(done);
    world->n_ports = kept;
    world->port_of_facet = port_of;
    *ret_port_of_facet = port_of;
    orl_images_done(&world->images);
    const int code = orl_images_build(&world->images, world, NULL);
    orl_world_settle(world);
    return code;
}

/* ---- What is by ports ------------------------------------------------------------------------ */

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

/* Polygons by their corners; round things by balls about their ends. */
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
