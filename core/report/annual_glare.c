/* Annual glare metrics: rates viewpoints by their hours in use. */
#include "report/report_internal.h"

#include <oriel/annual/annual_report.h>

#include <stdlib.h>
#include <string.h>

#include "base/statistics/numeric.h"

const double orl_glare_bounds[ORL_GLARE_BOUNDS] = {0.35, 0.40, 0.45};
static const double most_percent = 5;

const char *orl_glare_protection_name(enum orl_glare_protection level)
{
    static const char *const names[] = {"none", "minimum", "medium", "high"};
    return names[level];
}

/* Context of rating a viewpoint; dark hours count as without glare. */
struct seat_rating {
    const struct orl_annual_result *result;
    const struct orl_viewpoint_hours *hours;
    size_t n_used;  /* steps in use, including dark ones */
    double *values; /* scratch, one value per column */
};

static bool is_in_use(const struct seat_rating *t, size_t column)
{
    return !isnan(t->hours->dgp[column]);
}

/* ---- Shares ---------------------------------------------------------------------------------- */

static double share_above(const struct seat_rating *t, const float *dgp, double bound)
{
    size_t n = 0;
    for (size_t c = 0; c < t->result->n_columns; c++)
        n += is_in_use(t, c) && (double)dgp[c] > bound;
    return orl_percent((double)n, (double)t->n_used);
}

/* Returns the DGP that most_percent of the steps in use exceed at most. */
static double exceeded_dgp(const struct seat_rating *t, const float *dgp)
{
    const size_t which = (size_t)floor(most_percent / 100 * (double)t->n_used);
    size_t n = 0;
    for (size_t c = 0; c < t->result->n_columns; c++)
        if (is_in_use(t, c))
            t->values[n++] = (double)dgp[c];
    return which < n ? orl_nth_element(t->values, n, n - 1 - which) : 0;
}

/* Returns the level from the percentages of time above each bound. */
static enum orl_glare_protection level_of(double above_35, double above_40, double above_45)
{
    static const double slack = 1e-9;
    return above_35 <= most_percent + slack   ? ORL_PROTECTED_HIGH
           : above_40 <= most_percent + slack ? ORL_PROTECTED_MEDIUM
           : above_45 <= most_percent + slack ? ORL_PROTECTED_MINIMUM
                                              : ORL_PROTECTED_NONE;
}

/* ---- Worst hours ----------------------------------------------------------------------------- */

static bool is_same_day(const struct orl_annual_result *result, size_t a, size_t b)
{
    return result->steps[a].month == result->steps[b].month &&
           result->steps[a].day == result->steps[b].day;
}

/* DGP is clamped to 1, for instance if the sun's disc is in view; then the illuminance at the eye
 * decides. */
static bool is_worse(const struct orl_viewpoint_hour *a, const struct orl_viewpoint_hour *b)
{
    if (a->dgp.value != b->dgp.value)
        return a->dgp.value > b->dgp.value;
    return a->eye_lx > b->eye_lx;
}

/* Enters an hour into the list of worst hours: one per day, ORL_GLARE_WORST days. */
static void enter_worst_hour(const struct seat_rating *t, size_t column,
                             struct orl_viewpoint_glare *glare)
{
    const struct orl_viewpoint_hours *h = t->hours;
    const struct orl_viewpoint_hour hour = {
        t->result->step_of_column[column],
        {(double)h->dgp[column], (double)h->low[column], (double)h->high[column]},
        (double)h->eye_lx[column]};
    size_t at = glare->n_worst;
    for (size_t i = 0; i < glare->n_worst; i++)
        if (is_same_day(t->result, glare->worst[i].step, hour.step)) {
            if (!is_worse(&hour, &glare->worst[i]))
                return;
            memmove(&glare->worst[i], &glare->worst[i + 1],
                    (--glare->n_worst - i) * sizeof *glare->worst);
            at = glare->n_worst;
            break;
        }
    while (at > 0 && is_worse(&hour, &glare->worst[at - 1]))
        at--;
    if (at == ORL_GLARE_WORST)
        return;
    const size_t room = ORL_GLARE_WORST - 1;
    const size_t moved = (glare->n_worst < room ? glare->n_worst : room) - at;
    memmove(&glare->worst[at + 1], &glare->worst[at], moved * sizeof *glare->worst);
    glare->worst[at] = hour;
    glare->n_worst += glare->n_worst < ORL_GLARE_WORST;
}

/* ---- Viewpoints ------------------------------------------------------------------------------ */

static void rate_viewpoint(const struct seat_rating *t, struct orl_viewpoint_glare *ret)
{
    const struct orl_viewpoint_hours *h = t->hours;
    *ret = (struct orl_viewpoint_glare){.n_worst = 0};
    for (int i = 0; i < ORL_GLARE_BOUNDS; i++)
        ret->above[i] = (struct orl_annual_value){share_above(t, h->dgp, orl_glare_bounds[i]),
                                                  share_above(t, h->low, orl_glare_bounds[i]),
                                                  share_above(t, h->high, orl_glare_bounds[i])};
    ret->exceeded = (struct orl_annual_value){exceeded_dgp(t, h->dgp), exceeded_dgp(t, h->low),
                                              exceeded_dgp(t, h->high)};
    const struct orl_annual_value *a = ret->above;
    ret->level = level_of(a[0].value, a[1].value, a[2].value);
    ret->lowest = level_of(a[0].high, a[1].high, a[2].high);
    ret->highest = level_of(a[0].low, a[1].low, a[2].low);
    for (size_t c = 0; c < t->result->n_columns; c++)
        if (is_in_use(t, c))
            enter_worst_hour(t, c, ret);
}

/* Returns the percentage of viewpoints whose DGP exceeds 0.40 in at most 5 % of their use. */
static struct orl_annual_value autonomy_of(const struct orl_viewpoint_glare *viewpoints, size_t n)
{
    struct orl_annual_value sum = {0, 0, 0};
    for (size_t i = 0; i < n; i++) {
        sum.value += viewpoints[i].level >= ORL_PROTECTED_MEDIUM;
        sum.low += viewpoints[i].lowest >= ORL_PROTECTED_MEDIUM;
        sum.high += viewpoints[i].highest >= ORL_PROTECTED_MEDIUM;
    }
    return (struct orl_annual_value){orl_percent(sum.value, (double)n),
                                     orl_percent(sum.low, (double)n),
                                     orl_percent(sum.high, (double)n)};
}

int orl_report_viewpoints(const struct orl_annual_result *result, struct orl_annual_report *report,
                          struct orl_error *err)
{
    struct seat_rating t = {.result = result};
    for (uint32_t i = 0; i < report->year.steps.count; i++)
        t.n_used += report->marks[i];
    t.values = malloc((result->n_columns + 1) * sizeof *t.values);
    report->viewpoints = calloc(report->n_viewpoints, sizeof *report->viewpoints);
    const bool room = t.values && report->viewpoints;
    for (size_t i = 0; room && i < report->n_viewpoints; i++) {
        t.hours = &report->viewpoint_hours[i];
        rate_viewpoint(&t, &report->viewpoints[i]);
        if (!orl_report_has_hours(report, ORL_WHEN_OCCUPIED)) { /* any level is possible */
            report->viewpoints[i].lowest = ORL_PROTECTED_NONE;
            report->viewpoints[i].highest = ORL_PROTECTED_HIGH;
        }
    }
    free(t.values);
    if (!room)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    report->glare_autonomy = autonomy_of(report->viewpoints, report->n_viewpoints);
    return 0;
}

int orl_annual_report_add_glare(const struct orl_annual_request *request,
                                const struct orl_annual_result *result,
                                const struct orl_report_request *report_request,
                                const struct orl_run_env *env, struct orl_annual_report *report,
                                struct orl_error *err)
{
    if (report_request->glare.n_viewpoints == 0)
        return 0;
    unsigned char *wanted = calloc(result->n_columns + 1, 1);
    if (!wanted)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t c = 0; c < result->n_columns; c++) {
        const struct orl_annual_step *row = &result->steps[result->step_of_column[c]];
        wanted[c] = report->marks[orl_annual_step_of(&report->year, row)];
    }
    const int code = orl_annual_glare_compute(&report_request->glare, request, result, wanted, env,
                                              &report->viewpoint_hours, err);
    free(wanted);
    if (code < 0)
        return code;
    report->n_viewpoints = report_request->glare.n_viewpoints;
    return orl_report_viewpoints(result, report, err);
}
