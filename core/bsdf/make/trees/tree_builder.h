/*
 * Tensor trees under construction: cells with values and error estimates, from the finest up. Rank
 * 4 or 3 (bsdf/tree/tree.h, iso.h). A branch has a child for each combination of halves of (A.x,
 * A.y, B.x, B.y), or of (A, B.x, B.y), numbered by these bits.
 *
 * The cells of a branch are merged to a leaf if the data do not distinguish them. Their differences
 * must be within their standard errors, below a given share of their mean, or below an amount of
 * light that counts. The leaf has their mean, and the standard deviation of the cells from it. That
 * includes the standard error of the mean and the differences of the cells. Colours are compared in
 * addition; errors are those of luminance.
 *
 * Ownership: the caller's, freed by orl_gonio_builder_done. One thread writes at a time.
 */
#ifndef ORL_BSDF_MAKE_TREES_TREE_BUILDER_H
#define ORL_BSDF_MAKE_TREES_TREE_BUILDER_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <oriel/base/thread_pool.h>

#include <oriel/bsdf/bsdf_make.h>

#include "bsdf/xml/bsdf_xml.h"

enum { ORL_GONIO_MAX_BRANCHING = 16 };

/* A leaf or a branch. */
struct orl_gonio_node {
    float value, variance; /* 1/sr; variance of the mean, in a branch of all below */
    float path;   /* value contributed by a single path, 1/sr: a lower limit of the error */
    float spread; /* mean squared difference of the finest cells below from the value, beyond what
                     their errors explain; may be negative by chance */
    float merge_error; /* branch: largest ratio of squared differences below it to their squared
                    errors; leaf: 0 */
    uint32_t branch;   /* 1 + index of the branch; 0: a leaf */
};

struct orl_gonio_branch {
    struct orl_gonio_node child[ORL_GONIO_MAX_BRANCHING];
};

/*
 * Colour of a node beside its luminance: red, green and blue. noise: variances of their differences
 * from the luminance in the node's own chromaticity.
 *
 * Luminance and colour share one subdivision. Cells are merged if both their luminances and their
 * chromaticities allow it. Each channel is compared with the chromaticity of the cells' total
 * light. The difference must be within its errors, the share that cells may differ by, or an amount
 * of light that counts. A merged cell has the chromaticity of the total light, so no channel loses
 * light. Errors of chromaticities come from batches, as for values. They are much smaller if all
 * paths to a cell have one colour.
 *
 * A file has separate trees for u' and v', usually much coarser than that of luminances. Cells that
 * are not merged share a chromaticity if theirs agree to a quarter of that share at each level.
 */
enum { ORL_GONIO_COLORS = 3 };
struct orl_gonio_color {
    float value[ORL_GONIO_COLORS], noise[ORL_GONIO_COLORS];
};

struct orl_gonio_branch_colors {
    struct orl_gonio_color child[ORL_GONIO_MAX_BRANCHING];
};

/* An array of nodes with their colours. */
struct orl_gonio_cells {
    struct orl_gonio_node *nodes;
    struct orl_gonio_color *colors; /* NULL: luminance only */
};
/* Allocates count cells. Returns false if out of memory; *cells is then empty. */
bool orl_gonio_cells_make(struct orl_gonio_cells *cells, size_t count, bool color);
void orl_gonio_cells_done(struct orl_gonio_cells *cells);
static inline struct orl_gonio_cells orl_gonio_cells_at(struct orl_gonio_cells cells, size_t first)
{
    return (struct orl_gonio_cells){cells.nodes + first,
                                    cells.colors ? cells.colors + first : NULL};
}
void orl_gonio_cells_copy(struct orl_gonio_cells to, struct orl_gonio_cells from, size_t count);

/* Limits on the differences of cells from their mean when they are merged, unless errors explain
 * the differences. */
struct orl_gonio_cull {
    double share;         /* share of the mean */
    double cull_fraction; /* or light that a cell may redirect, as a share of the incident light */
};

struct orl_gonio_builder {
    unsigned rank;
    struct orl_gonio_cull cull;
    bool color;
    struct orl_gonio_branch *branches;      /* owned */
    struct orl_gonio_branch_colors *colors; /* colours, one per branch; owned */
    size_t count, capacity, colors_capacity;
};

void orl_gonio_builder_done(struct orl_gonio_builder *builder);

/* Returns the variance of a cell's mean, at least that of one path. A dark cell has none. */
static inline double orl_gonio_node_variance(const struct orl_gonio_node *node)
{
    const double variance = (double)node->variance, path = (double)node->path;
    return node->value > 0 ? fmax(variance, path * path) : 0;
}
/* Returns the standard deviation of a leaf's finest cells from its value, including the error,
 * 1/sr. */
static inline double orl_gonio_node_error(const struct orl_gonio_node *node)
{
    const double path = (double)node->path;
    return sqrt((double)node->variance + path * path + fmax(0, (double)node->spread));
}

/* Returns true if nodes at `level` can be replaced by their mean, and sets the mean. The mean's
 * merge error is the largest ratio of squared differences to squared errors. */
bool orl_gonio_try_merge(const struct orl_gonio_cull *cull, struct orl_gonio_cells children,
                         unsigned branching, unsigned level, struct orl_gonio_cells ret_mean);

/* Returns the children of a cell of directions in at the next level: 4 in rank 4, 2 in rank 3. */
static inline unsigned orl_gonio_children_in(unsigned rank)
{
    return rank == 4 ? 4 : 2;
}
/* Makes the count nodes of one cell in at `level` from those of its children (parts). Each child
 * has four times as many nodes, one child after another. Returns false if out of memory. */
bool orl_gonio_builder_merge_level(struct orl_gonio_builder *builder, struct orl_gonio_cells parts,
                                   size_t count, unsigned level, struct orl_gonio_cells ret_nodes);

/*
 * Computes the nodes of a cell of directions in, by merging those of finer cells: `fill` sets the
 * nodes of the cells at level `end`. In rank 3 the upper half of A has no directions; it is a copy
 * of the lower one.
 */
struct orl_gonio_merger {
    struct orl_gonio_builder *builder;
    unsigned end;
    size_t components; /* nodes for each cell out: 2, reflected and transmitted, or 1 */
    bool (*fill)(void *ctx, uint32_t a, struct orl_gonio_cells ret_cells);
    void *ctx;
};
/* Sets the nodes of cell a at `level`. Returns false if out of memory, or if `fill` did. */
bool orl_gonio_merge_nodes(const struct orl_gonio_merger *merger, unsigned level, uint32_t a,
                           struct orl_gonio_cells ret_cells);

/* Subtrees of directions in that are computed separately: cells at level `split`. In rank 3 every
 * ring is a subtree, and half of A has none. */
struct orl_gonio_split {
    unsigned rank, levels, split; /* there are 2^levels finest cells a side */
    size_t n_subtrees;
};
struct orl_gonio_split orl_gonio_split_of(enum orl_bsdf_basis basis, uint32_t resolution,
                                          unsigned most_split);
/* Returns the weight of a subtree's finest cells in diffuse light. Cells have equal weights in rank
 * 4, and rings have weights by their size in rank 3. */
double orl_gonio_diffuse_weight(const struct orl_gonio_split *split, size_t subtree);

/* Returns the mirror image of a cell of a square at a level. mirror: bit 0 for x, bit 1 for y. */
static inline uint32_t orl_gonio_mirrored_cell(uint32_t cell, unsigned level, unsigned mirror)
{
    for (unsigned l = 0; l < level; l++)
        cell ^= mirror << 2 * l;
    return cell;
}

/* Copies all branches of another builder, with mirrored children: the i-th is the (i ^ mirror)-th.
 * *ret_shift: to be added to branch numbers (orl_gonio_node_shifted). Returns false if out of
 * memory. */
bool orl_gonio_builder_append(struct orl_gonio_builder *builder,
                              const struct orl_gonio_builder *other, unsigned mirror,
                              uint32_t *ret_shift);
struct orl_gonio_node orl_gonio_node_shifted(struct orl_gonio_node node, uint32_t shift);

/* Writes a tree in the braces of a file: luminances, or their errors. Incomplete if cancelled. */
void orl_gonio_builder_write(const struct orl_gonio_builder *builder, struct orl_gonio_node root,
                             bool errors, const atomic_bool *cancel, FILE *out);

/* Returns the largest leaf, 1/sr. */
double orl_gonio_builder_peak(const struct orl_gonio_builder *builder, struct orl_gonio_node root);
/* Largest relative errors over leaves whose value is at least `from`: of the mean (noise), and of
 * the merged cells (merge_error). orl_gonio_builder_max_errors only raises the present figures. */
struct orl_gonio_max_error {
    double noise, merge_error;
};
void orl_gonio_builder_max_errors(const struct orl_gonio_builder *builder,
                                  struct orl_gonio_node root, double from,
                                  struct orl_gonio_max_error *worst);

/* Writes the braces of u' or v'; dark cells have the chromaticity of grey. */
void orl_gonio_write_chromaticity(const struct orl_gonio_builder *builder,
                                  struct orl_gonio_node root, struct orl_gonio_color node_color,
                                  enum orl_bsdf_channel channel, const atomic_bool *cancel,
                                  FILE *out);

#endif
