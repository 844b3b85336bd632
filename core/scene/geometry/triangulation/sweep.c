#include "scene/geometry/triangulation/triangulate.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

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

#define NONE UINT32_MAX

enum side { LEFT, RIGHT };

/* The part of a monotone polygon that is not triangulated yet: a reflex chain of nodes on one side.
 * Its lowest node is also the last of the other side. */
struct funnel {
    uint32_t top; /* index into beads */
    enum side side;
};

struct bead {
    uint32_t node, below; /* below: index into beads, or NONE */
};

/* An interval inside the polygon. United regions wait for the next node, which the diagonal will
 * end at. */
struct region {
    struct funnel funnel, other; /* other: the right funnel, if united */
    bool united;
};

/* An edge that the sweep line cuts; region: the one right of it, for edges at even positions. */
struct cut {
    uint32_t edge, region;
};

struct state {
    struct orl_sweep *out;
    const struct orl_arrangement *a;
    const struct orl_node *nodes;
    struct orl_sweep_order order;
    struct cut *cuts;
    size_t n_cuts;
    struct region *regions;
    uint32_t n_regions;
    struct bead *beads;
    uint32_t n_beads;
};

/* ---- Funnels --------------------------------------------------------------------------------- */

static void emit_triangle(struct state *s, uint32_t a, uint32_t b, uint32_t c)
{
    const int64_t turn = orl_node_turn(&s->nodes[a], &s->nodes[b], &s->nodes[c]);
    uint32_t *triple = s->out->triples[s->out->n_triples];
    if (turn == 0)
        return;
    triple[0] = a;
    triple[1] = turn > 0 ? b : c;
    triple[2] = turn > 0 ? c : b;
    s->out->n_triples++;
}

static uint32_t push_bead(struct state *s, uint32_t node, uint32_t below)
{
    s->beads[s->n_beads] = (struct bead){node, below};
    return s->n_beads++;
}

static struct funnel funnel_from(struct state *s, uint32_t low, uint32_t high, enum side side)
{
    return (struct funnel){push_bead(s, high, push_bead(s, low, NONE)), side};
}

/* Emits triangles from the node to the whole chain. */
static void emit_fan(struct state *s, const struct funnel *f, uint32_t node)
{
    for (uint32_t i = f->top; s->beads[i].below != NONE; i = s->beads[i].below)
        emit_triangle(s, node, s->beads[i].node, s->beads[s->beads[i].below].node);
}

/* Adds the next node, on that side. */
static void extend_funnel(struct state *s, struct funnel *f, uint32_t node, enum side side)
{
    const uint32_t top = f->top;
    if (s->beads[top].below != NONE && f->side != side) {
        emit_fan(s, f, node);
        *f = funnel_from(s, s->beads[top].node, node, side);
        return;
    }
    uint32_t at = top;
    while (s->beads[at].below != NONE) {
        const uint32_t a = s->beads[s->beads[at].below].node, b = s->beads[at].node;
        const int64_t turn = orl_node_turn(&s->nodes[a], &s->nodes[b], &s->nodes[node]);
        if (side == LEFT ? turn >= 0 : turn <= 0)
            break;
        emit_triangle(s, a, b, node);
        at = s->beads[at].below;
    }
    *f = (struct funnel){push_bead(s, node, at), side};
}

/* ---- Regions --------------------------------------------------------------------------------- */

static uint32_t open_region(struct state *s, struct funnel funnel)
{
    s->regions[s->n_regions] = (struct region){.funnel = funnel};
    return s->n_regions++;
}

static void extend_left(struct state *s, uint32_t region, uint32_t node)
{
    struct region *r = &s->regions[region];
    if (r->united) {
        emit_fan(s, &r->funnel, node);
        r->funnel = r->other;
        r->united = false;
    }
    extend_funnel(s, &r->funnel, node, LEFT);
}

static void extend_right(struct state *s, uint32_t region, uint32_t node)
{
    struct region *r = &s->regions[region];
    if (r->united) {
        emit_fan(s, &r->other, node);
        r->united = false;
    }
    extend_funnel(s, &r->funnel, node, RIGHT);
}

static void close_region(struct state *s, uint32_t region, uint32_t node)
{
    const struct region *r = &s->regions[region];
    emit_fan(s, &r->funnel, node);
    if (r->united)
        emit_fan(s, &r->other, node);
}

/* Splits a region at a node inside it; returns the right part. */
static uint32_t divide_region(struct state *s, uint32_t region, uint32_t node)
{
    struct region *r = &s->regions[region];
    struct funnel right;
    if (r->united) {
        right = r->other;
        r->united = false;
        extend_funnel(s, &r->funnel, node, RIGHT);
        extend_funnel(s, &right, node, LEFT);
    } else {
        const uint32_t helper = s->beads[r->funnel.top].node;
        const bool chain_left = r->funnel.side == LEFT;
        struct funnel fresh = funnel_from(s, helper, node, chain_left ? RIGHT : LEFT);
        extend_funnel(s, &r->funnel, node, chain_left ? LEFT : RIGHT);
        right = chain_left ? r->funnel : fresh;
        r->funnel = chain_left ? fresh : r->funnel;
    }
    return open_region(s, right);
}

/* Merges two regions at the node where the boundary between them ends. */
static void unite_regions(struct state *s, uint32_t left, uint32_t right, uint32_t node)
{
    extend_right(s, left, node);
    extend_left(s, right, node);
    s->regions[left].other = s->regions[right].funnel;
    s->regions[left].united = true;
}

/* ---- The sweep ------------------------------------------------------------------------------- */

/* Replaces the m edges that end at the node by those that start there. */
static void replace_edges(struct state *s, size_t at, size_t m, uint32_t node, uint32_t right)
{
    const uint32_t first = s->order.first_start[node];
    const size_t k = s->order.first_start[node + 1] - first;
    memmove(&s->cuts[at + k], &s->cuts[at + m], (s->n_cuts - at - m) * sizeof *s->cuts);
    s->n_cuts = s->n_cuts - m + k;
    for (size_t i = 0; i < k; i++) {
        struct cut *cut = &s->cuts[at + i];
        *cut = (struct cut){s->order.starts[first + i], NONE};
        if ((at + i) % 2 == 1)
            continue;
        cut->region = i + 1 == k && right != NONE
                          ? right
                          : open_region(s, (struct funnel){push_bead(s, node, NONE), LEFT});
    }
}

/* Processes a node. Returns false if edges cross, which they must not. */
static bool visit_node(struct state *s, uint32_t node)
{
    const size_t at = orl_sweep_count_left(s->a, &s->cuts->edge, 2, s->n_cuts, node),
                 m = s->order.ends[node];
    const size_t k = s->order.first_start[node + 1] - s->order.first_start[node];
    const bool has_left = at % 2 == 1, has_right = (at + m) % 2 == 1;
    const uint32_t left = has_left ? s->cuts[at - 1].region : NONE;
    uint32_t right = has_right && m > 0 ? s->cuts[at + m - 1].region : NONE;
    if (m + k == 0)
        return true;
    for (size_t i = at; i < at + m; i++)
        if (i >= s->n_cuts || s->a->edges[s->cuts[i].edge].high != node)
            return false;
    for (size_t i = has_left ? at + 1 : at; i + 1 < at + m; i += 2)
        close_region(s, s->cuts[i].region, node);
    if (m == 0 && has_left) {
        right = divide_region(s, left, node);
    } else if (k == 0 && has_left && has_right) {
        unite_regions(s, left, right, node);
    } else {
        if (has_left)
            extend_right(s, left, node);
        if (has_right)
            extend_left(s, right, node);
    }
    replace_edges(s, at, m, node, right);
    return true;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Allocates the arrays. Every edge opens at most one region, and adds two beads to each of two
 * funnels at either end. */
static int lay_out(struct state *s)
{
    const size_t n = s->a->n_nodes, e = s->a->n_edges, beads = 8 * (n + e) + 8;
    const size_t bytes = (e + 1) * (sizeof *s->cuts + sizeof *s->regions) +
                         beads * sizeof *s->beads + orl_sweep_order_words(s->a) * sizeof(uint32_t);
    struct orl_sweep *out = s->out;
    if (!orl_array_reserve_more(&out->scratch, &out->scratch_room, 0, bytes, 1) ||
        !orl_array_reserve_more(&out->triples, &out->triples_room, 0, 2 * (n + e) + 1,
                                sizeof *out->triples))
        return ORL_ERR_NOMEM;
    s->cuts = out->scratch;
    s->regions = (struct region *)(s->cuts + e + 1);
    s->beads = (struct bead *)(s->regions + e + 1);
    orl_sweep_order_fill(&s->order, s->a, (uint32_t *)(s->beads + beads));
    return 0;
}

int orl_sweep_triangulate(struct orl_sweep *sweep, const struct orl_arrangement *arrangement)
{
    struct state s = {.out = sweep, .a = arrangement, .nodes = arrangement->nodes};
    sweep->n_triples = 0;
    if (lay_out(&s) < 0)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < arrangement->n_nodes; i++)
        if (!visit_node(&s, s.order.nodes[i]))
            return ORL_ERR_INTERNAL;
    return 0;
}

void orl_sweep_done(struct orl_sweep *sweep)
{
    free(sweep->triples);
    free(sweep->scratch);
}
