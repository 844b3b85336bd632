/* Reads tensor trees: values, integrals over one direction, draws of one given the other. */
#include "bsdf/tree.h"

#include "bsdf/shirley.h"

/* A place on the square in units of the finest cell, 2^depth a side. */
struct cell {
    unsigned x, y;
};

static struct cell cell_of(struct orl_vec3 direction, double sign, unsigned depth)
{
    const struct orl_square s = orl_disk_to_square(sign * direction.x, sign * direction.y);
    const unsigned side = 1U << depth;
    const unsigned x = (unsigned)(s.x * side), y = (unsigned)(s.y * side);
    return (struct cell){x < side ? x : side - 1, y < side ? y : side - 1};
}

static double axis_sign(enum orl_axis axis)
{
    return axis == ORL_AXIS_A ? -1 : 1;
}

double orl_tree_mean(const uint32_t *words, struct orl_tree_ref ref, enum orl_axis given,
                     unsigned x, unsigned y, unsigned level)
{
    const uint32_t *node;
    unsigned depth, shift, mask;
    if (ref.leaf)
        return orl_tree_float(ref.bits);
    node = orl_tree_node(words, ref.bits);
    depth = ref.bits >> 28;
    shift = level - depth;
    if (depth == 1) {
        const unsigned mine = (x >> shift & 1) | (y >> shift & 1) << 1;
        const unsigned first = given == ORL_AXIS_A ? mine : 4 * mine;
        const unsigned step = given == ORL_AXIS_A ? 4 : 1;
        const uint32_t *leaf = node + 1 + first;
        return 0.25 * (((double)orl_tree_float(leaf[0]) + orl_tree_float(leaf[step])) +
                       ((double)orl_tree_float(leaf[2 * step]) + orl_tree_float(leaf[3 * step])));
    }
    mask = (1U << depth) - 1;
    node += ORL_TREE_HEAD + ((size_t)given << 2 * depth);
    return orl_tree_float(node[(x >> shift & mask) << depth | (y >> shift & mask)]);
}

double orl_tree_eval(const struct orl_tree *tree, struct orl_vec3 a, struct orl_vec3 b)
{
    const struct cell ca = cell_of(a, -1, tree->depth), cb = cell_of(b, 1, tree->depth);
    struct orl_tree_ref ref = tree->root;
    for (unsigned level = tree->depth; !ref.leaf;) {
        unsigned i;
        level--;
        i = (ca.x >> level & 1) | (ca.y >> level & 1) << 1 | (cb.x >> level & 1) << 2 |
            (cb.y >> level & 1) << 3;
        ref = orl_tree_child(orl_tree_node(tree->words, ref.bits), i);
    }
    return orl_tree_float(ref.bits);
}

double orl_tree_total(const struct orl_tree *tree, enum orl_axis given, struct orl_vec3 direction)
{
    const struct cell c = cell_of(direction, axis_sign(given), tree->depth);
    return ORL_PI * orl_tree_mean(tree->words, tree->root, given, c.x, c.y, tree->depth);
}

/*
 * Chooses the upper half with probability high / (low + high) and stretches what is left of u to
 * [0,1) again. A half of weight 0 is never chosen, since u < 1.
 */
static unsigned choose_half(double low, double high, double *u)
{
    const double p = low / (low + high);
    const bool upper = *u >= p;
    *u = upper ? (*u - p) / (1 - p) : *u / p;
    if (!(*u < 1)) /* rounding */
        *u = 0x1.fffffffffffffp-1;
    return upper;
}

/*
 * A place within a cell, kept clear of its border by 1e-9 of its width: the direction made from it
 * then falls into the same cell when it is mapped back.
 */
static double inside_cell(unsigned cell, double u, unsigned levels)
{
    const double margin = 0x1p-30;
    return ldexp(cell + margin + u * (1 - 2 * margin), -(int)levels);
}

double orl_tree_draw(const struct orl_tree *tree, enum orl_axis given, struct orl_vec3 direction,
                     const double u[2], struct orl_vec3 *ret_direction)
{
    const struct cell c = cell_of(direction, axis_sign(given), tree->depth);
    struct orl_tree_ref ref = tree->root;
    unsigned level = tree->depth, x = 0, y = 0;
    double ux = u[0], uy = u[1], sign = -axis_sign(given);
    while (!ref.leaf) {
        const uint32_t *node = orl_tree_node(tree->words, ref.bits);
        double mean[4];
        unsigned mine, high_x, high_y, i;
        level--;
        mine = (c.x >> level & 1) | (c.y >> level & 1) << 1;
        for (unsigned other = 0; other < 4; other++) {
            i = given == ORL_AXIS_A ? mine | other << 2 : other | mine << 2;
            mean[other] =
                orl_tree_mean(tree->words, orl_tree_child(node, i), given, c.x, c.y, level);
        }
        high_x = choose_half(mean[0] + mean[2], mean[1] + mean[3], &ux);
        high_y = choose_half(mean[high_x], mean[2 | high_x], &uy);
        i = high_x | high_y << 1;
        ref = orl_tree_child(node, given == ORL_AXIS_A ? mine | i << 2 : i | mine << 2);
        x = x << 1 | high_x;
        y = y << 1 | high_y;
    }
    *ret_direction = orl_square_to_hemisphere((struct orl_square){
        inside_cell(x, ux, tree->depth - level), inside_cell(y, uy, tree->depth - level)});
    ret_direction->x *= sign;
    ret_direction->y *= sign;
    return orl_tree_float(ref.bits);
}
