/*
 * A tensor tree of rank 4: a function of two directions, each given by its place on the
 * Shirley-Chiu square, constant over cells (leaves) of varying size.
 *
 * Axes. The tree's two directions are A (the file's "incident", mapped with x and y negated, as
 * the light travels) and B (the file's "exitant"). A child of a branch is numbered by four bits:
 * bit 0 A.x, bit 1 A.y, bit 2 B.x, bit 3 B.y; a set bit is the upper half.
 *
 * Store. The lowest branches, all of whose children are leaves, are blocks of 16 floats: one line
 * of the cache each. Higher branches are runs of 32-bit words:
 *     word 0       bit i set: child i is a leaf
 *     words 1..16  the children: a leaf's value (float), or depth << 28 | index, which counts
 *                  blocks for depth 1 and words above
 *     4^depth      float means over B, for each cell of A at 2^depth a side, x-major
 *     4^depth      float means over A, for each cell of B
 * depth is how many levels of branches the node spans, itself included. The means make a draw of
 * one direction given the other a plain descent: at each level, four sums to choose from. Those of
 * a block are summed when they are wanted, which costs less than fetching them.
 *
 * Invariants: leaves are finite and not negative (scan.h); the tree is immutable once built.
 * Threads: any number may read. References: Ward, Kurt and Bonneel 2014 (the format); Clarberg,
 * Jarosz, Akenine-Moller and Jensen 2005 (warping uniforms down a hierarchy of means).
 */
#ifndef ORL_BSDF_TREE_H
#define ORL_BSDF_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

#include "bsdf/shirley.h"

enum { ORL_TREE_FANOUT = 16, ORL_TREE_HEAD = 17, ORL_TREE_INDEX_BITS = 28 };

/* Which of the two directions is given. */
enum orl_axis { ORL_AXIS_A = 0, ORL_AXIS_B = 1 };

/* A leaf's value or a branch, as held in a branch's words. */
struct orl_tree_ref {
    uint32_t bits;
    bool leaf;
};

struct orl_tree {
    uint32_t *words; /* higher branches; owned */
    size_t n_words, words_capacity;
    float (*blocks)[ORL_TREE_FANOUT]; /* lowest branches, on cache lines; owned */
    size_t n_blocks, blocks_capacity;
    struct orl_tree_ref root;
    unsigned depth; /* log2 of the resolution per axis; 0: one leaf */
    size_t values;  /* leaves in the file */
    size_t clamped; /* negative values set to zero */
    float minimum;  /* over all leaves */
};

/* ---- Building (tree_build.c) ---------------------------------------------------------------- */

/* Appends a branch over 16 finished children and its means; 16 equal leaves become one leaf. */
int orl_tree_branch(struct orl_tree *tree, const struct orl_tree_ref child[ORL_TREE_FANOUT],
                    struct orl_tree_ref *ret_ref, struct orl_error *err);
/* The same for a full grid of 2^log2_side cells per axis: A.x slowest, B.y fastest. */
int orl_tree_grid(struct orl_tree *tree, const float *values, unsigned log2_side,
                  struct orl_tree_ref *ret_ref, struct orl_error *err);
struct orl_tree_ref orl_tree_leaf(float value);
/* Sets the root and gives back spare memory. */
void orl_tree_finish(struct orl_tree *tree, struct orl_tree_ref root);
void orl_tree_done(struct orl_tree *tree); /* NULL and half-built are allowed */

/* ---- Reading (tree.c) ------------------------------------------------------------------------ */

static inline unsigned orl_tree_ref_depth(struct orl_tree_ref ref)
{
    return ref.leaf ? 0 : ref.bits >> ORL_TREE_INDEX_BITS;
}

static inline uint32_t orl_tree_ref_index(struct orl_tree_ref ref)
{
    return ref.bits & ((1U << ORL_TREE_INDEX_BITS) - 1);
}

/*
 * The mean over the other direction, within ref's subtree, where the given direction lies in cell
 * (x, y); coordinates in units of the finest cell, of which ref's side has 2^level.
 */
float orl_tree_mean(const struct orl_tree *tree, struct orl_tree_ref ref, enum orl_axis given,
                    unsigned x, unsigned y, unsigned level);

/* Directions below are places on the square as orl_disk_to_square gives them; A's is turned inside.
 */

double orl_tree_eval(const struct orl_tree *tree, struct orl_square a, struct orl_square b);

/* The integral over the other hemisphere of value times cosine, for the given direction. */
double orl_tree_total(const struct orl_tree *tree, enum orl_axis given, struct orl_square place);

/*
 * Draws the other direction in proportion to value times cosine; u: two uniforms in [0,1). Only
 * where orl_tree_total is positive. ret_direction has z > 0; returns the value there.
 */
double orl_tree_draw(const struct orl_tree *tree, enum orl_axis given, struct orl_square place,
                     const double u[2], struct orl_vec3 *ret_direction);

#endif
