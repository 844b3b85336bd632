#include "base/morton.h"
#include "scene/geometry/coincidence/coincident_pairs.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory/memory.h"

/* A box's index, and the Morton code of its centre. */
struct leaf {
    uint64_t code;
    uint32_t number;
};

bool orl_boxes_meet(const struct orl_box *a, const struct orl_box *b, double pad)
{
    return a->low.x <= b->high.x + pad && b->low.x <= a->high.x + pad &&
           a->low.y <= b->high.y + pad && b->low.y <= a->high.y + pad &&
           a->low.z <= b->high.z + pad && b->low.z <= a->high.z + pad;
}

/* ---- Building -------------------------------------------------------------------------------- */

static const struct orl_box empty = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

static double smaller(double a, double b)
{
    return a < b ? a : b;
}

static double larger(double a, double b)
{
    return a > b ? a : b;
}

static struct orl_box box_union(const struct orl_box *a, const struct orl_box *b)
{
    return (struct orl_box){
        {smaller(a->low.x, b->low.x), smaller(a->low.y, b->low.y), smaller(a->low.z, b->low.z)},
        {larger(a->high.x, b->high.x), larger(a->high.y, b->high.y), larger(a->high.z, b->high.z)}};
}

static const struct orl_box *box_at(const struct orl_box *boxes, size_t stride, size_t i)
{
    return (const struct orl_box *)((const char *)boxes + i * stride);
}

/* Position of an interval's middle within the range, as 21 bits. */
static uint64_t grid_place(double low, double high, double range_low, double range_high)
{
    const double at = 0.5 * (low + high) - range_low, width = range_high - range_low;
    return at > 0 && width > 0 ? (uint64_t)(smaller(at / width, 1) * 0x1fffff) : 0;
}

static uint64_t code_of(const struct orl_box *box, const struct orl_box *all)
{
    return orl_morton_code(grid_place(box->low.x, box->high.x, all->low.x, all->high.x),
                           grid_place(box->low.y, box->high.y, all->low.y, all->high.y),
                           grid_place(box->low.z, box->high.z, all->low.z, all->high.z));
}

static int compare_leaves(const void *left, const void *right)
{
    const struct leaf *a = left, *b = right;
    if (a->code != b->code)
        return a->code < b->code ? -1 : 1;
    return a->number < b->number ? -1 : a->number > b->number;
}

static void order_leaves(const struct orl_box *boxes, size_t stride, size_t n, struct leaf *leaves)
{
    struct orl_box all = empty;
    for (size_t i = 0; i < n; i++)
        all = box_union(&all, box_at(boxes, stride, i));
    for (size_t i = 0; i < n; i++)
        leaves[i] = (struct leaf){code_of(box_at(boxes, stride, i), &all), (uint32_t)i};
    qsort(leaves, n, sizeof *leaves, compare_leaves);
}

bool orl_box_tree_build(struct orl_box_tree *tree, const struct orl_box *boxes, size_t stride,
                        size_t n)
{
    struct leaf *const leaves = malloc((n + 1) * sizeof *leaves);
    tree->n_leaves = 1;
    while (tree->n_leaves < n)
        tree->n_leaves *= 2;
    free(tree->nodes);
    tree->nodes = malloc(2 * tree->n_leaves * sizeof *tree->nodes);
    if (leaves && tree->nodes) {
        struct orl_box_node *const nodes = tree->nodes;
        order_leaves(boxes, stride, n, leaves);
        for (size_t i = 0; i < tree->n_leaves; i++)
            nodes[tree->n_leaves + i] =
                i < n ? (struct orl_box_node){*box_at(boxes, stride, leaves[i].number),
                                              leaves[i].number}
                      : (struct orl_box_node){empty, -1};
        for (size_t k = tree->n_leaves; --k > 0;) {
            const struct orl_box_node *const a = &nodes[2 * k], *const b = &nodes[2 * k + 1];
            nodes[k].box = box_union(&a->box, &b->box);
            nodes[k].last = a->last > b->last ? a->last : b->last;
        }
    }
    free(leaves);
    return leaves && tree->nodes;
}

/* ---- Searching ------------------------------------------------------------------------------- */

static int compare_numbers(const void *left, const void *right)
{
    const uint32_t a = *(const uint32_t *)left, b = *(const uint32_t *)right;
    return a < b ? -1 : a > b;
}

bool orl_box_tree_find(struct orl_box_tree *tree, const struct orl_box *box, int64_t after,
                       double pad, uint64_t *visits)
{
    enum { DEEPEST = 64 }; /* one sibling of each level is on the stack */
    size_t waiting[DEEPEST], n_waiting = 1;
    waiting[0] = 1;
    tree->n_found = 0;
    while (n_waiting > 0) {
        const size_t k = waiting[--n_waiting];
        const struct orl_box_node *const node = &tree->nodes[k];
        ++*visits;
        if (node->last <= after || !orl_boxes_meet(box, &node->box, pad))
            continue;
        if (k < tree->n_leaves) {
            waiting[n_waiting++] = 2 * k + 1;
            waiting[n_waiting++] = 2 * k;
            continue;
        }
        if (!orl_array_reserve(&tree->found, &tree->room, tree->n_found, sizeof *tree->found))
            return false;
        tree->found[tree->n_found++] = (uint32_t)node->last;
    }
    if (tree->n_found > 1)
        qsort(tree->found, tree->n_found, sizeof *tree->found, compare_numbers);
    return true;
}

void orl_box_tree_done(struct orl_box_tree *tree)
{
    free(tree->nodes);
    free(tree->found);
}

/* ---- Boxes of surfaces ----------------------------------------------------------------------- */

static struct orl_box box_of_ring(const struct orl_surface *s)
{
    const struct orl_vec3 n = s->normal;
    const struct orl_vec3 reach =
        orl_scale(orl_v3(sqrt(fmax(1 - n.x * n.x, 0)), sqrt(fmax(1 - n.y * n.y, 0)),
                         sqrt(fmax(1 - n.z * n.z, 0))),
                  s->quadric->radius[1]);
    return (struct orl_box){orl_sub(s->quadric->center[0], reach),
                            orl_add(s->quadric->center[0], reach)};
}

struct orl_box orl_box_of_flat(const struct orl_surface *surface)
{
    if (surface->kind == ORL_SURFACE_RING)
        return box_of_ring(surface);
    struct orl_box box = {surface->vertices[0], surface->vertices[0]};
    for (uint32_t i = 1; i < surface->n_vertices; i++)
        orl_box_include(surface->vertices[i], &box.low, &box.high);
    return box;
}

bool orl_boxes_overlap(const struct orl_box *a, const struct orl_box *b, double tolerance)
{
    const double pad = tolerance;
    if (!orl_boxes_meet(a, b, pad))
        return false;
    const struct orl_vec3 common = {fmin(a->high.x, b->high.x) - fmax(a->low.x, b->low.x),
                                    fmin(a->high.y, b->high.y) - fmax(a->low.y, b->low.y),
                                    fmin(a->high.z, b->high.z) - fmax(a->low.z, b->low.z)};
    return (common.x > pad) + (common.y > pad) + (common.z > pad) >= 2;
}
