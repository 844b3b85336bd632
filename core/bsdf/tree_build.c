/* Builds tensor trees bottom up: children first, then the branch with its means. */
#include "bsdf/tree.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include <oriel/limits.h>

enum { LINE_BYTES = 64, HUGE_BYTES = 2 << 20 };

/* A bounded multiple of the values, whatever the shape of the tree. */
#define LINES_MAX (2 * ORL_LIMIT_BSDF_VALUES / ORL_TREE_FANOUT)
_Static_assert(LINES_MAX <= 1UL << ORL_TREE_INDEX_BITS, "an index must fit");
_Static_assert(ORL_LIMIT_TREE_DEPTH <= 8, "a child's depth has 3 bits");
_Static_assert(sizeof(struct orl_tree_line) == LINE_BYTES, "a line of the cache");

static uint32_t float_bits(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

struct orl_tree_ref orl_tree_leaf(float value)
{
    return (struct orl_tree_ref){float_bits(value)};
}

/*
 * Moves the lines to an array of the given capacity. A large one asks for huge pages: a draw jumps
 * all over it, and would otherwise wait for the page tables as often as for the data.
 */
static int resize(struct orl_tree *tree, size_t capacity, struct orl_error *err)
{
    const size_t page = capacity >= 2 * HUGE_BYTES / LINE_BYTES ? HUGE_BYTES : LINE_BYTES;
    const size_t bytes = (capacity * LINE_BYTES + page - 1) / page * page;
    struct orl_tree_line *lines = aligned_alloc(page, bytes);
    if (!lines)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
#ifdef MADV_HUGEPAGE
    if (page == HUGE_BYTES)
        madvise(lines, bytes, MADV_HUGEPAGE); /* a wish: nothing depends on it */
#endif
    if (tree->n_lines > 0)
        memcpy(lines, tree->lines, tree->n_lines * sizeof *lines);
    free(tree->lines);
    tree->lines = lines;
    tree->capacity = capacity;
    return 0;
}

/* Makes room for count more lines. */
static int reserve(struct orl_tree *tree, size_t count, struct orl_error *err)
{
    size_t capacity = tree->capacity ? tree->capacity : 256;
    if (count > LINES_MAX - tree->n_lines)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree needs more than %lu MB",
                             LINES_MAX * LINE_BYTES >> 20);
    if (tree->n_lines + count <= tree->capacity)
        return 0;
    while (capacity < tree->n_lines + count)
        capacity += capacity / 2 + 1;
    return resize(tree, capacity, err);
}

static bool all_equal(const struct orl_tree_ref child[ORL_TREE_FANOUT])
{
    for (int i = 0; i < ORL_TREE_FANOUT; i++)
        if (!orl_tree_is_leaf(child[i]) || child[i].bits != child[0].bits)
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

int orl_tree_branch(struct orl_tree *tree, const struct orl_tree_ref child[ORL_TREE_FANOUT],
                    struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    unsigned depth = 1;
    size_t means = 0; /* words for one given direction */
    uint32_t *words;
    int code;
    if (all_equal(child)) {
        *ret_ref = child[0];
        return 0;
    }
    for (int i = 0; i < ORL_TREE_FANOUT; i++)
        if (orl_tree_depth(child[i]) >= depth)
            depth = orl_tree_depth(child[i]) + 1;
    if (depth > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    if (depth > 1 && !tree->plain)
        means = (size_t)1 << 2 * depth;
    code = reserve(tree, 1 + 2 * means / ORL_TREE_FANOUT, err);
    if (code < 0)
        return code;
    words = tree->lines[tree->n_lines].words;
    memcpy(words, child, ORL_TREE_FANOUT * sizeof *words);
    if (means > 0) {
        fill_means(tree, child, ORL_AXIS_A, depth, words + ORL_TREE_FANOUT);
        fill_means(tree, child, ORL_AXIS_B, depth, words + ORL_TREE_FANOUT + means);
    }
    ret_ref->bits = 1U << 31 | (depth - 1) << ORL_TREE_INDEX_BITS | (uint32_t)tree->n_lines;
    tree->n_lines += 1 + 2 * means / ORL_TREE_FANOUT;
    return 0;
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
    tree->depth = orl_tree_depth(root);
    /* Giving back spare room is a courtesy: where it fails, the larger array stays. */
    if (tree->n_lines > 0 && tree->n_lines < tree->capacity)
        resize(tree, tree->n_lines, NULL);
}

void orl_tree_done(struct orl_tree *tree)
{
    if (!tree)
        return;
    free(tree->lines);
    memset(tree, 0, sizeof *tree);
}
