#include "annual/panes/port_rects.h"

#include <stdlib.h>

static int allocate_rects(struct orl_port_rects *windows, size_t most)
{
    windows->at = malloc((most + 1) * sizeof *windows->at);
    windows->clear = malloc((most + 1) * sizeof *windows->clear);
    return windows->at && windows->clear ? 0 : ORL_ERR_NOMEM;
}

static bool transmits_straight(const struct orl_material *m)
{
    return m->kind != ORL_MATERIAL_BSDF || m->peak;
}

static void add_port_rect(struct orl_port_rects *windows, const struct orl_lit_scene *lit_scene,
                          uint32_t facet)
{
    if (orl_facet_kind(lit_scene->geometry, facet) != ORL_SURFACE_POLYGON) {
        windows->all = true;
        return;
    }
    const struct orl_bounding_rect window = orl_bounding_rect_of(lit_scene->geometry, facet);
    windows->at[windows->count++] = window;
    if (transmits_straight(&lit_scene->materials[orl_facet_material(lit_scene->geometry, facet)]))
        windows->clear[windows->n_clear++] = window;
}

int orl_port_rects_init(struct orl_port_rects *windows, const struct orl_lit_scene *lit_scene)
{
    *windows = (struct orl_port_rects){.all = lit_scene->open};
    if (windows->all)
        return 0;
    const int code = allocate_rects(windows, lit_scene->n_ports);
    for (size_t i = 0; i < lit_scene->n_ports && code == 0; i++)
        add_port_rect(windows, lit_scene, lit_scene->ports[i].facet);
    return code == 0 ? orl_pane_bvh_init(&windows->tree, windows->clear, NULL, windows->n_clear)
                     : code;
}

void orl_port_rects_done(struct orl_port_rects *windows)
{
    orl_pane_bvh_done(&windows->tree);
    free(windows->at);
    free(windows->clear);
    *windows = (struct orl_port_rects){.at = NULL};
}

bool orl_port_rects_passed(const struct orl_port_rects *windows, struct orl_vec3 origin,
                           struct orl_vec3 direction, double slack)
{
    return windows->all ||
           orl_pane_bvh_passed(&windows->tree, windows->clear, origin, direction, slack, INFINITY);
}

bool orl_port_rects_passed_before(const struct orl_port_rects *windows, struct orl_vec3 origin,
                                  struct orl_vec3 direction, double before)
{
    return windows->all ||
           orl_pane_bvh_passed(&windows->tree, windows->clear, origin, direction, 0, before);
}
