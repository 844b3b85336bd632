/*
 * Colour of a tensor tree's cells under construction: red, green and blue beside the luminance
 * (builder.h).
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
#ifndef ORL_BSDF_MAKE_TREES_TREE_CHROMATICITY_H
#define ORL_BSDF_MAKE_TREES_TREE_CHROMATICITY_H

#include "bsdf/make/trees/tree_builder.h"
#include "bsdf/xml/write_xml.h"

/* Result of joining chromaticities: is_one is true if nodes at `level` can have the
 * chromaticity of their total light. Otherwise merge error is the ratio of squared differences to
 * squared errors. orl_gonio_match_chromaticity also sets their mean. */
struct orl_gonio_color_match {
    bool is_match;
    float merge_error;
};
struct orl_gonio_color_match orl_gonio_match_chromaticity(const struct orl_gonio_cull *cull,
                                                          struct orl_gonio_cells children,
                                                          unsigned branching, unsigned level,
                                                          struct orl_gonio_color *ret_mean);

/* Writes the braces of u' or v'; dark cells have the chromaticity of grey. */
void orl_gonio_write_chromaticity(const struct orl_gonio_builder *builder,
                                  struct orl_gonio_node root, struct orl_gonio_color node_color,
                                  enum orl_bsdf_channel channel, const atomic_bool *cancel,
                                  FILE *out);

#endif
