#include "scene/cache/cache_stream.h"

#include "scene/grid/grid.h"

static void pass_grid(struct orl_serializer *serializer, struct orl_grid *grid)
{
    struct orl_grid image = *grid;
    bool uneven[ORL_GRID_AXES];
    image.values = NULL;
    for (int i = 0; i < ORL_GRID_AXES; i++) {
        uneven[i] = image.axes[i].places != NULL;
        image.axes[i].places = NULL;
    }
    orl_serialize_value(serializer, &image);
    orl_serialize_value(serializer, &uneven);
    if (orl_serializer_reads(serializer))
        *grid = image;
    for (int i = 0; i < ORL_GRID_AXES; i++)
        if (uneven[i])
            orl_serialize_array(serializer, &grid->axes[i].places, grid->axes[i].n,
                                sizeof *grid->axes[i].places);
    orl_serialize_array(serializer, &grid->values, grid->n_values, sizeof *grid->values);
}

void orl_cache_grids(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    struct orl_serializer *const serializer = &k->serializer;
    size_t n = d->n_grids;
    orl_serialize_value(serializer, &n);
    orl_serializer_alloc(serializer, &d->grids, n, sizeof(struct orl_grid *));
    for (size_t i = 0; i < n && serializer->code == 0; i++) {
        orl_serializer_alloc(serializer, &d->grids[i], 1, sizeof *d->grids[i]);
        d->n_grids = i + 1;
        if (d->grids[i])
            pass_grid(serializer, d->grids[i]);
    }
}
