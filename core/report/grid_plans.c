/* Figures of grids on pages: values of each step, titles of metrics, maps on the plan of the
 * scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/thread_pool.h>

#include "base/statistics/numeric.h"
#include "render/heat_map/heat_map.h"
#include "report/report_internal.h"

/* ---- Values of each step --------------------------------------------------------------------- */

/* Adds a sensor to the sum of each column. Rows of the result are read sequentially. */
static void add_sensor(const struct orl_annual_rows *rows, enum orl_annual_series series,
                       double threshold_lx, size_t sensor, struct orl_sum *sums)
{
    const float *row = &rows->total_lx[sensor * rows->n_columns];
    for (size_t k = 0; k < rows->n_columns; k++) {
        const double lx = row[k];
        orl_sum_add(&sums[k], rows->area[sensor] *
                                  (series == ORL_SERIES_MEAN ? lx : 100 * (lx >= threshold_lx)));
    }
}

int orl_annual_series_of(const struct orl_annual_report *report,
                         const struct orl_annual_result *result, size_t grid,
                         enum orl_annual_series series, double threshold_lx,
                         const atomic_bool *cancel, float *ret_values)
{
    const struct orl_annual_timeline *year = &report->year;
    const struct orl_annual_rows rows = orl_annual_rows_of(report, result, grid);
    struct orl_sum *sums = calloc(rows.n_columns + 1, sizeof *sums), area = {0};
    int code = sums ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; i < rows.n_sensors && code == 0; i++) {
        code = orl_is_cancelled(cancel) ? ORL_ERR_CANCELLED : 0;
        add_sensor(&rows, series, threshold_lx, i, sums);
        orl_sum_add(&area, rows.area[i]);
    }
    for (uint32_t i = 0; i < year->steps.count && code == 0; i++)
        ret_values[i] = year->measured[i] ? ORL_SUN_DOWN : NAN;
    for (size_t k = 0; k < year->n_columns && code == 0; k++)
        ret_values[year->step_of_column[k]] =
            rows.n_sensors > 0 ? (float)(orl_sum_value(&sums[k]) / orl_sum_value(&area)) : 0;
    free(sums);
    return code;
}

/* ---- Titles of metrics on pages, and their names in file names ------------------------------- */

static const struct {
    const char *file;          /* in file names */
    const char *title, *after; /* before and after the thresholds */
    int thresholds;
} metric_words[ORL_METRIC_KINDS] = {
    [ORL_METRIC_DA] = {"da", "Daylight autonomy at ", " lx", 1},
    [ORL_METRIC_CDA] = {"cda", "Continuous daylight autonomy at ", " lx", 1},
    [ORL_METRIC_UDI] = {"udi", "Useful daylight, ", " lx", 2},
    [ORL_METRIC_UDI_LOWER] = {"udi_lower", "Below useful daylight, under ", " lx", 1},
    [ORL_METRIC_UDI_PART] = {"udi_part", "Supplementary daylight, ", " lx", 2},
    [ORL_METRIC_UDI_UPPER] = {"udi_upper", "Above useful daylight, over ", " lx", 1},
    [ORL_METRIC_MEAN] = {"mean", "Mean illuminance", "", 0},
    [ORL_METRIC_CUMULATIVE] = {"cumulative", "Cumulative illuminance", "", 0},
    [ORL_METRIC_HOURS] = {"hours", "Hours with ", " lx or more", 1},
    [ORL_METRIC_DIRECT_HOURS] = {"direct_hours", "Direct sunlight above ", " lx", 1},
    [ORL_METRIC_DF] = {"df", "Daylight factor", "", 0},
};

/* Writes the given number of thresholds of a metric. */
static void write_thresholds(const struct orl_annual_metric *metric, int thresholds,
                             const char *between, char ret_text[64])
{
    ret_text[0] = '\0';
    if (thresholds == 1)
        snprintf(ret_text, 64, "%g", metric->low_lx);
    else if (thresholds == 2)
        snprintf(ret_text, 64, "%g%s%g", metric->low_lx, between, metric->high_lx);
}

void orl_annual_metric_title(const struct orl_annual_metric *metric, char *ret_text, size_t size)
{
    static const char *const when[ORL_WHEN_COUNT] = {"", ", daylight hours", ", all hours"};
    char thresholds[64];
    write_thresholds(metric, metric_words[metric->kind].thresholds, " to ", thresholds);
    snprintf(ret_text, size, "%s%s%s%s", metric_words[metric->kind].title, thresholds,
             metric_words[metric->kind].after,
             metric->kind == ORL_METRIC_DF ? "" : when[metric->when]);
}

void orl_annual_metric_file(const struct orl_annual_metric *metric, char *ret_text, size_t size)
{
    static const char *const when[ORL_WHEN_COUNT] = {"", "_daylight", "_year"};
    const int n = metric->kind == ORL_METRIC_DF ? 1 : metric_words[metric->kind].thresholds;
    char thresholds[64];
    write_thresholds(metric, n, "-", thresholds);
    snprintf(ret_text, size, "%s%s%s", metric_words[metric->kind].file, thresholds,
             when[metric->when]);
}

/* ---- Planes of grids ------------------------------------------------------------------------- */

/* Planes of grids, for maps on the plan of the scene. */
struct orl_annual_plans {
    struct orl_scene *scene; /* a reference is held */
    struct orl_sensor_plane *planes;
    bool *found;
    size_t n_grids;
};

static int find_planes(struct orl_annual_plans *plans, const struct orl_annual_request *request,
                       const struct orl_annual_report *report)
{
    plans->n_grids = report->n_grids;
    plans->planes = calloc(report->n_grids + 1, sizeof *plans->planes);
    plans->found = calloc(report->n_grids + 1, sizeof *plans->found);
    int code = plans->planes && plans->found ? 0 : ORL_ERR_NOMEM;
    for (size_t g = 0; g < report->n_grids && code == 0; g++) {
        size_t count = 0;
        code = orl_sensor_planes_find(request->sensors + report->grids[g].first,
                                      report->grids[g].count, 1, &plans->planes[g], &count);
        plans->found[g] = code == 0 && count == 1;
    }
    return code;
}

int orl_annual_plans_new(const struct orl_annual_request *request,
                         const struct orl_annual_report *report, const struct orl_run_env *env,
                         struct orl_annual_plans **ret_plans, struct orl_error *err)
{
    struct orl_annual_plans *plans = calloc(1, sizeof *plans);
    int code = plans ? find_planes(plans, request, report) : ORL_ERR_NOMEM;
    if (code < 0)
        orl_error_set(err, code, "out of memory");
    else
        code = orl_unshaded_scene_load(request, env, &plans->scene, err);
    if (code < 0)
        orl_annual_plans_free(plans);
    else
        *ret_plans = plans;
    return code;
}

void orl_annual_plans_free(struct orl_annual_plans *plans)
{
    if (!plans)
        return;
    for (size_t g = 0; plans->planes && plans->found && g < plans->n_grids; g++)
        if (plans->found[g])
            orl_sensor_planes_done(&plans->planes[g], 1);
    free(plans->planes);
    free(plans->found);
    orl_scene_release(plans->scene);
    free(plans);
}

/* ---- Drawing --------------------------------------------------------------------------------- */

/* A metric of a grid as a heat map. */
struct sheet {
    struct orl_heat_map map;
    struct orl_heat_map_request how;
    char title[96];
    double *values; /* owned, like intervals */
    double (*intervals)[2];
};

static void choose_scale(const struct orl_annual_metric *metric, struct orl_heat_map_request *how)
{
    const bool percent = orl_annual_unit(metric->kind)[0] == '%';
    how->colors.scale = percent ? 100 : 0;
    how->n_thresholds = 1;
    if (metric->kind == ORL_METRIC_DA || metric->kind == ORL_METRIC_CDA)
        how->thresholds_lx[0] = 50;
    else if (metric->kind == ORL_METRIC_DIRECT_HOURS)
        how->thresholds_lx[0] = 250;
    else
        how->n_thresholds = 0;
}

static int sheet_init(struct sheet *sheet, const struct orl_annual_plans *plans,
                      const struct orl_annual_report *report, size_t grid, size_t metric)
{
    const struct orl_annual_grid *g = &report->grids[grid];
    *sheet = (struct sheet){.values = calloc(g->count + 1, sizeof *sheet->values),
                            .intervals = calloc(g->count + 1, sizeof *sheet->intervals)};
    if (!sheet->values || !sheet->intervals)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < g->count; i++) {
        const struct orl_annual_value *v =
            &report->values[metric * report->n_sensors + g->first + i];
        sheet->values[i] = v->value;
        sheet->intervals[i][0] = v->low;
        sheet->intervals[i][1] = v->high;
    }
    choose_scale(&report->metrics[metric], &sheet->how);
    orl_annual_metric_title(&report->metrics[metric], sheet->title, sizeof sheet->title);
    sheet->map = (struct orl_heat_map){.geometry = plans->scene->geometry,
                                       .plane = &plans->planes[grid],
                                       .quantity = sheet->title,
                                       .unit = orl_annual_unit(report->metrics[metric].kind),
                                       .values = sheet->values,
                                       .intervals = (const double(*)[2])sheet->intervals,
                                       .how = &sheet->how};
    return 0;
}

static void sheet_done(struct sheet *sheet)
{
    free(sheet->values);
    free(sheet->intervals);
}

bool orl_annual_plan_size(const struct orl_annual_plans *plans, size_t grid, double side,
                          double *ret_width, double *ret_height)
{
    const struct orl_heat_map map = {.geometry = plans->scene->geometry,
                                     .plane = &plans->planes[grid]};
    if (!plans->found[grid])
        return false;
    orl_heat_map_size(&map, side, ret_width, ret_height);
    return true;
}

int orl_annual_plan_draw(const struct orl_annual_plans *plans,
                         const struct orl_annual_report *report, size_t grid, size_t metric,
                         struct orl_canvas *canvas, double x, double y, double side)
{
    struct sheet sheet;
    int code = sheet_init(&sheet, plans, report, grid, metric);
    if (code == 0)
        code = orl_heat_map_draw(&sheet.map, canvas, x, y, side);
    sheet_done(&sheet);
    return code;
}

int orl_annual_plan_write(const struct orl_annual_plans *plans,
                          const struct orl_annual_report *report, size_t grid, size_t metric,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err)
{
    struct sheet sheet;
    int code = sheet_init(&sheet, plans, report, grid, metric);
    if (code < 0)
        orl_error_set(err, code, "out of memory drawing a map");
    else
        code = orl_heat_map_write(&sheet.map, kind, path, err);
    sheet_done(&sheet);
    return code;
}
