#include "goniometer/forest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/units.h>

#include "base/grow.h"
#include "bsdf/write.h"

/* Ratios of sums of squares that chance exceeds in 1 of 10^4 cases (chi-square); and in none of the
 * many millions that a panel has: of 15 degrees of freedom, and of the 3 of a cell out alone. */
static const double by_chance[2] = {3, 7}, beyond_chance[2] = {8, 13};

/* What is seen of differences between cells that are joined by chance is two thirds of them: of
 * cells whose mean squares are 1.5 to 3 times their errors' those pass that seem to have 1.1. */
static const double unseen_more = 0.5;

void orl_gonio_forest_done(struct orl_gonio_forest *forest)
{
    free(forest->branches);
    memset(forest, 0, sizeof *forest);
}

/* By pairs, which mirrors (i ^ mirror) leave as they are, so that no rounding tells them apart. The
 * values are used up. */
static double sum_of(double *values, unsigned fan)
{
    for (unsigned step = 1; step < fan; step *= 2)
        for (unsigned i = 0; i < fan; i += 2 * step)
            values[i] += values[i + step];
    return values[0];
}

/* A path more in one of the cells: of those that some came to, if there are any. */
static float path_of(const struct orl_gonio_node *children, unsigned fan)
{
    float lit = 0, dark = 0;
    for (unsigned i = 0; i < fan; i++)
        if (children[i].value > 0)
            lit = fmaxf(lit, children[i].path);
        else
            dark = fmaxf(dark, children[i].path);
    return (lit > 0 ? lit : dark) / (float)fan;
}

static struct orl_gonio_node mean_of(const struct orl_gonio_node *children, unsigned fan)
{
    double values[ORL_GONIO_FAN_MOST] = {0}, variances[ORL_GONIO_FAN_MOST] = {0};
    double spreads[ORL_GONIO_FAN_MOST] = {0};
    for (unsigned i = 0; i < fan; i++) {
        values[i] = (double)children[i].value;
        variances[i] = (double)children[i].variance;
    }
    const double mean = sum_of(values, fan) / fan;
    for (unsigned i = 0; i < fan; i++) {
        const double off = (double)children[i].value - mean;
        spreads[i] =
            (double)children[i].spread + off * off - (double)children[i].variance * (fan - 1) / fan;
    }
    return (struct orl_gonio_node){.value = (float)mean,
                                   .variance = (float)(sum_of(variances, fan) / (fan * fan)),
                                   .path = path_of(children, fan),
                                   .spread = (float)(sum_of(spreads, fan) / fan)};
}

/* Most are. */
static bool are_dark(const struct orl_gonio_node *children, unsigned fan)
{
    bool dark = true;
    for (unsigned i = 0; i < fan; i++)
        dark = dark && children[i].value == 0 && !children[i].branch;
    return dark;
}

bool orl_gonio_are_one(const struct orl_gonio_cull *cull, const struct orl_gonio_node *children,
                       unsigned fan, unsigned level, struct orl_gonio_node *ret_mean)
{
    if (are_dark(children, fan)) {
        *ret_mean = (struct orl_gonio_node){.path = path_of(children, fan)};
        return true;
    }
    const bool few = fan == 4;
    const double omega = ldexp(ORL_PI, -2 * (int)level), unseen = cull->unseen / omega;
    struct orl_gonio_node mean = mean_of(children, fan);
    const double shade = cull->share * (double)mean.value;
    double off2[ORL_GONIO_FAN_MOST] = {0}, variances[ORL_GONIO_FAN_MOST] = {0}, doubt = 0;
    bool leaves = true;
    for (unsigned i = 0; i < fan; i++) {
        const double off = (double)children[i].value - (double)mean.value;
        off2[i] = off * off;
        variances[i] = orl_gonio_noise(&children[i]);
        doubt = fmax(doubt, (double)children[i].doubt);
        leaves = leaves && !children[i].branch;
    }
    const double squares = sum_of(off2, fan), noise = sum_of(variances, fan);
    mean.doubt = (float)fmin(1e30, fmax(doubt, noise > 0 ? squares / noise : 1e30));
    *ret_mean = mean;
    if (squares <= by_chance[few] * noise && doubt <= beyond_chance[few]) {
        /* Of those that differ by as much as their errors the ones that look alike are taken. */
        ret_mean->spread += (float)(unseen_more * (squares - noise * (fan - 1) / fan) / fan);
        return true;
    }
    return leaves && (squares <= fan * shade * shade || squares <= fan * unseen * unseen);
}

bool orl_gonio_join(struct orl_gonio_forest *forest, const struct orl_gonio_node *children,
                    unsigned level, struct orl_gonio_node *ret_node)
{
    const unsigned fan = 1U << forest->rank;
    struct orl_gonio_node node;
    const bool one = orl_gonio_are_one(&forest->cull, children, fan, level, &node);
    if (forest->rank == 3 && level == 0) /* of eight parts these are two, mirrored and copied */
        node.variance *= 4;
    if (one) {
        node.doubt = 0;
        *ret_node = node;
        return true;
    }
    if (forest->count >= UINT32_MAX - 1 ||
        !orl_grow(&forest->branches, &forest->room, forest->count, sizeof *forest->branches))
        return false;
    memcpy(forest->branches[forest->count].child, children, fan * sizeof *children);
    node.branch = (uint32_t)++forest->count;
    *ret_node = node;
    return true;
}

bool orl_gonio_join_level(struct orl_gonio_forest *forest, const struct orl_gonio_node *parts,
                          size_t count, unsigned level, struct orl_gonio_node *ret_nodes)
{
    const unsigned in = orl_gonio_parts_in(forest->rank);
    for (size_t i = 0; i < count; i++) {
        struct orl_gonio_node children[ORL_GONIO_FAN_MOST];
        for (unsigned a = 0; a < in; a++)
            for (unsigned b = 0; b < 4; b++)
                children[a + b * in] = parts[4 * (a * count + i) + b];
        if (!orl_gonio_join(forest, children, level + 1, &ret_nodes[i]))
            return false;
    }
    return true;
}

struct orl_gonio_node orl_gonio_shifted(struct orl_gonio_node node, uint32_t shift)
{
    if (node.branch)
        node.branch += shift;
    return node;
}

bool orl_gonio_forest_take(struct orl_gonio_forest *forest, const struct orl_gonio_forest *other,
                           unsigned mirror, uint32_t *ret_shift)
{
    const uint32_t shift = (uint32_t)forest->count;
    if (other->count >= UINT32_MAX - 1 - forest->count)
        return false;
    for (size_t k = 0; k < other->count; k++) {
        if (!orl_grow(&forest->branches, &forest->room, forest->count, sizeof *forest->branches))
            return false;
        struct orl_gonio_branch *branch = &forest->branches[forest->count++];
        for (unsigned i = 0; i < 1U << forest->rank; i++)
            branch->child[i] = orl_gonio_shifted(other->branches[k].child[i ^ mirror], shift);
    }
    *ret_shift = shift;
    return true;
}

/* Depth is at most seven. */
void orl_gonio_forest_write(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                            bool errors, FILE *out)
{
    fputs("{ ", out);
    if (root.branch) {
        const struct orl_gonio_branch *branch = &forest->branches[root.branch - 1];
        fputs("\n", out);
        for (unsigned i = 0; i < 1U << forest->rank; i++)
            orl_gonio_forest_write(forest, branch->child[i], errors, out);
    } else {
        orl_write_value(out, errors ? (float)orl_gonio_error(&root) : root.value);
    }
    fputs(" }\n", out);
}

double orl_gonio_forest_peak(const struct orl_gonio_forest *forest, struct orl_gonio_node root)
{
    double peak = 0;
    if (!root.branch)
        return (double)root.value;
    for (unsigned i = 0; i < 1U << forest->rank; i++)
        peak =
            fmax(peak, orl_gonio_forest_peak(forest, forest->branches[root.branch - 1].child[i]));
    return peak;
}

void orl_gonio_forest_worst(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                            double from, struct orl_gonio_worst *worst)
{
    const double value = (double)root.value, path = (double)root.path;
    for (unsigned i = 0; root.branch && i < 1U << forest->rank; i++)
        orl_gonio_forest_worst(forest, forest->branches[root.branch - 1].child[i], from, worst);
    if (root.branch || !(value > 0) || value < from)
        return;
    worst->noise = fmax(worst->noise, sqrt((double)root.variance + path * path) / value);
    worst->joined = fmax(worst->joined, sqrt(fmax(0, (double)root.spread)) / value);
}
