/* Warnings about a report that its user should know. */
#include "report/report_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

struct warning {
    struct orl_annual_result *result;
    void (*warned)(void *ctx, const char *warning);
    void *ctx;
    struct orl_error *err;
};

static int add_warning(const struct warning *w, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static int add_warning(const struct warning *w, const char *format, ...)
{
    struct orl_annual_result *r = w->result;
    char **grown = realloc(r->warnings, (r->n_warnings + 1) * sizeof *grown);
    char *text = NULL;
    va_list args;
    if (grown)
        r->warnings = grown;
    va_start(args, format);
    const int length = grown ? vasprintf(&text, format, args) : -1;
    va_end(args);
    if (length < 0)
        return orl_error_set(w->err, ORL_ERR_NOMEM, "out of memory");
    grown[r->n_warnings++] = text;
    if (w->warned)
        w->warned(w->ctx, text);
    return 0;
}

static bool sees_out(const struct orl_annual_report *report)
{
    size_t i = 0;
    while (i < report->n_views && report->views[i].layers == 0)
        i++;
    return i < report->n_views;
}

/* ---- Errors of hours ------------------------------------------------------------------------- */

struct uncertain_hours {
    unsigned char *columns; /* 1: the hour is uncertain at some sensor */
    size_t n_columns, n_sunlit, n_sensors;
    size_t sensor, column; /* position of the largest error relative to its illuminance */
    double worst;          /* that relative error */
};

static void find_of_sensor(const struct orl_annual_result *result, size_t sensor,
                           struct uncertain_hours *hours)
{
    const float *total = orl_annual_row(result, result->total, sensor);
    const float *se = orl_annual_row(result, result->se, sensor);
    bool any = false;
    for (size_t c = 0; c < result->n_columns; c++) {
        const double lx = (double)total[c], error = (double)se[c];
        if (!orl_report_is_uncertain(lx, error))
            continue;
        any = true;
        hours->columns[c] = 1;
        if (!(error / lx > hours->worst))
            continue;
        hours->worst = error / lx;
        hours->sensor = sensor;
        hours->column = c;
    }
    hours->n_sensors += any;
}

static void find_uncertain_hours(const struct orl_annual_result *result,
                                 struct uncertain_hours *hours)
{
    for (size_t i = 0; i < result->n_sensors; i++)
        find_of_sensor(result, i, hours);
    for (size_t c = 0; c < result->n_columns; c++) {
        const struct orl_annual_step *step = &result->steps[result->step_of_column[c]];
        hours->n_columns += hours->columns[c];
        hours->n_sunlit += hours->columns[c] && step->direct_normal_lx > 0;
    }
}

/* Describes how to reduce the errors. The sky is not interpolated between nodes, so errors of hours
 * without sun come from paths alone. */
static void describe_remedy(const struct orl_annual_request *request,
                            const struct uncertain_hours *hours, char *ret_text, size_t size)
{
    char nodes[64] = ", with \"sun_halvings\" at its maximum";
    if (request->sun_halvings < ORL_ANNUAL_MOST_HALVINGS)
        snprintf(nodes, sizeof nodes, " that \"sun_halvings\": %u reduces",
                 request->sun_halvings + 1);
    if (hours->n_sunlit == 0)
        snprintf(ret_text, size, "more \"samples\" reduce it");
    else
        snprintf(ret_text, size,
                 "more \"samples\" reduce the error of paths; in hours with sun (%zu), "
                 "interpolation between sun positions adds an error%s",
                 hours->n_sunlit, nodes);
}

static const struct orl_annual_grid *grid_of(const struct orl_annual_report *report, size_t sensor)
{
    size_t g = 0;
    while (g + 1 < report->n_grids && sensor >= report->grids[g].first + report->grids[g].count)
        g++;
    return &report->grids[g];
}

static void describe_worst(const struct orl_annual_report *report,
                           const struct orl_annual_result *result,
                           const struct uncertain_hours *hours, char *ret_text, size_t size)
{
    static const char *const months[12] = {"January",   "February", "March",    "April",
                                           "May",       "June",     "July",     "August",
                                           "September", "October",  "November", "December"};
    const struct orl_annual_grid *grid = grid_of(report, hours->sensor);
    const struct orl_annual_step *step = &result->steps[result->step_of_column[hours->column]];
    const int minutes = (int)lround(60 * step->hour);
    snprintf(ret_text, size,
             "sensor %zu (from 1) of '%.100s' on %d %s at %02d:%02d, %.3g lx with an error of "
             "%.3g lx",
             hours->sensor - grid->first + 1, grid->name, step->day, months[step->month - 1],
             minutes / 60, minutes % 60,
             (double)orl_annual_row(result, result->total, hours->sensor)[hours->column],
             (double)orl_annual_row(result, result->se, hours->sensor)[hours->column]);
}

static int warn_of_uncertain_hours(const struct warning *w,
                                   const struct orl_annual_request *request,
                                   const struct orl_annual_report *report)
{
    const struct orl_annual_result *result = w->result;
    struct uncertain_hours hours = {.columns = calloc(result->n_columns + 1, 1)};
    char worst[256], remedy[256];
    int code = 0;
    if (!hours.columns)
        return orl_error_set(w->err, ORL_ERR_NOMEM, "out of memory");
    find_uncertain_hours(result, &hours);
    if (hours.n_columns > 0) {
        describe_worst(report, result, &hours, worst, sizeof worst);
        describe_remedy(request, &hours, remedy, sizeof remedy);
        code = add_warning(
            w,
            "the standard error is above %g %% of the illuminance in %zu of %zu lit %s, at "
            "%zu of %zu sensors (counted where illuminance and twice the error are %g lx "
            "or more; the worst is %s): %s",
            100 * ORL_UNCERTAIN_SHARE, hours.n_columns, result->n_columns,
            report->year.steps.per_hour > 1 ? "steps" : "hours", hours.n_sensors, result->n_sensors,
            ORL_UNCERTAIN_LEAST_LX, worst, remedy);
    }
    free(hours.columns);
    return code;
}

/* ---- All of them ----------------------------------------------------------------------------- */

int orl_annual_report_warn(const struct orl_annual_request *request,
                           const struct orl_annual_report *report, struct orl_annual_result *result,
                           void (*warned)(void *ctx, const char *warning), void *ctx,
                           struct orl_error *err)
{
    const struct warning w = {result, warned, ctx, err};
    int code = 0;
    if (report->year.n_missing > 0)
        code = add_warning(&w,
                           "%zu step%s of the year %s not in the weather file, or not measured; "
                           "nights next to them count as dark",
                           report->year.n_missing, report->year.n_missing == 1 ? "" : "s",
                           report->year.n_missing == 1 ? "is" : "are");
    if (code == 0 && report->year.n_doubtful > 0)
        code =
            add_warning(&w,
                        "%zu step%s the sun at 3 degrees or higher but no light in the weather "
                        "file: counted as dark",
                        report->year.n_doubtful, report->year.n_doubtful == 1 ? " has" : "s have");
    if (code == 0 && report->n_unlit > 0)
        code = add_warning(
            &w, "no light ever reaches %zu sensors: check that they are not inside an object",
            report->n_unlit);
    if (code == 0 && report->views && !sees_out(report))
        code = add_warning(&w, "no point has a view out: openings must be glass panes, or surfaces "
                               "that the view out names, of a closed building");
    if (code == 0 && result->se)
        code = warn_of_uncertain_hours(&w, request, report);
    return code;
}
