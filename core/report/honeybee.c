/* Writes a results folder in the layout of Honeybee's annual daylight. */
#include <oriel/annual/annual_report.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/io/out_file.h"
#include "metrics/annual/annual_figures.h"

#define LIGHT_PATH "__static_apertures__"
enum { PATH_SIZE = 4096, NAME_SIZE = 128 };

struct folder_writer {
    const char *folder;
    const struct orl_annual_report *report;
    const struct orl_annual_result *result;
    int (*named)(void *ctx, const char *name, struct orl_error *err);
    void *ctx;
    const atomic_bool *cancel;
    struct orl_error *err;
};

static int path_in(const struct folder_writer *w, char ret_path[PATH_SIZE], const char *name)
{
    if (snprintf(ret_path, PATH_SIZE, "%s/%s", w->folder, name) < PATH_SIZE)
        return 0;
    return orl_error_set(w->err, ORL_ERR_LIMIT, "the path '%s' is too long", w->folder);
}

/* Builds the path of a file that will be written, and passes its name to `named`. */
static int name_file(const struct folder_writer *w, char ret_path[PATH_SIZE], const char *name)
{
    const int code = w->named ? w->named(w->ctx, name, w->err) : 0;
    return code < 0 ? code : path_in(w, ret_path, name);
}

static int open_file(const struct folder_writer *w, struct orl_out_file *file, const char *name)
{
    char path[PATH_SIZE];
    const int code = name_file(w, path, name);
    return code < 0 ? code : orl_out_open(file, path, w->err);
}

/* Builds the name of a grid's file: a folder, the grid's name and an ending. */
static void name_grid_file(const struct orl_annual_grid *grid, const char *folder,
                           const char *ending, char ret_name[PATH_SIZE / 2])
{
    char file[NAME_SIZE];
    orl_annual_file_name(grid->name, file, sizeof file);
    snprintf(ret_name, PATH_SIZE / 2, "%s/%s.%s", folder, file, ending);
}

/* Makes a folder; its parents must exist. */
static int make_folder(const struct folder_writer *w, const char *name)
{
    char path[PATH_SIZE];
    const int code = path_in(w, path, name);
    if (code < 0 || mkdir(path, 0777) == 0 || errno == EEXIST)
        return code;
    return orl_error_set(w->err, orl_err_of_errno(errno), "cannot make the folder '%s': %s", path,
                         strerror(errno));
}

/* Writes a JSON string; names are UTF-8 already. */
static void put_string(FILE *stream, const char *text)
{
    fputc('"', stream);
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            fprintf(stream, "\\%c", c);
        else if (c < 0x20)
            fprintf(stream, "\\u%04x", c);
        else
            fputc(c, stream);
    }
    fputc('"', stream);
}

/* ---- Description of the folder --------------------------------------------------------------- */

static void put_grids_info(FILE *stream, const struct folder_writer *w)
{
    const struct orl_annual_report *report = w->report;
    fputs("[", stream);
    for (size_t g = 0; g < report->n_grids; g++) {
        char file[NAME_SIZE];
        orl_annual_file_name(report->grids[g].name, file, sizeof file);
        fprintf(stream, "%s\n  {\"count\": %zu, \"name\": ", g ? "," : "", report->grids[g].count);
        put_string(stream, report->grids[g].name);
        fprintf(stream,
                ", \"identifier\": \"%s\", \"group\": \"\", \"full_id\": \"%s\", \"light_path\": "
                "[[\"" LIGHT_PATH "\"]]}",
                file, file);
    }
    fputs("\n]\n", stream);
}

static void put_grid_states(FILE *stream, const struct folder_writer *w)
{
    fputs("{", stream);
    for (size_t g = 0; g < w->report->n_grids; g++) {
        char file[NAME_SIZE];
        orl_annual_file_name(w->report->grids[g].name, file, sizeof file);
        fprintf(stream, "%s\"%s\": {\"" LIGHT_PATH "\": [\"default\"]}", g ? ", " : "", file);
    }
    fputs("}\n", stream);
}

static void put_sun_up_hours(FILE *stream, const struct folder_writer *w)
{
    const struct orl_annual_timeline *year = &w->report->year;
    for (size_t i = 0; i < year->n_columns; i++)
        fprintf(stream, "%.10g\n",
                orl_calendar_hour_of_year(&year->steps, year->step_of_column[i]));
}

static void put_study_info(FILE *stream, const struct folder_writer *w)
{
    const struct orl_annual_steps *steps = &w->report->year.steps;
    fprintf(stream, "{\"timestep\": %u, \"study_hours\": [", steps->per_hour);
    for (uint32_t i = 0; i < steps->count; i++)
        fprintf(stream, "%s%.10g", i ? ", " : "", orl_calendar_hour_of_year(steps, i));
    fputs("]}\n", stream);
}

static int write_with(const struct folder_writer *w, const char *name,
                      void (*put)(FILE *stream, const struct folder_writer *w))
{
    struct orl_out_file file = {.stream = NULL};
    const int code = open_file(w, &file, name);
    if (code < 0)
        return code;
    put(file.stream, w);
    return orl_out_close(&file, 0, w->err);
}

/* ---- Series ---------------------------------------------------------------------------------- */

/* Standard errors are in a third folder next to the values. Honeybee-radiance-postprocess reads a
 * folder of series by its name alone, and requests "total" and "direct". */
static int write_series(const struct folder_writer *w)
{
    const struct orl_annual_result *result = w->result;
    const struct {
        const char *name;
        const float *values; /* NULL: unknown */
    } series[] = {{"total", result->total}, {"direct", result->direct}, {"se", result->se}};
    int code = make_folder(w, LIGHT_PATH);
    if (code == 0)
        code = make_folder(w, LIGHT_PATH "/default");
    for (size_t i = 0; i < sizeof series / sizeof *series && code == 0; i++) {
        char folder[64];
        if (!series[i].values)
            continue;
        snprintf(folder, sizeof folder, LIGHT_PATH "/default/%s", series[i].name);
        code = make_folder(w, folder);
        for (size_t g = 0; g < w->report->n_grids && code == 0; g++) {
            const struct orl_annual_grid *grid = &w->report->grids[g];
            char path[PATH_SIZE], file[PATH_SIZE / 2];
            name_grid_file(grid, folder, "npy", file);
            code = name_file(w, path, file);
            if (code == 0)
                code = orl_npy_write(path, orl_annual_row(result, series[i].values, grid->first),
                                     grid->count, result->n_columns, w->cancel, w->err);
        }
    }
    return code;
}

/* ---- Metrics --------------------------------------------------------------------------------- */

/* Metrics with Honeybee's thresholds, independent of those requested from the report. */
static const struct {
    const char *name, *ending;
    int digits;
    struct orl_annual_metric metric;
} kinds[] = {
    {"da", "da", 2, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}},
    {"cda", "cda", 2, {ORL_METRIC_CDA, ORL_WHEN_OCCUPIED, 300, 0}},
    {"udi", "udi", 2, {ORL_METRIC_UDI, ORL_WHEN_OCCUPIED, 100, 3000}},
    {"udi_lower", "udi", 2, {ORL_METRIC_UDI_LOWER, ORL_WHEN_OCCUPIED, 100, 0}},
    {"udi_upper", "udi", 2, {ORL_METRIC_UDI_UPPER, ORL_WHEN_OCCUPIED, 3000, 0}},
    {"hours_above", "res", 0, {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0}},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static int write_metric(const struct folder_writer *w, size_t kind,
                        const struct orl_annual_grid *grid)
{
    struct orl_out_file file = {.stream = NULL};
    char folder[64], name[PATH_SIZE / 2];
    snprintf(folder, sizeof folder, "metrics/%s", kinds[kind].name);
    name_grid_file(grid, folder, kinds[kind].ending, name);
    const int code = open_file(w, &file, name);
    if (code < 0)
        return code;
    file.cancel = w->cancel;
    for (size_t i = grid->first; i < grid->first + grid->count && orl_out_continues(&file); i++) {
        const struct orl_annual_light light = {
            .total_lx = orl_annual_row(w->result, w->result->total, i),
            .direct_lx = orl_annual_row(w->result, w->result->direct, i)};
        fprintf(file.stream, "%.*f\n", kinds[kind].digits,
                orl_annual_evaluate_at(&kinds[kind].metric, &w->report->periods[ORL_WHEN_OCCUPIED],
                                       &light, 0));
    }
    return orl_out_close(&file, 0, w->err);
}

static int write_metrics(const struct folder_writer *w)
{
    int code = make_folder(w, "metrics");
    for (size_t k = 0; k < KINDS && code == 0; k++) {
        char name[64];
        snprintf(name, sizeof name, "metrics/%s", kinds[k].name);
        code = make_folder(w, name);
        snprintf(name, sizeof name, "metrics/%s/grids_info.json", kinds[k].name);
        if (code == 0)
            code = write_with(w, name, put_grids_info);
        for (size_t g = 0; g < w->report->n_grids && code == 0; g++)
            code = write_metric(w, k, &w->report->grids[g]);
    }
    return code;
}

/* Writes the report's second figure: one number per grid. */
static int write_ase(const struct folder_writer *w)
{
    const size_t places = w->report->n_grids + 1;
    int code = make_folder(w, "metrics/ase");
    if (code == 0)
        code = write_with(w, "metrics/ase/grids_info.json", put_grids_info);
    for (size_t g = 0; g < w->report->n_grids && code == 0; g++) {
        struct orl_out_file file = {.stream = NULL};
        char name[PATH_SIZE / 2];
        name_grid_file(&w->report->grids[g], "metrics/ase", "ase", name);
        code = open_file(w, &file, name);
        if (code < 0)
            return code;
        fprintf(file.stream, "%.2f", w->report->areas[places + g].value.value);
        code = orl_out_close(&file, 0, w->err);
    }
    return code;
}

static void put_summary(FILE *stream, const struct folder_writer *w)
{
    const struct orl_annual_report *report = w->report;
    const size_t places = report->n_grids + 1;
    fputs("[", stream);
    for (size_t g = 0; g < report->n_grids; g++) {
        const struct orl_annual_value *sda = &report->areas[g].value;
        const struct orl_annual_value *ase = &report->areas[places + g].value;
        fprintf(stream, "%s\n  {\"Sensor Grid\": ", g ? "," : "");
        put_string(stream, report->grids[g].name);
        fprintf(stream, ", \"Sensor Count\": %zu, \"sDA\": %.2f, \"ASE\": %.2f}",
                report->grids[g].count, sda->value, ase->value);
    }
    fputs("\n]\n", stream);
}

int orl_honeybee_write_hours(const char *folder, const struct orl_annual_report *report,
                             const struct orl_annual_result *result,
                             int (*named)(void *ctx, const char *name, struct orl_error *err),
                             void *ctx, const atomic_bool *cancel, struct orl_error *err)
{
    static const struct {
        const char *name;
        void (*put)(FILE *stream, const struct folder_writer *w);
    } files[] = {{"grids_info.json", put_grids_info},
                 {"grid_states.json", put_grid_states},
                 {"sun-up-hours.txt", put_sun_up_hours},
                 {"study_info.json", put_study_info}};
    const struct folder_writer w = {folder, report, result, named, ctx, cancel, err};
    int code = make_folder(&w, "");
    for (size_t i = 0; i < sizeof files / sizeof *files && code == 0; i++)
        code = write_with(&w, files[i].name, files[i].put);
    return code ? code : write_series(&w);
}

int orl_honeybee_write(const char *folder, const struct orl_annual_report *report,
                       const struct orl_annual_result *result,
                       int (*named)(void *ctx, const char *name, struct orl_error *err), void *ctx,
                       const atomic_bool *cancel, struct orl_error *err)
{
    const struct folder_writer w = {folder, report, result, named, ctx, cancel, err};
    int code = orl_honeybee_write_hours(folder, report, result, named, ctx, cancel, err);
    if (code == 0)
        code = write_metrics(&w);
    if (code == 0)
        code = write_ase(&w);
    if (code == 0)
        code = write_with(&w, "metrics/summary.json", put_summary);
    return code;
}
