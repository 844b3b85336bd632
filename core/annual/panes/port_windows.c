#include "annual/panes/port_windows.h"

#include <stdlib.h>

static int make_room(struct orl_windows *windows, size_t most)
{
    windows->at = malloc((most + 1) * sizeof *windows->at);
    windows->clear = malloc((most + 1) * sizeof *windows->clear);
    return windows->at && windows->clear ? 0 : ORL_ERR_NOMEM;
}

static bool lets_rays_pass(const struct orl_material *m)
{
    return m->kind != ORL_MATERIAL_BSDF || m->peak;
}

static void add_window(struct orl_windows *windows, const struct orl_world *world, uint32_t facet)
{
    if (orl_facet_kind(world->geometry, facet) != ORL_SURFACE_POLYGON) {
        windows->all = true;
        return;
    }
    const struct orl_window window = orl_window_of(world->geometry, facet);
    windows->at[windows->count++] = window;
    if (lets_rays_pass(&world->materials[orl_facet_material(world->geometry, facet)]))
        windows->clear[windows->n_clear++] = window;
}

int orl_windows_of_ports(struct orl_windows *windows, const struct orl_world *world)
{
    *windows = (struct orl_windows){.all = world->open};
    if (windows->all)
        return 0;
    const int code = make_room(windows, world->n_ports);
    for (size_t i = 0; i < world->n_ports && code == 0; i++)
        add_window(windows, world, world->ports[i].facet);
    return code == 0 ? orl_pane_tree_init(&windows->tree, windows->clear, NULL, windows->n_clear)
                     : code;
}

void orl_windows_done(struct orl_windows *windows)
{
    orl_pane_tree_done(&windows->tree);
    free(windows->at);
    free(windows->clear);
    *windows = (struct orl_windows){.at = NULL};
}

bool orl_windows_passed(const struct orl_windows *windows, struct orl_vec3 origin,
                        struct orl_vec3 direction, double slack)
{
    return windows->all ||
           orl_pane_tree_passed(&windows->tree, windows->clear, origin, direction, slack, INFINITY);
}

bool orl_windows_passed_before(const struct orl_windows *windows, struct orl_vec3 origin,
                               struct orl_vec3 direction, double before)
{
    return windows->all ||
           orl_pane_tree_passed(&windows->tree, windows->clear, origin, direction, 0, before);
}
