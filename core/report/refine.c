/* Refines sensors that leave a verdict undecided, by tracing more paths. */
#include <oriel/annual/annual_report.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

#include "metrics/annual/annual_figures.h"

enum { SAMPLES_FACTOR = 4 }; /* factor from one round's paths to the next */

/* Ratio from round to round of squared errors times paths, above which interpolation dominates. It
 * is 1 if paths alone cause the errors, and more than three if interpolation between nodes does. */
static const double interpolation_ratio = 2;
static const double near_share = 0.5, near_part = 0.005, far_off = 3;

struct refinement_run {
    const struct orl_annual_request *request;
    const struct orl_report_request *report_request;
    const struct orl_annual_env *env;
    struct orl_annual_result *result;
    struct orl_annual_refinement *state;
    uint64_t *samples; /* paths of each sensor so far */
    size_t *undecided; /* sensors of the next round */
    size_t n_undecided;
    uint32_t sun_halvings; /* halvings in the next round */
    bool uncertain;        /* true if too many hours have large errors, and more paths help */
    struct orl_error *err;
};

static int no_memory(const struct refinement_run *r)
{
    return orl_error_set(r->err, ORL_ERR_NOMEM, "out of memory");
}

/* ---- Undecided sensors ----------------------------------------------------------------------- */

/* Lists the sensors of the target's grid, or of all grids, that may lie on either side of the
 * bound. */
static int list_undecided(struct refinement_run *r, const struct orl_annual_report *report,
                          size_t grid)
{
    const struct orl_annual_figure *figure = &r->state->target.figure;
    const struct orl_annual_period *period = &report->periods[figure->metric.when];
    const struct orl_annual_rows rows = orl_annual_rows_of(report, r->result, grid);
    const size_t first = grid == ORL_ALL_GRIDS ? 0 : report->grids[grid].first;
    double *scratch = malloc((period->n_columns + 1) * sizeof *scratch);
    int code = 0;
    if (!scratch)
        return no_memory(r);
    r->n_undecided = 0;
    for (size_t i = 0; i < rows.n_sensors && code == 0; i++) {
        const struct orl_annual_light light = orl_annual_light_of(&rows, i);
        if (r->uncertain || figure->aggregate != ORL_AGGREGATE_SHARE ||
            fabs(orl_annual_crossing(&figure->metric, figure->least, period, &light, scratch)) <
                far_off)
            r->undecided[r->n_undecided++] = first + i;
        if (orl_is_cancelled(r->env->run->cancel))
            code = orl_error_set(r->err, ORL_ERR_CANCELLED, "cancelled while refining");
    }
    free(scratch);
    return code;
}

/* Evaluates the target, and lists the sensors that leave it undecided. If too few paths make hours
 * uncertain, all sensors are listed. */
static int evaluate_target(struct refinement_run *r)
{
    struct orl_report_request report_request = *r->report_request;
    struct orl_annual_report report;
    report_request.n_metrics = 0;
    report_request.n_rules = 0;
    report_request.targets = report_request.until;
    report_request.n_targets = 1;
    int code = orl_annual_report_make(r->request, r->result, &report_request, r->env->run->files,
                                      r->env->run->cancel, r->env->run->pool, &report, r->err);
    if (code < 0)
        return code;
    const struct orl_annual_verdict *verdict = &report.verdicts[0];
    const struct orl_annual_figure *figure = &verdict->target.figure;
    const bool percent =
        figure->aggregate == ORL_AGGREGATE_SHARE ||
        (orl_annual_unit(figure->metric.kind)[0] == '%' && figure->metric.kind != ORL_METRIC_DF);
    r->state->target = verdict->target;
    r->state->area = verdict->area;
    r->state->verdict = verdict->verdict;
    r->uncertain = verdict->uncertain && r->state->most_samples < ORL_ANNUAL_SAMPLES;
    r->state->decided =
        !r->uncertain &&
        orl_annual_is_decided(&verdict->target, &verdict->area.value,
                              percent ? near_share : near_part * verdict->target.bound);
    code = list_undecided(r, &report, verdict->grid);
    orl_annual_report_done(&report);
    return code;
}

/* ---- Another round --------------------------------------------------------------------------- */

static float weighted_mean(double a, double wa, double b, double wb)
{
    return (float)((wa * a + wb * b) / (wa + wb));
}

/* Combines errors of two runs. Errors of paths are independent; errors of interpolation (rough) are
 * the same in both. */
static float combine_errors(bool rough, double a, double wa, double b, double wb)
{
    return rough ? weighted_mean(a, wa, b, wb) : (float)(hypot(wa * a, wb * b) / (wa + wb));
}

/* Coherence of the mean of two years. It is the error of the sum over hours with sun, divided by
 * the sum of their errors. */
static float combine_coherence(bool rough, double sum_a, double a, double wa, double sum_b,
                               double b, double wb)
{
    const double whole = (double)combine_errors(rough, sum_a, wa, sum_b, wb);
    return whole > 0 ? (float)((double)combine_errors(rough, sum_a * a, wa, sum_b * b, wb) / whole)
                     : 0;
}

/* Sums relative errors, or their squares, over hours with sun, because the sky is not
 * interpolated. */
static double sum_errors(const struct orl_annual_result *result, size_t sensor, bool squares)
{
    const float *total = orl_annual_row(result, result->total, sensor);
    const float *se = orl_annual_row(result, result->se, sensor);
    double sum = 0;
    for (size_t k = 0; k < result->n_columns; k++)
        if (result->steps[result->step_of_column[k]].direct_normal_lx > 0 && total[k] > 0) {
            const double error = (double)(se[k] / total[k]);
            sum += squares ? error * error : error;
        }
    return sum;
}

/* Returns true if more paths would gain little. Compares the rows so far with those of one more
 * run. */
static bool is_rough(const struct refinement_run *r, const struct orl_annual_result *more,
                     uint32_t samples)
{
    double before = 0, after = 0;
    for (size_t i = 0; i < r->n_undecided; i++) {
        before +=
            sum_errors(r->result, r->undecided[i], true) * (double)r->samples[r->undecided[i]];
        after += sum_errors(more, i, true) * samples;
    }
    return after > interpolation_ratio * before;
}

/* Merges another run's rows into the result, weighted by their numbers of paths. */
static void merge_runs(struct refinement_run *r, const struct orl_annual_result *more,
                       uint32_t samples, bool rough)
{
    const size_t n = r->result->n_columns;
    for (size_t i = 0; i < r->n_undecided; i++) {
        const size_t sensor = r->undecided[i], to = sensor * n, from = i * n;
        const double old = (double)r->samples[sensor], add = samples;
        r->result->overcast[sensor] =
            weighted_mean(r->result->overcast[sensor], old, more->overcast[i], add);
        r->result->overcast_se[sensor] =
            combine_errors(false, r->result->overcast_se[sensor], old, more->overcast_se[i], add);
        r->result->coherence[sensor] = combine_coherence(
            rough, sum_errors(r->result, sensor, false), (double)r->result->coherence[sensor], old,
            sum_errors(more, i, false), (double)more->coherence[i], add);
        for (size_t k = 0; k < n; k++) {
            r->result->total[to + k] =
                weighted_mean(r->result->total[to + k], old, more->total[from + k], add);
            r->result->direct[to + k] =
                weighted_mean(r->result->direct[to + k], old, more->direct[from + k], add);
            r->result->se[to + k] =
                combine_errors(rough, r->result->se[to + k], old, more->se[from + k], add);
        }
        r->samples[r->undecided[i]] += samples;
    }
}

/* Returns a run environment whose progress covers one round: half of the remaining part, if more
 * rounds may follow. */
static struct orl_run_env share_of(const struct refinement_run *r, uint32_t round)
{
    struct orl_run_env run = *r->env->run;
    const double whole = run.part > 0 ? run.part : 1;
    double from = 0, part = r->report_request->until ? 0.5 : 1;
    for (uint32_t i = 0; i < round; i++) {
        from += part;
        part /= 2;
    }
    run.part_from += whole * from;
    run.part = whole * part;
    return run;
}

/* Fixes the shades of later rounds to the states that the first round found, because controls need
 * all sensors. groups: room for all groups; their series belong to the result. */
static void fix_shades(const struct refinement_run *r, struct orl_window_group *groups)
{
    const size_t steps = r->result->n_steps;
    for (size_t g = 0; g < r->request->n_groups; g++) {
        groups[g] = r->request->groups[g];
        groups[g].series = r->result->states + g * steps;
        groups[g].n_series = steps;
        groups[g].n_spans = 0;
        groups[g].control.kind = ORL_SHADES_NO_CONTROL;
    }
}

static int run_again(struct refinement_run *r, uint32_t samples)
{
    struct orl_window_group groups[ORL_SHADES_MOST_GROUPS];
    struct orl_annual_request request = *r->request;
    const struct orl_run_env run = share_of(r, r->state->rounds);
    const struct orl_annual_env env = {.run = &run,
                                       .reuse = r->env->reuse,
                                       .reuse_most = r->env->reuse_most,
                                       .restored = r->env->restored,
                                       .done = r->env->done,
                                       .round = r->state->rounds,
                                       .ctx = r->env->ctx};
    struct orl_annual_result more = {.n_steps = 0};
    request.grids = NULL;
    request.n_grids = 0;
    request.groups = groups;
    fix_shades(r, groups);
    request.samples = samples;
    request.sun_halvings = r->state->sun_halvings = r->sun_halvings;
    request.seed += r->state->rounds;
    request.n_sensors = r->n_undecided;
    request.sensors = malloc((r->n_undecided + 1) * sizeof *request.sensors);
    if (!request.sensors)
        return no_memory(r);
    for (size_t i = 0; i < r->n_undecided; i++)
        request.sensors[i] = r->request->sensors[r->undecided[i]];
    const int code = orl_annual_run(&request, &env, &more, r->err);
    if (code == 0) {
        const bool rough = is_rough(r, &more, samples);
        if (rough && r->sun_halvings < ORL_ANNUAL_MOST_HALVINGS)
            r->sun_halvings++;
        merge_runs(r, &more, samples, rough);
        r->result->total_s += more.total_s;
        for (int s = 0; s < ORL_ANNUAL_STAGES; s++)
            r->result->timings_s[s] += more.timings_s[s];
        for (int k = 0; k < ORL_ANNUAL_CACHE_KINDS; k++)
            orl_annual_cache_stats_add(&r->result->reuse.of[k], &more.reuse.of[k]);
    }
    free(request.sensors);
    orl_annual_done(&more);
    return code;
}

static void count_refined(struct refinement_run *r)
{
    r->state->refined = 0;
    r->state->most_samples = 0;
    for (size_t i = 0; i < r->request->n_sensors; i++) {
        r->state->refined += r->samples[i] > r->result->samples;
        if (r->samples[i] > r->state->most_samples)
            r->state->most_samples = r->samples[i];
    }
}

static int refine_until_decided(struct refinement_run *r,
                                void (*round_done)(void *ctx,
                                                   const struct orl_annual_refinement *so_far),
                                void *ctx)
{
    uint64_t samples = r->result->samples;
    int code = 0;
    for (size_t i = 0; i < r->request->n_sensors; i++)
        r->samples[i] = samples;
    for (;;) {
        r->state->rounds++;
        count_refined(r);
        code = evaluate_target(r);
        if (code < 0)
            return code;
        if (round_done)
            round_done(ctx, r->state);
        samples *= SAMPLES_FACTOR;
        if (r->state->decided || r->n_undecided == 0 || samples > ORL_ANNUAL_MOST_SAMPLES)
            return 0;
        code = run_again(r, (uint32_t)samples);
        if (code < 0)
            return code;
    }
}

int orl_annual_run_until(const struct orl_annual_request *request,
                         const struct orl_report_request *report_request,
                         const struct orl_annual_env *env,
                         void (*round_done)(void *ctx, const struct orl_annual_refinement *so_far),
                         void *ctx, struct orl_annual_result *ret_result,
                         struct orl_annual_refinement *ret_refinement, struct orl_error *err)
{
    struct orl_annual_result result = {.n_steps = 0};
    struct orl_annual_refinement state = {.asked = report_request->until != NULL,
                                          .sun_halvings = request->sun_halvings};
    struct refinement_run r = {.request = request,
                               .report_request = report_request,
                               .env = env,
                               .result = &result,
                               .state = &state,
                               .sun_halvings = request->sun_halvings,
                               .err = err};
    const struct orl_run_env run = share_of(&r, 0);
    struct orl_annual_env first = *env;
    first.run = &run;
    int code = orl_annual_run(request, &first, &result, err);
    if (code == 0 && report_request->until) {
        r.samples = calloc(request->n_sensors + 1, sizeof *r.samples);
        r.undecided = calloc(request->n_sensors + 1, sizeof *r.undecided);
        code = r.samples && r.undecided ? refine_until_decided(&r, round_done, ctx) : no_memory(&r);
    }
    free(r.samples);
    free(r.undecided);
    if (code < 0) {
        orl_annual_done(&result);
        return code;
    }
    *ret_result = result;
    *ret_refinement = state;
    return 0;
}
