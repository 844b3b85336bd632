#include "goniometer/resolve.h"

#include <math.h>

/* Updates the result with a cell; its doubt holds the mean variance of the cells joined into it. */
static void update_seen(struct orl_gonio_seen *seen, const struct orl_gonio_node *cell, double from)
{
    const double value = (double)cell->value;
    if (cell->branch)
        return;
    seen->peak = fmax(seen->peak, value);
    if (value > 0 && value >= from)
        seen->worst = fmax(seen->worst, sqrt((double)cell->doubt) / value);
}

/* Joins four cells of a level to one of the next coarser level, or adds them to the result. */
static void join_four(struct orl_gonio_cells four, unsigned level,
                      const struct orl_gonio_cull *cull, double from, struct orl_gonio_seen *seen,
                      struct orl_gonio_cells ret_mean)
{
    enum { FAN = 4 };
    const struct orl_gonio_node *children = four.nodes;
    struct orl_gonio_node plain[FAN], mean;
    struct orl_gonio_hue hue;
    double variance = 0;
    for (int i = 0; i < FAN; i++) {
        plain[i] = children[i];
        if (!children[i].branch)
            plain[i].doubt = 0;
        variance += orl_gonio_noise(&children[i]) / FAN;
    }
    const bool one = orl_gonio_are_one(cull, (struct orl_gonio_cells){plain, four.hues}, FAN, level,
                                       (struct orl_gonio_cells){&mean, four.hues ? &hue : NULL});
    for (int i = 0; i < FAN && (!one || (double)mean.value < from); i++)
        /* Children of a dark joined cell count as well: they may be cells of a tree. */
        update_seen(seen, &children[i], from);
    if (one)
        mean.doubt = (float)variance;
    mean.branch = !one;
    orl_gonio_cells_copy(ret_mean, (struct orl_gonio_cells){&mean, &hue}, 1);
}

struct orl_gonio_seen orl_gonio_resolve(struct orl_gonio_cells cells, unsigned levels,
                                        const struct orl_gonio_cull *cull, double from)
{
    struct orl_gonio_seen seen = {0, 0};
    const size_t n = (size_t)1 << 2 * levels;
    for (size_t i = 0; i < n; i++)
        cells.nodes[i].doubt = (float)(orl_gonio_noise(&cells.nodes[i]));
    for (unsigned level = levels; level > 0; level--)
        for (size_t i = 0; i < (size_t)1 << 2 * (level - 1); i++)
            join_four(orl_gonio_cells_at(cells, 4 * i), level, cull, from, &seen,
                      orl_gonio_cells_at(cells, i));
    update_seen(&seen, cells.nodes, from);
    return seen;
}
