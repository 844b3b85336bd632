#include "goniometer/forest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/units.h>

#include "base/grow.h"
#include "bsdf/write_xml.h"
#include "goniometer/fan.h"
#include "goniometer/hues.h"

/* Ratios of sums of squares that chance exceeds in none of the many millions of cases of a panel
 * (chi-square): with 15 degrees of freedom, and with the 3 of a cell out alone. */
static const double beyond_chance[2] = {8, 13};

/* Correction for a selection effect. Cells joined within their errors were selected for looking
 * alike, so two thirds of their differences are visible. Cells whose mean squares are 1.5 to 3
 * times their errors' pass if they appear to be 1.1 times. */
static const double unseen_more = 0.5;

void orl_gonio_forest_done(struct orl_gonio_forest *forest)
{
    free(forest->branches);
    free(forest->hues);
    memset(forest, 0, sizeof *forest);
}

bool orl_gonio_cells_make(struct orl_gonio_cells *cells, size_t count, bool color)
{
    cells->nodes = malloc(count * sizeof *cells->nodes);
    cells->hues = color ? malloc(count * sizeof *cells->hues) : NULL;
    if (cells->nodes && (cells->hues || !color))
        return true;
    orl_gonio_cells_done(cells);
    return false;
}

void orl_gonio_cells_done(struct orl_gonio_cells *cells)
{
    free(cells->nodes);
    free(cells->hues);
    *cells = (struct orl_gonio_cells){NULL, NULL};
}

void orl_gonio_cells_copy(struct orl_gonio_cells to, struct orl_gonio_cells from, size_t count)
{
    memcpy(to.nodes, from.nodes, count * sizeof *to.nodes);
    if (to.hues)
        memcpy(to.hues, from.hues, count * sizeof *to.hues);
}

/* Returns the value of one more path in one of the cells; cells with paths have precedence. */
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
    const double mean = orl_gonio_sum(values, fan) / fan;
    for (unsigned i = 0; i < fan; i++) {
        const double off = (double)children[i].value - mean;
        spreads[i] =
            (double)children[i].spread + off * off - (double)children[i].variance * (fan - 1) / fan;
    }
    return (struct orl_gonio_node){.value = (float)mean,
                                   .variance = (float)(orl_gonio_sum(variances, fan) / (fan * fan)),
                                   .path = path_of(children, fan),
                                   .spread = (float)(orl_gonio_sum(spreads, fan) / fan)};
}

/* Common case. */
static bool are_dark(const struct orl_gonio_node *children, unsigned fan)
{
    bool dark = true;
    for (unsigned i = 0; i < fan; i++)
        dark = dark && children[i].value == 0 && !children[i].branch;
    return dark;
}

/* Nodes that may be joined. */
struct group {
    const struct orl_gonio_cull *cull;
    struct orl_gonio_cells children;
    unsigned fan, level;
    bool leaves;  /* true if all are leaves */
    double doubt; /* largest doubt, including that of nodes below */
};

/* Differences from the mean: sums of squares, and of variances. */
struct scatter {
    double mean, squares, noise;
};

static bool is_chance(const struct group *g, const struct scatter *s)
{
    const bool few = g->fan == 4;
    return s->squares <= orl_gonio_by_chance(g->fan) * s->noise && g->doubt <= beyond_chance[few];
}

/* Returns true if the nodes can be joined: within their errors or, if all are leaves, because the
 * differences are small enough. */
static bool can_join(const struct group *g, const struct scatter *s)
{
    const double omega = ldexp(ORL_PI, -2 * (int)g->level), unseen = g->cull->unseen / omega;
    const double shade = g->cull->share * s->mean, fan = g->fan;
    return is_chance(g, s) || (g->leaves && (s->squares <= fan * shade * shade ||
                                             s->squares <= fan * unseen * unseen));
}

static struct scatter scatter_of(const struct group *g, double mean)
{
    double off2[ORL_GONIO_FAN_MOST] = {0}, noises[ORL_GONIO_FAN_MOST] = {0};
    for (unsigned i = 0; i < g->fan; i++) {
        const double off = (double)g->children.nodes[i].value - mean;
        off2[i] = off * off;
        noises[i] = orl_gonio_noise(&g->children.nodes[i]);
    }
    return (struct scatter){mean, orl_gonio_sum(off2, g->fan), orl_gonio_sum(noises, g->fan)};
}

static float doubt_of(double doubt, const struct scatter *s)
{
    return (float)fmin(1e30, fmax(doubt, s->noise > 0 ? s->squares / s->noise : 1e30));
}

bool orl_gonio_are_one(const struct orl_gonio_cull *cull, struct orl_gonio_cells children,
                       unsigned fan, unsigned level, struct orl_gonio_cells ret_mean)
{
    struct group g = {cull, children, fan, level, true, 0};
    struct orl_gonio_node *mean = ret_mean.nodes;
    if (are_dark(children.nodes, fan)) {
        *mean = (struct orl_gonio_node){.path = path_of(children.nodes, fan)};
        if (ret_mean.hues)
            *ret_mean.hues = (struct orl_gonio_hue){.value = {0}};
        return true;
    }
    for (unsigned i = 0; i < fan; i++) {
        g.doubt = fmax(g.doubt, (double)children.nodes[i].doubt);
        g.leaves = g.leaves && !children.nodes[i].branch;
    }
    *mean = mean_of(children.nodes, fan);
    const struct scatter s = scatter_of(&g, (double)mean->value);
    mean->doubt = doubt_of(g.doubt, &s);
    if (children.hues) {
        const struct orl_gonio_blend blend =
            orl_gonio_blend_of(cull, children, fan, level, ret_mean.hues);
        mean->doubt = fmaxf(mean->doubt, blend.doubt);
        if (!blend.is_one)
            return false;
    }
    if (!is_chance(&g, &s))
        return can_join(&g, &s);
    /* Nodes that differ as much as their errors were selected for looking alike. */
    mean->spread += (float)(unseen_more * (s.squares - s.noise * (fan - 1) / fan) / fan);
    return true;
}

/* Makes room for one more branch. */
static bool reserve_branch(struct orl_gonio_forest *forest)
{
    return forest->count < UINT32_MAX - 1 &&
           orl_grow(&forest->branches, &forest->room, forest->count, sizeof *forest->branches) &&
           (!forest->color ||
            orl_grow(&forest->hues, &forest->hues_room, forest->count, sizeof *forest->hues));
}

bool orl_gonio_join(struct orl_gonio_forest *forest, struct orl_gonio_cells children,
                    unsigned level, struct orl_gonio_cells ret_node)
{
    const unsigned fan = 1U << forest->rank;
    struct orl_gonio_node node;
    const bool one = orl_gonio_are_one(&forest->cull, children, fan, level,
                                       (struct orl_gonio_cells){&node, ret_node.hues});
    if (forest->rank == 3 && level == 0) /* two of eight parts are independent */
        node.variance *= 4;
    if (one) {
        node.doubt = 0;
        *ret_node.nodes = node;
        return true;
    }
    if (!reserve_branch(forest))
        return false;
    memcpy(forest->branches[forest->count].child, children.nodes, fan * sizeof *children.nodes);
    if (forest->color)
        memcpy(forest->hues[forest->count].child, children.hues, fan * sizeof *children.hues);
    node.branch = (uint32_t)++forest->count;
    *ret_node.nodes = node;
    return true;
}

bool orl_gonio_join_level(struct orl_gonio_forest *forest, struct orl_gonio_cells parts,
                          size_t count, unsigned level, struct orl_gonio_cells ret_nodes)
{
    const unsigned in = orl_gonio_parts_in(forest->rank);
    for (size_t i = 0; i < count; i++) {
        struct orl_gonio_node nodes[ORL_GONIO_FAN_MOST];
        struct orl_gonio_hue hues[ORL_GONIO_FAN_MOST];
        const struct orl_gonio_cells children = {nodes, parts.hues ? hues : NULL};
        for (unsigned a = 0; a < in; a++)
            for (unsigned b = 0; b < 4; b++)
                orl_gonio_cells_copy(orl_gonio_cells_at(children, a + b * in),
                                     orl_gonio_cells_at(parts, 4 * (a * count + i) + b), 1);
        if (!orl_gonio_join(forest, children, level + 1, orl_gonio_cells_at(ret_nodes, i)))
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
        if (!reserve_branch(forest))
            return false;
        const size_t at = forest->count++;
        for (unsigned i = 0; i < 1U << forest->rank; i++) {
            forest->branches[at].child[i] =
                orl_gonio_shifted(other->branches[k].child[i ^ mirror], shift);
            if (forest->color)
                forest->hues[at].child[i] = other->hues[k].child[i ^ mirror];
        }
    }
    *ret_shift = shift;
    return true;
}

/* The recursion depth is at most seven. */
void orl_gonio_forest_write(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                            bool errors, const atomic_bool *cancel, FILE *out)
{
    if (root.branch && orl_is_cancelled(cancel))
        return;
    fputs("{ ", out);
    if (root.branch) {
        const struct orl_gonio_branch *branch = &forest->branches[root.branch - 1];
        fputs("\n", out);
        for (unsigned i = 0; i < 1U << forest->rank; i++)
            orl_gonio_forest_write(forest, branch->child[i], errors, cancel, out);
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
