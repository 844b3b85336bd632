#include "bsdf/fit/transport/transport.h"

#include <stdlib.h>
#include <string.h>

/* Moves below this share of a cluster are dropped, and their light goes to the others. */
static const double least_share = 1e-4;
/* Destinations within this many widths of a cluster are joined. */
static const float close_sigmas = 4;

void orl_fit_plan_done(struct orl_fit_plan *plan)
{
    if (!plan)
        return;
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

/* One way of a plan: its source, its destination, and the flows. */
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

/* Sorts the moves of one way by cluster; shares add up to 1. */
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

/* Joins moves close to the heaviest one, then to the heaviest of the rest. Returns the number
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
