/* Builds tensor trees bottom up: children first, then the branch with its means. */
#include "bsdf/tree.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

/* What an index of 28 bits can reach, and no more than a bounded multiple of the values. */
#define WORDS_MAX (2 * ORL_LIMIT_BSDF_VALUES)
_Static_assert(WORDS_MAX <= 1UL << ORL_TREE_INDEX_BITS, "an index must fit");
_Static_assert(ORL_LIMIT_TREE_DEPTH < 16, "a child's depth has 4 bits");

enum { LINE_BYTES = 64 };

static uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

struct orl_tree_ref orl_tree_leaf(float value)
{
    return (struct orl_tree_ref){float_bits(value), true};
}

static int out_of_memory(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
}

/* Makes room for count more words. Children, once finished, never move within their array. */
static int reserve_words(struct orl_tree *tree, size_t count, struct orl_error *err)
{
    size_t capacity = tree->words_capacity ? tree->words_capacity : 4096;
    uint32_t *words;
    if (count > WORDS_MAX - tree->n_words)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree needs more than %lu MB",
                             WORDS_MAX * sizeof(uint32_t) >> 20);
    if (tree->n_words + count <= tree->words_capacity)
        return 0;
    while (capacity < tree->n_words + count)
        capacity += capacity / 2;
    words = realloc(tree->words, capacity * sizeof *words);
    if (!words)
        return out_of_memory(err);
    tree->words = words;
    tree->words_capacity = capacity;
    return 0;
}

/* Moves the blocks to an array of the given capacity that starts on a cache line. */
static int resize_blocks(struct orl_tree *tree, size_t capacity, struct orl_error *err)
{
    float(*blocks)[ORL_TREE_FANOUT] = aligned_alloc(LINE_BYTES, capacity * sizeof *blocks);
    if (!blocks)
        return out_of_memory(err);
    if (tree->n_blocks > 0)
        memcpy(blocks, tree->blocks, tree->n_blocks * sizeof *blocks);
    free(tree->blocks);
    tree->blocks = blocks;
    tree->blocks_capacity = capacity;
    return 0;
}

static bool all_equal(const struct orl_tree_ref child[ORL_TREE_FANOUT])
{
    for (int i = 0; i < ORL_TREE_FANOUT; i++)
        if (!child[i].leaf || child[i].bits != child[0].bits)
            return false;
    return true;
}

/* Fills the means for one given direction, 4^depth of them, from those of the children. */
static void fill_means(const struct orl_tree *tree, const struct orl_tree_ref *child,
                       enum orl_axis given, unsigned depth, uint32_t *means)
{
    const unsigned side = 1U << depth, low = depth - 1;
    for (unsigned x = 0; x < side; x++) {
        for (unsigned y = 0; y < side; y++) {
            const unsigned mine = x >> low | (y >> low) << 1;
            double sum = 0;
            for (unsigned other = 0; other < 4; other++) {
                const unsigned i = given == ORL_AXIS_A ? mine | other << 2 : other | mine << 2;
                sum += (double)orl_tree_mean(tree, child[i], given, x, y, low);
            }
            means[x << depth | y] = float_bits((float)(0.25 * sum));
        }
    }
}

/* A branch over leaves only. */
static int add_block(struct orl_tree *tree, const struct orl_tree_ref *child,
                     struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    const size_t capacity = tree->blocks_capacity;
    int code = 0;
    if (tree->n_blocks == capacity)
        code = resize_blocks(tree, capacity ? capacity + capacity / 2 : 1024, err);
    if (code < 0)
        return code;
    for (int i = 0; i < ORL_TREE_FANOUT; i++)
        memcpy(&tree->blocks[tree->n_blocks][i], &child[i].bits, sizeof(float));
    ret_ref->bits = 1U << ORL_TREE_INDEX_BITS | (uint32_t)tree->n_blocks++;
    ret_ref->leaf = false;
    return 0;
}

/* A branch of depth at least 2. */
static int add_node(struct orl_tree *tree, const struct orl_tree_ref *child, unsigned depth,
                    struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    const size_t means = (size_t)1 << 2 * depth;
    const int code = reserve_words(tree, ORL_TREE_HEAD + 2 * means, err);
    uint32_t *node;
    if (code < 0)
        return code;
    node = tree->words + tree->n_words;
    node[0] = 0;
    for (int i = 0; i < ORL_TREE_FANOUT; i++) {
        node[0] |= (uint32_t)child[i].leaf << i;
        node[1 + i] = child[i].bits;
    }
    fill_means(tree, child, ORL_AXIS_A, depth, node + ORL_TREE_HEAD);
    fill_means(tree, child, ORL_AXIS_B, depth, node + ORL_TREE_HEAD + means);
    ret_ref->bits = depth << ORL_TREE_INDEX_BITS | (uint32_t)tree->n_words;
    ret_ref->leaf = false;
    tree->n_words += ORL_TREE_HEAD + 2 * means;
    return 0;
}

int orl_tree_branch(struct orl_tree *tree, const struct orl_tree_ref child[ORL_TREE_FANOUT],
                    struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    unsigned depth = 1;
    if (all_equal(child)) {
        *ret_ref = child[0];
        return 0;
    }
    for (int i = 0; i < ORL_TREE_FANOUT; i++)
        if (orl_tree_ref_depth(child[i]) >= depth)
            depth = orl_tree_ref_depth(child[i]) + 1;
    if (depth > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    return depth == 1 ? add_block(tree, child, ret_ref, err)
                      : add_node(tree, child, depth, ret_ref, err);
}

/* A cube of cells within a grid of values. */
struct cube {
    const float *values;
    unsigned log2_grid; /* of the whole grid */
    unsigned low[4];    /* the cube's first cell, per axis */
};

static int build_cube(struct orl_tree *tree, const struct cube *cube, unsigned log2_side,
                      struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    struct orl_tree_ref child[ORL_TREE_FANOUT];
    if (log2_side == 0) {
        size_t index = 0;
        for (int axis = 0; axis < 4; axis++)
            index = index << cube->log2_grid | cube->low[axis];
        *ret_ref = orl_tree_leaf(cube->values[index]);
        return 0;
    }
    for (unsigned i = 0; i < ORL_TREE_FANOUT; i++) {
        struct cube part = *cube;
        int code;
        for (unsigned axis = 0; axis < 4; axis++)
            part.low[axis] += (i >> axis & 1) << (log2_side - 1);
        code = build_cube(tree, &part, log2_side - 1, &child[i], err);
        if (code < 0)
            return code;
    }
    return orl_tree_branch(tree, child, ret_ref, err);
}

int orl_tree_grid(struct orl_tree *tree, const float *values, unsigned log2_side,
                  struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    const struct cube whole = {values, log2_side, {0, 0, 0, 0}};
    return build_cube(tree, &whole, log2_side, ret_ref, err);
}

void orl_tree_finish(struct orl_tree *tree, struct orl_tree_ref root)
{
    tree->root = root;
    tree->depth = orl_tree_ref_depth(root);
    /* Giving back spare room is a courtesy: where it fails, the larger array stays. */
    if (tree->n_words > 0 && tree->n_words < tree->words_capacity) {
        uint32_t *words = realloc(tree->words, tree->n_words * sizeof *words);
        if (words) {
            tree->words = words;
            tree->words_capacity = tree->n_words;
        }
    }
    if (tree->n_blocks > 0 && tree->n_blocks < tree->blocks_capacity)
        resize_blocks(tree, tree->n_blocks, NULL);
}

void orl_tree_done(struct orl_tree *tree)
{
    if (!tree)
        return;
    free(tree->words);
    free(tree->blocks);
    memset(tree, 0, sizeof *tree);
}
