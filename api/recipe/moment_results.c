/* Results of recipes under one sky: grids, views, and LEED's option 2. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "recipe/recipe_run.h"

enum { DIGITS = 4 };

/* ---- Grids ----------------------------------------------------------------------------------- */

static void file_name(const char *grid, char ret_name[256])
{
    orl_annual_file_name(grid, ret_name, 256);
}

/* Writes FOLDER/GRID.res for every grid, from one number per sensor, and grids_info.json. */
static int write_grids(const struct orl_recipe_run *run, const struct orl_result *result,
                       const char *folder, const double *values, int digits, struct orl_error *err)
{
    char path[ORL_RESULT_PATH], name[256];
    int rc = orl_result_path(&run->out, path, err, "%s/grids_info.json", folder);
    if (rc == 0)
        rc = orl_result_json(path, orl_recipe_grids_info(run, result), err);
    for (size_t g = 0; g < result->n_grids && rc == 0; g++) {
        const struct orl_grid_result *grid = &result->grids[g];
        file_name(grid->name, name);
        rc = orl_result_path(&run->out, path, err, "%s/%s.res", folder, name);
        if (rc == 0)
            rc = orl_result_numbers(path, values + grid->first, grid->count, digits, err);
    }
    return rc;
}

/* Returns the illuminances times a factor, owned. */
static double *scaled(const struct orl_result *result, double factor)
{
    double *values = malloc((result->n_sensors + 1) * sizeof *values);
    for (size_t i = 0; values && i < result->n_sensors; i++)
        values[i] = result->illuminance_lx[i] * factor;
    return values;
}

static int write_scaled(const struct orl_recipe_run *run, const struct orl_result *result,
                        const char *folder, double factor, struct orl_error *err)
{
    double *values = scaled(result, factor);
    const int rc =
        values ? write_grids(run, result, folder, values, DIGITS, err) : orl_error_no_memory(err);
    free(values);
    return rc;
}

/* Percent of the light of the whole sky, 100 000 lx. */
static const double percent_of_sky = 100 / 100000.0;

/* Mean, minimum, maximum and uniformity of each grid. */
static int write_summary(const struct orl_recipe_run *run, const struct orl_result *result,
                         struct orl_error *err)
{
    char path[ORL_RESULT_PATH], name[256];
    FILE *stream;
    char *text = NULL;
    size_t size = 0;
    int rc = orl_result_path(&run->out, path, err, "grid_summary.csv");
    if (rc)
        return rc;
    stream = open_memstream(&text, &size);
    if (!stream)
        return orl_error_no_memory(err);
    fputs("Sensor Grid,Sensor Grid ID,Mean,Minimum,Maximum,Uniformity Ratio\n", stream);
    for (size_t g = 0; g < result->n_grids; g++) {
        const struct orl_grid_result *grid = &result->grids[g];
        const struct orl_model_grid *of_model = orl_recipe_grid(run, grid->name);
        double sum = 0, least = INFINITY, most = 0;
        for (size_t i = grid->first; i < grid->first + grid->count; i++) {
            const double value = result->illuminance_lx[i] * percent_of_sky;
            sum += value;
            least = fmin(least, value);
            most = fmax(most, value);
        }
        const double mean = sum / (double)grid->count;
        file_name(grid->name, name);
        fprintf(stream, "%s,%s,%.2f,%.2f,%.2f,%.2f\n",
                of_model ? of_model->display_name : grid->name, name, mean, least, most,
                mean > 0 ? 100 * least / mean : 0.0);
    }
    fclose(stream);
    rc = orl_result_text(path, text, size, err);
    free(text);
    return rc;
}

int orl_recipe_write_factors(struct orl_recipe_run *run, size_t job,
                             const struct orl_result *result, struct orl_error *err)
{
    (void)job;
    const int rc = write_scaled(run, result, "results", percent_of_sky, err);
    return rc ? rc : write_summary(run, result, err);
}

int orl_recipe_write_sky_view(struct orl_recipe_run *run, size_t job,
                              const struct orl_result *result, struct orl_error *err)
{
    (void)job;
    return write_scaled(run, result, "results/sky_view", percent_of_sky, err);
}

int orl_recipe_write_illuminance(struct orl_recipe_run *run, size_t job,
                                 const struct orl_result *result, struct orl_error *err)
{
    (void)job;
    return write_scaled(run, result, "results/pit", 1, err);
}

/* ---- Views ----------------------------------------------------------------------------------- */

int orl_recipe_write_views(struct orl_recipe_run *run, size_t job, const struct orl_result *result,
                           struct orl_error *err)
{
    char path[ORL_RESULT_PATH], from[ORL_RESULT_PATH], name[256];
    json_t *info = json_array();
    int rc = info ? 0 : orl_error_no_memory(err);
    (void)job;
    for (size_t i = 0; i < result->n_views && rc == 0; i++) {
        const struct orl_view_result *view = &result->views[i];
        const char *slash = strrchr(view->name, '/');
        file_name(view->name, name);
        snprintf(from, sizeof from, "%.2000s/%.2000s", run->output, view->files[ORL_PICTURE_HDR]);
        rc = orl_result_path(&run->out, path, err, "results/%s.HDR", name);
        if (rc == 0)
            rc = orl_result_copy(path, from, err);
        json_array_append_new(info, json_pack("{s:s, s:s, s:s, s:s%}", "name", name, "identifier",
                                              slash ? slash + 1 : view->name, "full_id", name,
                                              "group", view->name,
                                              slash ? (size_t)(slash - view->name) : (size_t)0));
    }
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "results/views_info.json");
    if (rc == 0)
        return orl_result_json(path, info, err);
    json_decref(info);
    return rc;
}

/* ---- LEED, option 2 -------------------------------------------------------------------------- */

static const char *const hours[] = {"9AM", "3PM", "combined"};
enum { MORNING, AFTERNOON, BOTH, HOURS };

/* Sums of the sensors that pass, by hour: of a grid, or of all grids. */
struct equinox_sums {
    double passing[HOURS], area_passing[HOURS], count, area;
};

/* Returns true if a sensor passes: 300 lx, and without devices against glare at most 3000 lx. */
static bool passes(const struct orl_recipe_run *run, double lx)
{
    const char *devices = orl_recipe_text(run->inputs, "glare-control-devices");
    return lx > 300 && (strcmp(devices, "glare-control") == 0 || lx < 3000);
}

/* Writes 1 and 0 of each hour, and adds the sums of every grid. */
static int write_passing(const struct orl_recipe_run *run, const struct orl_result *result,
                         struct equinox_sums *sums, struct orl_error *err)
{
    const double *const lx[2] = {run->kept[MORNING], run->kept[AFTERNOON]};
    double *pass = malloc((result->n_sensors + 1) * sizeof *pass);
    int rc = 0;
    if (!pass)
        return orl_error_no_memory(err);
    for (int hour = 0; hour < HOURS && rc == 0; hour++) {
        char folder[32];
        for (size_t g = 0; g < result->n_grids; g++) {
            const struct orl_model_grid *grid = orl_recipe_grid(run, result->grids[g].name);
            for (size_t k = 0; k < result->grids[g].count; k++) {
                const size_t i = result->grids[g].first + k;
                const double area = orl_recipe_sensor_area(run, grid, k);
                pass[i] = hour == BOTH ? passes(run, lx[0][i]) && passes(run, lx[1][i])
                                       : passes(run, lx[hour][i]);
                sums[g].passing[hour] += pass[i];
                sums[g].area_passing[hour] += pass[i] * area;
                sums[g].count += hour == 0;
                sums[g].area += hour == 0 ? area : 0;
            }
        }
        snprintf(folder, sizeof folder, "results/%s", hours[hour]);
        rc = write_grids(run, result, folder, pass, 0, err);
    }
    free(pass);
    return rc;
}

static int write_spaces(const struct orl_recipe_run *run, const struct orl_result *result,
                        const struct equinox_sums *sums, bool has_areas, struct orl_error *err)
{
    char path[ORL_RESULT_PATH], *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return orl_error_no_memory(err);
    fprintf(stream, "Space Name,Sensor Count,%s%% Passing 9AM,%% Passing 3PM,%% Passing Combined\n",
            has_areas ? "Area (m2),Area (ft2),Spacing (m)," : "");
    for (size_t g = 0; g < result->n_grids; g++) {
        const struct orl_model_grid *grid = orl_recipe_grid(run, result->grids[g].name);
        const double m2 = sums[g].area * run->grids.metres * run->grids.metres,
                     ft2 = m2 / 0.09290304;
        fprintf(stream, "%s,%.0f", grid ? grid->display_name : result->grids[g].name,
                sums[g].count);
        if (has_areas)
            fprintf(stream, ",%.3f,%.3f,%.3f", m2, ft2, sqrt(m2 / sums[g].count));
        for (int hour = 0; hour < HOURS; hour++)
            fprintf(stream, ",%.2f", 100 * sums[g].area_passing[hour] / sums[g].area);
        fputc('\n', stream);
    }
    fclose(stream);
    int rc = orl_result_path(&run->out, path, err, "results/space_summary.csv");
    if (rc == 0)
        rc = orl_result_text(path, text, size, err);
    free(text);
    return rc;
}

/* LEED v4.1 BD+C, EQ Daylight, option 2: 55, 75 and 90 % of the area. */
static int credits_of(double percent)
{
    return percent >= 90 ? 3 : percent >= 75 ? 2 : percent >= 55 ? 1 : 0;
}

static int write_credits(const struct orl_recipe_run *run, const struct equinox_sums *sums,
                         size_t n_grids, bool has_areas, struct orl_error *err)
{
    static const char *const endings[HOURS] = {"_9AM", "_3PM", ""};
    struct equinox_sums all = {.count = 0};
    char path[ORL_RESULT_PATH], name[64];
    json_t *summary = json_object();
    for (size_t g = 0; g < n_grids; g++) {
        for (int hour = 0; hour < HOURS; hour++) {
            all.passing[hour] += sums[g].passing[hour];
            all.area_passing[hour] += sums[g].area_passing[hour];
        }
        all.count += sums[g].count;
        all.area += sums[g].area;
    }
    for (int hour = 0; hour < HOURS; hour++) {
        snprintf(name, sizeof name, "sensor_count_passing%s", endings[hour]);
        json_object_set_new(summary, name, json_integer((json_int_t)all.passing[hour]));
        snprintf(name, sizeof name, "floor_area_passing%s", endings[hour]);
        if (has_areas)
            json_object_set_new(summary, name, json_real(all.area_passing[hour]));
        snprintf(name, sizeof name, "percentage_passing%s", endings[hour]);
        json_object_set_new(summary, name, json_real(100 * all.area_passing[hour] / all.area));
    }
    json_object_set_new(summary, "total_sensor_count", json_integer((json_int_t)all.count));
    if (has_areas)
        json_object_set_new(summary, "total_floor_area", json_real(all.area));
    json_object_set_new(summary, "credits",
                        json_integer(credits_of(100 * all.area_passing[BOTH] / all.area)));
    const int rc = orl_result_path(&run->out, path, err, "credit_summary.json");
    if (rc == 0)
        return orl_result_json(path, summary, err);
    json_decref(summary);
    return rc;
}

/* Returns true if all grids have areas; without a mesh every sensor counts as 1. */
static bool result_has_areas(const struct orl_recipe_run *run, const struct orl_result *result)
{
    for (size_t g = 0; g < result->n_grids; g++) {
        const struct orl_model_grid *grid = orl_recipe_grid(run, result->grids[g].name);
        if (!grid || grid->n_areas != result->grids[g].count)
            return false;
    }
    return true;
}

int orl_recipe_write_equinox(struct orl_recipe_run *run, size_t job,
                             const struct orl_result *result, struct orl_error *err)
{
    char folder[64], path[ORL_RESULT_PATH];
    snprintf(folder, sizeof folder, "simulation/%s/results", hours[job]);
    run->kept[job] = scaled(result, 1);
    int rc = run->kept[job] ? write_grids(run, result, folder, run->kept[job], DIGITS, err)
                            : orl_error_no_memory(err);
    if (rc || job == MORNING)
        return rc;
    const bool has_areas = result_has_areas(run, result);
    struct equinox_sums *sums = calloc(result->n_grids + 1, sizeof *sums);
    if (!sums)
        return orl_error_no_memory(err);
    rc = write_passing(run, result, sums, err);
    if (rc == 0)
        rc = write_spaces(run, result, sums, has_areas, err);
    if (rc == 0)
        rc = write_credits(run, sums, result->n_grids, has_areas, err);
    if (rc == 0 && run->model)
        rc = orl_result_path(&run->out, path, err, "simulation/model.hbjson");
    if (rc == 0 && run->model)
        rc = orl_result_json(path, json_incref(run->model), err);
    free(sums);
    return rc;
}
