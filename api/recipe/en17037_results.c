/* EN 17037:2018, daylight provision by climate data, in the layout of
 * honeybee-radiance-postprocess: en17037/{da,sda}/"TARGET LUX", en17037/compliance_level/TARGET,
 * and two summaries. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "recipe/recipe_run.h"

enum { TARGETS = 2, LEVELS = 3 };

/* EN 17037:2018, table A.1. */
static const struct {
    const char *name, *title;
    double lx[LEVELS], share; /* % of the area */
} targets[TARGETS] = {{"Minimum Illuminance", "minimum", {100, 300, 500}, 95},
                      {"Target Illuminance", "target", {300, 500, 750}, 50}};
static const double time_share = 50; /* % of the daylight hours */

/* Shares of a grid, and areas by the highest level that sensors reach (0: none). */
struct grid_levels {
    double weight, share[TARGETS][LEVELS], by_level[TARGETS][LEVELS + 1];
};

static double weight_of(const struct orl_recipe_run *run, bool has_areas,
                        const struct orl_annual_grid *grid, size_t k)
{
    return has_areas ? orl_recipe_sensor_area(run, orl_recipe_grid(run, grid->name), k) : 1;
}

static void rate(const struct orl_recipe_run *run, const struct orl_annual_grid *grid,
                 bool has_areas, double *da[TARGETS][LEVELS], struct grid_levels *ret_levels)
{
    for (size_t k = 0; k < grid->count; k++) {
        const double weight = weight_of(run, has_areas, grid, k);
        ret_levels->weight += weight;
        for (int t = 0; t < TARGETS; t++) {
            int reached = 0;
            for (int l = 0; l < LEVELS; l++) {
                const bool passes = da[t][l][grid->first + k] >= time_share;
                ret_levels->share[t][l] += passes ? weight : 0;
                reached = passes ? l + 1 : reached;
            }
            ret_levels->by_level[t][reached] += weight;
        }
    }
    for (int t = 0; t < TARGETS; t++)
        for (int l = 0; l < LEVELS; l++)
            ret_levels->share[t][l] *= 100 / ret_levels->weight;
}

static int write_list(const struct orl_recipe_run *run, const char *folder, const char *part,
                      const char *name, struct orl_error *err)
{
    char path[ORL_RESULT_PATH];
    const int rc =
        orl_result_path(&run->out, path, err, "%s/%s/%s/grids_info.json", folder, part, name);
    return rc ? rc : orl_result_json(path, orl_recipe_grids_info(run, NULL), err);
}

/* Writes daylight autonomies and shares of one target and level. */
static int write_level(const struct orl_recipe_run *run, const char *folder, int t, int l,
                       const double *da, const struct grid_levels *levels, struct orl_error *err)
{
    char path[ORL_RESULT_PATH], file[256], name[64], title[64];
    snprintf(name, sizeof name, "%s %.0f", targets[t].name, targets[t].lx[l]);
    snprintf(title, sizeof title, "Daylight Autonomy - %s %.0f lux", targets[t].title,
             targets[t].lx[l]);
    int rc = write_list(run, folder, "da", name, err);
    if (rc == 0)
        rc = write_list(run, folder, "sda", name, err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "%s/da/%s/vis_metadata.json", folder, name);
    if (rc == 0)
        rc = orl_result_legend(path, title, "Fraction", "%", 100, ORL_COLORS_COMFORT, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        orl_annual_file_name(grid->name, file, sizeof file);
        rc = orl_result_path(&run->out, path, err, "%s/da/%s/%s.da", folder, name, file);
        if (rc == 0)
            rc = orl_result_numbers(path, da + grid->first, grid->count, 2, err);
        if (rc == 0)
            rc = orl_result_path(&run->out, path, err, "%s/sda/%s/%s.sda", folder, name, file);
        if (rc == 0)
            rc = orl_result_numbers(path, &levels[g].share[t][l], 1, 2, err);
    }
    return rc;
}

/* Writes the highest level that each grid reaches, 0 to 3, for all of its sensors. */
static int write_compliance(const struct orl_recipe_run *run, const char *folder, int t,
                            const struct grid_levels *levels, struct orl_error *err)
{
    char path[ORL_RESULT_PATH], file[256];
    int rc = write_list(run, folder, "compliance_level", targets[t].name, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        double *values = calloc(grid->count + 1, sizeof *values);
        int reached = 0;
        for (int l = 0; l < LEVELS; l++)
            reached = levels[g].share[t][l] >= targets[t].share ? l + 1 : reached;
        for (size_t k = 0; values && k < grid->count; k++)
            values[k] = reached;
        orl_annual_file_name(grid->name, file, sizeof file);
        rc = values ? orl_result_path(&run->out, path, err, "%s/compliance_level/%s/%s.pf", folder,
                                      targets[t].name, file)
                    : orl_error_no_memory(err);
        if (rc == 0)
            rc = orl_result_numbers(path, values, grid->count, 0, err);
        free(values);
    }
    return rc;
}

/* ---- Summaries ------------------------------------------------------------------------------- */

static double round_to_cents(double value)
{
    return round(value * 100) / 100;
}

static json_t *weight_to_json(double weight, bool has_areas)
{
    return has_areas ? json_real(round_to_cents(weight)) : json_integer((json_int_t)weight);
}

static void add_share(json_t *summary, int t, int l, double share)
{
    char label[64];
    snprintf(label, sizeof label, "%s %.0f", targets[t].name, targets[t].lx[l]);
    json_object_set_new(
        summary, label,
        json_pack("{s:f, s:b}", "sDA", round_to_cents(share), "passes", share >= targets[t].share));
}

/* Adds the shares of the area by the highest level that its sensors reach. */
static void add_breakdown(json_t *summary, int t, const double by_level[LEVELS + 1], double weight,
                          bool has_areas)
{
    const double *lx = targets[t].lx;
    char name[64], labels[LEVELS + 1][48];
    snprintf(labels[3], sizeof labels[3], "High (>= %.0f lux)", lx[2]);
    snprintf(labels[2], sizeof labels[2], "Medium (%.0f - %.0f lux)", lx[1], lx[2]);
    snprintf(labels[1], sizeof labels[1], "Minimum (%.0f - %.0f lux)", lx[0], lx[1]);
    snprintf(labels[0], sizeof labels[0], "Fail (< %.0f lux)", lx[0]);
    snprintf(name, sizeof name, "%s %s", targets[t].name,
             has_areas ? "Area Percentage" : "Sensor Percentage");
    json_t *shares = json_object();
    for (int l = LEVELS; l >= 0; l--)
        json_object_set_new(shares, labels[l],
                            json_real(round_to_cents(100 * by_level[l] / weight)));
    json_object_set_new(summary, name, shares);
}

static json_t *summarise(const struct orl_recipe_run *run, const struct grid_levels *levels,
                         bool has_areas)
{
    struct grid_levels all = {.weight = 0};
    json_t *summary = json_object();
    for (size_t g = 0; g < run->report->n_grids; g++) {
        all.weight += levels[g].weight;
        for (int t = 0; t < TARGETS; t++) {
            for (int l = 0; l < LEVELS; l++)
                all.share[t][l] += levels[g].share[t][l] * levels[g].weight;
            for (int l = 0; l <= LEVELS; l++)
                all.by_level[t][l] += levels[g].by_level[t][l];
        }
    }
    json_object_set_new(summary, has_areas ? "Total Floor Area" : "Total Sensors",
                        weight_to_json(all.weight, has_areas));
    for (int t = 0; t < TARGETS; t++) {
        for (int l = 0; l < LEVELS; l++)
            add_share(summary, t, l, all.share[t][l] / all.weight);
        add_breakdown(summary, t, all.by_level[t], all.weight, has_areas);
    }
    return summary;
}

static json_t *summarise_grids(const struct orl_recipe_run *run, const struct grid_levels *levels,
                               bool has_areas)
{
    json_t *list = json_array();
    for (size_t g = 0; g < run->report->n_grids; g++) {
        const char *name = run->report->grids[g].name;
        const struct orl_model_grid *grid = orl_recipe_grid(run, name);
        json_t *summary = json_pack("{s:s, s:o}", "Sensor Grid", grid ? grid->display_name : name,
                                    has_areas ? "Total Floor Area" : "Total Sensors",
                                    weight_to_json(levels[g].weight, has_areas));
        for (int t = 0; t < TARGETS; t++)
            for (int l = 0; l < LEVELS; l++)
                add_share(summary, t, l, levels[g].share[t][l]);
        json_array_append_new(list, summary);
    }
    return list;
}

static int write_summaries(const struct orl_recipe_run *run, const char *folder,
                           const struct grid_levels *levels, bool has_areas, struct orl_error *err)
{
    char path[ORL_RESULT_PATH];
    int rc = orl_result_path(&run->out, path, err, "%s/summary.json", folder);
    if (rc == 0)
        rc = orl_result_json(path, summarise(run, levels, has_areas), err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "%s/summary_grid.json", folder);
    return rc ? rc : orl_result_json(path, summarise_grids(run, levels, has_areas), err);
}

/* ---- The folder ------------------------------------------------------------------------------ */

static int compute(const struct orl_recipe_run *run, double *da[TARGETS][LEVELS],
                   struct orl_error *err)
{
    for (int t = 0; t < TARGETS; t++)
        for (int l = 0; l < LEVELS; l++) {
            da[t][l] = calloc(run->report->n_sensors + 1, sizeof *da[t][l]);
            if (!da[t][l])
                return orl_error_no_memory(err);
            for (size_t i = 0; i < run->report->n_sensors; i++)
                da[t][l][i] = orl_recipe_metric(run, ORL_METRIC_DA, ORL_WHEN_DAYLIGHT,
                                                targets[t].lx[l], 0, i);
        }
    return 0;
}

int orl_recipe_write_en17037_folder(struct orl_recipe_run *run, const char *folder,
                                    struct orl_error *err)
{
    const bool has_areas = orl_recipe_has_areas(run);
    double *da[TARGETS][LEVELS] = {{NULL}};
    struct grid_levels *levels = calloc(run->report->n_grids + 1, sizeof *levels);
    if (!levels)
        return orl_error_no_memory(err);
    int rc = compute(run, da, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++)
        rate(run, &run->report->grids[g], has_areas, da, &levels[g]);
    for (int t = 0; t < TARGETS && rc == 0; t++) {
        for (int l = 0; l < LEVELS && rc == 0; l++)
            rc = write_level(run, folder, t, l, da[t][l], levels, err);
        if (rc == 0)
            rc = write_compliance(run, folder, t, levels, err);
    }
    if (rc == 0)
        rc = write_summaries(run, folder, levels, has_areas, err);
    for (int t = 0; t < TARGETS; t++)
        for (int l = 0; l < LEVELS; l++)
            free(da[t][l]);
    free(levels);
    return rc;
}
