#include "annual/port_windows.h"

#include <stdlib.h>

static int make_room(struct orl_windows *windows, size_t most)
{
    windows->at = malloc((most + 1) * sizeof *windows->at);
    return windows->at ? 0 : ORL_ERR_NOMEM;
}

static void add(struct orl_windows *windows, const struct orl_geometry *g, uint32_t facet)
{
    if (orl_facet_kind(g, facet) != ORL_SURFACE_POLYGON)
        windows->all = true;
    else
        windows->at[windows->count++] = orl_window_of(g, facet);
}

int orl_windows_of_ports(struct orl_windows *windows, const struct orl_world *world)
{
    *windows = (struct orl_windows){.all = world->open};
    if (windows->all)
        return 0;
    const int code = make_room(windows, world->n_ports);
    for (size_t i = 0; i < world->n_ports && code == 0; i++)
        add(windows, world->geometry, world->ports[i].facet);
    return code == 0 ? orl_pane_tree_init(&windows->tree, windows->at, NULL, windows->count) : code;
}

void orl_windows_done(struct orl_windows *windows)
{
    orl_pane_tree_done(&windows->tree);
    free(windows->at);
    *windows = (struct orl_windows){.at = NULL};
}

bool orl_windows_passed(const struct orl_windows *windows, struct orl_vec3 origin,
                        struct orl_vec3 direction, double slack)
{
    return windows->all ||
           orl_pane_tree_passed(&windows->tree, windows->at, origin, direction, slack, INFINITY);
}

bool orl_windows_passed_before(const struct orl_windows *windows, struct orl_vec3 origin,
                               struct orl_vec3 direction, double before)
{
    return windows->all ||
           orl_pane_tree_passed(&windows->tree, windows->at, origin, direction, 0, before);
}
