/* Figures of grids, and verdicts on targets. */
#include "report/report_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/thread_pool.h>

#include "base/statistics/numeric.h"

struct orl_annual_rows orl_annual_rows_of(const struct orl_annual_report *report,
                                          const struct orl_annual_result *result, size_t grid)
{
    const struct orl_annual_grid *one = grid == ORL_ALL_GRIDS ? NULL : &report->grids[grid];
    const size_t first = one ? one->first : 0, at = first * result->n_columns;
    const float *se = result->se ? result->se + at : NULL;
    return (struct orl_annual_rows){
        .total_lx = result->total + at,
        .direct_lx = result->direct ? result->direct + at : NULL,
        .total_error_lx = se,
        .direct_error_lx = se,
        .overcast_lx = result->overcast ? result->overcast + first : NULL,
        .overcast_error_lx = result->overcast_se ? result->overcast_se + first : NULL,
        .coherence = result->coherence ? result->coherence + first : NULL,
        .sunny = report->year.sunny,
        .n_sensors = one ? one->count : report->n_sensors,
        .n_columns = result->n_columns,
        .area = report->area + first};
}

int orl_report_figure_of(const struct orl_report_builder *m, const struct orl_annual_figure *figure,
                         size_t grid, struct orl_annual_area *ret_area)
{
    struct orl_annual_rows rows = orl_annual_rows_of(m->report, m->result, grid);
    rows.cancel = m->cancel;
    rows.pool = m->pool;
    return orl_annual_figure_of(figure, m->report->periods, &rows, ret_area, m->err);
}

/* ---- Reasons for undecided verdicts ---------------------------------------------------------- */

/* IES LM-83-12, 2.2.6: blinds close in hours in which more than this share of the points has at
 * least this much direct sunlight. */
static const double lm83_lx = 1000, lm83_percent = 2;

struct verdict_context {
    const struct orl_report_builder *m;
    bool *needs_blinds; /* by grid: true if LM-83 closes blinds in some hour of use; or NULL */
};

/* Returns the hours of the weather on which a metric depends; ORL_WHEN_COUNT: none. A daylight
 * factor that must reach an illuminance depends on the median over the daylight hours. */
static enum orl_annual_when hours_of(const struct orl_report_builder *m,
                                     const struct orl_annual_metric *metric)
{
    if (metric->kind != ORL_METRIC_DF)
        return metric->when;
    return metric->low_lx > 0 && !(m->report_request->median_diffuse_lx > 0) ? ORL_WHEN_DAYLIGHT
                                                                             : ORL_WHEN_COUNT;
}

static void note_few_hours(const struct orl_report_builder *m, struct orl_annual_verdict *verdict)
{
    static const char *const kinds[ORL_WHEN_COUNT] = {"occupied hours", "daylight hours",
                                                      "hours of the year"};
    const enum orl_annual_when when = hours_of(m, &verdict->target.figure.metric);
    if (when == ORL_WHEN_COUNT || orl_report_has_hours(m->report, when))
        return;
    const double hours = m->report->periods[when].hours, wanted = m->report->hours_wanted[when];
    verdict->verdict = ORL_VERDICT_UNDECIDED;
    snprintf(verdict->note, sizeof verdict->note, "the weather file has %.6g of %.6g %s", hours,
             wanted, kinds[when]);
}

/*
 * Above this share of uncertain hours, intervals are unreliable: batches of few paths miss rare
 * bright ones, and underestimate their errors. A verdict is then decided only if the bound is
 * further from the value than clear_sides times the interval's longer side. Measured in a room with
 * 35 % of such hours, with 64 paths and four seeds: shares of the area were up to 6 % low.
 * Intervals reached 3 % above them; their longer sides were 4 to 5 %.
 */
static const double most_uncertain_percent = 10, clear_sides = 3;

/* Returns the percentage of a period's hours at a grid's sensors that are uncertain. */
static double uncertain_percent(const struct orl_annual_rows *rows,
                                const struct orl_annual_period *period)
{
    size_t n = 0;
    for (size_t i = 0; i < rows->n_sensors; i++)
        for (size_t c = 0; c < period->n_columns; c++) {
            const size_t at = i * rows->n_columns + period->columns[c];
            n += orl_report_is_uncertain((double)rows->total_lx[at],
                                         (double)rows->total_error_lx[at]);
        }
    return orl_percent((double)n, (double)rows->n_sensors * (double)period->n_columns);
}

/* Marks a verdict as undecided if too many hours are uncertain. Direct sunlight at sensors has no
 * error of paths, and DF has its own interval. */
static void note_uncertain_hours(const struct orl_report_builder *m,
                                 struct orl_annual_verdict *verdict)
{
    const struct orl_annual_rows rows = orl_annual_rows_of(m->report, m->result, verdict->grid);
    const struct orl_annual_metric *metric = &verdict->target.figure.metric;
    if (metric->kind == ORL_METRIC_DF || metric->kind == ORL_METRIC_DIRECT_HOURS ||
        !rows.total_error_lx || verdict->verdict == ORL_VERDICT_UNDECIDED)
        return;
    const struct orl_annual_value *value = &verdict->area.value;
    const double side = fmax(value->value - value->low, value->high - value->value);
    if (fabs(verdict->target.bound - value->value) > clear_sides * side)
        return;
    const double percent = uncertain_percent(&rows, &m->report->periods[metric->when]);
    if (!(percent > most_uncertain_percent))
        return;
    verdict->verdict = ORL_VERDICT_UNDECIDED;
    verdict->uncertain = true;
    snprintf(verdict->note, sizeof verdict->note,
             "%.0f %% of the hours have standard errors above %g %%: use more \"samples\"", percent,
             100 * ORL_UNCERTAIN_SHARE);
}

/* Returns true if some group closes at LM-83's thresholds, or at lower ones. */
static bool closes_by_lm83(const struct orl_annual_request *request)
{
    for (size_t i = 0; i < request->n_groups; i++) {
        const struct orl_shade_control *control = &request->groups[i].control;
        if (control->kind == ORL_SHADES_BY_SUN && control->above_lx <= lm83_lx &&
            control->share_percent <= lm83_percent)
            return true;
    }
    return false;
}

/* Sets *ret_sunny if LM-83 closes blinds in some hour of use; otherwise leaves it unchanged.
 * sunlit: scratch, one number per column. */
static int check_sun(const struct orl_report_builder *m, size_t grid, uint32_t *sunlit,
                     bool *ret_sunny)
{
    const struct orl_annual_rows rows = orl_annual_rows_of(m->report, m->result, grid);
    const struct orl_annual_period *period = &m->report->periods[ORL_WHEN_OCCUPIED];
    memset(sunlit, 0, period->n_columns * sizeof *sunlit);
    for (size_t i = 0; rows.direct_lx && i < rows.n_sensors; i++) {
        const float *row = rows.direct_lx + i * rows.n_columns;
        for (size_t c = 0; c < period->n_columns; c++)
            sunlit[c] += (double)row[period->columns[c]] >= lm83_lx;
        if (orl_is_cancelled(m->cancel))
            return orl_error_set(m->err, ORL_ERR_CANCELLED, "cancelled while making the report");
    }
    for (size_t c = 0; c < period->n_columns; c++)
        if (100.0 * sunlit[c] > lm83_percent * (double)rows.n_sensors)
            *ret_sunny = true;
    return 0;
}

/* Fills judging->needs_blinds if some rule requires blinds that the job lacks. */
static int find_need_of_blinds(struct verdict_context *verdict_context)
{
    const struct orl_report_builder *m = verdict_context->m;
    const size_t n_grids = m->report->n_grids;
    bool asked = false;
    int code = 0;
    for (size_t i = 0; i < m->report_request->n_rules; i++)
        asked = asked || m->report_request->rules[i].needs_blinds;
    if (!asked || closes_by_lm83(m->request))
        return 0;
    uint32_t *sunlit =
        malloc((m->report->periods[ORL_WHEN_OCCUPIED].n_columns + 1) * sizeof *sunlit);
    verdict_context->needs_blinds = calloc(n_grids + 1, sizeof *verdict_context->needs_blinds);
    if (!sunlit || !verdict_context->needs_blinds)
        code = orl_error_set(m->err, ORL_ERR_NOMEM, "out of memory");
    for (size_t g = 0; g < n_grids && code == 0; g++)
        code = check_sun(m, g, sunlit, &verdict_context->needs_blinds[g]);
    free(sunlit);
    return code;
}

/* LM-83 closes blinds by grid: all grids together need blinds if one of them does. */
static bool grid_needs_blinds(const struct verdict_context *verdict_context, size_t grid)
{
    if (grid != ORL_ALL_GRIDS)
        return verdict_context->needs_blinds[grid];
    bool needed = false;
    for (size_t g = 0; g < verdict_context->m->report->n_grids; g++)
        needed = needed || verdict_context->needs_blinds[g];
    return needed;
}

static void note_blinds(const struct verdict_context *verdict_context,
                        struct orl_annual_verdict *verdict)
{
    if (!verdict_context->needs_blinds || !verdict->rule || !verdict->rule->needs_blinds ||
        verdict->verdict != ORL_VERDICT_PASS || !grid_needs_blinds(verdict_context, verdict->grid))
        return;
    verdict->verdict = ORL_VERDICT_UNDECIDED;
    snprintf(verdict->note, sizeof verdict->note, "not according to LM-83: %s",
             verdict_context->m->request->n_groups == 0 ? "no blinds modelled"
                                                        : "no blinds close by its rule");
}

/* ---- Verdicts -------------------------------------------------------------------------------- */

static int evaluate_on_grid(const struct verdict_context *verdict_context,
                            const struct orl_annual_rule *rule,
                            const struct orl_annual_target *target, size_t grid)
{
    const struct orl_report_builder *m = verdict_context->m;
    struct orl_annual_verdict *verdict = &m->report->verdicts[m->report->n_verdicts];
    *verdict = (struct orl_annual_verdict){.rule = rule, .target = *target, .grid = grid};
    struct orl_annual_figure *figure = &verdict->target.figure;
    if (figure->metric.kind == ORL_METRIC_DF && figure->metric.low_lx > 0)
        figure->least = 100 * figure->metric.low_lx / m->report->median_diffuse_lx;
    const int code = orl_report_figure_of(m, figure, grid, &verdict->area);
    if (code < 0)
        return code;
    verdict->verdict = orl_annual_judge(target, &verdict->area.value);
    note_uncertain_hours(m, verdict);
    note_blinds(verdict_context, verdict);
    note_few_hours(m, verdict);
    m->report->n_verdicts++;
    return 0;
}

/* Returns the grid's index; ORL_ALL_GRIDS if no grid has that name. */
static size_t find_grid(const struct orl_annual_report *report, const char *name)
{
    for (size_t g = 0; g < report->n_grids; g++)
        if (strcasecmp(report->grids[g].name, name) == 0)
            return g;
    return ORL_ALL_GRIDS;
}

static int check_grid(const struct orl_report_builder *m, const struct orl_annual_target *target)
{
    if (!target->grid[0] || find_grid(m->report, target->grid) != ORL_ALL_GRIDS)
        return 0;
    return orl_error_set(m->err, ORL_ERR_INVALID, "'%s': there is no grid named '%s'", target->text,
                         target->grid);
}

int orl_report_check_grids(const struct orl_report_builder *m)
{
    int code = m->report_request->until ? check_grid(m, m->report_request->until) : 0;
    for (size_t i = 0; i < m->report_request->n_targets && code == 0; i++)
        code = check_grid(m, &m->report_request->targets[i]);
    return code;
}

/* Evaluates a target on the grid it names. Without a name, evaluates all grids together and each
 * grid. */
static int evaluate_on_all_grids(const struct verdict_context *verdict_context,
                                 const struct orl_annual_rule *rule,
                                 const struct orl_annual_target *target)
{
    const struct orl_annual_report *report = verdict_context->m->report;
    if (target->grid[0])
        return evaluate_on_grid(verdict_context, rule, target, find_grid(report, target->grid));
    int code =
        evaluate_on_grid(verdict_context, rule, target, report->n_grids > 1 ? ORL_ALL_GRIDS : 0);
    for (size_t g = 0; g < report->n_grids && report->n_grids > 1 && code == 0; g++)
        code = evaluate_on_grid(verdict_context, rule, target, g);
    return code;
}

static int evaluate_rule(const struct verdict_context *verdict_context,
                         const struct orl_annual_rule *rule)
{
    int code = 0;
    for (int i = 0; i < ORL_RULE_TARGETS && rule->targets[i] && code == 0; i++) {
        struct orl_annual_target target;
        code = orl_annual_target_parse(rule->targets[i], &target, verdict_context->m->err);
        if (code == 0)
            code = evaluate_on_all_grids(verdict_context, rule, &target);
    }
    return code;
}

int orl_report_make_verdicts(const struct orl_report_builder *m)
{
    const struct orl_report_request *report_request = m->report_request;
    const size_t targets = report_request->n_targets + ORL_RULE_TARGETS * report_request->n_rules;
    struct verdict_context verdict_context = {.m = m};
    m->report->verdicts =
        calloc(targets * (m->report->n_grids + 1) + 1, sizeof *m->report->verdicts);
    if (!m->report->verdicts)
        return orl_error_set(m->err, ORL_ERR_NOMEM, "out of memory");
    int code = find_need_of_blinds(&verdict_context);
    for (size_t i = 0; i < report_request->n_targets && code == 0; i++)
        code = evaluate_on_all_grids(&verdict_context, NULL, &report_request->targets[i]);
    for (size_t i = 0; i < report_request->n_rules && code == 0; i++)
        code = evaluate_rule(&verdict_context, &report_request->rules[i]);
    free(verdict_context.needs_blinds);
    return code;
}
