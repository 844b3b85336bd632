/* Tensor trees under construction: sums over the children of a node, colours, then merging and
 * writing. */
#include "bsdf/make/trees/tree_builder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "base/memory/memory.h"
#include "bsdf/document.h"
#include "bsdf/xml/bsdf_xml.h"

/* ---- Sums over the children of a node -------------------------------------------------------- */

/* Limits by chance: with 15 degrees of freedom, and with the 3 of a cell out alone. */
static const double chi_square_limits[2] = {3, 7};

/* Returns the ratio of sums of squares that chance exceeds in 1 of 10^4 cases (chi-square with
 * branching - 1 degrees of freedom). */
static double chi_square_limit(unsigned branching)
{
    return chi_square_limits[branching == 4];
}

/* Returns the sum, added by pairs. Mirrors (i ^ mirror) do not change the pairs, so mirrored sums
 * are equal to the last bit. The values are overwritten. */
static double pairwise_sum(double *values, unsigned branching)
{
    for (unsigned step = 1; step < branching; step *= 2)
        for (unsigned i = 0; i < branching; i += 2 * step)
            values[i] += values[i + step];
    return values[0];
}

/* ---- Colours --------------------------------------------------------------------------------- */

/* Relative difference that rounding may cause. */
static const double rounding_error = 1e-6;
/* Share of the allowed difference for cells that are not merged. */
static const double unmerged_share = 0.25;

/* Sums of squares of one channel of nodes, compared with their luminances in one chromaticity. */
struct channel_spread {
    double off, noise, value;
};

/* Returns the sums of channel c. unit: the channel divided by the luminance, over all nodes. A node
 * with few paths has a chromaticity as uncertain as its luminance. */
static struct channel_spread channel_spread_of(struct orl_gonio_cells children, unsigned branching,
                                               int c, double unit)
{
    double off2[ORL_GONIO_MAX_BRANCHING] = {0}, noises[ORL_GONIO_MAX_BRANCHING] = {0};
    double values[ORL_GONIO_MAX_BRANCHING] = {0};
    for (unsigned i = 0; i < branching; i++) {
        const struct orl_gonio_node *node = &children.nodes[i];
        const double luma = (double)node->value, wanted = unit * luma;
        const double off = (double)children.colors[i].value[c] - wanted;
        const double turn = luma > 0 ? off / luma : 0;
        off2[i] = off * off;
        noises[i] =
            (double)children.colors[i].noise[c] + turn * turn * orl_gonio_node_variance(node);
        values[i] = wanted * wanted;
    }
    return (struct channel_spread){pairwise_sum(off2, branching), pairwise_sum(noises, branching),
                                   pairwise_sum(values, branching)};
}

static struct orl_gonio_color mean_color_of(struct orl_gonio_cells children, unsigned branching)
{
    struct orl_gonio_color mean;
    for (int c = 0; c < ORL_GONIO_COLORS; c++) {
        double values[ORL_GONIO_MAX_BRANCHING] = {0}, noises[ORL_GONIO_MAX_BRANCHING] = {0};
        for (unsigned i = 0; i < branching; i++) {
            values[i] = (double)children.colors[i].value[c];
            noises[i] = (double)children.colors[i].noise[c];
        }
        mean.value[c] = (float)(pairwise_sum(values, branching) / branching);
        mean.noise[c] = (float)(pairwise_sum(noises, branching) / (branching * branching));
    }
    return mean;
}

static double luma_of(struct orl_gonio_cells children, unsigned branching)
{
    double values[ORL_GONIO_MAX_BRANCHING] = {0};
    for (unsigned i = 0; i < branching; i++)
        values[i] = (double)children.nodes[i].value;
    return pairwise_sum(values, branching) / branching;
}

/* Result of comparing chromaticities. */
struct color_match {
    bool is_match; /* true if the nodes can have the chromaticity of their total light */
    float
        merge_error; /* largest ratio of squared differences to squared errors; 0 if none counts */
};

/* Compares the chromaticities of nodes at `level` and sets their mean colour. */
static struct color_match match_chromaticity(const struct orl_gonio_cull *cull,
                                             struct orl_gonio_cells children, unsigned branching,
                                             unsigned level, struct orl_gonio_color *ret_mean)
{
    const double omega = ldexp(ORL_PI, -2 * (int)level),
                 cull_fraction = cull->cull_fraction / omega;
    const double share = fmax(cull->share, rounding_error), luma = luma_of(children, branching);
    struct color_match match = {true, 0};
    const struct orl_gonio_color mean = mean_color_of(children, branching);
    for (int c = 0; c < ORL_GONIO_COLORS && luma > 0; c++) {
        const struct channel_spread s =
            channel_spread_of(children, branching, c, (double)mean.value[c] / luma);
        if (s.off <= fmax(share * share * s.value, branching * cull_fraction * cull_fraction))
            continue;
        const double ratio = s.noise > 0 ? fmin(s.off / s.noise, 1e30) : 1e30;
        match.merge_error = fmaxf(match.merge_error, (float)ratio);
        match.is_match = match.is_match && ratio <= chi_square_limit(branching);
    }
    *ret_mean = mean;
    return match;
}

/* ---- Chromaticities in the file -------------------------------------------------------------- */

static struct orl_gonio_cells children_of(const struct orl_gonio_builder *builder, uint32_t branch)
{
    return (struct orl_gonio_cells){builder->branches[branch - 1].child,
                                    builder->colors[branch - 1].child};
}

/* Returns true if a node at `level` has one chromaticity. */
static bool is_match(const struct orl_gonio_builder *builder, const struct orl_gonio_node *node,
                     unsigned level)
{
    const struct orl_gonio_cull cull = {unmerged_share * builder->cull.share,
                                        builder->cull.cull_fraction};
    struct orl_gonio_color mean;
    if (!node->branch || !(node->value > 0))
        return true;
    const struct orl_gonio_cells children = children_of(builder, node->branch);
    for (unsigned i = 0; i < 1U << builder->rank; i++)
        if (!is_match(builder, &children.nodes[i], level + 1))
            return false;
    return match_chromaticity(&cull, children, 1U << builder->rank, level + 1, &mean).is_match;
}

static void write_colors(const struct orl_gonio_builder *builder, const struct orl_gonio_node *node,
                         const struct orl_gonio_color *node_color, unsigned level,
                         enum orl_bsdf_channel channel, const atomic_bool *cancel, FILE *out)
{
    if (node->branch && orl_is_cancelled(cancel))
        return;
    fputs("{ ", out);
    if (is_match(builder, node, level)) {
        double u, v;
        orl_color_uv((struct orl_rgb){(double)node_color->value[0], (double)node_color->value[1],
                                      (double)node_color->value[2]},
                     &u, &v);
        orl_write_value(out, (float)(channel == ORL_CHANNEL_FIRST ? u : v));
    } else {
        const struct orl_gonio_cells children = children_of(builder, node->branch);
        fputs("\n", out);
        for (unsigned i = 0; i < 1U << builder->rank; i++)
            write_colors(builder, &children.nodes[i], &children.colors[i], level + 1, channel,
                         cancel, out);
    }
    fputs(" }\n", out);
}

void orl_gonio_write_chromaticity(const struct orl_gonio_builder *builder,
                                  struct orl_gonio_node root, struct orl_gonio_color node_color,
                                  enum orl_bsdf_channel channel, const atomic_bool *cancel,
                                  FILE *out)
{
    write_colors(builder, &root, &node_color, 0, channel, cancel, out);
}

/* ---- Merging and writing --------------------------------------------------------------------- */

/* Ratios of sums of squares that chance exceeds in none of the many millions of cases of a panel
 * (chi-square): with 15 degrees of freedom, and with the 3 of a cell out alone. */
static const double max_chi_square[2] = {8, 13};

/* Correction for a selection effect. Cells that are merged within their errors were selected
 * because they appeared alike, so two thirds of their differences are visible. Cells whose mean
 * squares are 1.5 to 3 times those of their errors pass if they appear to be 1.1 times. */
static const double selection_bias = 0.5;

void orl_gonio_builder_done(struct orl_gonio_builder *builder)
{
    free(builder->branches);
    free(builder->colors);
    memset(builder, 0, sizeof *builder);
}

bool orl_gonio_cells_make(struct orl_gonio_cells *cells, size_t count, bool color)
{
    cells->nodes = malloc(count * sizeof *cells->nodes);
    cells->colors = color ? malloc(count * sizeof *cells->colors) : NULL;
    if (cells->nodes && (cells->colors || !color))
        return true;
    orl_gonio_cells_done(cells);
    return false;
}

void orl_gonio_cells_done(struct orl_gonio_cells *cells)
{
    free(cells->nodes);
    free(cells->colors);
    *cells = (struct orl_gonio_cells){NULL, NULL};
}

void orl_gonio_cells_copy(struct orl_gonio_cells to, struct orl_gonio_cells from, size_t count)
{
    memcpy(to.nodes, from.nodes, count * sizeof *to.nodes);
    if (to.colors)
        memcpy(to.colors, from.colors, count * sizeof *to.colors);
}

/* Returns the value of one more path in one of the cells; cells with paths have precedence. */
static float path_of(const struct orl_gonio_node *children, unsigned branching)
{
    float lit = 0, dark = 0;
    for (unsigned i = 0; i < branching; i++)
        if (children[i].value > 0)
            lit = fmaxf(lit, children[i].path);
        else
            dark = fmaxf(dark, children[i].path);
    return (lit > 0 ? lit : dark) / (float)branching;
}

static struct orl_gonio_node mean_of(const struct orl_gonio_node *children, unsigned branching)
{
    double values[ORL_GONIO_MAX_BRANCHING] = {0}, variances[ORL_GONIO_MAX_BRANCHING] = {0};
    double spreads[ORL_GONIO_MAX_BRANCHING] = {0};
    for (unsigned i = 0; i < branching; i++) {
        values[i] = (double)children[i].value;
        variances[i] = (double)children[i].variance;
    }
    const double mean = pairwise_sum(values, branching) / branching;
    for (unsigned i = 0; i < branching; i++) {
        const double off = (double)children[i].value - mean;
        spreads[i] = (double)children[i].spread + off * off -
                     (double)children[i].variance * (branching - 1) / branching;
    }
    return (struct orl_gonio_node){
        .value = (float)mean,
        .variance = (float)(pairwise_sum(variances, branching) / (branching * branching)),
        .path = path_of(children, branching),
        .spread = (float)(pairwise_sum(spreads, branching) / branching)};
}

/* Returns true if all nodes are dark leaves, the common case. */
static bool are_dark(const struct orl_gonio_node *children, unsigned branching)
{
    bool dark = true;
    for (unsigned i = 0; i < branching; i++)
        dark = dark && children[i].value == 0 && !children[i].branch;
    return dark;
}

/* Nodes that may be merged. */
struct group {
    const struct orl_gonio_cull *cull;
    struct orl_gonio_cells children;
    unsigned branching, level;
    bool leaves;        /* true if all are leaves */
    double merge_error; /* largest merge error, including that of nodes below */
};

/* Differences from the mean: sums of squares, and of variances. */
struct scatter {
    double mean, squares, noise;
};

static bool is_chance(const struct group *g, const struct scatter *s)
{
    const bool few = g->branching == 4;
    return s->squares <= chi_square_limit(g->branching) * s->noise &&
           g->merge_error <= max_chi_square[few];
}

/* Returns true if the nodes can be merged: within their errors or, if all are leaves, because the
 * differences are small enough. */
static bool can_merge(const struct group *g, const struct scatter *s)
{
    const double omega = ldexp(ORL_PI, -2 * (int)g->level),
                 cull_fraction = g->cull->cull_fraction / omega;
    const double shade = g->cull->share * s->mean, branching = g->branching;
    return is_chance(g, s) ||
           (g->leaves && (s->squares <= branching * shade * shade ||
                          s->squares <= branching * cull_fraction * cull_fraction));
}

static struct scatter scatter_of(const struct group *g, double mean)
{
    double off2[ORL_GONIO_MAX_BRANCHING] = {0}, noises[ORL_GONIO_MAX_BRANCHING] = {0};
    for (unsigned i = 0; i < g->branching; i++) {
        const double off = (double)g->children.nodes[i].value - mean;
        off2[i] = off * off;
        noises[i] = orl_gonio_node_variance(&g->children.nodes[i]);
    }
    return (struct scatter){mean, pairwise_sum(off2, g->branching),
                            pairwise_sum(noises, g->branching)};
}

static float merge_error_of(double merge_error, const struct scatter *s)
{
    return (float)fmin(1e30, fmax(merge_error, s->noise > 0 ? s->squares / s->noise : 1e30));
}

bool orl_gonio_try_merge(const struct orl_gonio_cull *cull, struct orl_gonio_cells children,
                         unsigned branching, unsigned level, struct orl_gonio_cells ret_mean)
{
    struct group g = {cull, children, branching, level, true, 0};
    struct orl_gonio_node *mean = ret_mean.nodes;
    if (are_dark(children.nodes, branching)) {
        *mean = (struct orl_gonio_node){.path = path_of(children.nodes, branching)};
        if (ret_mean.colors)
            *ret_mean.colors = (struct orl_gonio_color){.value = {0}};
        return true;
    }
    for (unsigned i = 0; i < branching; i++) {
        g.merge_error = fmax(g.merge_error, (double)children.nodes[i].merge_error);
        g.leaves = g.leaves && !children.nodes[i].branch;
    }
    *mean = mean_of(children.nodes, branching);
    const struct scatter s = scatter_of(&g, (double)mean->value);
    mean->merge_error = merge_error_of(g.merge_error, &s);
    if (children.colors) {
        const struct color_match match =
            match_chromaticity(cull, children, branching, level, ret_mean.colors);
        mean->merge_error = fmaxf(mean->merge_error, match.merge_error);
        if (!match.is_match)
            return false;
    }
    if (!is_chance(&g, &s))
        return can_merge(&g, &s);
    /* Nodes that differ as much as their errors were selected because they appeared alike. */
    mean->spread +=
        (float)(selection_bias * (s.squares - s.noise * (branching - 1) / branching) / branching);
    return true;
}

/* Reserves space for one more branch. Returns false if out of memory. */
static bool reserve_branch(struct orl_gonio_builder *builder)
{
    return builder->count < UINT32_MAX - 1 &&
           orl_array_reserve(&builder->branches, &builder->capacity, builder->count,
                             sizeof *builder->branches) &&
           (!builder->color || orl_array_reserve(&builder->colors, &builder->colors_capacity,
                                                 builder->count, sizeof *builder->colors));
}

/* Makes one node over 2^rank others at `level`: a branch or a leaf. Returns false if out of
 * memory. */
static bool merge_children(struct orl_gonio_builder *builder, struct orl_gonio_cells children,
                           unsigned level, struct orl_gonio_cells ret_node)
{
    const unsigned branching = 1U << builder->rank;
    struct orl_gonio_node node;
    const bool one = orl_gonio_try_merge(&builder->cull, children, branching, level,
                                         (struct orl_gonio_cells){&node, ret_node.colors});
    if (builder->rank == 3 && level == 0) /* two of eight parts are independent */
        node.variance *= 4;
    if (one) {
        node.merge_error = 0;
        *ret_node.nodes = node;
        return true;
    }
    if (!reserve_branch(builder))
        return false;
    memcpy(builder->branches[builder->count].child, children.nodes,
           branching * sizeof *children.nodes);
    if (builder->color)
        memcpy(builder->colors[builder->count].child, children.colors,
               branching * sizeof *children.colors);
    node.branch = (uint32_t)++builder->count;
    *ret_node.nodes = node;
    return true;
}

bool orl_gonio_builder_merge_level(struct orl_gonio_builder *builder, struct orl_gonio_cells parts,
                                   size_t count, unsigned level, struct orl_gonio_cells ret_nodes)
{
    const unsigned in = orl_gonio_children_in(builder->rank);
    for (size_t i = 0; i < count; i++) {
        struct orl_gonio_node nodes[ORL_GONIO_MAX_BRANCHING];
        struct orl_gonio_color colors[ORL_GONIO_MAX_BRANCHING];
        const struct orl_gonio_cells children = {nodes, parts.colors ? colors : NULL};
        for (unsigned a = 0; a < in; a++)
            for (unsigned b = 0; b < 4; b++)
                orl_gonio_cells_copy(orl_gonio_cells_at(children, a + b * in),
                                     orl_gonio_cells_at(parts, 4 * (a * count + i) + b), 1);
        if (!merge_children(builder, children, level + 1, orl_gonio_cells_at(ret_nodes, i)))
            return false;
    }
    return true;
}

bool orl_gonio_merge_nodes(const struct orl_gonio_merger *merger, unsigned level, uint32_t a,
                           struct orl_gonio_cells ret_cells)
{
    const size_t in = orl_gonio_children_in(merger->builder->rank);
    const size_t count = merger->components << 2 * level;
    struct orl_gonio_cells parts;
    if (level == merger->end)
        return merger->fill(merger->ctx, a, ret_cells);
    bool fine = orl_gonio_cells_make(&parts, in * 4 * count, merger->builder->color);
    for (size_t k = 0; k < in && fine; k++) {
        const struct orl_gonio_cells part = orl_gonio_cells_at(parts, k * 4 * count);
        if (merger->builder->rank == 3 && level == 0 && k == 1)
            orl_gonio_cells_copy(part, parts, 4 * count);
        else
            fine = orl_gonio_merge_nodes(merger, level + 1, (uint32_t)(in * a + k), part);
    }
    fine = fine && orl_gonio_builder_merge_level(merger->builder, parts, count, level, ret_cells);
    orl_gonio_cells_done(&parts);
    return fine;
}

struct orl_gonio_split orl_gonio_split_of(enum orl_bsdf_basis basis, uint32_t resolution,
                                          unsigned most_split)
{
    struct orl_gonio_split s = {.rank = basis == ORL_BSDF_TENSOR_TREE_4 ? 4 : 3, .levels = 1};
    while (1U << s.levels < resolution)
        s.levels++;
    s.split = s.rank == 3 || s.levels < most_split ? s.levels : most_split;
    s.n_subtrees = s.rank == 3 ? (size_t)1 << (s.levels - 1) : (size_t)1 << 2 * s.split;
    return s;
}

double orl_gonio_diffuse_weight(const struct orl_gonio_split *split, size_t subtree)
{
    const double n = (double)split->n_subtrees;
    return split->rank == 4 ? ldexp(1, -2 * (int)split->levels)
                            : (2 * (n - (double)subtree) - 1) / (n * n);
}

struct orl_gonio_node orl_gonio_node_shifted(struct orl_gonio_node node, uint32_t shift)
{
    if (node.branch)
        node.branch += shift;
    return node;
}

bool orl_gonio_builder_append(struct orl_gonio_builder *builder,
                              const struct orl_gonio_builder *other, unsigned mirror,
                              uint32_t *ret_shift)
{
    const uint32_t shift = (uint32_t)builder->count;
    if (other->count >= UINT32_MAX - 1 - builder->count)
        return false;
    for (size_t k = 0; k < other->count; k++) {
        if (!reserve_branch(builder))
            return false;
        const size_t at = builder->count++;
        for (unsigned i = 0; i < 1U << builder->rank; i++) {
            builder->branches[at].child[i] =
                orl_gonio_node_shifted(other->branches[k].child[i ^ mirror], shift);
            if (builder->color)
                builder->colors[at].child[i] = other->colors[k].child[i ^ mirror];
        }
    }
    *ret_shift = shift;
    return true;
}

/* Recursive; the depth is at most seven. */
void orl_gonio_builder_write(const struct orl_gonio_builder *builder, struct orl_gonio_node root,
                             bool errors, const atomic_bool *cancel, FILE *out)
{
    if (root.branch && orl_is_cancelled(cancel))
        return;
    fputs("{ ", out);
    if (root.branch) {
        const struct orl_gonio_branch *branch = &builder->branches[root.branch - 1];
        fputs("\n", out);
        for (unsigned i = 0; i < 1U << builder->rank; i++)
            orl_gonio_builder_write(builder, branch->child[i], errors, cancel, out);
    } else {
        orl_write_value(out, errors ? (float)orl_gonio_node_error(&root) : root.value);
    }
    fputs(" }\n", out);
}

double orl_gonio_builder_peak(const struct orl_gonio_builder *builder, struct orl_gonio_node root)
{
    double peak = 0;
    if (!root.branch)
        return (double)root.value;
    for (unsigned i = 0; i < 1U << builder->rank; i++)
        peak = fmax(peak,
                    orl_gonio_builder_peak(builder, builder->branches[root.branch - 1].child[i]));
    return peak;
}

void orl_gonio_builder_max_errors(const struct orl_gonio_builder *builder,
                                  struct orl_gonio_node root, double from,
                                  struct orl_gonio_max_error *worst)
{
    const double value = (double)root.value, path = (double)root.path;
    for (unsigned i = 0; root.branch && i < 1U << builder->rank; i++)
        orl_gonio_builder_max_errors(builder, builder->branches[root.branch - 1].child[i], from,
                                     worst);
    if (root.branch || !(value > 0) || value < from)
        return;
    worst->noise = fmax(worst->noise, sqrt((double)root.variance + path * path) / value);
    worst->merge_error = fmax(worst->merge_error, sqrt(fmax(0, (double)root.spread)) / value);
}
