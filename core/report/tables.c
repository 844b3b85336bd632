/* Tables of a year, with one line per sensor or per hour, and Radiance matrix files. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/annual/annual_report.h>

#include "base/io/out_file.h"
#include "base/statistics/numeric.h"
#include "metrics/annual/annual_figures.h"

/* ---- Radiance matrix files ------------------------------------------------------------------- */

/* Writes each value as three equal components, block by block. */
static void write_grey(const struct orl_out_file *file, const float *values, size_t n)
{
    enum { CHUNK = 4096 };
    float grey[3 * CHUNK];
    for (size_t at = 0; at < n && orl_out_continues(file); at += CHUNK) {
        const size_t count = n - at < CHUNK ? n - at : CHUNK;
        for (size_t i = 0; i < count; i++)
            grey[3 * i] = grey[3 * i + 1] = grey[3 * i + 2] = values[at + i];
        fwrite(grey, sizeof *grey, 3 * count, file->stream);
    }
}

static void write_ascii(const struct orl_out_file *file, const float *values, size_t rows,
                        size_t columns)
{
    for (size_t r = 0; r < rows && orl_out_continues(file); r++)
        for (size_t c = 0; c < columns; c++)
            fprintf(file->stream, "%.6g%c", (double)values[r * columns + c],
                    c + 1 < columns ? '\t' : '\n');
}

int orl_coefficients_write(const char *path, const float *values, size_t rows, size_t columns,
                           const atomic_bool *cancel, struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    fprintf(file.stream,
            "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=3\nBigEndian=%d\nFORMAT=float\n\n", rows,
            columns, big);
    write_grey(&file, values, rows * columns);
    return orl_out_close(&file, 0, err);
}

int orl_matrix_write(const char *path, const float *values, size_t rows, size_t columns, bool ascii,
                     const atomic_bool *cancel, struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    fprintf(file.stream, "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=1\n", rows, columns);
    if (!ascii)
        fprintf(file.stream, "BigEndian=%d\n", big);
    fprintf(file.stream, "FORMAT=%s\n\n", ascii ? "ascii" : "float");
    if (ascii)
        write_ascii(&file, values, rows, columns);
    else
        orl_out_floats(&file, values, rows * columns);
    return orl_out_close(&file, 0, err);
}

/* ---- Fields of tables ------------------------------------------------------------------------ */

void orl_annual_file_name(const char *grid, char *ret_name, size_t size)
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    size_t n = 0;
    for (; grid[n] && n + 1 < size; n++)
        ret_name[n] = strchr(allowed, grid[n]) && !(n == 0 && grid[n] == '.') ? grid[n] : '_';
    ret_name[n] = '\0';
}

/* Writes a quoted field; quotes inside are doubled. */
static void put_field(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', stream);
        fputc(*text, stream);
    }
    fputc('"', stream);
}

static void put_number(FILE *stream, double value)
{
    if (isfinite(value))
        fprintf(stream, ",%.6g", value);
    else
        fputc(',', stream);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

static void write_sensor_heads(FILE *stream, const struct orl_annual_report *report)
{
    fputs("grid,x,y,z,dx,dy,dz", stream);
    for (size_t k = 0; k < report->n_metrics; k++) {
        const struct orl_annual_metric *metric = &report->metrics[k];
        char name[64], text[96];
        orl_annual_metric_name(metric, name, sizeof name);
        snprintf(text, sizeof text, "%s (%s)", name, orl_annual_unit(metric->kind));
        fputc(',', stream);
        put_field(stream, text);
        fputs(",low_95,high_95", stream);
    }
    fputc('\n', stream);
}

int orl_annual_sensors_csv(const char *path, const struct orl_annual_report *report,
                           const struct orl_sensor *sensors, const atomic_bool *cancel,
                           struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    write_sensor_heads(file.stream, report);
    for (size_t g = 0; g < report->n_grids; g++) {
        const struct orl_annual_grid *grid = &report->grids[g];
        for (size_t i = grid->first; i < grid->first + grid->count && orl_out_continues(&file);
             i++) {
            const struct orl_vec3 p = sensors[i].position, d = sensors[i].direction;
            put_field(file.stream, grid->name);
            fprintf(file.stream, ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", p.x, p.y, p.z, d.x, d.y, d.z);
            for (size_t k = 0; k < report->n_metrics; k++) {
                const struct orl_annual_value *v = &report->values[k * report->n_sensors + i];
                put_number(file.stream, v->value);
                put_number(file.stream, v->low);
                put_number(file.stream, v->high);
            }
            fputc('\n', file.stream);
        }
    }
    return orl_out_close(&file, 0, err);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

/* Returns the mean over a grid; dark hours have no column. */
static double mean_of(const struct orl_annual_report *report,
                      const struct orl_annual_result *result, size_t g, uint32_t column)
{
    const struct orl_annual_grid *grid = &report->grids[g];
    struct orl_sum sum = {0};
    if (column == ORL_ANNUAL_DARK || grid->count == 0)
        return 0;
    for (size_t i = grid->first; i < grid->first + grid->count; i++)
        orl_sum_add(&sum, orl_annual_row(result, result->total, i)[column]);
    return orl_sum_value(&sum) / (double)grid->count;
}

/* Returns the standard error of the mean over a grid; errors of sensors are independent. */
static double error_of(const struct orl_annual_report *report,
                       const struct orl_annual_result *result, size_t g, uint32_t column)
{
    const struct orl_annual_grid *grid = &report->grids[g];
    struct orl_sum squares = {0};
    if (column == ORL_ANNUAL_DARK || grid->count == 0)
        return 0;
    for (size_t i = grid->first; i < grid->first + grid->count; i++) {
        const double se = (double)orl_annual_row(result, result->se, i)[column];
        orl_sum_add(&squares, se * se);
    }
    return sqrt(orl_sum_value(&squares)) / (double)grid->count;
}

static void put_error_heads(FILE *stream, const struct orl_annual_report *report)
{
    char text[128];
    for (size_t g = 0; g < report->n_grids; g++) {
        snprintf(text, sizeof text, "standard error of %.100s", report->grids[g].name);
        fputc(',', stream);
        put_field(stream, text);
    }
}

static void put_groups(FILE *stream, const struct orl_annual_request *request)
{
    char text[128];
    for (size_t g = 0; g < request->n_groups; g++) {
        snprintf(text, sizeof text, "shades of %.100s", request->groups[g].name);
        fputc(',', stream);
        put_field(stream, text);
    }
}

static void put_states(FILE *stream, const struct orl_annual_request *request,
                       const struct orl_annual_result *result, size_t step)
{
    for (size_t g = 0; g < request->n_groups && result->states; g++) {
        fputc(',', stream);
        put_field(stream,
                  request->groups[g].states[result->states[g * result->n_steps + step]].name);
    }
}

int orl_annual_hours_csv(const char *path, const struct orl_annual_request *request,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, const atomic_bool *cancel,
                         struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    uint32_t step = 0;
    if (code < 0)
        return code;
    file.cancel = cancel;
    fputs("month,day,hour,occupied,sun_altitude_deg,direct_normal_lx,diffuse_lx,global_lx",
          file.stream);
    for (size_t g = 0; g < report->n_grids; g++) {
        fputc(',', file.stream);
        put_field(file.stream, report->grids[g].name);
    }
    if (result->se)
        put_error_heads(file.stream, report);
    put_groups(file.stream, request);
    fputc('\n', file.stream);
    for (size_t row = 0; row < result->n_steps && orl_out_continues(&file); row++) {
        const size_t i = orl_annual_step_of_row(result, row);
        const struct orl_annual_step *s = &result->steps[i];
        step = orl_annual_step_of(&report->year, s);
        fprintf(file.stream, "%d,%d,%.6g,%d,%.4f", s->month, s->day, s->hour, report->marks[step],
                s->sun_altitude_deg);
        put_number(file.stream, s->missing ? NAN : s->direct_normal_lx);
        put_number(file.stream, s->missing ? NAN : s->diffuse_lx);
        put_number(file.stream, s->missing ? NAN : s->global_lx);
        for (size_t g = 0; g < report->n_grids; g++)
            put_number(file.stream, s->missing ? NAN : mean_of(report, result, g, s->column));
        for (size_t g = 0; result->se && g < report->n_grids; g++)
            put_number(file.stream, s->missing ? NAN : error_of(report, result, g, s->column));
        put_states(file.stream, request, result, i);
        fputc('\n', file.stream);
    }
    return orl_out_close(&file, 0, err);
}

int orl_annual_columns_csv(const char *path, const struct orl_annual_report *report,
                           const struct orl_annual_result *result, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const struct orl_annual_timeline *year = &report->year;
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fputs("column,month,day,hour,hour_of_year\n", file.stream);
    for (size_t c = 0; c < result->n_columns && orl_out_continues(&file); c++) {
        const struct orl_annual_step *s = &result->steps[result->step_of_column[c]];
        fprintf(file.stream, "%zu,%d,%d,%.6g,%.10g\n", c, s->month, s->day, s->hour,
                orl_calendar_hour_of_year(&year->steps, year->step_of_column[c]));
    }
    return orl_out_close(&file, 0, err);
}

/* ---- Views out ------------------------------------------------------------------------------- */

static void put_view(FILE *stream, const char *grid, const char *name, struct orl_vec3 at,
                     const struct orl_view_out *view)
{
    put_field(stream, grid);
    fputc(',', stream);
    put_field(stream, name);
    fprintf(stream, ",%.9g,%.9g,%.9g", at.x, at.y, at.z);
    put_number(stream, view->sight_angle_deg);
    put_number(stream, view->distance_m);
    fprintf(stream, ",%d,%d,%d,%s\n", (view->layers & ORL_VIEW_SKY) != 0,
            (view->layers & ORL_VIEW_LANDSCAPE) != 0, (view->layers & ORL_VIEW_GROUND) != 0,
            orl_view_level_name(view->level));
}

int orl_annual_view_out_csv(const char *path, const struct orl_report_request *report_request,
                            const struct orl_annual_report *report,
                            const struct orl_sensor *sensors, struct orl_error *err)
{
    const struct orl_view_out_request *requested = &report_request->view_out;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fputs("grid,point,x,y,z,sight_angle_deg,distance_m,sky,landscape,ground,level\n", file.stream);
    for (size_t i = 0; i < requested->n_points; i++)
        put_view(file.stream, "", requested->points[i].name, requested->points[i].at,
                 &report->views[i]);
    for (size_t g = 0; report->view_shares && g < report->n_grids; g++) {
        const struct orl_annual_grid *grid = &report->grids[g];
        for (size_t i = grid->first; i < grid->first + grid->count; i++) {
            struct orl_vec3 at = sensors[i].position;
            at.z += requested->above_sensors;
            put_view(file.stream, grid->name, "", at, &report->views[requested->n_points + i]);
        }
    }
    return orl_out_close(&file, 0, err);
}

/* ---- Glare ----------------------------------------------------------------------------------- */

static void put_viewpoints(FILE *stream, const struct orl_viewpoint_request *requested)
{
    static const char *const of[] = {"DGP", "low_95", "high_95", "eye (lx)"};
    char text[96];
    for (size_t i = 0; i < requested->n_viewpoints; i++)
        for (int k = 0; k < 4; k++) {
            snprintf(text, sizeof text, "%s: %s", requested->viewpoints[i].name, of[k]);
            fputc(',', stream);
            put_field(stream, text);
        }
    fputc('\n', stream);
}

int orl_annual_glare_csv(const char *path, const struct orl_report_request *report_request,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fputs("month,day,hour", file.stream);
    put_viewpoints(file.stream, &report_request->glare);
    for (size_t c = 0; c < result->n_columns; c++) {
        const struct orl_annual_step *s = &result->steps[result->step_of_column[c]];
        if (isnan(report->viewpoint_hours[0].dgp[c]))
            continue;
        fprintf(file.stream, "%d,%d,%.6g", s->month, s->day, s->hour);
        for (size_t i = 0; i < report->n_viewpoints; i++) {
            const struct orl_viewpoint_hours *h = &report->viewpoint_hours[i];
            fprintf(file.stream, ",%.4f,%.4f,%.4f,%.5g", (double)h->dgp[c], (double)h->low[c],
                    (double)h->high[c], (double)h->eye_lx[c]);
        }
        fputc('\n', file.stream);
    }
    return orl_out_close(&file, 0, err);
}
