/*
 * From cells in order of their keys to the text of a tensor tree: every node's cells stand
 * together, so that a walk over ranges needs no memory of its own.
 *
 * Sixteen children become one leaf, their mean, when the whole node is nearly even:
 * max - min <= tolerance * (sqrt(mean) + 0.03), the measure by which Radiance's rttree_reduce
 * culls. A mean keeps the node's flux.
 */
#include <math.h>
#include <stdbool.h>

#include "lcp.h"

struct node {
    const struct lcp_cell *first, *end;
    unsigned levels; /* below this node: 0 is one cell */
    unsigned mirror; /* bit 0: x is mirrored, bit 1: y is */
};

/* The child with this number in the file, where a mirrored quarter is looked up turned around. */
static struct node child_of(const struct node *node, unsigned number)
{
    const unsigned shift = 4 * (node->levels - 1);
    const unsigned wanted = number ^ (node->mirror | node->mirror << 2);
    struct node child = {node->first, node->end, node->levels - 1, node->mirror};
    while (child.first < node->end && (child.first->key >> shift & 15) < wanted)
        child.first++;
    child.end = child.first;
    while (child.end < node->end && (child.end->key >> shift & 15) == wanted)
        child.end++;
    return child;
}

static double mean_of(const struct node *node)
{
    double sum = 0;
    for (const struct lcp_cell *c = node->first; c < node->end; c++)
        sum += (double)c->value;
    return ldexp(sum, -4 * (int)node->levels);
}

static bool is_even(const struct node *node, double tolerance)
{
    const uint64_t cells = UINT64_C(1) << 4 * node->levels;
    double low = INFINITY, high = 0;
    for (const struct lcp_cell *c = node->first; c < node->end; c++) {
        low = fmin(low, (double)c->value);
        high = fmax(high, (double)c->value);
    }
    if ((uint64_t)(node->end - node->first) < cells)
        low = 0;
    return high - low <= tolerance * (sqrt(mean_of(node)) + 0.03);
}

static void indent(FILE *out, unsigned depth)
{
    while (depth-- > 0)
        fputs(" ", out);
}

static void write_value(FILE *out, double value)
{
    if (value > 0)
        fprintf(out, " %.5g", value);
    else
        fputs(" 0", out);
}

/* Sixteen cells: as a grid, A.x slowest and B.y fastest. */
static void write_grid(FILE *out, const struct node *node)
{
    fputs("{", out);
    for (unsigned i = 0; i < 16; i++) {
        const unsigned number = i >> 3 | (i >> 2 & 1) << 1 | (i >> 1 & 1) << 2 | (i & 1) << 3;
        const struct node cell = child_of(node, number);
        write_value(out, mean_of(&cell));
    }
    fputs(" }\n", out);
}

static void write_node(FILE *out, const struct node *node, unsigned depth, double tolerance)
{
    indent(out, depth);
    if (node->levels == 0 || is_even(node, tolerance)) {
        fputs("{", out);
        write_value(out, mean_of(node));
        fputs(" }\n", out);
    } else if (node->levels == 1) {
        write_grid(out, node);
    } else {
        fputs("{\n", out);
        for (unsigned i = 0; i < 16; i++) {
            const struct node child = child_of(node, i);
            write_node(out, &child, depth + 1, tolerance);
        }
        indent(out, depth);
        fputs("}\n", out);
    }
}

void lcp_write_tree(FILE *out, const struct lcp_settings *settings, const struct lcp_tensor *tensor)
{
    struct node root = {tensor->cells, tensor->cells + tensor->count, settings->levels, 0};
    fputs("{\n", out);
    for (unsigned i = 0; i < 16; i++) {
        /* Only the lower quarter of A was traced; the others are its mirror images. */
        struct node child;
        root.mirror = i & 3;
        child = child_of(&root, i);
        write_node(out, &child, 1, settings->tolerance);
    }
    fputs("}\n", out);
}
