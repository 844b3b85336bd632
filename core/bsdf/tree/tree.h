/*
 * Tensor tree of rank 4: a function of two directions, each given by its place on the Shirley-Chiu
 * square, constant over cells (leaves) of varying size.
 *
 * Axes. The tree's two directions are A (the file's "incident", mapped with x and y negated, as the
 * light travels) and B (the file's "exitant"). A child of a branch is numbered by four bits: bit 0
 * A.x, bit 1 A.y, bit 2 B.x, bit 3 B.y; a set bit is the upper half.
 *
 * Storage: one array of lines of 16 words, a cache line each, children before parents. A word of a
 * branch is a child. A leaf is its value, a float that is never negative. A branch has the sign bit
 * set, depth - 1 (3 bits) and the index of its first line (28 bits). Its depth is the number of
 * levels of branches that the node spans, itself included. A branch is stored as
 *     1 line             its children
 * and, if its depth is at least 2 (not all children are leaves),
 *     4^depth words      float means over B, for each cell of A at 2^depth a side, x-major
 *     4^depth words      float means over A, for each cell of B
 * With the means, sampling one direction given the other is a descent that chooses among four sums
 * at each level. The means of a lowest branch are summed on demand, which costs less than fetching
 * them.
 *
 * Invariants: leaves are finite and not negative (xml/data_text.h); the tree is immutable once
 * built. Threads: any number may read. References: Ward, Kurt and Bonneel 2014 (the format);
 * Clarberg, Jarosz, Akenine-Moller and Jensen 2005 (warping uniforms down a hierarchy of means).
 */
#ifndef ORL_BSDF_TREE_TREE_H
#define ORL_BSDF_TREE_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <oriel/base/error.h>

#include "bsdf/tree/shirley.h"

enum { ORL_TREE_FANOUT = 16, ORL_TREE_INDEX_BITS = 28 };

/* The direction that is given. */
enum orl_tree_axis { ORL_AXIS_A = 0, ORL_AXIS_B = 1 };

/* A leaf or a branch, as a word of the storage. */
struct orl_tree_ref {
    uint32_t bits;
};

struct orl_tree_line {
    uint32_t words[ORL_TREE_FANOUT];
};

struct orl_tree {
    struct orl_tree_line *lines; /* aligned to 64 bytes; owned */
    size_t n_lines, capacity;
    struct orl_tree_ref root;
    unsigned depth; /* log2 of the resolution per axis; 0: a single leaf */
    size_t values;  /* number of leaves in the file */
    size_t clamped; /* negative values set to zero */
    float minimum;  /* over all leaves */
    bool eval_only; /* true for a tree that is only evaluated: no means, one line per branch */
};

/* ---- Building (tree_build.c) ----------------------------------------------------------------- */

/* Appends a branch with its means over 16 finished children; 16 equal leaves become one leaf.
 * Returns 0, ORL_ERR_LIMIT or ORL_ERR_NOMEM. */
int orl_tree_branch(struct orl_tree *tree, const struct orl_tree_ref child[ORL_TREE_FANOUT],
                    struct orl_tree_ref *ret_ref, struct orl_error *err);
/* Appends a full grid of 2^log2_side cells per axis: A.x slowest, B.y fastest. Errors as for
 * orl_tree_branch. */
int orl_tree_grid(struct orl_tree *tree, const float *values, unsigned log2_side,
                  struct orl_tree_ref *ret_ref, struct orl_error *err);
struct orl_tree_ref orl_tree_leaf(float value);
/* Sets the root and frees spare memory. */
void orl_tree_finish(struct orl_tree *tree, struct orl_tree_ref root);
void orl_tree_done(struct orl_tree *tree); /* a partly built tree is allowed */

/* ---- Reading (tree.c) ------------------------------------------------------------------------ */

static inline bool orl_tree_is_leaf(struct orl_tree_ref ref)
{
    return !(ref.bits >> 31);
}

/* Returns the levels of branches from this node down; 0 for a leaf. */
static inline unsigned orl_tree_depth(struct orl_tree_ref ref)
{
    return orl_tree_is_leaf(ref) ? 0 : (ref.bits >> ORL_TREE_INDEX_BITS & 7) + 1;
}

/* Returns the index of a branch's first line. */
static inline size_t orl_tree_index(struct orl_tree_ref ref)
{
    return ref.bits & ((1U << ORL_TREE_INDEX_BITS) - 1);
}

static inline struct orl_tree_ref orl_tree_child(const struct orl_tree *tree,
                                                 struct orl_tree_ref ref, unsigned i)
{
    return (struct orl_tree_ref){tree->lines[orl_tree_index(ref)].words[i]};
}

static inline float orl_tree_leaf_value(struct orl_tree_ref leaf)
{
    float value;
    memcpy(&value, &leaf.bits, sizeof value);
    return value;
}

/*
 * Returns the mean over the other direction of a lowest branch's leaves, for a given direction in
 * quarter x | y << 1.
 */
static inline float orl_tree_mean_of_leaves(const uint32_t words[ORL_TREE_FANOUT],
                                            enum orl_tree_axis given, unsigned quarter)
{
    const size_t first = given == ORL_AXIS_A ? quarter : 4 * (size_t)quarter;
    const size_t step = given == ORL_AXIS_A ? 4 : 1;
    float leaf[4];
    for (size_t k = 0; k < 4; k++)
        memcpy(leaf + k, words + first + k * step, sizeof *leaf);
    return 0.25F * ((leaf[0] + leaf[1]) + (leaf[2] + leaf[3]));
}

/* Returns true if both trees have the same cells and values. */
bool orl_tree_equal(const struct orl_tree *tree, const struct orl_tree *other);

/* Evaluates the tree. Directions here and below are places on the square from orl_disk_to_square;
 * the function turns A's itself. */

double orl_tree_eval(const struct orl_tree *tree, struct orl_square a, struct orl_square b);

/* Returns the cell of a direction if the square has 2^depth a side: x << depth | y. */
size_t orl_square_cell(enum orl_tree_axis axis, struct orl_square place, unsigned depth);

/* Evaluates the tree, and sets the number of times each axis is halved down to the leaf. */
double orl_tree_eval_level(const struct orl_tree *tree, struct orl_square a, struct orl_square b,
                           unsigned *ret_level);

/*
 * Reads a window of finest cells of B for one finest cell of A: side * side cells from (low_x,
 * low_y), x fastest. `finest` is true for leaves of the finest size. Cells beyond the square are
 * left unchanged.
 */
struct orl_tree_window {
    unsigned a_x, a_y;
    int low_x, low_y, side;
    double *values;
    bool *finest;
};
void orl_tree_read_window(const struct orl_tree *tree, const struct orl_tree_window *window);

/*
 * Returns a direction of that axis, with z > 0, in cell (x, y) of the square halved `level` times;
 * u, v in [0,1) give the place in the cell.
 */
struct orl_vec3 orl_square_cell_direction(enum orl_tree_axis axis, unsigned x, unsigned y,
                                          unsigned level, double u, double v);

/* Returns the integral of value times cosine over the other hemisphere, for the given direction. */
double orl_tree_total(const struct orl_tree *tree, enum orl_tree_axis given,
                      struct orl_square place);
/* Prefetches the memory that orl_tree_total will read. */
void orl_tree_prefetch_total(const struct orl_tree *tree, enum orl_tree_axis given,
                             struct orl_square place);

/*
 * Samples the other direction in proportion to value times cosine; u: two uniforms in [0,1).
 * orl_tree_total must be positive. Returns the value there; ret_direction has z > 0.
 */
double orl_tree_sample(const struct orl_tree *tree, enum orl_tree_axis given,
                       struct orl_square place, const double u[2], struct orl_vec3 *ret_direction);

/* Arguments and results of orl_tree_sample. */
struct orl_tree_sample {
    const struct orl_tree *tree;
    enum orl_tree_axis given;
    struct orl_square place;
    double u[2];
    struct orl_vec3 direction;
    double value;
};

/* Samples n times like orl_tree_sample. Memory accesses overlap, so many samples take the time of a
 * few. */
void orl_tree_sample_many(struct orl_tree_sample *samples, size_t n);

#endif
