/* Values that results of years share: grids, areas, metrics and hourly collections. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "recipe/recipe_run.h"

const struct orl_model_grid *orl_recipe_grid(const struct orl_recipe_run *run, const char *name)
{
    for (size_t i = 0; i < run->grids.count; i++)
        if (strcmp(run->grids.items[i].full_id, name) == 0)
            return &run->grids.items[i];
    return NULL;
}

double orl_recipe_sensor_area(const struct orl_recipe_run *run, const struct orl_model_grid *grid,
                              size_t sensor)
{
    (void)run;
    return grid && sensor < grid->n_areas ? grid->areas[sensor] : 1;
}

bool orl_recipe_has_areas(const struct orl_recipe_run *run)
{
    for (size_t g = 0; g < run->report->n_grids; g++) {
        const struct orl_model_grid *grid = orl_recipe_grid(run, run->report->grids[g].name);
        if (!grid || grid->n_areas != run->report->grids[g].count)
            return false;
    }
    return true;
}

static json_t *grid_to_json(const struct orl_recipe_run *run, const char *name, size_t count,
                            bool is_year)
{
    const struct orl_model_grid *grid = orl_recipe_grid(run, name);
    char file[256];
    orl_annual_file_name(name, file, sizeof file);
    json_t *json =
        json_pack("{s:I, s:s, s:s, s:s, s:s}", "count", (json_int_t)count, "name",
                  grid ? grid->display_name : name, "identifier", grid ? grid->identifier : file,
                  "group", grid ? grid->group : "", "full_id", file);
    if (json && is_year)
        json_object_set_new(json, "light_path", json_pack("[[s]]", "__static_apertures__"));
    return json;
}

json_t *orl_recipe_grids_info(const struct orl_recipe_run *run, const struct orl_result *result)
{
    json_t *info = json_array();
    for (size_t g = 0; result && g < result->n_grids; g++)
        json_array_append_new(
            info, grid_to_json(run, result->grids[g].name, result->grids[g].count, false));
    for (size_t g = 0; !result && g < run->report->n_grids; g++)
        json_array_append_new(
            info, grid_to_json(run, run->report->grids[g].name, run->report->grids[g].count, true));
    return info;
}

double orl_recipe_metric(const struct orl_recipe_run *run, enum orl_metric_kind kind,
                         enum orl_annual_when when, double low, double high, size_t sensor)
{
    const struct orl_annual_metric metric = {kind, when, low, high};
    const struct orl_annual_light light = {
        .total_lx = orl_annual_row(run->result, run->result->total, sensor),
        .direct_lx = orl_annual_row(run->result, run->result->direct, sensor)};
    return orl_annual_evaluate_at(&metric, &run->report->periods[when], &light, 0);
}

json_t *orl_recipe_hourly(const struct orl_recipe_run *run, json_t *data_type, const char *unit,
                          json_t *metadata, json_t *values)
{
    const struct orl_annual_steps *steps = &run->report->year.steps;
    json_t *period = json_pack(
        "{s:s, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:b}", "type", "AnalysisPeriod", "st_month", 1,
        "st_day", 1, "st_hour", 0, "end_month", 12, "end_day", 31, "end_hour", 23, "timestep",
        (int)steps->per_hour, "is_leap_year", steps->count > 8760 * steps->per_hour);
    return json_pack("{s:s, s:{s:s, s:o, s:s, s:o, s:o}, s:o}", "type",
                     "HourlyContinuousCollection", "header", "type", "Header", "data_type",
                     data_type, "unit", unit, "analysis_period", period, "metadata", metadata,
                     "values", values);
}

/* ---- Files that several recipes write -------------------------------------------------------- */

/* Copies the model, so that Honeybee finds the areas and rooms of the grids. */
static int write_model(const struct orl_recipe_run *run, struct orl_error *err)
{
    char path[ORL_RESULT_PATH];
    if (!run->model)
        return 0;
    const int rc = orl_result_path(&run->out, path, err, "output_model.hbjson");
    return rc ? rc : orl_result_json(path, json_incref(run->model), err);
}

int orl_recipe_write_hours(struct orl_recipe_run *run, struct orl_error *err)
{
    char path[ORL_RESULT_PATH], folder[ORL_RESULT_PATH];
    int rc = orl_result_path(&run->out, path, err, "results/grids_info.json");
    if (rc == 0) {
        snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
        rc = orl_honeybee_write_hours(folder, run->report, run->result, NULL, NULL, run->cancel,
                                      err);
    }
    if (rc == 0)
        rc = orl_result_json(path, orl_recipe_grids_info(run, NULL), err);
    return rc ? rc : write_model(run, err);
}

int orl_recipe_write_daylight_hours(struct orl_recipe_run *run, struct orl_error *err)
{
    const struct orl_annual_timeline *year = &run->report->year;
    unsigned char *marks = calloc(year->steps.count, sizeof *marks);
    double *numbers = calloc(year->steps.count, sizeof *numbers);
    char path[ORL_RESULT_PATH];
    if (!marks || !numbers) {
        free(marks);
        free(numbers);
        return orl_error_no_memory(err);
    }
    json_t *values = json_array();
    int rc = orl_annual_daylight_mark(year->global_lx, year->measured, &year->steps, marks, err);
    for (uint32_t i = 0; i < year->steps.count && rc == 0; i++) {
        numbers[i] = marks[i];
        json_array_append_new(values, json_integer(marks[i]));
    }
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "daylight_hours.csv");
    if (rc == 0)
        rc = orl_result_numbers(path, numbers, year->steps.count, 0, err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "daylight_hours.json");
    if (rc == 0)
        rc = orl_result_json(path,
                             orl_recipe_hourly(run,
                                               orl_result_data_type("Daylight hours", "Fraction"),
                                               "fraction", json_object(), json_incref(values)),
                             err);
    json_decref(values);
    free(numbers);
    free(marks);
    return rc;
}
