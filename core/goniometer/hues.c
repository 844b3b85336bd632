#include "goniometer/hues.h"

#include <math.h>

#include <oriel/units.h>

#include "bsdf/color.h"
#include "goniometer/fan.h"

/* Relative difference that rounding may cause. */
static const double rounding = 1e-6;
/* Share of the allowed difference for cells that are not joined. */
static const double apart = 0.25;

/* One channel of nodes compared with their luminances in one chromaticity: sums of squares. */
struct shades {
    double off, noise, value;
};

/* unit: the channel divided by the luminance, over all nodes. A node with few paths has a
 * chromaticity as uncertain as its luminance. */
static struct shades shades_of(struct orl_gonio_cells children, unsigned fan, int c, double unit)
{
    double off2[ORL_GONIO_FAN_MOST] = {0}, noises[ORL_GONIO_FAN_MOST] = {0};
    double values[ORL_GONIO_FAN_MOST] = {0};
    for (unsigned i = 0; i < fan; i++) {
        const struct orl_gonio_node *node = &children.nodes[i];
        const double luma = (double)node->value, wanted = unit * luma;
        const double off = (double)children.hues[i].value[c] - wanted;
        const double turn = luma > 0 ? off / luma : 0;
        off2[i] = off * off;
        noises[i] = (double)children.hues[i].noise[c] + turn * turn * orl_gonio_noise(node);
        values[i] = wanted * wanted;
    }
    return (struct shades){orl_gonio_sum(off2, fan), orl_gonio_sum(noises, fan),
                           orl_gonio_sum(values, fan)};
}

static struct orl_gonio_hue mean_of(struct orl_gonio_cells children, unsigned fan)
{
    struct orl_gonio_hue mean;
    for (int c = 0; c < ORL_GONIO_HUES; c++) {
        double values[ORL_GONIO_FAN_MOST] = {0}, noises[ORL_GONIO_FAN_MOST] = {0};
        for (unsigned i = 0; i < fan; i++) {
            values[i] = (double)children.hues[i].value[c];
            noises[i] = (double)children.hues[i].noise[c];
        }
        mean.value[c] = (float)(orl_gonio_sum(values, fan) / fan);
        mean.noise[c] = (float)(orl_gonio_sum(noises, fan) / (fan * fan));
    }
    return mean;
}

static double luma_of(struct orl_gonio_cells children, unsigned fan)
{
    double values[ORL_GONIO_FAN_MOST] = {0};
    for (unsigned i = 0; i < fan; i++)
        values[i] = (double)children.nodes[i].value;
    return orl_gonio_sum(values, fan) / fan;
}

struct orl_gonio_blend orl_gonio_blend_of(const struct orl_gonio_cull *cull,
                                          struct orl_gonio_cells children, unsigned fan,
                                          unsigned level, struct orl_gonio_hue *ret_mean)
{
    const double omega = ldexp(ORL_PI, -2 * (int)level), unseen = cull->unseen / omega;
    const double share = fmax(cull->share, rounding), luma = luma_of(children, fan);
    struct orl_gonio_blend blend = {true, 0};
    const struct orl_gonio_hue mean = mean_of(children, fan);
    for (int c = 0; c < ORL_GONIO_HUES && luma > 0; c++) {
        const struct shades s = shades_of(children, fan, c, (double)mean.value[c] / luma);
        if (s.off <= fmax(share * share * s.value, fan * unseen * unseen))
            continue;
        const double ratio = s.noise > 0 ? fmin(s.off / s.noise, 1e30) : 1e30;
        blend.doubt = fmaxf(blend.doubt, (float)ratio);
        blend.is_one = blend.is_one && ratio <= orl_gonio_by_chance(fan);
    }
    *ret_mean = mean;
    return blend;
}

/* ---- The file -------------------------------------------------------------------------------- */

static struct orl_gonio_cells children_of(const struct orl_gonio_forest *forest, uint32_t branch)
{
    return (struct orl_gonio_cells){forest->branches[branch - 1].child,
                                    forest->hues[branch - 1].child};
}

/* Returns true if a node at `level` has one chromaticity. */
static bool is_one(const struct orl_gonio_forest *forest, const struct orl_gonio_node *node,
                   unsigned level)
{
    const struct orl_gonio_cull cull = {apart * forest->cull.share, forest->cull.unseen};
    struct orl_gonio_hue mean;
    if (!node->branch || !(node->value > 0))
        return true;
    const struct orl_gonio_cells children = children_of(forest, node->branch);
    for (unsigned i = 0; i < 1U << forest->rank; i++)
        if (!is_one(forest, &children.nodes[i], level + 1))
            return false;
    return orl_gonio_blend_of(&cull, children, 1U << forest->rank, level + 1, &mean).is_one;
}

static void write_hues(const struct orl_gonio_forest *forest, const struct orl_gonio_node *node,
                       const struct orl_gonio_hue *hue, unsigned level,
                       enum orl_bsdf_channel channel, const atomic_bool *cancel, FILE *out)
{
    if (node->branch && orl_is_cancelled(cancel))
        return;
    fputs("{ ", out);
    if (is_one(forest, node, level)) {
        double u, v;
        orl_color_uv(
            (struct orl_rgb){(double)hue->value[0], (double)hue->value[1], (double)hue->value[2]},
            &u, &v);
        orl_write_value(out, (float)(channel == ORL_CHANNEL_FIRST ? u : v));
    } else {
        const struct orl_gonio_cells children = children_of(forest, node->branch);
        fputs("\n", out);
        for (unsigned i = 0; i < 1U << forest->rank; i++)
            write_hues(forest, &children.nodes[i], &children.hues[i], level + 1, channel, cancel,
                       out);
    }
    fputs(" }\n", out);
}

void orl_gonio_hues_write(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                          struct orl_gonio_hue hue, enum orl_bsdf_channel channel,
                          const atomic_bool *cancel, FILE *out)
{
    write_hues(forest, &root, &hue, 0, channel, cancel, out);
}
