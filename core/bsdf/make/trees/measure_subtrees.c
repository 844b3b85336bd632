/* Measures the subtrees of a panel's trees: whether an incident cell is sampled enough, then all
 * subtrees in parallel. */
#include "bsdf/make/trees/measure_subtrees.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf/make/make_bsdf.h"

/* ---- Convergence of one incident cell -------------------------------------------------------- */

/* Result for one component. */
struct convergence {
    double peak;      /* largest cell, 1/sr */
    double max_error; /* largest relative error of a cell whose value is at least `from` */
};

/* Updates the result with a cell; its merge error is the mean variance of the cells merged into
 * it. */
static void update_convergence(struct convergence *convergence, const struct orl_gonio_node *cell,
                               double from)
{
    const double value = (double)cell->value;
    if (cell->branch)
        return;
    convergence->peak = fmax(convergence->peak, value);
    if (value > 0 && value >= from)
        convergence->max_error =
            fmax(convergence->max_error, sqrt((double)cell->merge_error) / value);
}

/* Merges four cells of a level to one of the next coarser level, or adds them to the result. */
static void merge_four(struct orl_gonio_cells four, unsigned level,
                       const struct orl_gonio_cull *cull, double from,
                       struct convergence *convergence, struct orl_gonio_cells ret_mean)
{
    enum { BRANCHING = 4 };
    const struct orl_gonio_node *children = four.nodes;
    struct orl_gonio_node plain[BRANCHING], mean;
    struct orl_gonio_color node_color;
    double variance = 0;
    for (int i = 0; i < BRANCHING; i++) {
        plain[i] = children[i];
        if (!children[i].branch)
            plain[i].merge_error = 0;
        variance += orl_gonio_node_variance(&children[i]) / BRANCHING;
    }
    const bool one =
        orl_gonio_try_merge(cull, (struct orl_gonio_cells){plain, four.colors}, BRANCHING, level,
                            (struct orl_gonio_cells){&mean, four.colors ? &node_color : NULL});
    for (int i = 0; i < BRANCHING && (!one || (double)mean.value < from); i++)
        /* Children of a dark merged cell count as well: they may be cells of a tree. */
        update_convergence(convergence, &children[i], from);
    if (one)
        mean.merge_error = (float)variance;
    mean.branch = !one;
    orl_gonio_cells_copy(ret_mean, (struct orl_gonio_cells){&mean, &node_color}, 1);
}

/*
 * Decides if light from one incident cell has been sampled enough. The 4^levels cells out are
 * numbered as in the probe. They are merged as in a tree (tree_builder.h) if the data do not
 * distinguish them, and the rest is examined. The error that counts is that of the merged cells.
 * Paths are thus sent until the next subdivision would have shown any differences. The cells are
 * overwritten.
 */
static struct convergence test_convergence(struct orl_gonio_cells cells, unsigned levels,
                                           const struct orl_gonio_cull *cull, double from)
{
    struct convergence convergence = {0, 0};
    const size_t n = (size_t)1 << 2 * levels;
    for (size_t i = 0; i < n; i++)
        cells.nodes[i].merge_error = (float)(orl_gonio_node_variance(&cells.nodes[i]));
    for (unsigned level = levels; level > 0; level--)
        for (size_t i = 0; i < (size_t)1 << 2 * (level - 1); i++)
            merge_four(orl_gonio_cells_at(cells, 4 * i), level, cull, from, &convergence,
                       orl_gonio_cells_at(cells, i));
    update_convergence(&convergence, cells.nodes, from);
    return convergence;
}

/* ---- Limits ---------------------------------------------------------------------------------- */

enum { CHUNK = 16 }; /* subtrees between two progress reports */
/* Paths into each incident cell, in each batch, for the survey of brightness. */
enum { SURVEY_PATHS = 4 };
/* Limit on branches of all trees together; a third in colour, which has three trees. They take 0.4
 * gigabytes, and twice that while they are merged. */
enum { MOST_BRANCHES = 1 << 20 };

/* Share of the peak from which values must reach the accuracy. Reported errors begin a little
 * higher (panel_trees.c), because a few paths overestimate the peak. */
static const double sampled_from = 0.007;

static int most_branches(const struct orl_gonio_trees *t)
{
    return t->request->color ? MOST_BRANCHES / 3 : MOST_BRANCHES;
}

int orl_gonio_trees_fail(const struct orl_gonio_trees *t, int code, struct orl_error *err)
{
    if (code == ORL_ERR_LIMIT) {
        orl_error_set(err, code, "the panel's trees have more than %d branches", most_branches(t));
        orl_error_hint(err, "Ask for a lower resolution, a larger cull, or more paths, so that "
                            "noise does not keep cells from being merged");
        return code;
    }
    return orl_error_set(
        err, code, code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory for the panel's BSDF");
}

size_t orl_gonio_original_of(const struct orl_gonio_trees *t, size_t subtree, unsigned *ret_mirror)
{
    size_t a = subtree;
    *ret_mirror = 0;
    if (t->of.rank == 3 || t->of.split == 0)
        return subtree;
    for (unsigned axis = 0; axis < 2; axis++) { /* highest bit of x, then of y */
        if (!(t->request->symmetry >> axis & 1) || !(a >> (2 * (t->of.split - 1) + axis) & 1))
            continue;
        a = orl_gonio_mirrored_cell((uint32_t)a, t->of.split, 1U << axis);
        *ret_mirror |= 5U << axis; /* mirrors A and B */
    }
    return a;
}

/* ---- Subtrees -------------------------------------------------------------------------------- */

/* State of one thread's measurement. */
struct work {
    const struct orl_gonio_trees *t;
    struct orl_gonio_subtree *subtree;
    struct orl_gonio_probe probe;
    struct orl_gonio_cells cells; /* scratch for one incident cell; with an accuracy */
    size_t side;
};

static struct convergence test_component(const struct work *w, bool transmitted, double from)
{
    const size_t cells = orl_gonio_probe_cells(&w->probe);
    return test_convergence(orl_gonio_cells_at(w->cells, transmitted * cells), w->t->of.levels,
                            &w->t->cull, from);
}

/* Returns true if the cell's values will reach the accuracy with twice as many paths. */
static bool has_converged(const struct work *w, struct orl_gonio_cells cells)
{
    const double accuracy = sqrt(2) * w->t->request->accuracy;
    bool converged = true;
    orl_gonio_cells_copy(w->cells, cells, 2 * orl_gonio_probe_cells(&w->probe));
    for (int k = 0; k < 2 && converged; k++)
        converged = test_component(w, k, w->t->from[w->side][k]).max_error <= accuracy;
    return converged;
}

/* Doubles the paths until a second set of as many paths will reach the accuracy. Returns the paths
 * in each batch; 0 if cancelled. */
static uint32_t decide_paths(struct work *w, uint32_t a, struct orl_gonio_cells cells)
{
    const struct orl_gonio_trees *t = w->t;
    uint32_t sent = 0, paths = t->paths;
    for (;;) {
        orl_gonio_probe_trace(&w->probe, a, sent, paths);
        if (orl_is_cancelled(t->measurement->env->cancel))
            return 0;
        orl_gonio_probe_estimate(&w->probe, paths, cells);
        const bool converged = has_converged(w, cells);
        if (converged || 4ULL * paths > t->paths_most) {
            w->subtree->not_converged = w->subtree->not_converged || !converged;
            return paths;
        }
        sent = paths;
        paths *= 2;
    }
}

/* Measures one finest cell; returns false if cancelled. */
static bool measure_cell(void *ctx, uint32_t a, struct orl_gonio_cells ret_cells)
{
    struct work *w = ctx;
    const struct orl_gonio_trees *t = w->t;
    uint32_t paths = t->paths, sets = 1;
    if (t->sample->file) {
        orl_gonio_resample_cell(&w->probe, t->sample->file, a, ret_cells);
        return !orl_is_cancelled(t->measurement->env->cancel);
    }
    if (t->request->accuracy > 0) {
        paths = decide_paths(w, a, ret_cells);
        orl_gonio_probe_end_pilot(&w->probe, paths);
        sets = 2;
    }
    orl_gonio_probe_trace(&w->probe, a, 0, paths);
    if (orl_is_cancelled(t->measurement->env->cancel))
        return false;
    orl_gonio_probe_estimate(&w->probe, paths, ret_cells);
    orl_gonio_probe_finish_cell(&w->probe, paths);
    w->subtree->paths += (uint64_t)paths * sets * ORL_GONIO_BATCHES;
    return true;
}

static int work_init(const struct orl_gonio_trees *t, size_t place, struct work *w)
{
    *w = (struct work){.t = t, .subtree = &t->subtrees[place], .side = place / t->of.n_subtrees};
    w->probe = (struct orl_gonio_probe){.measurement = t->measurement,
                                        .rank = t->of.rank,
                                        .levels = t->of.levels,
                                        .color = t->request->color,
                                        .front = w->side == 1};
    return orl_gonio_cells_make(&w->cells, 2 * orl_gonio_probe_cells(&w->probe), w->probe.color)
               ? orl_gonio_probe_init(&w->probe, NULL)
               : ORL_ERR_NOMEM;
}

static void work_done(struct work *w)
{
    orl_gonio_probe_done(&w->probe);
    orl_gonio_cells_done(&w->cells);
}

/* Surveys the brightness of cells out by a few paths into every incident cell of a subtree. */
static void survey_subtree(void *arg, size_t index, uint32_t member)
{
    const struct orl_gonio_trees *t = arg;
    const size_t place = t->todo[t->first + index];
    const unsigned below = (t->of.rank == 4 ? 2 : 1) * (t->of.levels - t->of.split);
    const uint32_t first = (uint32_t)(place % t->of.n_subtrees) << below;
    struct work w;
    (void)member;
    w.subtree = &t->subtrees[place];
    w.subtree->code = work_init(t, place, &w);
    for (uint32_t a = first; w.subtree->code == 0 && a < first + (1U << below); a++) {
        orl_gonio_probe_trace(&w.probe, a, 0, SURVEY_PATHS);
        orl_gonio_probe_estimate(&w.probe, SURVEY_PATHS, w.cells);
        orl_gonio_probe_clear(&w.probe);
        for (int k = 0; k < 2; k++)
            w.subtree->peaks[k] = fmax(w.subtree->peaks[k], test_component(&w, k, 0).peak);
    }
    work_done(&w);
}

static void measure_subtree(void *arg, size_t index, uint32_t member)
{
    const struct orl_gonio_trees *t = arg;
    const size_t place = t->todo[t->first + index];
    struct orl_gonio_subtree *subtree = &t->subtrees[place];
    struct work w;
    const struct orl_gonio_merger merger = {&subtree->builder, t->of.levels, 2, measure_cell, &w};
    (void)member;
    subtree->builder = orl_gonio_empty_builder(t);
    subtree->code = work_init(t, place, &w);
    if (subtree->code == 0 &&
        (!orl_gonio_cells_make(&subtree->top_nodes, orl_gonio_nodes_at(t->of.split),
                               w.probe.color) ||
         !orl_gonio_merge_nodes(&merger, t->of.split, (uint32_t)(place % t->of.n_subtrees),
                                subtree->top_nodes)))
        subtree->code = ORL_ERR_NOMEM;
    memcpy(subtree->totals, w.probe.totals, sizeof subtree->totals);
    subtree->lost = w.probe.lost;
    work_done(&w);
}

/* One pass over the subtrees: the survey or the measurement. */
struct pass {
    struct orl_gonio_trees *t;
    const struct orl_bsdf_make_env *env;
    const char *name;
    orl_loop_body body;
    uint32_t paths;              /* paths into a cell in each batch, to begin with */
    double share_from, share_to; /* range of the total progress */
};

/* Processes some of the subtrees. */
static int run_subtrees(const struct pass *pass, size_t first, size_t count)
{
    struct orl_gonio_trees *t = pass->t;
    t->first = first;
    const int code = orl_parallel_try(pass->env->pool, count, pass->body, t);
    if (code < 0 || orl_is_cancelled(pass->env->cancel))
        return ORL_ERR_CANCELLED;
    for (size_t i = first; i < first + count; i++)
        if (t->subtrees[t->todo[i]].code < 0)
            return t->subtrees[t->todo[i]].code;
    return 0;
}

static int check_branches(const struct orl_gonio_trees *t)
{
    size_t branches = 0;
    for (size_t i = 0; i < t->n_todo; i++)
        branches += t->subtrees[t->todo[i]].builder.count;
    return branches > (size_t)most_branches(t) ? ORL_ERR_LIMIT : 0;
}

/* Processes all subtrees, CHUNK at a time, and reports progress. */
static int run_all_subtrees(const struct pass *pass)
{
    struct orl_gonio_trees *t = pass->t;
    const struct orl_bsdf_make_env *env = pass->env;
    const double share_from = pass->share_from, share_to = pass->share_to;
    if (env->progress)
        env->progress(env->ctx, 1, share_from);
    for (size_t first = 0, count; first < t->n_todo; first += count) {
        count = t->n_todo - first < CHUNK ? t->n_todo - first : CHUNK;
        int code = run_subtrees(pass, first, count);
        if (code == 0)
            code = check_branches(t);
        if (code < 0)
            return code;
        if (env->progress)
            env->progress(env->ctx, 1,
                          share_from + (share_to - share_from) * (double)(first + count) /
                                           (double)t->n_todo);
    }
    return 0;
}

/* ---- Distributed subtrees -------------------------------------------------------------------- */

static double task_core_s(void *ctx, size_t task)
{
    const struct pass *pass = ctx;
    const struct orl_gonio_trees *t = pass->t;
    const double cells = ldexp(1, (int)((t->of.rank == 4 ? 2 : 1) * (t->of.levels - t->of.split)));
    const int sets = t->request->accuracy > 0 ? 2 : 1;
    return ORL_GONIO_PATH_S * ORL_GONIO_BATCHES * sets *
           (double)orl_gonio_task_size(t->n_todo, task) * cells * pass->paths;
}

static int compute_task(void *ctx, size_t task, void **ret_data, size_t *ret_size,
                        struct orl_error *err)
{
    const struct pass *pass = ctx;
    const struct orl_gonio_trees *t = pass->t;
    const size_t n = orl_gonio_task_size(t->n_todo, task), first = task * ORL_GONIO_TASK_ITEMS,
                 top_nodes = orl_gonio_nodes_at(t->of.split);
    const int code = run_subtrees(pass, first, n);
    if (code < 0)
        return orl_gonio_trees_fail(t, code, err);
    *ret_size = 0;
    for (size_t i = first; i < first + n; i++)
        *ret_size += orl_gonio_subtree_bytes(&t->subtrees[t->todo[i]], top_nodes);
    char *to = malloc(*ret_size + 1);
    *ret_data = to;
    for (size_t i = first; i < first + n && to; i++)
        to = orl_gonio_subtree_pack(&t->subtrees[t->todo[i]], top_nodes, to);
    return to ? 0 : orl_gonio_trees_fail(t, ORL_ERR_NOMEM, err);
}

static int read_task(void *ctx, size_t task, const void *data, size_t size, bool *ret_valid,
                     struct orl_error *err)
{
    const struct orl_gonio_trees *t = ((const struct pass *)ctx)->t;
    const char *from = data, *end = from + size;
    (void)err;
    for (size_t i = task * ORL_GONIO_TASK_ITEMS;
         i < task * ORL_GONIO_TASK_ITEMS + orl_gonio_task_size(t->n_todo, task) && from; i++) {
        struct orl_gonio_subtree *subtree = &t->subtrees[t->todo[i]];
        subtree->builder = orl_gonio_empty_builder(t);
        from = orl_gonio_subtree_unpack(subtree, orl_gonio_nodes_at(t->of.split), from,
                                        (size_t)(end - from));
    }
    *ret_valid = from == end;
    return 0;
}

static void report_share(void *ctx, double share)
{
    const struct pass *pass = ctx;
    if (pass->env->progress)
        pass->env->progress(pass->env->ctx, 1,
                            pass->share_from + share * (pass->share_to - pass->share_from));
}

/* Runs a pass here, or distributed over processes; sets err. */
static int run_pass(struct pass *pass, struct orl_error *err)
{
    const struct orl_gonio_trees *t = pass->t;
    const struct orl_bsdf_distributor *shared = pass->env->shared;
    const struct orl_bsdf_tasks tasks = {.name = pass->name,
                                         .n = (t->n_todo + ORL_GONIO_TASK_ITEMS - 1) /
                                              ORL_GONIO_TASK_ITEMS,
                                         .ctx = pass,
                                         .core_s = task_core_s,
                                         .make = compute_task,
                                         .take = read_task,
                                         .told = report_share};
    int code;
    if (shared && !t->sample->file) {
        code = shared->run(shared->ctx, &tasks, err);
        return code < 0 || check_branches(t) == 0 ? code
                                                  : orl_gonio_trees_fail(t, ORL_ERR_LIMIT, err);
    }
    code = run_all_subtrees(pass);
    return code < 0 ? orl_gonio_trees_fail(t, code, err) : 0;
}

int orl_gonio_measure_subtrees(struct orl_gonio_trees *t, struct orl_error *err)
{
    const struct orl_bsdf_make_env *env = t->measurement->env;
    const double part = 0.05; /* approximate share of the survey in the total time */
    struct pass all = {t, env, "blocks", measure_subtree, t->paths, 0, 1};
    struct pass survey = {t, env, "survey", survey_subtree, SURVEY_PATHS, 0, part};
    if (!(t->request->accuracy > 0))
        return run_pass(&all, err);
    const int code = run_pass(&survey, err);
    all.share_from = part;
    for (size_t i = 0; i < t->n_todo; i++)
        for (int k = 0; k < 2; k++) {
            double *from = &t->from[t->todo[i] / t->of.n_subtrees][k];
            *from = fmax(*from, sampled_from * t->subtrees[t->todo[i]].peaks[k]);
        }
    return code < 0 ? code : run_pass(&all, err);
}
