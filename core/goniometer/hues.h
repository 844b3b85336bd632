/*
 * Colour of a tensor tree's cells while they are measured: red, green and blue beside the luminance
 * of each (forest.h).
 *
 * There is one subdivision. Cells become one where their luminances are, and their chromaticities
 * too: where by that of their light in all no channel of any is off by more than its errors
 * explain, than the share that cells may be off by, or than light that counts. So a cell has the
 * chromaticity of its light in all, and no channel loses any. Errors are known of chromaticities as
 * of values, by batches: they are far smaller where all paths to a cell have one colour, whatever
 * their number.
 *
 * A file has trees of their own for u' and v', as a rule much coarser than that of luminances: of
 * cells that are told apart, those have one chromaticity which are alike to a quarter of that share
 * at each level that they are joined over.
 */
#ifndef ORL_GONIOMETER_HUES_H
#define ORL_GONIOMETER_HUES_H

#include "bsdf/write.h"
#include "goniometer/forest.h"

/* Whether fan nodes, which lie level deep, are as good by the chromaticity of all of them; if they
 * are not, by how much they differ more than errors explain, as a ratio of squares. Fills in their
 * mean. */
struct orl_gonio_blend {
    bool is_one;
    float doubt;
};
struct orl_gonio_blend orl_gonio_blend_of(const struct orl_gonio_cull *cull,
                                          struct orl_gonio_cells children, unsigned fan,
                                          unsigned level, struct orl_gonio_hue *ret_mean);

/* The braces of u' or v'; of cells in the dark it is that of grey. */
void orl_gonio_hues_write(const struct orl_gonio_forest *forest, struct orl_gonio_node root,
                          struct orl_gonio_hue hue, enum orl_bsdf_channel channel,
                          const atomic_bool *cancel, FILE *out);

#endif
