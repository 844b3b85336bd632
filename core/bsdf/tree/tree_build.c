/* Builds tensor trees bottom up: children first, then the branch with its means. */
#include "bsdf/tree/tree.h"

#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include <oriel/base/limits.h>

enum { LINE_BYTES = 64, HUGE_BYTES = 2 << 20 };

/* Limit on lines: a fixed multiple of the values, for any shape of tree. */
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

/* Number of lines from which the array has pages of its own. */
static const size_t many_lines = 2 * HUGE_BYTES / LINE_BYTES;

static size_t whole_pages(size_t lines)
{
    return (lines * LINE_BYTES + HUGE_BYTES - 1) / HUGE_BYTES * HUGE_BYTES;
}

/*
 * Maps pages for that many lines and advises the kernel to make them huge. Samples access lines at
 * random and would otherwise wait for page tables as often as for data. Returns NULL if out of
 * memory.
 */
static struct orl_tree_line *map_pages(size_t lines)
{
    const size_t bytes = whole_pages(lines);
    char *all = mmap(NULL, bytes + HUGE_BYTES, PROT_READ | PROT_WRITE,
                     MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (all == MAP_FAILED)
        return NULL;
    const size_t before = (HUGE_BYTES - (uintptr_t)all % HUGE_BYTES) % HUGE_BYTES;
    if (before > 0)
        munmap(all, before);
    munmap(all + before + bytes, HUGE_BYTES - before);
#ifdef MADV_HUGEPAGE
    madvise(all + before, bytes, MADV_HUGEPAGE); /* advice only; failure is ignored */
#endif
    return (void *)(all + before);
}

/* Frees the lines from index `first` on. */
static void free_lines(struct orl_tree *tree, size_t first)
{
    if (tree->capacity < many_lines && first == 0)
        free(tree->lines);
    else if (tree->capacity >= many_lines && whole_pages(first) < whole_pages(tree->capacity))
        munmap((char *)tree->lines + whole_pages(first),
               whole_pages(tree->capacity) - whole_pages(first));
}

/* Moves the lines to an array of a greater capacity. Between arrays of pages nothing is copied. */
static int resize_lines(struct orl_tree *tree, size_t capacity, struct orl_error *err)
{
    struct orl_tree_line *lines = capacity < many_lines
                                      ? aligned_alloc(LINE_BYTES, capacity * LINE_BYTES)
                                      : map_pages(capacity);
    if (!lines)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
    if (tree->capacity >= many_lines) {
        const size_t bytes = whole_pages(tree->capacity);
        if (mremap(tree->lines, bytes, bytes, MREMAP_MAYMOVE | MREMAP_FIXED, lines) == MAP_FAILED) {
            munmap(lines, whole_pages(capacity));
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
        }
    } else {
        if (tree->n_lines > 0)
            memcpy(lines, tree->lines, tree->n_lines * sizeof *lines);
        free(tree->lines);
    }
    tree->lines = lines;
    tree->capacity = capacity;
    return 0;
}

/* Ensures room for count more lines. Returns 0, ORL_ERR_LIMIT or ORL_ERR_NOMEM. */
static int reserve_lines(struct orl_tree *tree, size_t count, struct orl_error *err)
{
    size_t capacity = tree->capacity ? tree->capacity : 256;
    if (count > LINES_MAX - tree->n_lines)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree needs more than %lu MB",
                             LINES_MAX * LINE_BYTES >> 20);
    if (tree->n_lines + count <= tree->capacity)
        return 0;
    while (capacity < tree->n_lines + count)
        capacity += capacity / 2 + 1;
    return resize_lines(tree, capacity, err);
}

/*
 * Returns the depth of a branch over these children; 0 if they are equal leaves and so one leaf. A
 * word begins with its kind, then its depth, so the greatest word is the deepest child.
 */
static unsigned depth_over(const struct orl_tree_ref child[ORL_TREE_FANOUT])
{
    uint32_t least = child[0].bits, most = child[0].bits;
    for (int i = 1; i < ORL_TREE_FANOUT; i++) {
        least = child[i].bits < least ? child[i].bits : least;
        most = child[i].bits > most ? child[i].bits : most;
    }
    const unsigned depth = orl_tree_depth((struct orl_tree_ref){most});
    return depth == 0 && least == most ? 0 : depth + 1;
}

/* The means of a child, 2^depth a side, read at a resolution of 2^(depth + shift) a side. */
struct means {
    const uint32_t *words;
    unsigned depth, shift;
    uint32_t own[4]; /* means of a leaf or a lowest branch, which stores none */
};

static void find_means(const struct orl_tree *tree, struct orl_tree_ref child,
                       enum orl_tree_axis given, unsigned depth, struct means *ret)
{
    ret->depth = orl_tree_depth(child);
    ret->shift = depth - ret->depth;
    ret->words = ret->own;
    if (ret->depth == 0) {
        ret->own[0] = child.bits;
        return;
    }
    const uint32_t *words = tree->lines[orl_tree_index(child)].words;
    if (ret->depth >= 2) {
        ret->words = words + ORL_TREE_FANOUT + ((size_t)given << 2 * ret->depth);
        return;
    }
    for (unsigned i = 0; i < 4; i++) /* order of i: x << 1 | y */
        ret->own[i] = float_bits(orl_tree_mean_of_leaves(words, given, i >> 1 | (i & 1) << 1));
}

static inline double mean_at(const struct means *m, unsigned x, unsigned y)
{
    float value;
    memcpy(&value, m->words + ((x >> m->shift) << m->depth | y >> m->shift), sizeof value);
    return (double)value;
}

/* Fills the 4^depth means for one given direction from those of the children. */
static void fill_means(const struct orl_tree *tree, const struct orl_tree_ref *child,
                       enum orl_tree_axis given, unsigned depth, uint32_t *means)
{
    const unsigned low = depth - 1, half = 1U << low;
    for (unsigned mine = 0; mine < 4; mine++) {
        const unsigned x0 = (mine & 1) << low, y0 = (mine >> 1) << low;
        struct means of[4];
        for (unsigned other = 0; other < 4; other++)
            find_means(tree, child[given == ORL_AXIS_A ? mine | other << 2 : other | mine << 2],
                       given, low, &of[other]);
        for (unsigned x = 0; x < half; x++) {
            for (unsigned y = 0; y < half; y++) {
                const double sum = mean_at(&of[0], x, y) + mean_at(&of[1], x, y) +
                                   mean_at(&of[2], x, y) + mean_at(&of[3], x, y);
                means[(x0 | x) << depth | y0 | y] = float_bits((float)(0.25 * sum));
            }
        }
    }
}

int orl_tree_branch(struct orl_tree *tree, const struct orl_tree_ref child[ORL_TREE_FANOUT],
                    struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    const unsigned depth = depth_over(child);
    size_t means = 0; /* words of means for one given direction */
    uint32_t *words;
    int code;
    if (depth == 0) {
        *ret_ref = child[0];
        return 0;
    }
    if (depth > ORL_LIMIT_TREE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "the tensor tree is deeper than %u levels",
                             ORL_LIMIT_TREE_DEPTH);
    if (depth > 1 && !tree->eval_only)
        means = (size_t)1 << 2 * depth;
    code = reserve_lines(tree, 1 + 2 * means / ORL_TREE_FANOUT, err);
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
    unsigned log2_grid; /* log2 of the cells per axis of the whole grid */
    unsigned low[4];    /* the cube's first cell, per axis */
};

static int build_cube(struct orl_tree *tree, const struct cube *cube, unsigned log2_side,
                      struct orl_tree_ref *ret_ref, struct orl_error *err)
{
    struct orl_tree_ref child[ORL_TREE_FANOUT];
    if (log2_side == 1 && cube->log2_grid == 1) {
        /* Common case in files: the whole grid is the children, in another order. */
        for (unsigned i = 0; i < ORL_TREE_FANOUT; i++)
            child[i] = orl_tree_leaf(
                cube->values[(i & 1) << 3 | (i & 2) << 1 | (i & 4) >> 1 | (i & 8) >> 3]);
        return orl_tree_branch(tree, child, ret_ref, err);
    }
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

/* Reallocates an array without pages to its exact size. If that fails, the larger array stays. */
static void shrink_lines(struct orl_tree *tree)
{
    struct orl_tree_line *lines = aligned_alloc(LINE_BYTES, tree->n_lines * LINE_BYTES);
    if (!lines)
        return;
    memcpy(lines, tree->lines, tree->n_lines * LINE_BYTES);
    free_lines(tree, 0);
    tree->lines = lines;
    tree->capacity = tree->n_lines;
}

void orl_tree_finish(struct orl_tree *tree, struct orl_tree_ref root)
{
    tree->root = root;
    tree->depth = orl_tree_depth(root);
    if (tree->n_lines < many_lines) {
        if (tree->n_lines > 0)
            shrink_lines(tree);
    } else {
        free_lines(tree, tree->n_lines);
        tree->capacity = tree->n_lines;
    }
}

void orl_tree_done(struct orl_tree *tree)
{
    free_lines(tree, 0);
    memset(tree, 0, sizeof *tree);
}
