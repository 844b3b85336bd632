/*
 * Colour of a tensor tree's cells under construction: red, green and blue beside the luminance
 * (forest.h).
 *
 * Luminance and colour share one subdivision. Cells are joined if both their luminances and their
 * chromaticities allow it. Each channel is compared with the chromaticity of the cells' total
 * light. The difference must be within its errors, the share that cells may differ by, or an amount
 * of light that counts. A joined cell has the chromaticity of the total light, so no channel loses
 * light. Errors of chromaticities come from batches, as for values. They are much smaller if all
 * paths to a cell have one colour.
 *
 * A file has separate trees for u' and v', usually much coarser than that of luminances. Cells that
 * are not joined share a chromaticity if theirs agree to a quarter of that share at each level.
 */
#ifndef ORL_GONIOMETER_HUES_H
#define ORL_GONIOMETER_HUES_H

#include "bsdf/write_xml.h"
#include "goniometer/forest.h"

/* Result of joining chromaticities: is_one is true if fan nodes at `level` can have the
 * chromaticity of their total light. Otherwise doubt is the ratio of squared differences to squared
 * errors. orl_gonio_blend_of also sets their mean. */
struct orl_gonio_blend {
    bool is_one;
    float doubt;
};
struct orl_gonio_blend orl_gonio_blend_of(const struct orl_gonio_cull *cull,
                                          struct orl_gonio_cells children, unsigned fan,
                                          unsigned level, struct orl_gonio_hue *ret_mean);

/* Writes the braces of u' or v'; dark cells have the chromaticity of grey. */
void orl_gonio_hues_write(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                          struct orl_gonio_hue hue, enum orl_bsdf_channel channel,
                          const atomic_bool *cancel, FILE *out);

#endif
