/* Computes metrics and figures of a year, and assembles its report. */
#include "report/report_internal.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

#include "base/statistics/numeric.h"
#include "metrics/annual/annual_figures.h"

_Static_assert(ORL_ANNUAL_DEGREES == ORL_ANNUAL_BATCHES - 1, "a batch less than there are");

/* ---- Periods --------------------------------------------------------------------------------- */

static int no_memory(const struct orl_report_builder *m)
{
    return orl_error_set(m->err, ORL_ERR_NOMEM, "out of memory");
}

/* Copies the request's grids; without any, makes one of all sensors. */
static int make_grids(const struct orl_report_builder *m)
{
    struct orl_annual_report *report = m->report;
    const size_t n = m->request->n_grids;
    report->n_grids = n > 0 ? n : 1;
    report->n_sensors = m->request->n_sensors;
    report->grids = calloc(report->n_grids, sizeof *report->grids);
    report->area = calloc(report->n_sensors + 1, sizeof *report->area);
    if (!report->grids || !report->area)
        return no_memory(m);
    for (size_t g = 0; g < report->n_grids; g++) {
        struct orl_annual_grid *grid = &report->grids[g];
        *grid = n > 0 ? m->request->grids[g]
                      : (struct orl_annual_grid){.first = 0, .count = report->n_sensors};
        grid->name = strdup(n > 0 ? grid->name : "sensors");
        if (!grid->name)
            return no_memory(m);
        for (size_t i = grid->first; i < grid->first + grid->count; i++)
            report->area[i] = m->report_request->grid_area
                                  ? m->report_request->grid_area[g] / (double)grid->count
                                  : 1;
    }
    return 0;
}

/* Returns the day, counted from 1 January, on which the weather file begins; 0 for files of one
 * calendar year. */
static uint32_t begin_of_year(const struct orl_report_builder *m)
{
    const struct orl_annual_timeline *year = &m->report->year;
    const size_t first = m->result->n_moved;
    return first > 0
               ? orl_annual_step_of(year, &m->result->steps[first]) / (24 * year->steps.per_hour)
               : 0;
}

static int mark_occupied(const struct orl_report_builder *m)
{
    const struct orl_report_request *report_request = m->report_request;
    struct orl_annual_report *report = m->report;
    struct orl_file file;
    if (!report_request->occupancy_file) {
        struct orl_occupancy use = report_request->occupancy;
        if (use.first_day == ORL_FIRST_DAY_OF_WEATHER)
            use.first_day = m->result->first_weekday >= 0 ? (unsigned)m->result->first_weekday : 0;
        use.begins_day = begin_of_year(m);
        orl_occupancy_mark(&use, &report->year.steps, report->marks);
        return 0;
    }
    int code = m->files->open(m->files->ctx, report_request->occupancy_file, &file, m->err);
    if (code < 0)
        return code;
    code = orl_occupancy_read(report_request->occupancy_file, file.data, file.size,
                              &report->year.steps, report->marks, m->err);
    m->files->close(m->files->ctx, &file);
    return code;
}

/* Adds a period from its marks, and clears marks of steps that were not measured. */
static int add_period(const struct orl_report_builder *m, unsigned char *marks,
                      enum orl_annual_when when)
{
    const struct orl_annual_timeline *year = &m->report->year;
    uint32_t wanted = 0;
    for (uint32_t i = 0; i < year->steps.count; i++) {
        wanted += marks[i] != 0;
        marks[i] = marks[i] && year->measured[i];
    }
    m->report->hours_wanted[when] = (double)wanted / year->steps.per_hour;
    return orl_annual_period_make(marks, &year->steps, year->step_of_column, year->n_columns,
                                  &m->report->periods[when], m->err);
}

/* Finds the median diffuse illuminance of the marked and measured steps, unless the request gives
 * it. */
static int find_median(const struct orl_report_builder *m, const unsigned char *marks)
{
    struct orl_annual_report *report = m->report;
    const struct orl_annual_timeline *year = &report->year;
    double *values = malloc((year->steps.count + (size_t)1) * sizeof *values);
    size_t n = 0;
    if (!values)
        return no_memory(m);
    for (uint32_t i = 0; i < year->steps.count; i++)
        if (marks[i] && year->measured[i])
            values[n++] = year->diffuse_lx[i];
    report->median_diffuse_lx = m->report_request->median_diffuse_lx;
    if (!(report->median_diffuse_lx > 0) && n > 0) {
        const double upper = orl_nth_element(values, n, n / 2);
        report->median_diffuse_lx =
            n % 2 == 1 ? upper : (upper + orl_nth_element(values, n, n / 2 - 1)) / 2;
    }
    free(values);
    return 0;
}

/* Makes all periods. marks: scratch for all steps. */
static int fill_periods(const struct orl_report_builder *m, unsigned char *marks)
{
    struct orl_annual_report *report = m->report;
    const struct orl_annual_timeline *year = &report->year;
    int code = mark_occupied(m);
    if (code == 0)
        code = add_period(m, report->marks, ORL_WHEN_OCCUPIED);
    if (code == 0)
        code =
            orl_annual_daylight_mark(year->global_lx, year->measured, &year->steps, marks, m->err);
    if (code == 0)
        code = add_period(m, marks, ORL_WHEN_DAYLIGHT);
    /* A file with part of a year only provides the lighter half of that part. */
    const uint32_t half_of_year = year->steps.count / 2;
    report->hours_wanted[ORL_WHEN_DAYLIGHT] = (double)half_of_year / year->steps.per_hour;
    if (code == 0)
        code = find_median(m, marks);
    for (uint32_t i = 0; i < year->steps.count; i++)
        marks[i] = 1;
    if (code == 0)
        code = add_period(m, marks, ORL_WHEN_ALWAYS);
    if (code == 0 && report->periods[ORL_WHEN_OCCUPIED].hours == 0)
        code = orl_error_set(m->err, ORL_ERR_INVALID,
                             "no measured hour is occupied, so there is nothing to report");
    return code;
}

static int make_periods(const struct orl_report_builder *m)
{
    const size_t count = m->report->year.steps.count;
    unsigned char *marks = calloc(count + 1, 1);
    m->report->marks = calloc(count + 1, 1);
    const int code = marks && m->report->marks ? fill_periods(m, marks) : no_memory(m);
    free(marks);
    return code;
}

/* ---- Sensors --------------------------------------------------------------------------------- */

static bool is_unlit(const float *total, size_t n)
{
    size_t i = 0;
    while (i < n && !(total[i] > 0))
        i++;
    return i == n;
}

struct evaluation {
    const struct orl_report_builder *m;
    float *factors; /* scratch for a row, per thread of the pool */
    atomic_size_t n_unlit;
    atomic_bool cancelled;
};

static void evaluate_sensor(void *arg, size_t i, uint32_t member)
{
    struct evaluation *e = arg;
    const struct orl_report_builder *m = e->m;
    struct orl_annual_report *report = m->report;
    const struct orl_annual_result *result = m->result;
    const struct orl_annual_rows rows = orl_annual_rows_of(report, result, ORL_ALL_GRIDS);
    float *factors = e->factors + member * result->n_columns;
    struct orl_annual_light light = orl_annual_light_of(&rows, i);
    light.total_factor = light.total_error_lx ? factors : NULL;
    if (atomic_load(&e->cancelled))
        return;
    if (light.total_factor)
        orl_annual_error_factors(&light, result->n_columns, factors);
    if (is_unlit(light.total_lx, result->n_columns))
        atomic_fetch_add(&e->n_unlit, 1);
    for (size_t k = 0; k < report->n_metrics; k++)
        orl_annual_evaluate(&report->metrics[k], &report->periods[report->metrics[k].when], &light,
                            &report->values[k * report->n_sensors + i]);
    if (orl_is_cancelled(m->cancel))
        atomic_store(&e->cancelled, true);
}

static int evaluate_sensors(const struct orl_report_builder *m)
{
    struct evaluation e = {
        .m = m,
        .factors =
            malloc((orl_thread_pool_size(m->pool) * m->result->n_columns + 1) * sizeof(float))};
    if (!e.factors)
        return no_memory(m);
    orl_parallel_for(m->pool, m->report->n_sensors, evaluate_sensor, &e);
    free(e.factors);
    m->report->n_unlit = atomic_load(&e.n_unlit);
    return atomic_load(&e.cancelled)
               ? orl_error_set(m->err, ORL_ERR_CANCELLED, "cancelled while making the report")
               : 0;
}

static int make_values(const struct orl_report_builder *m)
{
    struct orl_annual_report *report = m->report;
    const size_t n = m->report_request->n_metrics;
    report->metrics = calloc(n + 1, sizeof *report->metrics);
    report->values = calloc(n * report->n_sensors + 1, sizeof *report->values);
    if (!report->metrics || !report->values)
        return no_memory(m);
    report->n_metrics = n;
    if (n > 0)
        memcpy(report->metrics, m->report_request->metrics, n * sizeof *report->metrics);
    return evaluate_sensors(m);
}

/* ---- Grids ----------------------------------------------------------------------------------- */

/* Computes a figure of a grid. Averages use values that are already computed. */
static int make_figure(const struct orl_report_builder *m, size_t f, size_t grid,
                       struct orl_annual_area *ret_area)
{
    const struct orl_annual_report *report = m->report;
    const struct orl_annual_rows rows = orl_annual_rows_of(report, m->result, grid);
    if (report->figures[f].aggregate != ORL_AGGREGATE_AVERAGE)
        return orl_report_figure_of(m, &report->figures[f], grid, ret_area);
    const size_t first = grid == ORL_ALL_GRIDS ? 0 : report->grids[grid].first;
    ret_area->value = orl_annual_average(&report->values[(f - 2) * report->n_sensors + first],
                                         rows.area, rows.n_sensors);
    return 0;
}

static int make_figures(const struct orl_report_builder *m)
{
    static const struct orl_annual_figure first[2] = {
        {ORL_AGGREGATE_SHARE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 50},
        {ORL_AGGREGATE_SHARE, {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0}, 250}};
    struct orl_annual_report *report = m->report;
    const size_t places = report->n_grids + 1;
    int code = 0;
    report->n_figures = 2 + report->n_metrics;
    report->figures = calloc(report->n_figures, sizeof *report->figures);
    report->areas = calloc(report->n_figures * places, sizeof *report->areas);
    if (!report->figures || !report->areas)
        return no_memory(m);
    for (size_t f = 0; f < report->n_figures && code == 0; f++) {
        report->figures[f] =
            f < 2 ? first[f]
                  : (struct orl_annual_figure){ORL_AGGREGATE_AVERAGE, report->metrics[f - 2], 0};
        for (size_t g = 0; g < places && code == 0; g++)
            code = make_figure(m, f, g < report->n_grids ? g : ORL_ALL_GRIDS,
                               &report->areas[f * places + g]);
    }
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

/* Prepares the parts of a report that need no light: year, grids and periods. */
static int prepare_report(const struct orl_report_builder *m)
{
    int code = orl_annual_timeline_make(m->result, &m->report->year, m->err);
    if (code == 0)
        code = make_grids(m);
    if (code == 0)
        code = orl_report_check_grids(m);
    return code == 0 ? make_periods(m) : code;
}

int orl_report_request_validate(const struct orl_annual_request *request,
                                const struct orl_report_request *report_request,
                                struct orl_error *err)
{
    struct orl_annual_report report = {.n_grids = 0};
    const struct orl_report_builder m = {request, NULL, report_request, NULL,
                                         NULL,    NULL, &report,        err};
    int code = request->n_terms > 0 ? orl_report_check_matrices(report_request, err) : 0;
    if (code == 0)
        code = orl_viewpoints_validate(&report_request->glare, request, err);
    if (code == 0)
        code = orl_named_points_check(report_request->exposure.points,
                                      report_request->exposure.n_points, err);
    if (code == 0)
        code = orl_named_points_check(report_request->view_out.points,
                                      report_request->view_out.n_points, err);
    if (code == 0)
        code = make_grids(&m);
    if (code == 0)
        code = orl_report_check_grids(&m);
    orl_annual_report_done(&report);
    return code;
}

int orl_report_request_check(const struct orl_annual_request *request,
                             const struct orl_annual_result *result,
                             const struct orl_report_request *report_request,
                             const struct orl_files *files, struct orl_error *err)
{
    struct orl_annual_report report = {.n_grids = 0};
    const struct orl_report_builder m = {request, result, report_request, files,
                                         NULL,    NULL,   &report,        err};
    const int code = prepare_report(&m);
    orl_annual_report_done(&report);
    return code;
}

int orl_annual_report_make(const struct orl_annual_request *request,
                           const struct orl_annual_result *result,
                           const struct orl_report_request *report_request,
                           const struct orl_files *files, const atomic_bool *cancel,
                           struct orl_thread_pool *pool, struct orl_annual_report *ret_report,
                           struct orl_error *err)
{
    struct orl_annual_report report = {.n_grids = 0};
    const struct orl_report_builder m = {request, result, report_request, files,
                                         cancel,  pool,   &report,        err};
    int code = result->total && result->direct
                   ? prepare_report(&m)
                   : orl_error_set(err, ORL_ERR_INVALID, "the year's series were not kept");
    if (code == 0)
        code = make_values(&m);
    if (code == 0)
        code = make_figures(&m);
    if (code == 0)
        code = orl_report_make_verdicts(&m);
    if (code < 0)
        orl_annual_report_done(&report);
    else
        *ret_report = report;
    return code;
}

int orl_annual_report_add_exposure(const struct orl_annual_request *request,
                                   const struct orl_annual_result *result,
                                   const struct orl_report_request *report_request,
                                   const struct orl_run_env *env, struct orl_annual_report *report,
                                   struct orl_error *err)
{
    const size_t n = report_request->exposure.n_points;
    if (n == 0)
        return 0;
    report->exposures = calloc(n, sizeof *report->exposures);
    if (!report->exposures)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    report->n_exposures = n;
    return orl_exposure_compute(&report_request->exposure, &result->site, request, env,
                                report->exposures, err);
}

/* Computes the percentages of a grid's area by view level of its sensors. */
static struct orl_view_shares share_views(const struct orl_annual_report *report, size_t grid,
                                          const struct orl_view_out *views)
{
    static const double enough = 75 - 1e-9;
    const struct orl_annual_grid *g = &report->grids[grid];
    struct orl_view_shares shares = {.level = ORL_VIEW_NONE};
    double all = 0, reached[3] = {0};
    for (size_t i = g->first; i < g->first + g->count; i++) {
        all += report->area[i];
        for (unsigned level = 0; level < views[i].level; level++)
            reached[level] += report->area[i];
    }
    for (int level = 0; level < 3; level++) {
        shares.percent[level] = orl_percent(reached[level], all);
        shares.level += shares.percent[level] >= enough;
    }
    return shares;
}

int orl_annual_report_add_views(const struct orl_report_request *report_request,
                                struct orl_view_out *views, size_t n_views,
                                struct orl_annual_report *report, struct orl_error *err)
{
    const size_t n_points = report_request->view_out.n_points;
    report->views = views;
    report->n_views = n_views;
    if (n_views == n_points)
        return 0;
    report->view_shares = calloc(report->n_grids + 1, sizeof *report->view_shares);
    if (!report->view_shares)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t g = 0; g < report->n_grids; g++)
        report->view_shares[g] = share_views(report, g, views + n_points);
    return 0;
}

void orl_annual_report_done(struct orl_annual_report *report)
{
    if (!report)
        return;
    orl_annual_timeline_done(&report->year);
    for (int i = 0; i < ORL_WHEN_COUNT; i++)
        orl_annual_period_done(&report->periods[i]);
    for (size_t i = 0; report->grids && i < report->n_grids; i++)
        free(report->grids[i].name);
    free(report->marks);
    free(report->grids);
    free(report->area);
    free(report->metrics);
    free(report->values);
    free(report->figures);
    free(report->areas);
    free(report->verdicts);
    free(report->exposures);
    free(report->views);
    free(report->view_shares);
    orl_viewpoint_hours_free(report->viewpoint_hours, report->n_viewpoints);
    free(report->viewpoints);
    *report = (struct orl_annual_report){.n_grids = 0};
}
