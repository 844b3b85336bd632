/* Transport plans between the light of two scans; the transportation simplex comes first. */
#include "bsdf/fit/transport/transport.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

/* ---- Transportation simplex ------------------------------------------------------------------ */

/*
 * Transportation simplex over a tree of arcs. Each step finds an arc of largest gain outside the
 * tree and the cycle that it closes. Sources are nodes 0 to n_from - 1, sinks follow. Every node
 * except the root has an arc to its parent in the tree. Light flows along it from the source to the
 * sink.
 */
struct simplex {
    size_t n_from, n_to, n;
    const float *cost;
    const atomic_bool *cancel;
    int32_t *parent, *child, *next, *before; /* first child of a node, and its siblings; -1: none */
    int32_t *depth, *stack;
    double *flow, *potential; /* flow of the arc to the parent; potential of the node */
};

static double cost_of(const struct simplex *s, size_t a, size_t b)
{
    const size_t source = a < b ? a : b, sink = (a < b ? b : a) - s->n_from;
    return (double)s->cost[source * s->n_to + sink];
}

static bool is_source(const struct simplex *s, int32_t node)
{
    return (size_t)node < s->n_from;
}

static void attach_node(struct simplex *s, int32_t node, int32_t parent, double flow)
{
    s->parent[node] = parent;
    s->flow[node] = flow;
    s->before[node] = -1;
    s->next[node] = s->child[parent];
    if (s->child[parent] >= 0)
        s->before[s->child[parent]] = node;
    s->child[parent] = node;
}

static void detach_node(struct simplex *s, int32_t node)
{
    if (s->before[node] >= 0)
        s->next[s->before[node]] = s->next[node];
    else
        s->child[s->parent[node]] = s->next[node];
    if (s->next[node] >= 0)
        s->before[s->next[node]] = s->before[node];
}

/* Sets potentials and depths below top. The potentials of a tree arc's ends add up to its cost. */
static void set_potentials(struct simplex *s, int32_t top)
{
    size_t count = 0;
    s->stack[count++] = top;
    while (count > 0) {
        const int32_t node = s->stack[--count], parent = s->parent[node];
        if (parent >= 0) {
            s->depth[node] = s->depth[parent] + 1;
            s->potential[node] = cost_of(s, (size_t)node, (size_t)parent) - s->potential[parent];
        }
        for (int32_t c = s->child[node]; c >= 0; c = s->next[c])
            s->stack[count++] = c;
    }
}

/* Builds the first tree: sources and sinks in their order, each until it is used up. */
static void begin_tree(struct simplex *s, const double *supply, const double *demand)
{
    size_t i = 0, j = 0;
    double left = supply[0], wanted = demand[0];
    for (size_t k = 0; k < s->n; k++)
        s->parent[k] = s->child[k] = s->next[k] = s->before[k] = -1;
    s->potential[0] = 0;
    s->depth[0] = 0;
    bool by_source = true; /* true if the source is in the tree already */
    while (i < s->n_from && j < s->n_to) {
        const double amount = left < wanted ? left : wanted;
        const int32_t source = (int32_t)i, sink = (int32_t)(s->n_from + j);
        attach_node(s, by_source ? sink : source, by_source ? source : sink, amount);
        left -= amount;
        wanted -= amount;
        const bool source_ends = j + 1 == s->n_to || (i + 1 < s->n_from && left <= wanted);
        if (source_ends) {
            by_source = false;
            if (++i < s->n_from)
                left = supply[i];
        } else {
            by_source = true;
            wanted = demand[++j];
        }
    }
    set_potentials(s, 0);
}

struct arc {
    size_t source, sink; /* node numbers */
    double gain;
};

/* Returns the arc of largest gain in the first range of sources that has one. *row is where the
 * next search begins. */
static struct arc price_arcs(const struct simplex *s, size_t *row, double least)
{
    enum { STRETCH = 8 };
    struct arc best = {0, 0, least};
    for (size_t tried = 0; tried < s->n_from; tried++) {
        const size_t i = (*row + tried) % s->n_from;
        const float *cost = s->cost + i * s->n_to;
        for (size_t j = 0; j < s->n_to; j++) {
            const double gain = s->potential[i] + s->potential[s->n_from + j] - (double)cost[j];
            if (gain > best.gain)
                best = (struct arc){i, s->n_from + j, gain};
        }
        if (tried % STRETCH == STRETCH - 1 && best.gain > least) {
            *row = (i + 1) % s->n_from;
            return best;
        }
    }
    return best;
}

/* Returns the node whose arc to its parent runs out of light first, on the cycle of the new arc.
 * More light on the new arc means less on the other arcs out of its source. */
static int32_t find_leaving(const struct simplex *s, struct arc arc, bool *ret_by_source)
{
    int32_t a = (int32_t)arc.source, b = (int32_t)arc.sink, least = -1;
    while (a != b) {
        const bool up_a = s->depth[a] >= s->depth[b];
        const int32_t node = up_a ? a : b;
        if (is_source(s, node) == up_a && (least < 0 || s->flow[node] < s->flow[least])) {
            least = node;
            *ret_by_source = up_a;
        }
        if (up_a)
            a = s->parent[a];
        else
            b = s->parent[b];
    }
    return least;
}

static void shift_flow(struct simplex *s, struct arc arc, double amount)
{
    int32_t a = (int32_t)arc.source, b = (int32_t)arc.sink;
    while (a != b) {
        const bool up_a = s->depth[a] >= s->depth[b];
        const int32_t node = up_a ? a : b;
        s->flow[node] += is_source(s, node) == up_a ? -amount : amount;
        if (up_a)
            a = s->parent[a];
        else
            b = s->parent[b];
    }
}

/* Attaches the part of the tree below `out` to the new arc; parents become children from the arc's
 * end up. */
static void rehang_subtree(struct simplex *s, struct arc arc, int32_t out, bool by_source,
                           double amount)
{
    int32_t node = (int32_t)(by_source ? arc.source : arc.sink);
    int32_t parent = (int32_t)(by_source ? arc.sink : arc.source);
    const int32_t top = node;
    double flow = amount;
    for (;;) {
        const int32_t above = s->parent[node];
        const double was = s->flow[node];
        const bool last = node == out;
        detach_node(s, node);
        attach_node(s, node, parent, flow);
        if (last)
            break;
        parent = node;
        flow = was;
        node = above;
    }
    set_potentials(s, top);
}

static int solve_simplex(struct simplex *s)
{
    enum { PIVOTS_A_POLL = 256 };
    double largest = 0;
    size_t row = 0;
    for (size_t i = 0; i < s->n_from * s->n_to; i++)
        largest = fmax(largest, (double)s->cost[i]);
    const size_t most = 200 * s->n + 1000; /* a plan that is not optimal is still valid */
    for (size_t pivot = 0; pivot < most; pivot++) {
        const struct arc arc = price_arcs(s, &row, 1e-7 * largest);
        bool by_source = true;
        if (arc.source == arc.sink)
            return 0;
        if (pivot % PIVOTS_A_POLL == 0 && orl_is_cancelled(s->cancel))
            return ORL_ERR_CANCELLED;
        const int32_t out = find_leaving(s, arc, &by_source);
        const double amount = s->flow[out];
        shift_flow(s, arc, amount);
        rehang_subtree(s, arc, out, by_source, amount);
    }
    return 0;
}

static bool make_room(struct simplex *s)
{
    s->parent = malloc(6 * s->n * sizeof *s->parent);
    s->flow = malloc(2 * s->n * sizeof *s->flow);
    if (!s->parent || !s->flow)
        return false;
    s->child = s->parent + s->n;
    s->next = s->child + s->n;
    s->before = s->next + s->n;
    s->depth = s->before + s->n;
    s->stack = s->depth + s->n;
    s->potential = s->flow + s->n;
    return true;
}

int orl_fit_transport(const double *supply, size_t n_from, const double *demand, size_t n_to,
                      const float *cost, const atomic_bool *cancel, struct orl_fit_flow **ret_flows,
                      size_t *ret_n)
{
    struct simplex s = {
        .n_from = n_from, .n_to = n_to, .n = n_from + n_to, .cost = cost, .cancel = cancel};
    struct orl_fit_flow *flows = calloc(s.n, sizeof *flows);
    int code = make_room(&s) && flows ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        begin_tree(&s, supply, demand);
        code = solve_simplex(&s);
    }
    for (size_t node = 1; node < s.n && code == 0; node++) {
        const size_t parent = (size_t)s.parent[node];
        flows[node - 1] = (struct orl_fit_flow){
            (uint32_t)(node < parent ? node : parent),
            (uint32_t)((node < parent ? parent : node) - n_from), orl_larger(0, s.flow[node])};
    }
    free(s.parent);
    free(s.flow);
    if (code < 0) {
        free(flows);
        return code;
    }
    *ret_flows = flows;
    *ret_n = s.n - 1;
    return 0;
}

/* ---- Plans ----------------------------------------------------------------------------------- */

/* Moves below this share of a cluster are dropped, and their light goes to the others. */
static const double least_share = 1e-4;
/* Destinations within this many widths of a cluster are merged. */
static const float close_sigmas = 4;

void orl_fit_plan_done(struct orl_fit_plan *plan)
{
    for (int plan_direction = 0; plan_direction < 2; plan_direction++) {
        free(plan->directions[plan_direction].first);
        free(plan->directions[plan_direction].moves);
        free(plan->directions[plan_direction].submoves);
    }
    memset(plan, 0, sizeof *plan);
}

static double *masses_of(const struct orl_fit_part *part)
{
    double *masses = malloc(part->n_clusters * sizeof *masses), sum = 0;
    if (!masses)
        return NULL;
    for (size_t i = 0; i < part->n_clusters; i++)
        sum += (double)part->clusters[i].mass;
    for (size_t i = 0; i < part->n_clusters; i++)
        masses[i] = (double)part->clusters[i].mass / sum;
    return masses;
}

static float chord2(const struct orl_fit_cluster *a, const struct orl_fit_cluster *b)
{
    const float x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
    return x * x + y * y + z * z;
}

static float *costs_of(const struct orl_fit_part *from, const struct orl_fit_part *to,
                       double farthest)
{
    float *costs = malloc(from->n_clusters * to->n_clusters * sizeof *costs);
    const float most = (float)(farthest * farthest);
    for (size_t i = 0; costs && i < from->n_clusters; i++)
        for (size_t j = 0; j < to->n_clusters; j++) {
            const float cost = chord2(&from->clusters[i], &to->clusters[j]);
            costs[i * to->n_clusters + j] = cost < most ? cost : most;
        }
    return costs;
}

/* One direction of a plan: its source, its destination, and the flows. */
struct plan_direction {
    const struct orl_fit_part *of, *to;
    const struct orl_fit_flow *flows;
    size_t n;
    int number;
    double farthest;
};

static uint32_t source_of(const struct plan_direction *w, size_t flow)
{
    return w->number ? w->flows[flow].to : w->flows[flow].from;
}

static uint32_t target_of(const struct plan_direction *w, size_t flow)
{
    return w->number ? w->flows[flow].from : w->flows[flow].to;
}

/* Sorts the moves of one direction by cluster; shares add up to 1. */
static bool sort_moves(const struct plan_direction *w, struct orl_fit_moves *moves)
{
    const size_t clusters = w->of->n_clusters;
    moves->first = calloc(clusters + 2, sizeof *moves->first);
    moves->moves = malloc((w->n + 1) * sizeof *moves->moves);
    moves->submoves = malloc((w->n + 1) * sizeof *moves->submoves);
    double *sums = calloc(2 * clusters, sizeof *sums), *kept = sums + clusters;
    const bool fine = moves->first && moves->moves && moves->submoves && sums;
    for (size_t k = 0; k < w->n && fine; k++)
        sums[source_of(w, k)] += w->flows[k].amount;
    for (int pass = 0; pass < 2 && fine; pass++) {
        for (size_t k = 0; k < w->n; k++) {
            const uint32_t i = source_of(w, k);
            const struct orl_fit_cluster *target = &w->to->clusters[target_of(w, k)];
            if (!(w->flows[k].amount > least_share * sums[i]))
                continue;
            if (pass == 0) {
                moves->first[i + 2]++;
                kept[i] += w->flows[k].amount;
                continue;
            }
            const uint32_t submove = moves->first[i + 1]++;
            const float share = (float)(w->flows[k].amount / kept[i]);
            moves->submoves[submove] = (struct orl_fit_submove){target_of(w, k), submove, share};
            moves->moves[submove] = (struct orl_fit_move){
                .x = target->x,
                .y = target->y,
                .z = target->z,
                .sigma_rad = target->sigma_rad,
                .share = share,
                .fades = (double)chord2(&w->of->clusters[i], target) >= w->farthest * w->farthest,
                .submove = submove};
            moves->n_submoves++;
        }
        for (size_t i = 0; i < clusters && pass == 0; i++)
            moves->first[i + 2] += moves->first[i + 1];
    }
    free(sums);
    return fine;
}

static bool are_close(const struct orl_fit_move *a, const struct orl_fit_move *b, float sigma)
{
    const float x = a->x - b->x, y = a->y - b->y, z = a->z - b->z;
    const float wide = a->sigma_rad > sigma ? a->sigma_rad : sigma, near = close_sigmas * wide;
    return a->fades == b->fades && x * x + y * y + z * z < near * near;
}

/* Merges moves close to the heaviest one, then to the heaviest of the rest. Returns the number
 * left. */
static size_t join_moves(struct orl_fit_moves *all, uint32_t at, size_t n, float sigma)
{
    struct orl_fit_move *moves = all->moves + at;
    for (size_t i = 0; i < n; i++) {
        size_t top = i, kept = i + 1;
        for (size_t k = i + 1; k < n; k++)
            top = moves[k].share > moves[top].share ? k : top;
        const struct orl_fit_move first = moves[top];
        moves[top] = moves[i];
        struct orl_fit_move sum = {0};
        for (size_t k = i; k < n; k++) {
            const struct orl_fit_move m = k == i ? first : moves[k];
            if (k > i && !are_close(&first, &m, sigma)) {
                moves[kept++] = m;
                continue;
            }
            all->submoves[m.submove].move = at + (uint32_t)i;
            sum.x += m.share * m.x;
            sum.y += m.share * m.y;
            sum.z += m.share * m.z;
            sum.sigma_rad += m.share * m.sigma_rad;
            sum.share += m.share;
        }
        moves[i] = (struct orl_fit_move){.x = sum.x / sum.share,
                                         .y = sum.y / sum.share,
                                         .z = sum.z / sum.share,
                                         .sigma_rad = sum.sigma_rad / sum.share,
                                         .share = sum.share,
                                         .fades = first.fades,
                                         .submove = first.submove};
        n = kept;
    }
    return n;
}

static void join_all_moves(const struct plan_direction *w, struct orl_fit_moves *moves)
{
    uint32_t kept = 0;
    for (size_t i = 0; i < w->of->n_clusters; i++) {
        const uint32_t first = moves->first[i], n = moves->first[i + 1] - first;
        memmove(moves->moves + kept, moves->moves + first, n * sizeof *moves->moves);
        moves->first[i] = kept;
        kept += (uint32_t)join_moves(moves, kept, n, w->of->clusters[i].sigma_rad);
    }
    moves->first[w->of->n_clusters] = kept;
}

int orl_fit_plan_make(const struct orl_fit_part *from, const struct orl_fit_part *to,
                      double farthest, const atomic_bool *cancel, struct orl_fit_plan *ret_plan,
                      struct orl_error *err)
{
    struct orl_fit_plan plan = {0};
    struct orl_fit_flow *flows = NULL;
    size_t n = 0;
    if (from->n_clusters == 0 || to->n_clusters == 0) {
        *ret_plan = plan;
        return 0;
    }
    double *supply = masses_of(from), *demand = masses_of(to);
    float *costs = costs_of(from, to, farthest);
    int code = supply && demand && costs ? 0 : ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_fit_transport(supply, from->n_clusters, demand, to->n_clusters, costs, cancel,
                                 &flows, &n);
    for (int k = 0; k < 2 && code == 0; k++) {
        const struct plan_direction plan_direction = {k ? to : from, k ? from : to, flows, n, k,
                                                      farthest};
        if (sort_moves(&plan_direction, &plan.directions[k]))
            join_all_moves(&plan_direction, &plan.directions[k]);
        else
            code = ORL_ERR_NOMEM;
    }
    free(supply);
    free(demand);
    free(costs);
    free(flows);
    if (code < 0) {
        orl_fit_plan_done(&plan);
        return orl_error_set(err, code,
                             code == ORL_ERR_CANCELLED ? "cancelled"
                                                       : "out of memory for transport plans");
    }
    *ret_plan = plan;
    return 0;
}
