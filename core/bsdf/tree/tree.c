/* Reading of tensor trees: values, integrals over one direction, samples of one given the other. */
#include "bsdf/tree/tree.h"

#include <string.h>

#include "bsdf/tree/shirley.h"

/*
 * Opposite slices of the square share a formula if the radius is signed: one for right and left,
 * one for top and bottom. The angle then stays within 45 degrees of the slice's axis.
 */
struct orl_square orl_disk_to_square(double x, double y)
{
    const double r = sqrt(x * x + y * y);
    if (!(r > 0)) /* also for NaN */
        return (struct orl_square){0, 0};
    if (fabs(x) >= fabs(y)) {
        const double a = copysign(r, x);
        return (struct orl_square){a, a * (4 / ORL_PI) * atan(y / x)};
    }
    const double b = copysign(r, y);
    return (struct orl_square){b * (4 / ORL_PI) * atan(x / y), b};
}

/* ---- Values and integrals -------------------------------------------------------------------- */

enum { ABREAST = 16 }; /* samples whose descents are interleaved */

/* A place on the square in units of the finest cell, 2^depth a side. */
struct cell {
    unsigned x, y;
};

/* Returns the cell of a place. A is mapped as the light travels, half a turn from where its
 * direction points. */
static struct cell cell_of(struct orl_square place, enum orl_tree_axis axis, unsigned depth)
{
    const double sign = axis == ORL_AXIS_A ? -1 : 1;
    return (struct cell){orl_square_index(sign * place.x, 1U << depth),
                         orl_square_index(sign * place.y, 1U << depth)};
}

static float float_of(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Returns the word with a branch's mean over the other direction; for a lowest branch its line. */
static inline const uint32_t *mean_at(const struct orl_tree *tree, struct orl_tree_ref ref,
                                      enum orl_tree_axis given, struct cell c, unsigned level)
{
    const unsigned depth = orl_tree_depth(ref);
    const unsigned shift = level - depth, mask = (1U << depth) - 1;
    const unsigned x = c.x >> shift & mask, y = c.y >> shift & mask;
    const uint32_t *words = tree->lines[orl_tree_index(ref)].words;
    return depth == 1 ? words
                      : words + ORL_TREE_FANOUT + ((size_t)given << 2 * depth) + (x << depth | y);
}

/* Returns the mean over the other direction within ref's subtree, for a given direction in cell c.
 * Coordinates are in finest cells, of which ref's side has 2^level. The four leaves of a lowest
 * branch are summed here. */
static inline float mean_of(const struct orl_tree *tree, struct orl_tree_ref ref,
                            enum orl_tree_axis given, struct cell c, unsigned level)
{
    const unsigned depth = orl_tree_depth(ref);
    if (depth == 0)
        return float_of(ref.bits);
    const uint32_t *at = mean_at(tree, ref, given, c, level);
    if (depth > 1)
        return float_of(*at);
    return orl_tree_mean_of_leaves(at, given,
                                   (c.x >> (level - 1) & 1) | (c.y >> (level - 1) & 1) << 1);
}

/* Compares lines: trees are built in a fixed order, children first, so equal trees have equal
 * lines. */
bool orl_tree_equal(const struct orl_tree *tree, const struct orl_tree *other)
{
    return tree->root.bits == other->root.bits && tree->n_lines == other->n_lines &&
           (tree->n_lines == 0 ||
            !memcmp(tree->lines, other->lines, tree->n_lines * sizeof *tree->lines));
}

/* Returns the leaf of the pair, and sets its level. */
static inline struct orl_tree_ref leaf_of(const struct orl_tree *tree, struct orl_square a,
                                          struct orl_square b, unsigned *ret_level)
{
    const struct cell ca = cell_of(a, ORL_AXIS_A, tree->depth);
    const struct cell cb = cell_of(b, ORL_AXIS_B, tree->depth);
    struct orl_tree_ref ref = tree->root;
    unsigned level = tree->depth;
    while (!orl_tree_is_leaf(ref)) {
        level--;
        ref = orl_tree_child(tree, ref,
                             (ca.x >> level & 1) | (ca.y >> level & 1) << 1 |
                                 (cb.x >> level & 1) << 2 | (cb.y >> level & 1) << 3);
    }
    *ret_level = tree->depth - level;
    return ref;
}

size_t orl_square_cell(enum orl_tree_axis axis, struct orl_square place, unsigned depth)
{
    const struct cell c = cell_of(place, axis, depth);
    return (size_t)c.x << depth | c.y;
}

double orl_tree_eval(const struct orl_tree *tree, struct orl_square a, struct orl_square b)
{
    unsigned level;
    return (double)float_of(leaf_of(tree, a, b, &level).bits);
}

double orl_tree_eval_level(const struct orl_tree *tree, struct orl_square a, struct orl_square b,
                           unsigned *ret_level)
{
    return (double)float_of(leaf_of(tree, a, b, ret_level).bits);
}

/* A node, and its cell (x, y) of the other direction, 2^level finest cells a side. */
struct node {
    struct orl_tree_ref ref;
    int level, x, y;
};

/* Intersects the window with a node's cell along one axis; returns false if they are disjoint. */
static bool intersect_window(int low, int side, const struct node *node, int cell, int *ret_begin,
                             int *ret_end)
{
    const int begin = cell << node->level, end = begin + (1 << node->level);
    *ret_begin = begin > low ? begin : low;
    *ret_end = end < low + side ? end : low + side;
    return *ret_begin < *ret_end;
}

/* Reads the window within a node's cell. The recursion is as deep as the tree. */
static void read_window(const struct orl_tree *tree, const struct orl_tree_window *w,
                        const struct node *node)
{
    int left, right, low, high;
    if (!intersect_window(w->low_x, w->side, node, node->x, &left, &right) ||
        !intersect_window(w->low_y, w->side, node, node->y, &low, &high))
        return;
    if (orl_tree_is_leaf(node->ref)) {
        for (int y = low; y < high; y++)
            for (int x = left; x < right; x++) {
                const int i = (y - w->low_y) * w->side + x - w->low_x;
                w->values[i] = (double)float_of(node->ref.bits);
                w->finest[i] = node->level == 0;
            }
        return;
    }
    const int level = node->level - 1;
    const unsigned mine = (w->a_x >> level & 1) | (w->a_y >> level & 1) << 1;
    for (int k = 0; k < 4; k++) {
        const struct node part = {orl_tree_child(tree, node->ref, mine | (unsigned)k << 2), level,
                                  2 * node->x + (k & 1), 2 * node->y + (k >> 1)};
        read_window(tree, w, &part);
    }
}

void orl_tree_read_window(const struct orl_tree *tree, const struct orl_tree_window *window)
{
    read_window(tree, window, &(struct node){tree->root, (int)tree->depth, 0, 0});
}

double orl_tree_total(const struct orl_tree *tree, enum orl_tree_axis given,
                      struct orl_square place)
{
    const struct cell c = cell_of(place, given, tree->depth);
    return ORL_PI * (double)mean_of(tree, tree->root, given, c, tree->depth);
}

void orl_tree_prefetch_total(const struct orl_tree *tree, enum orl_tree_axis given,
                             struct orl_square place)
{
    const struct cell c = cell_of(place, given, tree->depth);
    if (!orl_tree_is_leaf(tree->root))
        __builtin_prefetch(mean_at(tree, tree->root, given, c, tree->depth));
}

/*
 * Returns a place within a cell, at least 1e-9 of the cell's width from its border. Its direction
 * thus maps back into the same cell.
 */
static double inside_cell(unsigned cell, double u, unsigned levels)
{
    const double margin = 0x1p-30;
    return (cell + margin + u * (1 - 2 * margin)) * (2.0 / (1U << levels)) - 1;
}

struct orl_vec3 orl_square_cell_direction(enum orl_tree_axis axis, unsigned x, unsigned y,
                                          unsigned level, double u, double v)
{
    const double sign = axis == ORL_AXIS_A ? -1 : 1;
    struct orl_vec3 direction = orl_square_to_hemisphere(
        (struct orl_square){inside_cell(x, u, level), inside_cell(y, v, level)});
    direction.x *= sign;
    direction.y *= sign;
    return direction;
}

/*
 * Chooses one of four with probability in proportion to its mean. *t is uniform below their sum; on
 * return it is uniform below the chosen mean. Rounding of floats may let *t reach the sum; then the
 * last one of positive mean is chosen. The means must not all be zero.
 */
static inline unsigned choose_quarter(const float mean[4], double *t)
{
    const double m0 = (double)mean[0], m1 = (double)mean[1], m2 = (double)mean[2];
    const double end0 = m0, end1 = m0 + m1, end2 = end1 + m2;
    unsigned i = (unsigned)(*t >= end0) + (unsigned)(*t >= end1) + (unsigned)(*t >= end2);
    const double start[4] = {0, end0, end1, end2};
    *t -= start[i];
    if (!(*t < (double)mean[i])) {
        while (!(mean[i] > 0))
            i--;
        *t = (double)mean[i] * 0x1.fffffffffffffp-1;
    }
    return i;
}

/* Address of a child's mean over the other direction. In a lowest branch the mean is the sum of
 * four leaves, `step` words apart. */
struct mean {
    const uint32_t *at;
    uint32_t step; /* 0: the word at `at` is the mean */
};

/*
 * State of a descent. At each level the quarters of the other direction's cell are weighted by
 * their means. The first uniform chooses the leaf, as a place along a curve through the square. Its
 * remainder and the second uniform give the place within the leaf.
 */
struct descent {
    const struct orl_tree *tree;
    enum orl_tree_axis given;
    struct cell c;
    struct orl_tree_ref ref, child[4]; /* current node; its four candidate children */
    struct mean mean[4];               /* means of the children */
    unsigned level, x, y;
    double t;
};

static inline struct descent descent_of(const struct orl_tree_sample *sample)
{
    const struct orl_tree *tree = sample->tree;
    struct descent d = {.tree = tree,
                        .given = sample->given,
                        .c = cell_of(sample->place, sample->given, tree->depth),
                        .ref = tree->root,
                        .level = tree->depth};
    d.t = sample->u[0] * (double)mean_of(tree, d.ref, d.given, d.c, d.level);
    return d;
}

/* Prefetches a branch's own line, which is read next if the descent goes there. */
static inline void prefetch_branch(const struct descent *d, struct orl_tree_ref ref)
{
    if (!orl_tree_is_leaf(ref))
        __builtin_prefetch(d->tree->lines[orl_tree_index(ref)].words);
}

/*
 * Finds the address of a child's mean without branches, because the child's type is random. A
 * leaf's mean is its word in the branch above. A branch's mean is a word of its own table, or for a
 * lowest branch the first of four leaves.
 */
static inline struct mean find_mean(const struct descent *d, const uint32_t *word)
{
    const uint32_t bits = *word, low = bits >> ORL_TREE_INDEX_BITS & 7;
    const bool branch = bits >> 31, lowest = branch & (low == 0), given_a = d->given == ORL_AXIS_A;
    const unsigned depth = low + 1, shift = (d->level - depth) & 31, mask = (1U << depth) - 1;
    const unsigned x = d->c.x >> shift & mask, y = d->c.y >> shift & mask;
    const size_t in_table = ORL_TREE_FANOUT + ((size_t)d->given << 2 * depth) + (x << depth | y);
    const size_t in_leaves = (size_t)(x | y << 1) << (given_a ? 0 : 2);
    const size_t line = branch ? orl_tree_index((struct orl_tree_ref){bits}) : 0;
    const uint32_t *inside = d->tree->lines[line].words;
    const size_t offset = lowest ? in_leaves : in_table;
    return (struct mean){(branch ? inside : word) + (branch ? offset : 0),
                         lowest ? (given_a ? 4 : 1) : 0};
}

static inline float read_mean(struct mean mean)
{
    float leaf[4];
    for (size_t k = 0; k < 4; k++)
        leaf[k] = float_of(mean.at[k * mean.step]);
    const float sum = 0.25F * ((leaf[0] + leaf[1]) + (leaf[2] + leaf[3]));
    return mean.step ? sum : leaf[0];
}

/* Reads a branch, and prefetches the means of the quarters to choose from. */
static inline void read_children(struct descent *d)
{
    const unsigned own = d->given == ORL_AXIS_A ? 0 : 2, others = 2 - own;
    const uint32_t *words = d->tree->lines[orl_tree_index(d->ref)].words;
    d->level--;
    const unsigned mine = ((d->c.x >> d->level & 1) | (d->c.y >> d->level & 1) << 1) << own;
    for (unsigned k = 0; k < 4; k++) {
        const uint32_t *word = words + (mine | k << others);
        d->child[k].bits = *word;
        d->mean[k] = find_mean(d, word);
        __builtin_prefetch(d->mean[k].at);
    }
}

static inline void choose_child(struct descent *d)
{
    float mean[4];
    for (unsigned k = 0; k < 4; k++)
        mean[k] = read_mean(d->mean[k]);
    d->t *= 4; /* the mean over the square is a quarter of the sum over its quarters */
    const unsigned i = choose_quarter(mean, &d->t);
    d->x = d->x << 1 | (i & 1);
    d->y = d->y << 1 | i >> 1;
    d->ref = d->child[i];
}

static inline void finish_descent(const struct descent *d, struct orl_tree_sample *sample)
{
    const double value = (double)float_of(d->ref.bits);
    const double t = orl_smaller(d->t / value, 0x1.fffffffffffffp-1);
    sample->direction =
        orl_square_cell_direction(d->given == ORL_AXIS_A ? ORL_AXIS_B : ORL_AXIS_A, d->x, d->y,
                                  d->tree->depth - d->level, t, sample->u[1]);
    sample->value = value;
}

double orl_tree_sample(const struct orl_tree *tree, enum orl_tree_axis given,
                       struct orl_square place, const double u[2], struct orl_vec3 *ret_direction)
{
    struct orl_tree_sample sample = {
        .tree = tree, .given = given, .place = place, .u = {u[0], u[1]}};
    struct descent d = descent_of(&sample);
    while (!orl_tree_is_leaf(d.ref)) {
        read_children(&d);
        choose_child(&d);
    }
    finish_descent(&d, &sample);
    *ret_direction = sample.direction;
    return sample.value;
}

/* Interleaves up to ABREAST descents, so that waits for memory overlap. */
static void sample_together(struct orl_tree_sample *samples, size_t n)
{
    struct descent descents[ABREAST];
    unsigned under_way[ABREAST], left = 0;
    for (unsigned i = 0; i < n; i++) {
        descents[i] = descent_of(&samples[i]);
        prefetch_branch(&descents[i], descents[i].ref);
        under_way[left++] = i;
    }
    while (left > 0) {
        unsigned kept = 0;
        for (unsigned i = 0; i < left; i++) {
            struct descent *d = &descents[under_way[i]];
            if (orl_tree_is_leaf(d->ref)) {
                finish_descent(d, &samples[under_way[i]]);
                continue;
            }
            read_children(d);
            under_way[kept++] = under_way[i];
        }
        left = kept;
        for (unsigned i = 0; i < left; i++) {
            struct descent *d = &descents[under_way[i]];
            choose_child(d);
            prefetch_branch(d, d->ref);
        }
    }
}

void orl_tree_sample_many(struct orl_tree_sample *samples, size_t n)
{
    for (size_t i = 0; i < n; i += ABREAST)
        sample_together(samples + i, n - i < ABREAST ? n - i : ABREAST);
}
