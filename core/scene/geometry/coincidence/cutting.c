#include "scene/geometry/coincidence/cutting.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

#include "base/memory/memory.h"
#include "scene/geometry/coincidence/coincident.h"

/* Limits: a constant for any scene, plus an amount per corner; at most some seconds. */
static const uint64_t least_comparisons = 4000000, comparisons_a_corner = 250,
                      most_comparisons = 400000000;
static const uint64_t least_work = 20000000, work_a_corner = 2500, most_work = 400000000;

void orl_cutting_bound(struct orl_cutting *cutting)
{
    const struct orl_parsed_scene *const d = cutting->d;
    uint64_t corners = 0;
    for (size_t i = 0; i < d->n_surfaces; i++)
        corners += d->surfaces[i].kind == ORL_SURFACE_POLYGON ? d->surfaces[i].n_vertices : 4;
    const uint64_t budget = least_comparisons + comparisons_a_corner * corners;
    const uint64_t work = least_work + work_a_corner * corners;
    cutting->budget.most = budget < most_comparisons ? budget : most_comparisons;
    cutting->most_work = work < most_work ? work : most_work;
}

struct orl_outline orl_outline_of(const struct orl_surface *polygon)
{
    return (struct orl_outline){polygon->vertices, polygon->n_vertices, polygon->normal};
}

enum { FEW_WINNERS = 16 };

/* ---- Cutting --------------------------------------------------------------------------------- */

static int compare_losses(const void *left, const void *right)
{
    const struct orl_pair *a = left, *b = right;
    if (a->a != b->a)
        return a->a < b->a ? -1 : 1;
    return a->b < b->b ? -1 : a->b > b->b;
}

int orl_cutting_test(struct orl_cutting *cutting, const struct orl_outline *a,
                     const struct orl_outline *b)
{
    const uint32_t layer = 0;
    cutting->overlap.shared = false;
    const int code = orl_outline_subtract(&cutting->overlap, a, b, &layer, 1, cutting->tolerance);
    cutting->cut_short =
        cutting->cut_short || cutting->overlap.work > cutting->most_work || code == ORL_ERR_LIMIT;
    if (code < 0)
        cutting->overlap.shared = false;
    return code == ORL_ERR_NOMEM ? code : 0;
}

static void report_overlap(struct orl_cutting *t, const struct orl_surface *loser,
                           const struct orl_surface *winner)
{
    const bool alike = orl_surfaces_alike(t->d, loser, winner);
    orl_coincidence_warn(t->warnings, t->d,
                         alike ? ORL_COINCIDENCE_SAME_MATERIAL : ORL_COINCIDENCE_RESOLVED, loser,
                         winner, t->overlap.n == 0);
}

/* Selects the winners that share an area with the loser, and reports them. If there are many, one
 * that covers the loser completely is selected alone. */
static int keep_overlapping(struct orl_cutting *t, const struct orl_surface *loser,
                            struct orl_pair *losses, size_t *n)
{
    const struct orl_outline first = orl_outline_of(loser);
    const bool many = *n > FEW_WINNERS;
    size_t kept = 0;
    for (size_t i = 0; i < *n && !t->cut_short; i++) {
        const struct orl_surface *winner = &t->d->surfaces[losses[i].b];
        const struct orl_outline second = orl_outline_of(winner);
        const int code = orl_cutting_test(t, &first, &second);
        if (code < 0)
            return code;
        if (!t->overlap.shared)
            continue;
        report_overlap(t, loser, winner);
        if (many && t->overlap.n == 0) {
            losses[0] = losses[i];
            kept = 1;
            break;
        }
        losses[kept++] = losses[i];
    }
    *n = kept;
    return 0;
}

/* A winner's outline, with its bounding box and its layer. */
struct layered {
    struct orl_box box;
    struct orl_outline outline;
    uint32_t layer; /* ORL_OVERLAP_LAYERS: not assigned yet */
};

/* Returns the layers, as bits, of winners before the i-th whose boxes overlap its box. */
static int find_taken(struct orl_cutting *t, const struct layered *winners, size_t i,
                      uint32_t *ret_taken)
{
    *ret_taken = 0;
    if (!orl_box_tree_find(&t->tree, &winners[i].box, -1, t->tolerance, &t->budget.n))
        return ORL_ERR_NOMEM;
    for (size_t k = 0; k < t->tree.n_found && t->tree.found[k] < i; k++) {
        const struct layered *const other = &winners[t->tree.found[k]];
        if (other->layer < ORL_OVERLAP_LAYERS &&
            orl_boxes_overlap(&winners[i].box, &other->box, t->tolerance))
            *ret_taken |= (uint32_t)1 << other->layer;
    }
    return 0;
}

/* Assigns layers to winners so that none of one layer overlap; moves those that got one to the
 * front. *ret_laid: their number. */
static int assign_layers(struct orl_cutting *t, struct layered *winners, size_t n, size_t *ret_laid)
{
    size_t laid = 0;
    if (!orl_box_tree_build(&t->tree, &winners[0].box, sizeof *winners, n))
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++) {
        uint32_t taken, layer = 0;
        const int code = find_taken(t, winners, i, &taken);
        if (code < 0)
            return code;
        while (layer < ORL_OVERLAP_LAYERS && (taken >> layer & 1))
            layer++;
        winners[i].layer = layer;
    }
    for (size_t i = 0; i < n; i++)
        if (winners[i].layer < ORL_OVERLAP_LAYERS) {
            const struct layered one = winners[i];
            winners[i] = winners[laid];
            winners[laid++] = one;
        }
    *ret_laid = laid;
    return 0;
}

/* Replaces the surface's outline by the remaining one. */
static int take_outline(struct orl_cutting *t, struct orl_surface *left)
{
    const size_t bytes = t->overlap.n * sizeof *left->vertices;
    left->n_vertices = t->overlap.n;
    left->has_uv = left->has_normals = false; /* they belonged to the original corners */
    left->vertices = orl_arena_alloc(t->d->outlines, bytes + 1);
    if (!left->vertices)
        return ORL_ERR_NOMEM;
    if (bytes > 0)
        memcpy(left->vertices, t->overlap.vertices, bytes);
    return 0;
}

/* Subtracts the winners that have layers from the loser; *ret_laid is their number. */
static int subtract(struct orl_cutting *t, struct layered *winners, size_t n,
                    struct orl_surface *left, size_t *ret_laid)
{
    const struct orl_outline outline = orl_outline_of(left);
    struct orl_outline *const others = malloc((n + 1) * sizeof *others);
    uint32_t *const layers = malloc((n + 1) * sizeof *layers);
    int code = others && layers ? assign_layers(t, winners, n, ret_laid) : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < *ret_laid; i++) {
        others[i] = winners[i].outline;
        layers[i] = winners[i].layer;
    }
    if (code == 0)
        code = orl_outline_subtract(&t->overlap, &outline, others, layers, *ret_laid, t->tolerance);
    t->cut_short = t->cut_short || t->overlap.work > t->most_work || t->budget.n > t->budget.most;
    if (code == 0)
        code = take_outline(t, left);
    free(others);
    free(layers);
    return code;
}

/* Subtracts all winners, with their original outlines, from the loser. */
static int cut_loser(struct orl_cutting *t, struct orl_pair *losses, size_t n,
                     struct orl_surface *left)
{
    struct layered *const winners = malloc((n + 1) * sizeof *winners);
    int code = winners ? keep_overlapping(t, left, losses, &n) : ORL_ERR_NOMEM;
    for (size_t i = 0; i < n && code == 0; i++) {
        const struct orl_surface *const winner = &t->d->surfaces[losses[i].b];
        winners[i] =
            (struct layered){orl_box_of_flat(winner), orl_outline_of(winner), ORL_OVERLAP_LAYERS};
    }
    for (size_t first = 0; first < n && code == 0 && left->n_vertices > 0 && !t->cut_short;) {
        size_t laid = 0;
        code = subtract(t, winners + first, n - first, left, &laid);
        if (code == ORL_ERR_LIMIT) {
            t->cut_short = true;
            code = 0;
        }
        first += laid;
    }
    free(winners);
    return code;
}

int orl_cutting_run(struct orl_cutting *cutting, struct orl_pairs *losses)
{
    struct orl_cutting *t = cutting;
    struct orl_parsed_scene *d = t->d;
    struct orl_surface *cuts = malloc((losses->n + 1) * sizeof *cuts);
    size_t n_cuts = 0;
    int code = cuts ? 0 : ORL_ERR_NOMEM;
    qsort(losses->items, losses->n, sizeof *losses->items, compare_losses);
    for (size_t first = 0, next; first < losses->n && code == 0; first = next) {
        for (next = first; next < losses->n && losses->items[next].a == losses->items[first].a;)
            next++;
        cuts[n_cuts] = d->surfaces[losses->items[first].a];
        code = cut_loser(t, losses->items + first, next - first, &cuts[n_cuts++]);
        if (orl_is_cancelled(d->cancel))
            code = ORL_ERR_CANCELLED;
    }
    for (size_t first = 0, k = 0; first < losses->n && code == 0; first++)
        if (first == 0 || losses->items[first].a != losses->items[first - 1].a)
            d->surfaces[losses->items[first].a] = cuts[k++];
    free(cuts);
    return code;
}

void orl_cutting_done(struct orl_cutting *cutting)
{
    orl_overlap_done(&cutting->overlap);
    orl_box_tree_done(&cutting->tree);
}
