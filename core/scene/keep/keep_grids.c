#include "scene/keep/keep_parts.h"

#include "scene/grid/grid.h"

static void pass_grid(struct orl_stream *stream, struct orl_grid *grid)
{
    struct orl_grid image = *grid;
    bool uneven[ORL_GRID_AXES];
    image.values = NULL;
    for (int i = 0; i < ORL_GRID_AXES; i++) {
        uneven[i] = image.axes[i].places != NULL;
        image.axes[i].places = NULL;
    }
    orl_stream_value(stream, &image);
    orl_stream_value(stream, &uneven);
    if (orl_stream_reads(stream))
        *grid = image;
    for (int i = 0; i < ORL_GRID_AXES; i++)
        if (uneven[i])
            orl_stream_array(stream, &grid->axes[i].places, grid->axes[i].n,
                             sizeof *grid->axes[i].places);
    orl_stream_array(stream, &grid->values, grid->n_values, sizeof *grid->values);
}

void orl_keep_grids(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    struct orl_stream *const stream = &k->stream;
    size_t n = d->n_grids;
    orl_stream_value(stream, &n);
    orl_stream_room(stream, &d->grids, n, sizeof(struct orl_grid *));
    for (size_t i = 0; i < n && stream->code == 0; i++) {
        orl_stream_room(stream, &d->grids[i], 1, sizeof *d->grids[i]);
        d->n_grids = i + 1;
        if (d->grids[i])
            pass_grid(stream, d->grids[i]);
    }
}
