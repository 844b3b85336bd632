#include "annual_job/annual_job.h"

#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include "chart/charts.h"

enum { NAME_SIZE = 256, PATH_SIZE = 4096, GRID_SIZE = 128 };
#define HONEYBEE "results"

/* State for writing the files. */
struct annual_writer {
    const struct orl_annual_outputs *outputs;
    struct orl_annual_plans *plans;
    json_t *names;
    size_t count;           /* expected number of files */
    atomic_size_t *n_begun; /* number of files begun by all threads */
    bool reports_progress;  /* true on the thread that reports progress */
    struct orl_error *err;
};

static const struct {
    enum orl_canvas_kind kind;
    const char *ending;
} kinds[3] = {{ORL_CANVAS_SVG, "svg"}, {ORL_CANVAS_PNG, "png"}, {ORL_CANVAS_PDF, "pdf"}};

/* Appends the name of a file that is about to be written, and reports progress. */
static int add_file_name(void *ctx, const char *name, struct orl_error *err)
{
    const struct annual_writer *w = ctx;
    const struct orl_run_env *run = w->outputs->run;
    if (orl_is_cancelled(run->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled");
    if (json_array_append_new(w->names, json_string(name)))
        return orl_error_no_memory(err);
    const double begun = (double)(atomic_fetch_add(w->n_begun, 1) + 1);
    const double done = fmin(begun / (double)w->count, 1);
    const double files = 1 - ORL_ANNUAL_FILES_FROM;
    if (run->progress && w->reports_progress)
        run->progress(run->ctx, ORL_STAGE_RENDER, done, ORL_ANNUAL_FILES_FROM + files * done,
                      w->outputs->result->total_s * files / ORL_ANNUAL_FILES_FROM * (1 - done));
    return 0;
}

/* Notes a file of the output folder and returns its path. */
static int name_file(struct annual_writer *w, char ret_path[PATH_SIZE], const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static int name_file(struct annual_writer *w, char ret_path[PATH_SIZE], const char *format, ...)
{
    char name[NAME_SIZE];
    va_list args;
    va_start(args, format);
    vsnprintf(name, sizeof name, format, args);
    va_end(args);
    const int rc = add_file_name(w, name, w->err);
    if (rc)
        return rc;
    const int length = snprintf(ret_path, PATH_SIZE, "%s/%s", w->outputs->run->output_folder, name);
    return length < PATH_SIZE ? 0 : orl_error_set(w->err, ORL_ERR_LIMIT, "the path is too long");
}

static int write_tables(struct annual_writer *w)
{
    char path[PATH_SIZE];
    int rc = name_file(w, path, "sensors.csv");
    if (rc == 0)
        rc = orl_annual_sensors_csv(path, w->outputs->report, w->outputs->job->request.sensors,
                                    w->outputs->run->cancel, w->err);
    if (rc == 0)
        rc = name_file(w, path, "hours.csv");
    if (rc == 0)
        rc = orl_annual_hours_csv(path, &w->outputs->job->request, w->outputs->report,
                                  w->outputs->result, w->outputs->run->cancel, w->err);
    if (rc == 0 && w->outputs->report->views) {
        rc = name_file(w, path, "view_out.csv");
        if (rc == 0)
            rc = orl_annual_view_out_csv(path, &w->outputs->job->report_request, w->outputs->report,
                                         w->outputs->job->request.sensors, w->err);
    }
    if (rc == 0 && w->outputs->report->n_viewpoints > 0) {
        rc = name_file(w, path, "glare.csv");
        if (rc == 0)
            rc = orl_annual_glare_csv(path, &w->outputs->job->report_request, w->outputs->report,
                                      w->outputs->result, w->err);
    }
    return rc;
}

/* Writes GRID.ill, GRID.direct.ill and, if errors are known, GRID.se.ill. */
static int write_grid_matrices(struct annual_writer *w, const struct orl_annual_grid *grid)
{
    const struct orl_annual_result *result = w->outputs->result;
    const struct {
        const char *ending;
        const float *values;
    } series[] = {{"ill", result->total}, {"direct.ill", result->direct}, {"se.ill", result->se}};
    char path[PATH_SIZE], name[GRID_SIZE];
    int rc = 0;
    orl_annual_file_name(grid->name, name, sizeof name);
    for (size_t i = 0; i < sizeof series / sizeof *series && rc == 0; i++) {
        if (!series[i].values)
            continue;
        rc = name_file(w, path, "%s.%s", name, series[i].ending);
        if (rc == 0)
            rc = orl_matrix_write(path, orl_annual_row(result, series[i].values, grid->first),
                                  grid->count, result->n_columns, false, w->outputs->run->cancel,
                                  w->err);
    }
    return rc;
}

static int write_matrices(struct annual_writer *w)
{
    char list[PATH_SIZE];
    int rc = name_file(w, list, "columns.csv");
    if (rc == 0)
        rc = orl_annual_columns_csv(list, w->outputs->report, w->outputs->result, w->err);
    for (size_t g = 0; g < w->outputs->report->n_grids && rc == 0; g++)
        rc = write_grid_matrices(w, &w->outputs->report->grids[g]);
    return rc;
}

static int write_coefficients(struct annual_writer *w)
{
    int rc = 0;
    for (size_t g = 0; g < w->outputs->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &w->outputs->report->grids[g];
        char path[PATH_SIZE], name[GRID_SIZE];
        orl_annual_file_name(grid->name, name, sizeof name);
        rc = name_file(w, path, "%s.dc.mtx", name);
        if (rc == 0)
            rc = orl_coefficients_write(
                path, w->outputs->result->coefficients + grid->first * ORL_ANNUAL_PATCHES,
                grid->count, ORL_ANNUAL_PATCHES, w->outputs->run->cancel, w->err);
    }
    return rc;
}

/* Writes the matrices of one window, and those of the window and each grid. */
static int write_window(struct annual_writer *w, const struct orl_phase_window *window)
{
    const struct {
        const char *ending;
        const float *values;
        size_t columns;
    } own[] = {{"t", window->transmission, ORL_PHASES_CELLS},
               {"d", window->daylight, ORL_ANNUAL_PATCHES},
               {"dd", window->direct_daylight, ORL_ANNUAL_PATCHES}},
      of_grids[] = {{"v", window->view, ORL_PHASES_CELLS},
                    {"vd", window->direct_view, ORL_PHASES_CELLS}};
    char path[PATH_SIZE], name[GRID_SIZE], grid_name[GRID_SIZE];
    int rc = 0;
    orl_annual_file_name(window->name, name, sizeof name);
    for (size_t i = 0; i < sizeof own / sizeof *own && rc == 0; i++) {
        rc = name_file(w, path, "%s.%s.mtx", name, own[i].ending);
        if (rc == 0)
            rc = orl_coefficients_write(path, own[i].values, ORL_PHASES_CELLS, own[i].columns,
                                        w->outputs->run->cancel, w->err);
    }
    for (size_t k = 0; k < 2 * w->outputs->report->n_grids && rc == 0; k++) {
        const struct orl_annual_grid *grid = &w->outputs->report->grids[k / 2];
        orl_annual_file_name(grid->name, grid_name, sizeof grid_name);
        rc = name_file(w, path, "%s.%s.%s.mtx", grid_name, name, of_grids[k % 2].ending);
        if (rc == 0)
            rc = orl_coefficients_write(
                path, of_grids[k % 2].values + grid->first * ORL_PHASES_CELLS, grid->count,
                ORL_PHASES_CELLS, w->outputs->run->cancel, w->err);
    }
    return rc;
}

static int write_phases(struct annual_writer *w)
{
    const struct orl_phase_matrices *phases = w->outputs->phases;
    int rc = 0;
    for (size_t i = 0; i < phases->n_windows && rc == 0; i++)
        rc = write_window(w, &phases->windows[i]);
    for (size_t g = 0; g < w->outputs->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &w->outputs->report->grids[g];
        char path[PATH_SIZE], name[GRID_SIZE];
        orl_annual_file_name(grid->name, name, sizeof name);
        rc = name_file(w, path, "%s.cds.mtx", name);
        if (rc == 0)
            rc = orl_coefficients_write(path, phases->suns + grid->first * ORL_PHASES_SUNS,
                                        grid->count, ORL_PHASES_SUNS, w->outputs->run->cancel,
                                        w->err);
    }
    return rc;
}

/* Draws every metric of a grid over the plan. */
static int write_plans(struct annual_writer *w, size_t g, const char *grid)
{
    int rc = 0;
    double wide, high;
    if (!orl_annual_plan_size(w->plans, g, 1, &wide, &high))
        return 0;
    for (size_t k = 0; k < w->outputs->report->n_metrics && rc == 0; k++)
        for (int i = 0; i < 2 && rc == 0; i++) {
            char path[PATH_SIZE], metric[64];
            orl_annual_metric_file(&w->outputs->report->metrics[k], metric, sizeof metric);
            rc = name_file(w, path, "%s.%s.%s", grid, metric, kinds[i].ending);
            if (rc == 0)
                rc = orl_annual_plan_write(w->plans, w->outputs->report, g, k, kinds[i].kind, path,
                                           w->err);
        }
    return rc;
}

/* Draws a grid's year as temporal maps: mean illuminance, and share of the area with at least 300
 * lx. */
static int write_years(struct annual_writer *w, size_t g, const char *grid)
{
    static const struct {
        enum orl_annual_series series;
        const char *name, *title, *unit;
        double top;
    } of[2] = {{ORL_SERIES_MEAN, "year", "mean illuminance, lx", "lx", 0},
               {ORL_SERIES_SHARE, "year300", "share of the area with 300 lx or more, %", "%", 100}};
    float *values = malloc(w->outputs->report->year.steps.count * sizeof *values);
    int rc = values ? 0 : orl_error_no_memory(w->err);
    for (int s = 0; s < 2 && rc == 0; s++) {
        char title[NAME_SIZE];
        snprintf(title, sizeof title, "%s: %s", w->outputs->report->grids[g].name, of[s].title);
        rc = orl_annual_series_of(w->outputs->report, w->outputs->result, g, of[s].series, 300,
                                  w->outputs->run->cancel, values);
        if (rc)
            orl_error_set(w->err, rc, "%s while writing the annual pictures",
                          rc == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
        for (int i = 0; i < 2 && rc == 0; i++) {
            const struct orl_temporal_map map = {.title = title,
                                                 .unit = of[s].unit,
                                                 .steps = w->outputs->report->year.steps,
                                                 .values = values,
                                                 .top = of[s].top,
                                                 .logarithmic = !(of[s].top > 0),
                                                 .marks = w->outputs->report->marks};
            char path[PATH_SIZE];
            rc = name_file(w, path, "%s.%s.%s", grid, of[s].name, kinds[i].ending);
            if (rc == 0)
                rc = orl_temporal_map_write(&map, kinds[i].kind, path, w->err);
        }
    }
    free(values);
    return rc;
}

static int write_page(struct annual_writer *w, size_t g, const char *grid)
{
    const struct orl_annual_page page = {.title = w->outputs->job->title,
                                         .request = &w->outputs->job->request,
                                         .report_request = &w->outputs->job->report_request,
                                         .result = w->outputs->result,
                                         .report = w->outputs->report,
                                         .plans = w->plans,
                                         .grid = g,
                                         .cancel = w->outputs->run->cancel};
    int rc = 0;
    for (int i = 0; i < 3 && rc == 0; i++) {
        char path[PATH_SIZE];
        rc = name_file(w, path, "%s.page.%s", grid, kinds[i].ending);
        if (rc == 0)
            rc = orl_annual_page_write(&page, kinds[i].kind, path, w->err);
    }
    return rc;
}

static int write_grid(struct annual_writer *w, size_t g)
{
    char grid[GRID_SIZE];
    orl_annual_file_name(w->outputs->report->grids[g].name, grid, sizeof grid);
    int rc = write_plans(w, g, grid);
    if (rc == 0)
        rc = write_years(w, g, grid);
    if (rc == 0)
        rc = write_page(w, g, grid);
    return rc;
}

/* Per-thread state for drawing grids in parallel: a list of names and an error of its own. */
struct grid_writer {
    struct annual_writer annual_writer;
    struct orl_error err;
    int rc;
};

static void draw_grid(void *arg, size_t g, uint32_t member)
{
    struct grid_writer *grid_writer = (struct grid_writer *)arg + g;
    grid_writer->annual_writer.reports_progress = member == 0;
    grid_writer->rc = write_grid(&grid_writer->annual_writer, g);
}

static int write_pictures(struct annual_writer *w)
{
    const size_t n = w->outputs->report->n_grids;
    struct grid_writer *grid_writers = calloc(n + 1, sizeof *grid_writers);
    int rc = 0;
    if (!grid_writers)
        return orl_error_no_memory(w->err);
    for (size_t g = 0; g < n && rc == 0; g++) {
        struct annual_writer *own = &grid_writers[g].annual_writer;
        *own = *w;
        own->err = &grid_writers[g].err;
        own->names = json_array();
        if (!own->names)
            rc = orl_error_no_memory(w->err);
    }
    if (rc == 0)
        orl_parallel_for(w->outputs->run->pool, n, draw_grid, grid_writers);
    for (size_t g = 0; g < n; g++) {
        if (rc == 0 && grid_writers[g].rc) {
            rc = grid_writers[g].rc;
            *w->err = grid_writers[g].err;
        }
        if (rc == 0 && json_array_extend(w->names, grid_writers[g].annual_writer.names))
            rc = orl_error_no_memory(w->err);
        json_decref(grid_writers[g].annual_writer.names);
    }
    free(grid_writers);
    return rc;
}

/* Notes a file of the subfolder HONEYBEE. */
static int add_honeybee_name(void *ctx, const char *name, struct orl_error *err)
{
    char below[NAME_SIZE];
    snprintf(below, sizeof below, HONEYBEE "/%s", name);
    return add_file_name(ctx, below, err);
}

static int write_honeybee(struct annual_writer *w)
{
    char path[PATH_SIZE];
    if (snprintf(path, sizeof path, "%s/" HONEYBEE, w->outputs->run->output_folder) >= PATH_SIZE)
        return orl_error_set(w->err, ORL_ERR_LIMIT, "the path is too long");
    return orl_honeybee_write(path, w->outputs->report, w->outputs->result, add_honeybee_name, w,
                              w->outputs->run->cancel, w->err);
}

/* Estimates the number of files, for progress. */
static size_t count_files(const struct orl_annual_outputs *outputs)
{
    const struct orl_annual_formats *formats = &outputs->job->formats;
    const size_t of_grid = 2 * outputs->report->n_metrics + 7 + (formats->matrices ? 3 : 0) +
                           formats->coefficients + (formats->honeybee ? 10 : 0) +
                           (outputs->phases ? 1 + 2 * outputs->phases->n_windows : 0);
    return 2 + formats->matrices + (outputs->report->views ? 1U : 0U) +
           (outputs->report->n_viewpoints > 0 ? 1U : 0U) + outputs->report->n_grids * of_grid +
           (formats->honeybee ? 12 : 0) + (outputs->phases ? 3 * outputs->phases->n_windows : 0);
}

static int write_all(struct annual_writer *w)
{
    const struct orl_annual_outputs *outputs = w->outputs;
    int rc = write_tables(w);
    if (rc == 0 && outputs->job->formats.matrices)
        rc = write_matrices(w);
    if (rc == 0 && outputs->job->formats.coefficients)
        rc = write_coefficients(w);
    if (rc == 0 && outputs->phases)
        rc = write_phases(w);
    if (rc == 0 && outputs->job->formats.honeybee)
        rc = write_honeybee(w);
    if (rc == 0)
        rc = orl_annual_plans_new(&outputs->job->request, outputs->report, outputs->run, &w->plans,
                                  w->err);
    return rc ? rc : write_pictures(w);
}

int orl_annual_files_write(const struct orl_annual_outputs *outputs, json_t *names,
                           struct orl_error *err)
{
    atomic_size_t n_begun = 0;
    struct annual_writer w = {.outputs = outputs,
                              .names = names,
                              .count = count_files(outputs),
                              .n_begun = &n_begun,
                              .reports_progress = true,
                              .err = err};
    const int rc = write_all(&w);
    orl_annual_plans_free(w.plans);
    return rc;
}
