/* Inputs of a year: requests of reports, sensors of grids, and a record of every file that was
 * read. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/limits.h>
#include <oriel/base/sha256.h>
#include <oriel/base/thread_pool.h>

#include "annual/sky/hours.h"
#include "base/memory/memory.h"
#include "light/daylight/weather.h"
#include "report/report_internal.h"
#include "run/request/job_inputs.h"

/* ---- Requests: defaults and freeing ---------------------------------------------------------- */

static const struct orl_annual_metric usual_metrics[] = {
    {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0},
    {ORL_METRIC_CDA, ORL_WHEN_OCCUPIED, 300, 0},
    {ORL_METRIC_UDI_LOWER, ORL_WHEN_OCCUPIED, 100, 0},
    {ORL_METRIC_UDI_PART, ORL_WHEN_OCCUPIED, 100, 300},
    {ORL_METRIC_UDI, ORL_WHEN_OCCUPIED, 300, 3000},
    {ORL_METRIC_UDI, ORL_WHEN_OCCUPIED, 100, 3000},
    {ORL_METRIC_UDI_UPPER, ORL_WHEN_OCCUPIED, 3000, 0},
    {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0},
    {ORL_METRIC_MEAN, ORL_WHEN_OCCUPIED, 0, 0},
    {ORL_METRIC_CUMULATIVE, ORL_WHEN_ALWAYS, 0, 0},
};
enum { USUAL = sizeof usual_metrics / sizeof *usual_metrics };

int orl_report_request_init(struct orl_report_request *report_request)
{
    *report_request = (struct orl_report_request){.n_metrics = 0};
    orl_occupancy_init(&report_request->occupancy);
    orl_view_out_request_init(&report_request->view_out);
    report_request->metrics = malloc(sizeof usual_metrics);
    if (!report_request->metrics)
        return ORL_ERR_NOMEM;
    memcpy(report_request->metrics, usual_metrics, sizeof usual_metrics);
    report_request->n_metrics = USUAL;
    return 0;
}

void orl_report_request_done(struct orl_report_request *report_request)
{
    if (!report_request)
        return;
    free(report_request->occupancy_file);
    free(report_request->metrics);
    free(report_request->targets);
    free(report_request->rules);
    free(report_request->grid_area);
    free(report_request->until);
    orl_exposure_request_done(&report_request->exposure);
    orl_view_out_request_done(&report_request->view_out);
    orl_viewpoint_request_done(&report_request->glare);
    *report_request = (struct orl_report_request){.n_metrics = 0};
}

/* ---- Checks for matrices --------------------------------------------------------------------- */

static bool needs_factors(const struct orl_annual_rule *rule)
{
    for (size_t i = 0; i < ORL_RULE_TARGETS && rule->targets[i]; i++) {
        struct orl_annual_target target;
        if (orl_annual_target_parse(rule->targets[i], &target, NULL) == 0 &&
            target.figure.metric.kind == ORL_METRIC_DF)
            return true;
    }
    return false;
}

int orl_report_check_matrices(const struct orl_report_request *report_request,
                              struct orl_error *err)
{
    bool factors = false;
    for (size_t i = 0; i < report_request->n_metrics; i++)
        factors = factors || report_request->metrics[i].kind == ORL_METRIC_DF;
    for (size_t i = 0; i < report_request->n_targets; i++)
        factors = factors || report_request->targets[i].figure.metric.kind == ORL_METRIC_DF;
    for (size_t i = 0; i < report_request->n_rules; i++)
        factors = factors || needs_factors(&report_request->rules[i]);
    if (factors)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "daylight factors need path tracing: a year computed from matrices has none");
    if (report_request->until)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "results from matrices have no error estimates, so no accuracy can be requested");
    return 0;
}

/* ---- Grids ----------------------------------------------------------------------------------- */

/* Sensors of all grids, grid by grid. */
struct sensor_list {
    struct orl_sensor *items;
    size_t count, capacity;
};

static int append_sensors(struct sensor_list *list, const struct orl_sensor *more, size_t n,
                          struct orl_error *err)
{
    if (n > ORL_LIMIT_SENSORS - list->count)
        return orl_error_set(err, ORL_ERR_LIMIT, "the grids have more than %lu sensors",
                             ORL_LIMIT_SENSORS);
    if (!orl_array_reserve_more(&list->items, &list->capacity, list->count, n + 1, sizeof *more))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu sensors", list->count + n);
    if (n > 0)
        memcpy(list->items + list->count, more, n * sizeof *more);
    list->count += n;
    return 0;
}

int orl_annual_grids_read(struct orl_annual_request *request, char *const *names,
                          const struct orl_files *files, const atomic_bool *cancel,
                          struct orl_error *err)
{
    struct sensor_list list = {.items = NULL};
    int code = 0;
    for (size_t g = 0; g < request->n_grids && code == 0; g++) {
        struct orl_annual_grid *grid = &request->grids[g];
        struct orl_sensor *read = NULL;
        size_t n = grid->count;
        if (names[g])
            code = orl_sensors_load(files, names[g], cancel, &read, &n, err);
        const size_t first = list.count;
        if (code == 0)
            code = append_sensors(&list, names[g] ? read : request->sensors + grid->first, n, err);
        grid->first = first;
        grid->count = n;
        free(read);
        if (code == 0 && orl_is_cancelled(cancel))
            code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading grids");
    }
    if (code < 0) {
        free(list.items);
        return code;
    }
    free(request->sensors);
    request->sensors = list.items;
    request->n_sensors = list.count;
    return 0;
}

/* ---- Checks before any run ------------------------------------------------------------------- */

/* Converts the times of the rows to a year's steps. */
static int steps_of(const struct orl_weather *weather, struct orl_annual_steps *ret_steps,
                    struct orl_error *err)
{
    struct orl_annual_result times = {.n_steps = weather->n_rows};
    struct orl_annual_timeline year = {.measured = NULL};
    times.steps = calloc(weather->n_rows + 1, sizeof *times.steps);
    if (!times.steps)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < weather->n_rows; i++) {
        const struct orl_weather_row *row = &weather->rows[i];
        times.steps[i] = (struct orl_annual_step){.month = row->month,
                                                  .day = row->day,
                                                  .hour = row->hour,
                                                  .missing = row->missing,
                                                  .column = ORL_ANNUAL_DARK};
    }
    const int code = orl_annual_timeline_make(&times, &year, err);
    if (code == 0)
        *ret_steps = year.steps;
    orl_annual_timeline_done(&year);
    free(times.steps);
    return code;
}

int orl_annual_weather_check(const char *name, const char *text, size_t size, int year_chosen,
                             struct orl_annual_steps *ret_steps, size_t *ret_rows,
                             struct orl_error *err)
{
    struct orl_weather weather = {0};
    int code = orl_weather_parse(name, text, size, year_chosen, &weather, err);
    if (code < 0)
        return code;
    const size_t rows = weather.n_rows;
    if (rows > ORL_HOURS_MOST)
        code = orl_error_set(
            err, ORL_ERR_LIMIT,
            "the weather file has %zu rows, but a year has at most %d (10-minute steps)", rows,
            ORL_HOURS_MOST);
    else
        code = steps_of(&weather, ret_steps, err);
    orl_weather_done(&weather);
    if (code < 0)
        orl_error_at(err, name, 0, NULL);
    else
        *ret_rows = rows;
    return code;
}

int orl_occupancy_check(const char *name, const char *text, size_t size,
                        const struct orl_annual_steps *steps, struct orl_error *err)
{
    unsigned char *marks = malloc(steps->count + (size_t)1);
    if (!marks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    const int code = orl_occupancy_read(name, text, size, steps, marks, err);
    free(marks);
    return code;
}

/* ---- Record of files ------------------------------------------------------------------------- */

/* Returns the index of a name in the sorted list, or where to insert it. */
static size_t place_of(const struct orl_annual_inputs *inputs, const char *name)
{
    size_t low = 0, high = inputs->count;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (strcmp(inputs->items[middle].name, name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool has_name(const struct orl_annual_inputs *inputs, size_t at, const char *name)
{
    return at < inputs->count && strcmp(inputs->items[at].name, name) == 0;
}

static int insert_input(struct orl_annual_inputs *inputs, const char *name, uint64_t bytes,
                        const char *digest, struct orl_error *err)
{
    const size_t at = place_of(inputs, name);
    if (has_name(inputs, at, name))
        return 0;
    struct orl_annual_input item = {.name = strdup(name), .bytes = bytes};
    if (!item.name ||
        !orl_array_reserve(&inputs->items, &inputs->room, inputs->count, sizeof *inputs->items)) {
        free(item.name);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    snprintf(item.digest, sizeof item.digest, "%s", digest);
    memmove(inputs->items + at + 1, inputs->items + at,
            (inputs->count - at) * sizeof *inputs->items);
    inputs->items[at] = item;
    inputs->count++;
    return 0;
}

static int record_file(struct orl_annual_inputs *inputs, const char *name,
                       const struct orl_file *file, struct orl_error *err)
{
    unsigned char digest[ORL_SHA256_BYTES];
    char hex[ORL_DIGEST_HEX + 1];
    if (has_name(inputs, place_of(inputs, name), name))
        return 0;
    const struct orl_files *files = inputs->files;
    if (!files->digest || !files->digest(files->ctx, name, digest))
        orl_sha256(file->data, file->size, digest);
    sodium_bin2hex(hex, sizeof hex, digest, sizeof digest);
    return insert_input(inputs, name, file->size, hex, err);
}

static int recording_open(void *ctx, const char *name, struct orl_file *ret_file,
                          struct orl_error *err)
{
    struct orl_annual_inputs *inputs = ctx;
    int code = inputs->files->open(inputs->files->ctx, name, ret_file, err);
    if (code < 0)
        return code;
    code = record_file(inputs, name, ret_file, err);
    if (code < 0)
        inputs->files->close(inputs->files->ctx, ret_file);
    return code;
}

static void recording_close(void *ctx, struct orl_file *file)
{
    const struct orl_annual_inputs *inputs = ctx;
    inputs->files->close(inputs->files->ctx, file);
}

static bool recording_digest(void *ctx, const char *name,
                             unsigned char ret_digest[ORL_SHA256_BYTES])
{
    const struct orl_annual_inputs *inputs = ctx;
    return inputs->files->digest(inputs->files->ctx, name, ret_digest);
}

static void recording_passed(void *ctx, const struct orl_file *file, size_t begin, size_t end)
{
    const struct orl_annual_inputs *inputs = ctx;
    inputs->files->passed(inputs->files->ctx, file, begin, end);
}

static bool recording_other_case(void *ctx, const char *name, char *ret_name, size_t size)
{
    const struct orl_annual_inputs *inputs = ctx;
    return inputs->files->other_case(inputs->files->ctx, name, ret_name, size);
}

int orl_annual_inputs_ensure(struct orl_annual_inputs *inputs, const char *name,
                             struct orl_error *err)
{
    struct orl_file file;
    if (has_name(inputs, place_of(inputs, name), name))
        return 0;
    const int code = recording_open(inputs, name, &file, err);
    if (code == 0)
        recording_close(inputs, &file);
    return code;
}

struct orl_files orl_annual_inputs_provider(struct orl_annual_inputs *inputs,
                                            const struct orl_files *files)
{
    *inputs = (struct orl_annual_inputs){.files = files};
    return (struct orl_files){.ctx = inputs,
                              .open = recording_open,
                              .close = recording_close,
                              .digest = files->digest ? recording_digest : NULL,
                              .passed = files->passed ? recording_passed : NULL,
                              .other_case = files->other_case ? recording_other_case : NULL};
}

void orl_annual_inputs_done(struct orl_annual_inputs *inputs)
{
    if (!inputs)
        return;
    for (size_t i = 0; i < inputs->count; i++)
        free(inputs->items[i].name);
    free(inputs->items);
    *inputs = (struct orl_annual_inputs){.count = 0};
}
