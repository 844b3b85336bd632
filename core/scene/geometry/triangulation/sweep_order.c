#include "scene/geometry/triangulation/sweep_order.h"

#include <stdbool.h>
#include <string.h>

typedef bool before_fn(const struct orl_arrangement *a, uint32_t first, uint32_t second);

static void merge_sort(const struct orl_arrangement *a, uint32_t *items, uint32_t *spare, size_t n,
                       before_fn *before)
{
    for (size_t width = 1; width < n; width *= 2) {
        for (size_t start = 0; start < n; start += 2 * width) {
            const size_t middle = start + width < n ? start + width : n;
            const size_t end = start + 2 * width < n ? start + 2 * width : n;
            size_t i = start, j = middle;
            for (size_t to = start; to < end; to++)
                spare[to] = i < middle && (j >= end || !before(a, items[j], items[i])) ? items[i++]
                                                                                       : items[j++];
        }
        memcpy(items, spare, n * sizeof *items);
    }
}

static bool node_before(const struct orl_arrangement *a, uint32_t first, uint32_t second)
{
    return orl_node_compare(&a->nodes[first], &a->nodes[second]) < 0;
}

static bool edge_before(const struct orl_arrangement *a, uint32_t first, uint32_t second)
{
    const struct orl_edge *e = &a->edges[first], *f = &a->edges[second];
    if (e->low != f->low)
        return e->low < f->low;
    return orl_node_turn(&a->nodes[e->low], &a->nodes[e->high], &a->nodes[f->high]) < 0;
}

size_t orl_sweep_order_words(const struct orl_arrangement *arrangement)
{
    return 4 * arrangement->n_nodes + 2 * arrangement->n_edges + 1;
}

void orl_sweep_order_fill(struct orl_sweep_order *order, const struct orl_arrangement *arrangement,
                          uint32_t *words)
{
    const size_t n = arrangement->n_nodes, e = arrangement->n_edges;
    uint32_t *spare = words + 3 * n + e + 1;
    *order = (struct orl_sweep_order){arrangement, words, words + n, words + n + e,
                                      words + 2 * n + e + 1};
    memset(order->first_start, 0, (2 * n + 1) * sizeof *words); /* clears ends as well */
    for (size_t i = 0; i < n; i++)
        order->nodes[i] = (uint32_t)i;
    for (size_t i = 0; i < e; i++) {
        order->starts[i] = (uint32_t)i;
        order->ends[arrangement->edges[i].high]++;
        order->first_start[arrangement->edges[i].low + 1]++;
    }
    for (size_t i = 0; i < n; i++)
        order->first_start[i + 1] += order->first_start[i];
    merge_sort(arrangement, order->nodes, spare, n, node_before);
    merge_sort(arrangement, order->starts, spare, e, edge_before);
}

size_t orl_sweep_count_left(const struct orl_arrangement *arrangement, const uint32_t *edges,
                            size_t stride, size_t n, uint32_t node)
{
    const struct orl_node *nodes = arrangement->nodes;
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const struct orl_edge *e = &arrangement->edges[edges[middle * stride]];
        if (orl_node_turn(&nodes[e->low], &nodes[e->high], &nodes[node]) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
