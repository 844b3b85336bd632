/*
 * A tensor tree of rank 4: a function of two directions, each given by its place on the
 * Shirley-Chiu square, constant over cells (leaves) of varying size.
 *
 * Axes. The tree's two directions are A (the file's "incident", mapped with x and y negated, as
 * the light travels) and B (the file's "exitant"). A child of a branch is numbered by four bits:
 * bit 0 A.x, bit 1 A.y, bit 2 B.x, bit 3 B.y; a set bit is the upper half.
 *
 * Store: one array of lines of 16 words, a cache line each, children before parents. A word of a
 * branch is a child: a leaf's value (a float, never negative), or with the sign bit set
 * depth - 1 (3 bits) and the index of the child's first line (28 bits). A branch is
 *     1 line             its children
 * and, when not all of them are leaves, that is when its depth is at least 2,
 *     4^depth words      float means over B, for each cell of A at 2^depth a side, x-major
 *     4^depth words      float means over A, for each cell of B
 * depth is how many levels of branches the node spans, itself included. The means make a draw of
 * one direction given the other a plain descent: at each level, four sums to choose from. Those of
 * a lowest branch are summed when they are wanted, which costs less than fetching them.
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
#include <string.h>

#include <oriel/error.h>

#include "bsdf/shirley.h"

enum { ORL_TREE_FANOUT = 16, ORL_TREE_INDEX_BITS = 28 };

/* Which of the two directions is given. */
enum orl_tree_axis { ORL_AXIS_A = 0, ORL_AXIS_B = 1 };

/* A leaf or a branch, as a word of the store. */
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
    unsigned depth; /* log2 of the resolution per axis; 0: one leaf */
    size_t values;  /* leaves in the file */
    size_t clamped; /* negative values set to zero */
    float minimum;  /* over all leaves */
    bool plain;     /* to be evaluated only: there are no means, branches have one line */
};

/* ---- Building (tree_build.c) ----------------------------------------------------------------- */

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

static inline bool orl_tree_is_leaf(struct orl_tree_ref ref)
{
    return !(ref.bits >> 31);
}

/* Levels of branches below and with this one; 0 for a leaf. */
static inline unsigned orl_tree_depth(struct orl_tree_ref ref)
{
    return orl_tree_is_leaf(ref) ? 0 : (ref.bits >> ORL_TREE_INDEX_BITS & 7) + 1;
}

/* A branch's first line. */
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
 * The mean over the other direction of a lowest branch's leaves, where the given one lies in
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

/*
 * The mean over the other direction, within ref's subtree, where the given direction lies in cell
 * (x, y); coordinates in units of the finest cell, of which ref's side has 2^level.
 */
float orl_tree_mean(const struct orl_tree *tree, struct orl_tree_ref ref, enum orl_tree_axis given,
                    unsigned x, unsigned y, unsigned level);

/* The same function of the same cells. */
bool orl_tree_equal(const struct orl_tree *tree, const struct orl_tree *other);

/* Directions below are places on the square as orl_disk_to_square gives them; A's is turned inside.
 */

double orl_tree_eval(const struct orl_tree *tree, struct orl_square a, struct orl_square b);

/* The cell that a direction lies in when the square has 2^depth a side: x << depth | y. */
size_t orl_square_cell(enum orl_tree_axis axis, struct orl_square place, unsigned depth);

/* orl_tree_eval, and how many times each axis is halved down to the leaf that holds the pair. */
double orl_tree_look(const struct orl_tree *tree, struct orl_square a, struct orl_square b,
                     unsigned *ret_level);

/*
 * The values for a finest cell of A over a window of finest cells of B, side * side of them from
 * cell (low_x, low_y), x fastest; whether each is a leaf of the finest size. Cells beyond the
 * square are left as they are.
 */
struct orl_tree_window {
    unsigned a_x, a_y;
    int low_x, low_y, side;
    double *values;
    bool *finest;
};
void orl_tree_look_about(const struct orl_tree *tree, const struct orl_tree_window *window);

/*
 * The direction of that axis, z > 0, at a place within cell (x, y) of the square halved level
 * times; u, v in [0,1).
 */
struct orl_vec3 orl_square_cell_direction(enum orl_tree_axis axis, unsigned x, unsigned y,
                                          unsigned level, double u, double v);

/* The integral over the other hemisphere of value times cosine, for the given direction. */
double orl_tree_total(const struct orl_tree *tree, enum orl_tree_axis given,
                      struct orl_square place);
/* Prefetches what that will read. */
void orl_tree_ask_for_total(const struct orl_tree *tree, enum orl_tree_axis given,
                            struct orl_square place);

/*
 * Draws the other direction in proportion to value times cosine; u: two uniforms in [0,1). Only
 * where orl_tree_total is positive. ret_direction has z > 0; returns the value there.
 */
double orl_tree_draw(const struct orl_tree *tree, enum orl_tree_axis given, struct orl_square place,
                     const double u[2], struct orl_vec3 *ret_direction);

/* Its arguments, and what comes of it. */
struct orl_tree_draw {
    const struct orl_tree *tree;
    enum orl_tree_axis given;
    struct orl_square place;
    double u[2];
    struct orl_vec3 direction;
    double value;
};

/* Each as orl_tree_draw makes it, all in the time of a few: they wait for memory together. */
void orl_tree_draw_many(struct orl_tree_draw *draws, size_t n);

#endif
