#include "bsdf/make/trees/convergence.h"

#include <math.h>

/* Updates the result with a cell; its merge error holds the mean variance of the cells joined into
 * it. */
static void update_convergence(struct orl_gonio_convergence *convergence,
                               const struct orl_gonio_node *cell, double from)
{
    const double value = (double)cell->value;
    if (cell->branch)
        return;
    convergence->peak = fmax(convergence->peak, value);
    if (value > 0 && value >= from)
        convergence->max_error =
            fmax(convergence->max_error, sqrt((double)cell->merge_error) / value);
}

/* Joins four cells of a level to one of the next coarser level, or adds them to the result. */
static void merge_four(struct orl_gonio_cells four, unsigned level,
                       const struct orl_gonio_cull *cull, double from,
                       struct orl_gonio_convergence *convergence, struct orl_gonio_cells ret_mean)
{
    enum { BRANCHING = 4 };
    const struct orl_gonio_node *children = four.nodes;
    struct orl_gonio_node plain[BRANCHING], mean;
    struct orl_gonio_color node_color;
    double variance = 0;
    for (int i = 0; i < BRANCHING; i++) {
        plain[i] = children[i];
        if (!children[i].branch)
            plain[i].merge_error = 0;
        variance += orl_gonio_node_variance(&children[i]) / BRANCHING;
    }
    const bool one =
        orl_gonio_try_merge(cull, (struct orl_gonio_cells){plain, four.colors}, BRANCHING, level,
                            (struct orl_gonio_cells){&mean, four.colors ? &node_color : NULL});
    for (int i = 0; i < BRANCHING && (!one || (double)mean.value < from); i++)
        /* Children of a dark joined cell count as well: they may be cells of a tree. */
        update_convergence(convergence, &children[i], from);
    if (one)
        mean.merge_error = (float)variance;
    mean.branch = !one;
    orl_gonio_cells_copy(ret_mean, (struct orl_gonio_cells){&mean, &node_color}, 1);
}

struct orl_gonio_convergence orl_gonio_test_convergence(struct orl_gonio_cells cells,
                                                        unsigned levels,
                                                        const struct orl_gonio_cull *cull,
                                                        double from)
{
    struct orl_gonio_convergence convergence = {0, 0};
    const size_t n = (size_t)1 << 2 * levels;
    for (size_t i = 0; i < n; i++)
        cells.nodes[i].merge_error = (float)(orl_gonio_node_variance(&cells.nodes[i]));
    for (unsigned level = levels; level > 0; level--)
        for (size_t i = 0; i < (size_t)1 << 2 * (level - 1); i++)
            merge_four(orl_gonio_cells_at(cells, 4 * i), level, cull, from, &convergence,
                       orl_gonio_cells_at(cells, i));
    update_convergence(&convergence, cells.nodes, from);
    return convergence;
}
