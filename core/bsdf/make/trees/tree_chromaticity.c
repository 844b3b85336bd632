#include "bsdf/make/trees/tree_chromaticity.h"

#include <math.h>

#include <oriel/base/units.h>

#include "bsdf/color.h"
#include "bsdf/make/trees/node_statistics.h"

/* Relative difference that rounding may cause. */
static const double rounding_error = 1e-6;
/* Share of the allowed difference for cells that are not joined. */
static const double unmerged_share = 0.25;

/* One channel of nodes compared with their luminances in one chromaticity: sums of squares. */
struct channel_spread {
    double off, noise, value;
};

/* unit: the channel divided by the luminance, over all nodes. A node with few paths has a
 * chromaticity as uncertain as its luminance. */
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
    return (struct channel_spread){orl_gonio_pairwise_sum(off2, branching),
                                   orl_gonio_pairwise_sum(noises, branching),
                                   orl_gonio_pairwise_sum(values, branching)};
}

static struct orl_gonio_color mean_of(struct orl_gonio_cells children, unsigned branching)
{
    struct orl_gonio_color mean;
    for (int c = 0; c < ORL_GONIO_COLORS; c++) {
        double values[ORL_GONIO_MAX_BRANCHING] = {0}, noises[ORL_GONIO_MAX_BRANCHING] = {0};
        for (unsigned i = 0; i < branching; i++) {
            values[i] = (double)children.colors[i].value[c];
            noises[i] = (double)children.colors[i].noise[c];
        }
        mean.value[c] = (float)(orl_gonio_pairwise_sum(values, branching) / branching);
        mean.noise[c] =
            (float)(orl_gonio_pairwise_sum(noises, branching) / (branching * branching));
    }
    return mean;
}

static double luma_of(struct orl_gonio_cells children, unsigned branching)
{
    double values[ORL_GONIO_MAX_BRANCHING] = {0};
    for (unsigned i = 0; i < branching; i++)
        values[i] = (double)children.nodes[i].value;
    return orl_gonio_pairwise_sum(values, branching) / branching;
}

struct orl_gonio_color_match orl_gonio_match_chromaticity(const struct orl_gonio_cull *cull,
                                                          struct orl_gonio_cells children,
                                                          unsigned branching, unsigned level,
                                                          struct orl_gonio_color *ret_mean)
{
    const double omega = ldexp(ORL_PI, -2 * (int)level),
                 cull_fraction = cull->cull_fraction / omega;
    const double share = fmax(cull->share, rounding_error), luma = luma_of(children, branching);
    struct orl_gonio_color_match match = {true, 0};
    const struct orl_gonio_color mean = mean_of(children, branching);
    for (int c = 0; c < ORL_GONIO_COLORS && luma > 0; c++) {
        const struct channel_spread s =
            channel_spread_of(children, branching, c, (double)mean.value[c] / luma);
        if (s.off <= fmax(share * share * s.value, branching * cull_fraction * cull_fraction))
            continue;
        const double ratio = s.noise > 0 ? fmin(s.off / s.noise, 1e30) : 1e30;
        match.merge_error = fmaxf(match.merge_error, (float)ratio);
        match.is_match = match.is_match && ratio <= orl_gonio_chi_square_limit(branching);
    }
    *ret_mean = mean;
    return match;
}

/* ---- The file -------------------------------------------------------------------------------- */

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
    return orl_gonio_match_chromaticity(&cull, children, 1U << builder->rank, level + 1, &mean)
        .is_match;
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
