/* Tables of a year, with one line per sensor or per hour, and Radiance matrix files. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
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

/* Writes a Radiance matrix of one or of three equal components. */
static int write_matrix(const char *path, const float *values, size_t rows, size_t columns,
                        int components, bool ascii, const atomic_bool *cancel,
                        struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    fprintf(file.stream, "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=%d\n", rows, columns, components);
    if (!ascii)
        fprintf(file.stream, "BigEndian=%d\n", big);
    fprintf(file.stream, "FORMAT=%s\n\n", ascii ? "ascii" : "float");
    if (ascii)
        write_ascii(&file, values, rows, columns);
    else if (components == 1)
        orl_out_floats(&file, values, rows * columns);
    else
        write_grey(&file, values, rows * columns);
    return orl_out_close(&file, 0, err);
}

int orl_coefficients_write(const char *path, const float *values, size_t rows, size_t columns,
                           const atomic_bool *cancel, struct orl_error *err)
{
    return write_matrix(path, values, rows, columns, 3, false, cancel, err);
}

int orl_matrix_write(const char *path, const float *values, size_t rows, size_t columns, bool ascii,
                     const atomic_bool *cancel, struct orl_error *err)
{
    return write_matrix(path, values, rows, columns, 1, ascii, cancel, err);
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

/* Writes the first quoted field of a line; quotes inside are doubled. */
static void put_first(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', stream);
        fputc(*text, stream);
    }
    fputc('"', stream);
}

/* Writes another quoted field, formatted as by printf. */
__attribute__((format(printf, 2, 3))) static void put_field(FILE *stream, const char *format, ...)
{
    char *text = NULL;
    va_list args;
    va_start(args, format);
    const bool made = vasprintf(&text, format, args) >= 0;
    va_end(args);
    fputc(',', stream);
    if (made)
        put_first(stream, text);
    free(made ? text : NULL);
}

/* ---- Sensors --------------------------------------------------------------------------------- */

static void write_sensor_heads(FILE *stream, const struct orl_annual_report *report)
{
    fputs("grid,x,y,z,dx,dy,dz", stream);
    for (size_t k = 0; k < report->n_metrics; k++) {
        const struct orl_annual_metric *metric = &report->metrics[k];
        char name[64];
        orl_annual_metric_name(metric, name, sizeof name);
        put_field(stream, "%s (%s)", name, orl_annual_unit(metric->kind));
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
            put_first(file.stream, grid->name);
            fprintf(file.stream, ",%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", p.x, p.y, p.z, d.x, d.y, d.z);
            for (size_t k = 0; k < report->n_metrics; k++) {
                const struct orl_annual_value *v = &report->values[k * report->n_sensors + i];
                orl_out_number(file.stream, v->value);
                orl_out_number(file.stream, v->low);
                orl_out_number(file.stream, v->high);
            }
            fputc('\n', file.stream);
        }
    }
    return orl_out_close(&file, 0, err);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

/* Writes a column's mean over each grid, or the standard error of that mean; errors of sensors are
 * independent. Dark hours have no column. */
static void put_means(FILE *stream, const struct orl_annual_report *report,
                      const struct orl_annual_result *result, const struct orl_annual_step *step,
                      bool errors)
{
    const float *values = errors ? result->se : result->total;
    for (size_t g = 0; g < report->n_grids; g++) {
        const struct orl_annual_grid *grid = &report->grids[g];
        const bool dark = step->column == ORL_ANNUAL_DARK || grid->count == 0;
        struct orl_sum sum = {0};
        for (size_t i = grid->first; !dark && i < grid->first + grid->count; i++) {
            const double lx = orl_annual_row(result, values, i)[step->column];
            orl_sum_add(&sum, errors ? lx * lx : lx);
        }
        const double mean = errors ? sqrt(orl_sum_value(&sum)) : orl_sum_value(&sum);
        orl_out_number(stream, step->missing ? NAN : dark ? 0 : mean / (double)grid->count);
    }
}

int orl_annual_hours_csv(const char *path, const struct orl_annual_request *request,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, const atomic_bool *cancel,
                         struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    fputs("month,day,hour,occupied,sun_altitude_deg,direct_normal_lx,diffuse_lx,global_lx",
          file.stream);
    for (size_t g = 0; g < report->n_grids; g++)
        put_field(file.stream, "%s", report->grids[g].name);
    for (size_t g = 0; result->se && g < report->n_grids; g++)
        put_field(file.stream, "standard error of %.100s", report->grids[g].name);
    for (size_t g = 0; g < request->n_groups; g++)
        put_field(file.stream, "shades of %.100s", request->groups[g].name);
    fputc('\n', file.stream);
    for (size_t row = 0; row < result->n_steps && orl_out_continues(&file); row++) {
        const size_t i = orl_annual_step_of_row(result, row);
        const struct orl_annual_step *s = &result->steps[i];
        fprintf(file.stream, "%d,%d,%.6g,%d,%.4f", s->month, s->day, s->hour,
                report->marks[orl_annual_step_of(&report->year, s)], s->sun_altitude_deg);
        orl_out_number(file.stream, s->missing ? NAN : s->direct_normal_lx);
        orl_out_number(file.stream, s->missing ? NAN : s->diffuse_lx);
        orl_out_number(file.stream, s->missing ? NAN : s->global_lx);
        put_means(file.stream, report, result, s, false);
        if (result->se)
            put_means(file.stream, report, result, s, true);
        for (size_t g = 0; g < request->n_groups && result->states; g++)
            put_field(file.stream, "%s",
                      request->groups[g].states[result->states[g * result->n_steps + i]].name);
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
    put_first(stream, grid);
    put_field(stream, "%s", name);
    fprintf(stream, ",%.9g,%.9g,%.9g", at.x, at.y, at.z);
    orl_out_number(stream, view->sight_angle_deg);
    orl_out_number(stream, view->distance_m);
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
    for (size_t i = 0; i < requested->n_viewpoints; i++)
        for (int k = 0; k < 4; k++)
            put_field(stream, "%s: %s", requested->viewpoints[i].name, of[k]);
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
