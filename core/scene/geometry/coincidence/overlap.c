#include "scene/geometry/coincidence/cutting.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "scene/geometry/triangulation/triangulate.h"

/* FIRST: layer of the first outline; the others' layers are the bits above */
enum { FIRST = 1, NONE = -1 };

/* A directed edge of the border of the result, with the inside on its left. */
struct side {
    uint32_t from, to;
    int32_t next; /* next side with the same start, or NONE */
    bool used;
};

struct border {
    struct side *sides;
    int32_t *first; /* per node: first side that starts there */
    size_t n;
};

/* ---- Separation test ------------------------------------------------------------------------- */

/* Range of an outline's signed distances from a line through origin, along a direction. */
static void distance_range(const struct orl_outline *o, struct orl_vec3 origin,
                           struct orl_vec3 across, double *ret_low, double *ret_high)
{
    *ret_low = INFINITY;
    *ret_high = -INFINITY;
    for (uint32_t i = 0; i < o->n; i++) {
        const double d = orl_dot(orl_sub(o->vertices[i], origin), across);
        *ret_low = fmin(*ret_low, d);
        *ret_high = fmax(*ret_high, d);
    }
}

static bool edge_parts(const struct orl_outline *of, const struct orl_outline *a,
                       const struct orl_outline *b, double tolerance)
{
    for (uint32_t i = 0; i < of->n; i++) {
        const struct orl_vec3 from = of->vertices[i], to = of->vertices[(i + 1) % of->n];
        const struct orl_vec3 across = orl_normalize(orl_cross(of->normal, orl_sub(to, from)));
        double a_low, a_high, b_low, b_high;
        distance_range(a, from, across, &a_low, &a_high);
        distance_range(b, from, across, &b_low, &b_high);
        if (a_high <= b_low + tolerance || b_high <= a_low + tolerance)
            return true;
    }
    return false;
}

bool orl_outlines_apart(const struct orl_outline *a, const struct orl_outline *b, double tolerance)
{
    enum { MOST = 64 }; /* larger ones go to the full comparison */
    return a->n <= MOST && b->n <= MOST &&
           (edge_parts(a, a, b, tolerance) || edge_parts(b, a, b, tolerance));
}

/* ---- Sides of edges -------------------------------------------------------------------------- */

/* Finds the layers that contain the area just left of every edge (above, for a horizontal one), as
 * the sweep reaches it. Returns false if edges cross, which they must not. */
static bool find_layers(const struct orl_arrangement *a, uint32_t *words, uint32_t *ret_left)
{
    struct orl_sweep_order order;
    uint32_t *front = words + orl_sweep_order_words(a);
    size_t n = 0;
    orl_sweep_order_fill(&order, a, words);
    for (size_t i = 0; i < a->n_nodes; i++) {
        const uint32_t node = order.nodes[i], first = order.first_start[node];
        const size_t at = orl_sweep_count_left(a, front, 1, n, node), m = order.ends[node];
        const size_t k = order.first_start[node + 1] - first;
        uint32_t layers = at > 0 ? ret_left[front[at - 1]] ^ a->edges[front[at - 1]].layers : 0;
        if (at + m > n)
            return false;
        memmove(front + at + k, front + at + m, (n - at - m) * sizeof *front);
        n = n - m + k;
        for (size_t j = 0; j < k; j++) {
            const uint32_t edge = front[at + j] = order.starts[first + j];
            ret_left[edge] = layers;
            layers ^= a->edges[edge].layers;
        }
    }
    return true;
}

typedef bool inside_fn(uint32_t layers);

static bool in_both(uint32_t layers)
{
    return (layers & FIRST) && layers != FIRST;
}

static bool in_first_alone(uint32_t layers)
{
    return layers == FIRST;
}

/* Finds the border of one polygon from the layers left of every edge. */
static void find_border(const struct orl_arrangement *a, const uint32_t *left, inside_fn *inside,
                        struct border *border)
{
    border->n = 0;
    for (size_t i = 0; i < a->n_nodes; i++)
        border->first[i] = NONE;
    for (size_t i = 0; i < a->n_edges; i++) {
        const struct orl_edge *e = &a->edges[i];
        const bool on_left = inside(left[i]), on_right = inside(left[i] ^ e->layers);
        if (on_left == on_right)
            continue;
        struct side *side = &border->sides[border->n];
        *side = (struct side){on_left ? e->low : e->high, on_left ? e->high : e->low, NONE, false};
        side->next = border->first[side->from];
        border->first[side->from] = (int32_t)border->n++;
    }
}

/* ---- Loops ----------------------------------------------------------------------------------- */

static int32_t unused_from(const struct border *border, uint32_t node)
{
    int32_t i = border->first[node];
    while (i != NONE && border->sides[i].used)
        i = border->sides[i].next;
    return i;
}

static bool add_vertex(struct orl_overlap *o, struct orl_vec3 place)
{
    if (!orl_array_reserve(&o->vertices, &o->vertices_room, o->n, sizeof *o->vertices))
        return false;
    o->vertices[o->n++] = place;
    return true;
}

/* Appends one closed loop; removes it again if it is only a thin strip. */
static int trace_loop(struct orl_overlap *o, struct border *border, int32_t start, double tolerance,
                      bool *ret_kept)
{
    const struct orl_arrangement *a = &o->arrangement;
    const uint32_t before = o->n;
    double twice = 0, length = 0;
    for (int32_t i = start; i != NONE; i = unused_from(border, border->sides[i].to)) {
        struct side *side = &border->sides[i];
        const struct orl_node *from = &a->nodes[side->from], *to = &a->nodes[side->to];
        side->used = true;
        twice += (double)from->x * to->y - (double)from->y * to->x;
        length += hypot((double)to->x - from->x, (double)to->y - from->y);
        if (!add_vertex(o, from->place))
            return ORL_ERR_NOMEM;
    }
    *ret_kept = fabs(twice) * a->step > tolerance * length;
    if (!*ret_kept)
        o->n = before;
    else if (!add_vertex(o, o->vertices[before]))
        return ORL_ERR_NOMEM;
    return 0;
}

/* Appends all loops; a seam from the first loop's start leads to each other loop and back. */
static int trace_loops(struct orl_overlap *o, struct border *border, double tolerance)
{
    o->n = 0;
    for (size_t i = 0; i < border->n; i++) {
        const bool first = o->n == 0;
        bool kept;
        if (border->sides[i].used)
            continue;
        if (trace_loop(o, border, (int32_t)i, tolerance, &kept) < 0)
            return ORL_ERR_NOMEM;
        if (kept && !first && !add_vertex(o, o->vertices[0]))
            return ORL_ERR_NOMEM;
    }
    return 0;
}

/* ---- Combination ----------------------------------------------------------------------------- */

static int arrange(struct orl_overlap *o, const struct orl_outline *a,
                   const struct orl_outline *others, const uint32_t *layers, size_t n)
{
    struct orl_vec3 low = a->vertices[0], high = low;
    for (size_t i = 0; i <= n; i++) {
        const struct orl_outline *outline = i < n ? &others[i] : a;
        for (uint32_t k = 0; k < outline->n; k++)
            orl_box_include(outline->vertices[k], &low, &high);
    }
    orl_arrangement_begin(&o->arrangement, a->normal, orl_scale(orl_add(low, high), 0.5),
                          0.5 * orl_length(orl_sub(high, low)));
    int code = orl_arrangement_add(&o->arrangement, a->vertices, a->n, FIRST);
    for (size_t i = 0; i < n && code == 0; i++)
        code = orl_arrangement_add(&o->arrangement, others[i].vertices, others[i].n,
                                   (uint32_t)2 << layers[i]);
    return code < 0 ? code : orl_arrangement_split(&o->arrangement);
}

int orl_outline_subtract(struct orl_overlap *o, const struct orl_outline *a,
                         const struct orl_outline *others, const uint32_t *layers, size_t n,
                         double tolerance)
{
    const int code = arrange(o, a, others, layers, n);
    const size_t n_edges = o->arrangement.n_edges, n_nodes = o->arrangement.n_nodes;
    struct border border = {0};
    o->work += 32 * (n_edges + 1) + o->arrangement.tests;
    if (code < 0)
        return code;
    const size_t words = n_nodes + 2 * n_edges + orl_sweep_order_words(&o->arrangement);
    if (!orl_array_reserve_more(&o->scratch, &o->scratch_room, 0,
                                n_edges * sizeof *border.sides + words * sizeof(uint32_t), 1))
        return ORL_ERR_NOMEM;
    border.sides = o->scratch;
    border.first = (int32_t *)(border.sides + n_edges);
    uint32_t *left = (uint32_t *)(border.first + n_nodes);
    if (!find_layers(&o->arrangement, left + n_edges, left))
        return ORL_ERR_LIMIT;
    find_border(&o->arrangement, left, in_both, &border);
    if (trace_loops(o, &border, tolerance) < 0)
        return ORL_ERR_NOMEM;
    o->shared = o->n > 0;
    find_border(&o->arrangement, left, in_first_alone, &border);
    return trace_loops(o, &border, tolerance);
}

void orl_overlap_done(struct orl_overlap *overlap)
{
    orl_arrangement_done(&overlap->arrangement);
    free(overlap->vertices);
    free(overlap->scratch);
}
