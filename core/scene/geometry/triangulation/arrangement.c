#include "scene/geometry/triangulation/arrangement.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"
#include "scene/geometry/triangulation/triangulate.h"

enum { MOST_PASSES = 64, LONG_PASS = 2, FEW_EDGES = 2000 };
/* Limits of pairs tested in one search for all intersections, and in total: about a second. */
static const uint64_t most_pairs = 20000000, most_tests = 60000000;

static const double steps = 0x1p29 - 2;

/* An edge's extent along x, y and the two diagonals. */
enum { AXES = 4 };
struct box {
    int32_t low[AXES], high[AXES];
    uint32_t edge;
};

struct split {
    uint32_t edge, node;
    double along;
};

enum scratch { BOXES, SPLITS, SPARE, TABLE }; /* BOXES: also used as scratch by the sweep */

/* ---- Memory ---------------------------------------------------------------------------------- */

static void *scratch_array(struct orl_arrangement *a, enum scratch which, size_t count, size_t item)
{
    return orl_array_reserve_more(&a->scratch[which], &a->scratch_room[which], 0,
                                  (count + 1) * item, 1)
               ? a->scratch[which]
               : NULL;
}

void orl_arrangement_done(struct orl_arrangement *a)
{
    free(a->nodes);
    free(a->edges);
    for (size_t i = 0; i < sizeof a->scratch / sizeof *a->scratch; i++)
        free(a->scratch[i]);
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

static size_t slot_of(const struct orl_arrangement *a, int32_t x, int32_t y)
{
    const uint64_t key = ((uint64_t)(uint32_t)x << 32 | (uint32_t)y) * 0x9e3779b97f4a7c15U;
    size_t slot = (key ^ key >> 29) & (a->table_size - 1);
    while (a->table[slot] > 0 &&
           (a->nodes[a->table[slot] - 1].x != x || a->nodes[a->table[slot] - 1].y != y))
        slot = (slot + 1) & (a->table_size - 1);
    return slot;
}

/* Makes room for more nodes, also in the hash table. */
static bool make_room(struct orl_arrangement *a, size_t more)
{
    const size_t wanted = a->n_nodes + more;
    size_t size = a->table_size ? a->table_size : 16;
    if (!orl_array_reserve_more(&a->nodes, &a->nodes_room, a->n_nodes, more, sizeof *a->nodes))
        return false;
    while (size < 2 * wanted)
        size *= 2;
    if (size == a->table_size)
        return true;
    a->table = scratch_array(a, TABLE, size, sizeof *a->table);
    if (!a->table)
        return false;
    a->table_size = size;
    memset(a->table, 0, size * sizeof *a->table);
    for (size_t i = 0; i < a->n_nodes; i++)
        a->table[slot_of(a, a->nodes[i].x, a->nodes[i].y)] = (uint32_t)i + 1;
    return true;
}

/* Returns the node at a grid point, created if there is none; room must have been made. */
static uint32_t node_at(struct orl_arrangement *a, int32_t x, int32_t y, struct orl_vec3 place)
{
    const size_t slot = slot_of(a, x, y);
    if (a->table[slot] == 0) {
        a->nodes[a->n_nodes] = (struct orl_node){x, y, place};
        a->table[slot] = (uint32_t)++a->n_nodes;
    }
    return a->table[slot] - 1;
}

void orl_arrangement_begin(struct orl_arrangement *a, struct orl_vec3 normal,
                           struct orl_vec3 middle, double reach)
{
    a->frame = orl_frame_about(normal);
    a->middle = middle;
    a->step = reach > 0 ? reach / steps : 1;
    a->n_nodes = a->n_edges = 0;
    a->table_size = 0;
    a->tests = 0;
}

static int32_t on_grid(double length, double step)
{
    const double at = rint(length / step);
    return (int32_t)fmin(fmax(at, -steps), steps);
}

static void set_edge(struct orl_arrangement *a, struct orl_edge *edge, uint32_t from, uint32_t to,
                     uint32_t layers)
{
    const bool up = orl_node_compare(&a->nodes[from], &a->nodes[to]) < 0;
    *edge = (struct orl_edge){up ? from : to, up ? to : from, layers};
}

int orl_arrangement_add(struct orl_arrangement *a, const struct orl_vec3 *vertices, uint32_t n,
                        uint32_t layer)
{
    uint32_t first = 0, last = 0;
    if (!make_room(a, n) ||
        !orl_array_reserve_more(&a->edges, &a->edges_room, a->n_edges, n, sizeof *a->edges))
        return ORL_ERR_NOMEM;
    for (uint32_t i = 0; i < n; i++) {
        const struct orl_vec3 d = orl_sub(vertices[i], a->middle);
        const uint32_t node = node_at(a, on_grid(orl_dot(d, a->frame.u), a->step),
                                      on_grid(orl_dot(d, a->frame.v), a->step), vertices[i]);
        if (i == 0)
            first = node;
        else if (node != last)
            set_edge(a, &a->edges[a->n_edges++], last, node, layer);
        last = node;
    }
    if (last != first)
        set_edge(a, &a->edges[a->n_edges++], last, first, layer);
    return 0;
}

/* ---- Coincident edges ------------------------------------------------------------------------ */

static int compare_edges(const void *left, const void *right)
{
    const struct orl_edge *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    return a->high < b->high ? -1 : a->high > b->high;
}

/* Merges coincident edges; in each layer an even number cancels. */
static void merge_coincident_edges(struct orl_arrangement *a)
{
    size_t kept = 0;
    qsort(a->edges, a->n_edges, sizeof *a->edges, compare_edges);
    for (size_t i = 0; i < a->n_edges;) {
        struct orl_edge edge = a->edges[i];
        for (i++; i < a->n_edges && compare_edges(&a->edges[i], &edge) == 0; i++)
            edge.layers ^= a->edges[i].layers;
        if (edge.layers != 0)
            a->edges[kept++] = edge;
    }
    a->n_edges = kept;
}

/* ---- Intersections --------------------------------------------------------------------------- */

static void measure_extents(const struct orl_node *n, int32_t ret_extent[AXES])
{
    ret_extent[0] = n->y;
    ret_extent[1] = n->x;
    ret_extent[2] = n->x + n->y;
    ret_extent[3] = n->x - n->y;
}

static int compare_boxes(const void *left, const void *right)
{
    const struct box *a = left, *b = right;
    if (a->low[0] != b->low[0])
        return a->low[0] < b->low[0] ? -1 : 1;
    return a->edge < b->edge ? -1 : a->edge > b->edge;
}

/* Boxes are padded by a grid step on each side, more than the half step of rounding. */
static void make_boxes(const struct orl_arrangement *a, struct box *boxes)
{
    for (size_t i = 0; i < a->n_edges; i++) {
        int32_t low[AXES], high[AXES];
        measure_extents(&a->nodes[a->edges[i].low], low);
        measure_extents(&a->nodes[a->edges[i].high], high);
        boxes[i].edge = (uint32_t)i;
        for (int k = 0; k < AXES; k++) {
            boxes[i].low[k] = (low[k] < high[k] ? low[k] : high[k]) - 1;
            boxes[i].high[k] = (low[k] < high[k] ? high[k] : low[k]) + 1;
        }
    }
    qsort(boxes, a->n_edges, sizeof *boxes, compare_boxes);
}

static bool are_apart(const struct box *a, const struct box *b)
{
    bool result = false;
    for (int k = 1; k < AXES; k++)
        result |= (a->low[k] > b->high[k]) | (b->low[k] > a->high[k]);
    return result;
}

/* The state of one search for meetings. */
struct search {
    struct orl_arrangement *a;
    size_t n_splits;
    int code;
};

static void add_split(struct search *s, uint32_t edge, uint32_t node, double along)
{
    struct orl_arrangement *a = s->a;
    struct split *splits = scratch_array(a, SPLITS, s->n_splits + 1, sizeof *splits);
    if (!splits)
        s->code = ORL_ERR_NOMEM;
    else if (a->n_edges + s->n_splits > 2 * (size_t)ORL_LIMIT_POLYGON_CROSSINGS)
        s->code = ORL_ERR_LIMIT;
    else
        splits[s->n_splits++] = (struct split){edge, node, along};
}

/* Splits the edge at a node within one grid step of it. */
static bool split_at(struct search *s, uint32_t edge, uint32_t node)
{
    const struct orl_node *nodes = s->a->nodes, *p = &nodes[node];
    const struct orl_edge *e = &s->a->edges[edge];
    if (node == e->low || node == e->high)
        return false;
    const struct orl_node *low = &nodes[e->low], *high = &nodes[e->high];
    const double dx = (double)high->x - low->x, dy = (double)high->y - low->y;
    const double length2 = dx * dx + dy * dy, off = (double)orl_node_turn(low, high, p);
    const double along = ((double)p->x - low->x) * dx + ((double)p->y - low->y) * dy;
    if (!(along > 0 && along < length2 && off * off <= length2))
        return false;
    add_split(s, edge, node, along);
    return true;
}

/* Splits both edges where they cross, at a new node unless there is one. */
static void split_crossing(struct search *s, uint32_t first, uint32_t second, int64_t to_low,
                           int64_t to_high)
{
    struct orl_arrangement *a = s->a;
    const struct orl_edge e = a->edges[first], f = a->edges[second];
    if (!make_room(a, 1)) {
        s->code = ORL_ERR_NOMEM;
        return;
    }
    /* Interpolates along f, by the distances of its ends from e. */
    const double share = (double)to_low / ((double)to_low - (double)to_high);
    const struct orl_node *low = &a->nodes[f.low], *high = &a->nodes[f.high];
    const double dx = (double)high->x - low->x, dy = (double)high->y - low->y;
    const uint32_t node =
        node_at(a, (int32_t)rint(low->x + share * dx), (int32_t)rint(low->y + share * dy),
                orl_madd(low->place, orl_sub(high->place, low->place), share));
    const struct orl_node *p = &a->nodes[node], *start = &a->nodes[e.low], *end = &a->nodes[e.high];
    if (node != f.low && node != f.high)
        add_split(s, second, node, share);
    if (node != e.low && node != e.high && s->code == 0)
        add_split(s, first, node,
                  ((double)p->x - start->x) * ((double)end->x - start->x) +
                      ((double)p->y - start->y) * ((double)end->y - start->y));
}

static void test_pair(struct search *s, uint32_t first, uint32_t second)
{
    struct orl_arrangement *a = s->a;
    const struct orl_edge e = a->edges[first], f = a->edges[second];
    const struct orl_node *n = a->nodes;
    const int64_t f_low = orl_node_turn(&n[e.low], &n[e.high], &n[f.low]);
    const int64_t f_high = orl_node_turn(&n[e.low], &n[e.high], &n[f.high]);
    /* Both ends are on one side, more than two steps away: no edge is longer than 2^31. */
    const int64_t far = (int64_t)1 << 32;
    if ((f_low > far && f_high > far) || (f_low < -far && f_high < -far))
        return;
    bool touches = split_at(s, first, f.low);
    touches |= split_at(s, first, f.high);
    touches |= split_at(s, second, e.low);
    touches |= split_at(s, second, e.high);
    if (touches || e.low == f.low || e.high == f.high || e.low == f.high || e.high == f.low)
        return;
    const int64_t e_low = orl_node_turn(&n[f.low], &n[f.high], &n[e.low]);
    const int64_t e_high = orl_node_turn(&n[f.low], &n[f.high], &n[e.high]);
    if ((f_low < 0) != (f_high < 0) && (e_low < 0) != (e_high < 0) && f_low != 0 && f_high != 0 &&
        e_low != 0 && e_high != 0)
        split_crossing(s, first, second, f_low, f_high);
}

/* Finds all intersections, or as many as the limit of tests allows. */
static void find_meetings(struct search *s)
{
    struct orl_arrangement *a = s->a;
    const uint64_t most = a->tests + most_pairs;
    struct box *boxes = scratch_array(a, BOXES, a->n_edges, sizeof *boxes);
    if (!boxes) {
        s->code = ORL_ERR_NOMEM;
        return;
    }
    make_boxes(a, boxes);
    for (size_t i = 0; i < a->n_edges && a->tests < most && s->code == 0; i++) {
        size_t j = i + 1;
        for (; j < a->n_edges && boxes[j].low[0] <= boxes[i].high[0] && s->code == 0; j++)
            if (!are_apart(&boxes[i], &boxes[j]))
                test_pair(s, boxes[i].edge, boxes[j].edge);
        a->tests += j - i;
    }
}

/* ---- Search by a sweep ----------------------------------------------------------------------- */

/* The edges that the sweep cuts, from left to right. */
struct front {
    const struct orl_sweep_order *order;
    uint32_t *edges;
    size_t n;
};

/* Removes the edges that end at a node when they are out of order, which means that edges cross. */
static size_t remove_ending_edges(struct front *f, const struct orl_arrangement *a, uint32_t node)
{
    size_t kept = 0;
    for (size_t i = 0; i < f->n; i++)
        if (a->edges[f->edges[i]].high != node)
            f->edges[kept++] = f->edges[i];
    f->n = kept;
    return orl_sweep_count_left(a, f->edges, 1, f->n, node);
}

/* Processes one node; tests the edges that become neighbours. */
static void pass_node(struct search *s, struct front *f, uint32_t node)
{
    const struct orl_arrangement *a = s->a;
    const uint32_t first = f->order->first_start[node];
    const size_t k = f->order->first_start[node + 1] - first;
    size_t m = f->order->ends[node], at = orl_sweep_count_left(a, f->edges, 1, f->n, node);
    bool in_place = at + m <= f->n;
    for (size_t i = at; i < at + m && in_place; i++)
        in_place = a->edges[f->edges[i]].high == node;
    if (!in_place) {
        s->a->tests += f->n / 16;
        at = remove_ending_edges(f, a, node);
        m = 0;
    }
    memmove(f->edges + at + k, f->edges + at + m, (f->n - at - m) * sizeof *f->edges);
    memcpy(f->edges + at, f->order->starts + first, k * sizeof *f->edges);
    f->n = f->n - m + k;
    for (size_t i = at > 0 ? at : 1; i <= at + k && i < f->n && s->code == 0; i++)
        test_pair(s, f->edges[i - 1], f->edges[i]);
    s->a->tests += k + 1;
}

/* Finds some intersection if there is any: two edges that meet are neighbours before (Shamos and
 * Hoey 1976). */
static void find_any_meeting(struct search *s)
{
    struct orl_arrangement *a = s->a;
    struct orl_sweep_order order;
    struct front front = {.order = &order};
    const size_t words = orl_sweep_order_words(a), n_nodes = a->n_nodes;
    uint32_t *room = scratch_array(a, BOXES, words + a->n_edges, sizeof *room);
    if (!room) {
        s->code = ORL_ERR_NOMEM;
        return;
    }
    orl_sweep_order_fill(&order, a, room);
    front.edges = room + words;
    for (size_t i = 0; i < n_nodes && s->code == 0; i++)
        pass_node(s, &front, order.nodes[i]);
}

/* ---- Splitting ------------------------------------------------------------------------------- */

static int compare_splits(const void *left, const void *right)
{
    const struct split *a = left, *b = right;
    if (a->edge != b->edge)
        return a->edge < b->edge ? -1 : 1;
    if (a->along != b->along)
        return a->along < b->along ? -1 : 1;
    return a->node < b->node ? -1 : a->node > b->node;
}

/* Computes the key that orders splits of one edge, independent of how they were found. */
static void measure_splits(const struct orl_arrangement *a, struct split *splits, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const struct orl_edge *e = &a->edges[splits[i].edge];
        const struct orl_node *low = &a->nodes[e->low], *high = &a->nodes[e->high];
        const struct orl_node *p = &a->nodes[splits[i].node];
        splits[i].along = ((double)p->x - low->x) * ((double)high->x - low->x) +
                          ((double)p->y - low->y) * ((double)high->y - low->y);
    }
    qsort(splits, n, sizeof *splits, compare_splits);
}

static int apply_splits(struct orl_arrangement *a, size_t n_splits)
{
    struct split *splits = a->scratch[SPLITS];
    const size_t most = a->n_edges + n_splits;
    struct orl_edge *pieces = scratch_array(a, SPARE, most, sizeof *pieces);
    size_t n = 0, k = 0;
    if (!pieces ||
        !orl_array_reserve_more(&a->edges, &a->edges_room, a->n_edges, n_splits, sizeof *a->edges))
        return ORL_ERR_NOMEM;
    measure_splits(a, splits, n_splits);
    for (size_t i = 0; i < a->n_edges; i++) {
        const struct orl_edge e = a->edges[i];
        uint32_t at = e.low;
        for (; k < n_splits && splits[k].edge == i; k++) {
            if (splits[k].node != at)
                set_edge(a, &pieces[n++], at, splits[k].node, e.layers);
            at = splits[k].node;
        }
        if (at != e.high)
            set_edge(a, &pieces[n++], at, e.high, e.layers);
    }
    memcpy(a->edges, pieces, n * sizeof *pieces);
    a->n_edges = n;
    return 0;
}

int orl_arrangement_split(struct orl_arrangement *a)
{
    for (int pass = 0; pass < MOST_PASSES; pass++) {
        struct search search = {.a = a};
        merge_coincident_edges(a);
        find_any_meeting(&search);
        if (search.n_splits > 0 && (pass == LONG_PASS || a->n_edges < FEW_EDGES)) {
            search.n_splits = 0;
            find_meetings(&search);
        }
        if (search.code < 0 || search.n_splits == 0)
            return search.code;
        if (a->tests > most_tests)
            return ORL_ERR_LIMIT;
        const int code = apply_splits(a, search.n_splits);
        if (code < 0)
            return code;
    }
    return ORL_ERR_LIMIT;
}
