#include "goniometer/resolve.h"

#include <math.h>

/* A cell with the error of those that it is made of, in the place of its variance. */
static void see(struct orl_gonio_seen *seen, const struct orl_gonio_node *cell, double from)
{
    const double value = (double)cell->value;
    if (cell->branch)
        return;
    seen->peak = fmax(seen->peak, value);
    if (value > 0 && value >= from)
        seen->worst = fmax(seen->worst, sqrt((double)cell->doubt) / value);
}

/* Four cells of a level become one of that above; of those that do not, what is seen. */
static struct orl_gonio_node join(struct orl_gonio_node *children, unsigned level,
                                  const struct orl_gonio_cull *cull, double from,
                                  struct orl_gonio_seen *seen)
{
    enum { FAN = 4 };
    struct orl_gonio_node plain[FAN], mean;
    double variance = 0;
    for (int i = 0; i < FAN; i++) {
        plain[i] = children[i];
        if (!children[i].branch)
            plain[i].doubt = 0;
        variance += orl_gonio_noise(&children[i]) / FAN;
    }
    if (orl_gonio_are_one(cull, plain, FAN, level, &mean)) {
        for (int i = 0; i < FAN && (double)mean.value < from; i++)
            see(seen, &children[i], from); /* it may be a cell of its own in a tree */
        mean.doubt = (float)variance;
        mean.branch = 0;
        return mean;
    }
    for (int i = 0; i < FAN; i++)
        see(seen, &children[i], from);
    mean.branch = 1;
    return mean;
}

struct orl_gonio_seen orl_gonio_resolve(struct orl_gonio_node *cells, unsigned levels,
                                        const struct orl_gonio_cull *cull, double from)
{
    struct orl_gonio_seen seen = {0, 0};
    const size_t n = (size_t)1 << 2 * levels;
    for (size_t i = 0; i < n; i++)
        cells[i].doubt = (float)(orl_gonio_noise(&cells[i]));
    for (unsigned level = levels; level > 0; level--)
        for (size_t i = 0; i < (size_t)1 << 2 * (level - 1); i++)
            cells[i] = join(cells + 4 * i, level, cull, from, &seen);
    see(&seen, &cells[0], from);
    return seen;
}
