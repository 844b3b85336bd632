#include "annual_files.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "chart/annual_page.h"
#include "chart/temporal_map.h"
#include "files.h"

enum { NAME_SIZE = 256, PATH_SIZE = 4096, GRID_SIZE = 128 };

/* What is written, and where. */
struct writing {
    const struct orl_annual_output *output;
    const struct orl_local_year *year;
    const struct orl_annual_report *report;
    struct orl_annual_plans *plans;
    json_t *files;
    struct orl_error *err;
};

static const struct {
    enum orl_canvas_kind kind;
    const char *ending;
} kinds[2] = {{ORL_CANVAS_SVG, "svg"}, {ORL_CANVAS_PNG, "png"}};

/* The path of a file of that name, which the result tells. */
static int name_file(const struct writing *w, char ret_path[PATH_SIZE], const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static int name_file(const struct writing *w, char ret_path[PATH_SIZE], const char *format, ...)
{
    char name[NAME_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(name, sizeof name, format, args);
    va_end(args);
    if (json_array_append_new(w->files, json_string(name)) != 0)
        return orl_error_set(w->err, ORL_ERR_NOMEM, "out of memory");
    return orl_join_path(w->output->folder, name, ret_path, PATH_SIZE, w->err);
}

static int write_tables(const struct writing *w)
{
    char path[PATH_SIZE];
    int rc = name_file(w, path, "sensors.csv");

    if (rc == 0)
        rc = orl_annual_sensors_csv(path, w->report, w->year->job->request.sensors, w->err);
    if (rc == 0)
        rc = name_file(w, path, "hours.csv");
    if (rc == 0)
        rc = orl_annual_hours_csv(path, w->report, w->year->result, w->err);
    return rc;
}

static int write_matrices(const struct writing *w)
{
    const struct orl_annual_result *result = w->year->result;
    int rc = 0;

    for (size_t g = 0; g < w->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &w->report->grids[g];
        char path[PATH_SIZE], name[GRID_SIZE];

        orl_annual_file_name(grid->name, name, sizeof name);
        rc = name_file(w, path, "%s.ill", name);
        if (rc == 0)
            rc = orl_matrix_write(path, orl_annual_row(result, result->total, grid->first),
                                  grid->count, result->n_columns, false, w->err);
        if (rc == 0)
            rc = name_file(w, path, "%s.direct.ill", name);
        if (rc == 0)
            rc = orl_matrix_write(path, orl_annual_row(result, result->direct, grid->first),
                                  grid->count, result->n_columns, false, w->err);
    }
    return rc;
}

/* Every metric of a grid over the plan. */
static int write_plans(const struct writing *w, size_t g, const char *grid)
{
    int rc = 0;
    double wide, high;

    if (!orl_annual_plan_size(w->plans, g, 1, &wide, &high))
        return 0;
    for (size_t k = 0; k < w->report->n_metrics && rc == 0; k++)
        for (int i = 0; i < 2 && rc == 0; i++) {
            char path[PATH_SIZE], metric[64];

            orl_annual_metric_file(&w->report->metrics[k], metric, sizeof metric);
            rc = name_file(w, path, "%s.%s.%s", grid, metric, kinds[i].ending);
            if (rc == 0)
                rc = orl_annual_plan_write(w->plans, w->report, g, k, kinds[i].kind, path, w->err);
        }
    return rc;
}

/* A grid's year as carpets: mean illuminance, and the share of the area with 300 lx. */
static int write_years(const struct writing *w, size_t g, const char *grid)
{
    static const struct {
        enum orl_annual_series series;
        const char *name, *title, *unit;
        double top;
    } of[2] = {{ORL_SERIES_MEAN, "year", "mean illuminance, lx", "lx", 0},
               {ORL_SERIES_SHARE, "year300", "share of the area with 300 lx or more, %", "%", 100}};
    float *values = malloc(w->report->year.steps.count * sizeof *values);
    int rc = values ? 0 : orl_error_set(w->err, ORL_ERR_NOMEM, "out of memory");

    for (int s = 0; s < 2 && rc == 0; s++) {
        char title[NAME_SIZE];

        snprintf(title, sizeof title, "%s: %s", w->report->grids[g].name, of[s].title);
        orl_annual_series_of(w->report, w->year->result, g, of[s].series, 300, values);
        for (int i = 0; i < 2 && rc == 0; i++) {
            const struct orl_temporal_map map = {.title = title,
                                                 .unit = of[s].unit,
                                                 .steps = w->report->year.steps,
                                                 .values = values,
                                                 .top = of[s].top,
                                                 .logarithmic = !(of[s].top > 0),
                                                 .marks = w->report->marks};
            char path[PATH_SIZE];

            rc = name_file(w, path, "%s.%s.%s", grid, of[s].name, kinds[i].ending);
            if (rc == 0)
                rc = orl_temporal_map_write(&map, kinds[i].kind, path, w->err);
        }
    }
    free(values);
    return rc;
}

static int write_page(const struct writing *w, size_t g, const char *grid)
{
    const struct orl_annual_page page = {.title = w->year->job->title,
                                         .request = &w->year->job->request,
                                         .wishes = &w->year->job->wishes,
                                         .result = w->year->result,
                                         .report = w->report,
                                         .plans = w->plans,
                                         .grid = g};
    int rc = 0;

    for (int i = 0; i < 2 && rc == 0; i++) {
        char path[PATH_SIZE];

        rc = name_file(w, path, "%s.page.%s", grid, kinds[i].ending);
        if (rc == 0)
            rc = orl_annual_page_write(&page, kinds[i].kind, path, w->err);
    }
    return rc;
}

static int write_pictures(const struct writing *w)
{
    int rc = 0;

    for (size_t g = 0; g < w->report->n_grids && rc == 0; g++) {
        char grid[GRID_SIZE];

        orl_annual_file_name(w->report->grids[g].name, grid, sizeof grid);
        rc = write_plans(w, g, grid);
        if (rc == 0)
            rc = write_years(w, g, grid);
        if (rc == 0)
            rc = write_page(w, g, grid);
    }
    return rc;
}

static int write_honeybee(const struct writing *w)
{
    char path[PATH_SIZE];
    int rc = name_file(w, path, "results");

    return rc ? rc : orl_honeybee_write(path, w->report, w->year->result, w->err);
}

int orl_annual_files_write(const struct orl_annual_output *output,
                           const struct orl_local_year *year,
                           const struct orl_annual_report *report, json_t *files,
                           struct orl_error *err)
{
    struct writing w = {output, year, report, NULL, files, err};
    int rc = write_tables(&w);

    if (rc == 0 && output->matrices)
        rc = write_matrices(&w);
    if (rc == 0 && output->honeybee)
        rc = write_honeybee(&w);
    if (rc == 0)
        rc = orl_annual_plans_new(&year->job->request, report, year->env, &w.plans, err);
    if (rc == 0)
        rc = write_pictures(&w);
    orl_annual_plans_free(w.plans);
    return rc;
}
