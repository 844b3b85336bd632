#include "recipe/recipe_run.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json/encode.h"

enum { HOURS = 8760, LEAP_HOURS = 8784 };
#define SCHEDULE_FILE "recipe_schedule.txt"

/* ---- Files of the recipe --------------------------------------------------------------------- */

/* Writes the schedule as a file of occupancy: 0 or 1 for each step. Honeybee's values count as
 * whole numbers, so that 0.5 is not in use. */
static int put_schedule(const struct orl_recipe_texts *texts, unsigned per_hour, FILE *stream,
                        struct orl_error *err)
{
    const char *at = texts->schedule, *const end = at + texts->schedule_size;
    size_t hours = 0;
    while (at < end) {
        char line[64], *rest;
        const char *newline = memchr(at, '\n', (size_t)(end - at));
        snprintf(line, sizeof line, "%.*s", (int)((newline ? newline : end) - at), at);
        at = newline ? newline + 1 : end;
        if (line[strspn(line, " \t\r")] == '\0')
            continue;
        const double value = strtod(line, &rest);
        if (rest == line || !isfinite(value))
            return orl_error_set(err, ORL_ERR_SYNTAX, "schedule: hour %zu is no number: '%.20s'",
                                 hours + 1, line);
        hours++;
        for (unsigned i = 0; i < per_hour; i++)
            fprintf(stream, "%d\n", value >= 1);
    }
    if (hours == HOURS || hours == LEAP_HOURS)
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE,
                         "schedule: a year of 8760 hours is expected, not %zu lines", hours);
}

static int add_schedule(struct orl_recipe_run *run, const struct orl_recipe_texts *texts,
                        struct orl_error *err)
{
    const double timestep = orl_recipe_number(run->inputs, "timestep");
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return orl_error_no_memory(err);
    int rc = put_schedule(texts, timestep > 1 ? (unsigned)timestep : 1, stream, err);
    fclose(stream);
    if (rc == 0 && json_object_set_new(run->files, SCHEDULE_FILE, json_string(text)))
        rc = orl_error_no_memory(err);
    free(text);
    return rc;
}

/* Compares the weather's rows with the input "timestep". */
static int check_timestep(const struct orl_recipe_run *run, struct orl_error *err)
{
    const struct orl_weather_rows *weather = &run->weather;
    const double timestep = orl_recipe_number(run->inputs, "timestep");
    const double wanted = isnan(timestep) ? 1 : timestep;
    if (weather->count < 2)
        return 0;
    double step_h = weather->rows[1].hour - weather->rows[0].hour;
    if (step_h <= 0 || step_h > 1.01 || fabs(step_h * wanted - 1) < 0.01)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "the weather file has %.4g rows per hour, not %.4g",
                  1 / step_h, wanted);
    if (!isnan(timestep))
        orl_error_hint(err, "timestep: give the rows per hour that the file has");
    return ORL_ERR_INVALID;
}

static int read_texts(struct orl_recipe_run *run, const struct orl_recipe_texts *texts,
                      struct orl_error *err)
{
    int rc = 0;
    if (texts->model) {
        run->model = json_deep_copy(texts->model);
        rc = run->model ? orl_model_grids_read(run->model, &run->grids, err)
                        : orl_error_no_memory(err);
    }
    if (rc == 0 && texts->weather)
        rc = orl_weather_rows_read(orl_recipe_weather(run->inputs), texts->weather,
                                   texts->weather_size, &run->weather, err);
    if (rc == 0 && texts->weather)
        rc = check_timestep(run, err);
    if (rc == 0 && texts->schedule)
        rc = add_schedule(run, texts, err);
    return rc;
}

/* ---- Runs ------------------------------------------------------------------------------------ */

int orl_recipe_run_new(const struct orl_recipe *recipe, const json_t *inputs,
                       const struct orl_recipe_texts *texts, const char *folder,
                       struct orl_recipe_run **ret_run, struct orl_error *err)
{
    struct orl_recipe_run *run = calloc(1, sizeof *run);
    if (!run)
        return orl_error_no_memory(err);
    run->recipe = recipe;
    run->grids.metres = 1;
    run->inputs = json_deep_copy(inputs);
    run->files = json_object();
    snprintf(run->out.path, sizeof run->out.path, "%s", folder);
    int rc = run->inputs && run->files ? read_texts(run, texts, err) : orl_error_no_memory(err);
    if (rc == 0)
        rc = recipe->make_jobs(run, err);
    if (rc)
        orl_recipe_run_free(run);
    else
        *ret_run = run;
    return rc;
}

void orl_recipe_run_free(struct orl_recipe_run *run)
{
    if (!run)
        return;
    for (size_t i = 0; i < ORL_RECIPE_MOST_JOBS; i++) {
        json_decref(run->documents[i]);
        free(run->kept[i]);
    }
    orl_model_grids_done(&run->grids);
    orl_weather_rows_done(&run->weather);
    json_decref(run->inputs);
    json_decref(run->model);
    json_decref(run->files);
    free(run);
}

size_t orl_recipe_job_count(const struct orl_recipe_run *run)
{
    return run->n_jobs;
}

json_t *orl_recipe_job_document(const struct orl_recipe_run *run, size_t job)
{
    return run->documents[job];
}

const json_t *orl_recipe_job_files(const struct orl_recipe_run *run)
{
    return run->files;
}

int orl_recipe_take_result(struct orl_recipe_run *run, size_t job, const struct orl_job *request,
                           const struct orl_result *result, const char *output,
                           struct orl_error *err)
{
    run->render = request;
    run->output = output;
    const int rc = run->recipe->take_result(run, job, result, err);
    run->render = NULL;
    run->output = NULL;
    return rc;
}

int orl_recipe_take_year(struct orl_recipe_run *run, size_t job,
                         const struct orl_annual_job *request,
                         const struct orl_annual_result *result,
                         const struct orl_annual_report *report, const atomic_bool *cancel,
                         struct orl_error *err)
{
    run->job = request;
    run->result = result;
    run->report = report;
    run->cancel = cancel;
    const int rc = run->recipe->take_year(run, job, err);
    run->job = NULL;
    run->result = NULL;
    run->report = NULL;
    return rc;
}

/* ---- Filters --------------------------------------------------------------------------------- */

/* Removes elements whose names do not match the pattern, where '*' matches folders, too. */
static int filter_list(json_t *list, const char *pattern, const char *what, struct orl_error *err)
{
    for (size_t i = json_array_size(list); i-- > 0;) {
        const char *name = json_string_value(json_object_get(json_array_get(list, i), "name"));
        if (name && fnmatch(pattern, name, 0) != 0)
            json_array_remove(list, i);
    }
    if (json_array_size(list) > 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "the model has no %s that match '%.100s'", what, pattern);
    orl_error_hint(err, "`oriel project MODEL` lists the names");
    return ORL_ERR_INVALID;
}

/* Removes grids or views that the pattern leaves out, or all where the recipe has no pattern. */
static int filter_part(json_t *document, const char *part, const char *pattern,
                       struct orl_error *err)
{
    json_t *list = json_object_get(document, part);
    if (!pattern) { /* the recipe does not use them */
        json_object_del(document, part);
        return 0;
    }
    if (json_array_size(list) > 0)
        return filter_list(list, pattern, part, err);
    orl_error_set(err, ORL_ERR_INVALID, "the model has no %s, which this recipe needs", part);
    orl_error_hint(err, "add %s to the model in Honeybee", part);
    return ORL_ERR_INVALID;
}

/* Gives views the size and the quantity of the recipe's inputs. */
static int set_views(const struct orl_recipe_run *run, json_t *views, struct orl_error *err)
{
    json_t *resolution = json_object_get(run->inputs, "resolution"), *view;
    const char *metric = orl_recipe_text(run->inputs, "metric");
    size_t i;
    int rc = 0;
    json_array_foreach(views, i, view)
    {
        rc |= json_object_set(view, "width", resolution);
        rc |= json_object_set(view, "height", resolution);
        rc |= json_object_set_new(view, "pixel_aspect", json_integer(1));
        if (metric && strcmp(metric, "illuminance") == 0)
            rc |= json_object_set_new(view, "irradiance", json_true());
    }
    return rc ? orl_error_no_memory(err) : 0;
}

int orl_recipe_filter(const struct orl_recipe_run *run, json_t *document, struct orl_error *err)
{
    const char *grids = orl_recipe_text(run->inputs, "grid-filter"),
               *views = orl_recipe_text(run->inputs, "view-filter");
    int rc = filter_part(document, "grids", grids, err);
    if (rc == 0)
        rc = filter_part(document, "views", views, err);
    return rc || !views ? rc : set_views(run, json_object_get(document, "views"), err);
}
