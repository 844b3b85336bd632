/* LEED v4.1, option 1, and WELL v2, in the layouts of honeybee-radiance-postprocess. Their last job
 * is the year with blinds by LM-83's rule; jobs before it have them open, then closed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "recipe/recipe_run.h"

/* Daylight autonomies that are kept of each job: [level * sensors + sensor]. */
enum { LUX_150, LUX_300, LEVELS };
static const double level_lx[LEVELS] = {150, 300};
static const double time_share = 50;  /* % of the hours of use: sDA */
static const double ase_hours = 250;  /* ASE: more hours with direct sunlight fail */
static const double direct_lx = 1000; /* LM-83's direct sunlight */
static const double most_share = 2;   /* % of a grid's sensors that may have it */

enum { OPEN, CLOSED, CONTROLLED, STATES };

/* Areas of a grid, or of all: those that pass sDA in each state, and ASE. */
struct passing {
    double weight, sda[STATES], ase;
};

static int keep_autonomy(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    const size_t n = run->report->n_sensors;
    double *values = calloc(LEVELS * n + 1, sizeof *values);
    if (!values)
        return orl_error_no_memory(err);
    for (int l = 0; l < LEVELS; l++)
        for (size_t i = 0; i < n; i++)
            values[(size_t)l * n + i] =
                orl_recipe_metric(run, ORL_METRIC_DA, ORL_WHEN_OCCUPIED, level_lx[l], 0, i);
    run->kept[job] = values;
    return 0;
}

/* Returns the autonomies of a state. A run of one job stands for all states. */
static const double *autonomy_of(const struct orl_recipe_run *run, int state, int level)
{
    const double *values = run->kept[run->n_jobs == 1 ? 0 : state];
    return values + (size_t)level * run->report->n_sensors;
}

static double direct_hours(const struct orl_recipe_run *run, size_t sensor)
{
    return orl_recipe_metric(run, ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, direct_lx, 0, sensor);
}

static void sum_grid(const struct orl_recipe_run *run, size_t g, int level, bool has_areas,
                     struct passing *ret_passing)
{
    const struct orl_annual_grid *grid = &run->report->grids[g];
    const struct orl_model_grid *of_model = orl_recipe_grid(run, grid->name);
    *ret_passing = (struct passing){.weight = 0};
    for (size_t k = 0; k < grid->count; k++) {
        const size_t i = grid->first + k;
        const double weight = has_areas ? orl_recipe_sensor_area(run, of_model, k) : 1;
        ret_passing->weight += weight;
        for (int state = 0; state < STATES; state++)
            ret_passing->sda[state] += autonomy_of(run, state, level)[i] >= time_share ? weight : 0;
        ret_passing->ase += direct_hours(run, i) < ase_hours ? weight : 0;
    }
}

static double percent(double part, double whole)
{
    return round(10000 * part / whole) / 100;
}

static json_t *weight_to_json(double weight, bool has_areas)
{
    return has_areas ? json_real(round(100 * weight) / 100) : json_integer((json_int_t)weight);
}

/* Sets the members that summaries of a grid and of all share. with_ase: LEED's. */
static void add_passing(json_t *summary, const struct passing *passing, bool has_areas,
                        bool with_ase)
{
    const char *const what = has_areas ? "floor_area" : "sensor_count";
    char name[64];
    json_object_set_new(summary, "sda",
                        json_real(percent(passing->sda[CONTROLLED], passing->weight)));
    snprintf(name, sizeof name, "%s_passing_sda", what);
    json_object_set_new(summary, name, weight_to_json(passing->sda[CONTROLLED], has_areas));
    snprintf(name, sizeof name, "total_%s", what);
    json_object_set_new(summary, name, weight_to_json(passing->weight, has_areas));
    if (!with_ase)
        return;
    json_object_set_new(summary, "ase",
                        json_real(percent(passing->weight - passing->ase, passing->weight)));
    snprintf(name, sizeof name, "%s_passing_ase", what);
    json_object_set_new(summary, name, weight_to_json(passing->ase, has_areas));
}

/* Returns the summary of each grid, by its id, and sums them up. */
static json_t *summarise_grids(const struct orl_recipe_run *run, int level, bool with_ase,
                               struct passing *ret_all)
{
    const bool has_areas = orl_recipe_has_areas(run);
    json_t *summaries = json_object();
    *ret_all = (struct passing){.weight = 0};
    for (size_t g = 0; g < run->report->n_grids; g++) {
        const char *name = run->report->grids[g].name;
        const struct orl_model_grid *grid = orl_recipe_grid(run, name);
        const char *display = grid ? grid->display_name : name;
        struct passing passing;
        char file[256];
        orl_annual_file_name(name, file, sizeof file);
        sum_grid(run, g, level, has_areas, &passing);
        json_t *summary =
            json_pack("{s:s, s:s, s:f, s:f}", "name", display, "full_id", file, "sda_blinds_up",
                      percent(passing.sda[OPEN], passing.weight), "sda_blinds_down",
                      percent(passing.sda[CLOSED], passing.weight));
        add_passing(summary, &passing, has_areas, with_ase);
        if (with_ase && percent(passing.weight - passing.ase, passing.weight) > 10)
            json_object_set_new(summary, "ase_note",
                                json_sprintf("Annual sunlight exposure is above 10 %% in %s: LEED "
                                             "asks how its design limits glare.",
                                             display));
        json_object_set_new(summaries, file, summary);
        ret_all->weight += passing.weight;
        ret_all->ase += passing.ase;
        for (int state = 0; state < STATES; state++)
            ret_all->sda[state] += passing.sda[state];
    }
    return summaries;
}

/* ---- Blinds ---------------------------------------------------------------------------------- */

/* Returns the share of a grid's area in direct sunlight in a column, percent, with blinds open. */
static double sunny_share(const struct orl_recipe_run *run, size_t g, size_t column)
{
    const struct orl_annual_grid *grid = &run->report->grids[g];
    const struct orl_model_grid *of_model = orl_recipe_grid(run, grid->name);
    double sunny = 0, all = 0;
    for (size_t k = 0; k < grid->count; k++) {
        const double area = orl_recipe_sensor_area(run, of_model, k);
        all += area;
        if ((double)orl_annual_row(run->result, run->result->direct, grid->first + k)[column] >
            direct_lx)
            sunny += area;
    }
    return 100 * sunny / all;
}

static json_t *zeros(const struct orl_recipe_run *run)
{
    json_t *values = json_array();
    for (uint32_t i = 0; i < run->report->year.steps.count; i++)
        json_array_append_new(values, json_integer(0));
    return values;
}

/* Returns the hours of use in which a grid has too much direct sunlight, and no blinds to close:
 * {GRID: [hour, ...]}. With blinds there are none, for they let no direct sunlight through. */
static json_t *uncontrolled_hours(const struct orl_recipe_run *run)
{
    const struct orl_annual_period *use = &run->report->periods[ORL_WHEN_OCCUPIED];
    const struct orl_annual_timeline *year = &run->report->year;
    json_t *grids = json_object();
    for (size_t g = 0; g < run->report->n_grids && run->result->n_groups == 0; g++) {
        json_t *hours = json_array();
        for (size_t c = 0; c < use->n_columns; c++)
            if (sunny_share(run, g, use->columns[c]) > most_share)
                json_array_append_new(hours, json_integer(year->step_of_column[use->columns[c]] /
                                                          year->steps.per_hour));
        if (json_array_size(hours) > 0)
            json_object_set(grids, run->report->grids[g].name, hours);
        json_decref(hours);
    }
    return grids;
}

/* Returns the states of each group over the year, 0 open and 1 closed, as hourly collections. */
static json_t *states_to_json(const struct orl_recipe_run *run)
{
    const struct orl_annual_timeline *year = &run->report->year;
    json_t *groups = json_object();
    for (size_t group = 0; group < run->result->n_groups; group++) {
        const char *name = run->job->request.groups[group].name;
        json_t *values = zeros(run);
        for (size_t c = 0; c < run->report->periods[ORL_WHEN_OCCUPIED].n_columns; c++) {
            const uint32_t column = run->report->periods[ORL_WHEN_OCCUPIED].columns[c];
            const size_t row = run->result->step_of_column[column];
            json_array_set_new(
                values, year->step_of_column[column],
                json_integer(run->result->states[group * run->result->n_steps + row]));
        }
        json_object_set_new(groups, name,
                            orl_recipe_hourly(run, orl_result_data_type(name, "GenericType"), "",
                                              json_pack("{s:s}", "identifier", name), values));
    }
    return groups;
}

static int write_json(const struct orl_recipe_run *run, const char *folder, const char *name,
                      json_t *json, struct orl_error *err)
{
    char path[ORL_RESULT_PATH];
    const int rc = orl_result_path(&run->out, path, err, "%s/%s", folder, name);
    if (rc == 0)
        return orl_result_json(path, json, err);
    json_decref(json);
    return rc;
}

/* Writes a number per sensor of each grid, and the list of grids. */
static int write_grids(const struct orl_recipe_run *run, const char *folder, const char *ending,
                       const double *values, int digits, struct orl_error *err)
{
    char path[ORL_RESULT_PATH], name[256];
    int rc = write_json(run, folder, "grids_info.json", orl_recipe_grids_info(run, NULL), err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        orl_annual_file_name(grid->name, name, sizeof name);
        rc = orl_result_path(&run->out, path, err, "%s/%s.%s", folder, name, ending);
        if (rc == 0)
            rc = orl_result_numbers(path, values + grid->first, grid->count, digits, err);
    }
    return rc;
}

/* Writes 1 for sensors that pass sDA, else 0. */
static int write_passing(const struct orl_recipe_run *run, const char *folder, int level,
                         struct orl_error *err)
{
    const double *da = autonomy_of(run, CONTROLLED, level);
    double *values = calloc(run->report->n_sensors + 1, sizeof *values);
    if (!values)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < run->report->n_sensors; i++)
        values[i] = da[i] >= time_share;
    const int rc = write_grids(run, folder, "pf", values, 0, err);
    free(values);
    return rc;
}

/* ---- LEED ------------------------------------------------------------------------------------ */

/* LEED v4.1, EQ Daylight, option 1: 40, 55 and 75 % of the area; one more if each room has 55 %. */
static json_t *credits_to_json(const json_t *grids, double sda)
{
    int credits = sda >= 75 ? 3 : sda >= 55 ? 2 : sda >= 40 ? 1 : 0;
    bool all = true;
    const char *name;
    json_t *grid;
    json_object_foreach((json_t *)(uintptr_t)grids, name, grid)
    {
        all = all && json_number_value(json_object_get(grid, "sda")) >= 55;
    }
    if (all && credits == 3)
        return json_string("Exemplary performance");
    return json_integer(credits + all);
}

/* Adds credits: none where direct sunlight cannot be kept out. */
static void add_credits(json_t *summary, const json_t *grids, const json_t *uncontrolled)
{
    if (json_object_size(uncontrolled) == 0) {
        json_object_set_new(
            summary, "credits",
            credits_to_json(grids, json_number_value(json_object_get(summary, "sda"))));
        return;
    }
    json_object_set_new(summary, "credits", json_integer(0));
    json_object_set_new(summary, "note",
                        json_sprintf("No credits: %zu of the grids have hours with direct sunlight "
                                     "of 1000 lux or more on more than 2 %% of their area, and no "
                                     "blinds. states_schedule_err.json lists the hours.",
                                     json_object_size(uncontrolled)));
}

/* Writes hours above 1000 lx, which sensors pass ASE, and by hour the share of the area above. */
static int write_ase(const struct orl_recipe_run *run, struct orl_error *err)
{
    const struct orl_annual_period *use = &run->report->periods[ORL_WHEN_OCCUPIED];
    const size_t n = run->report->n_sensors;
    double *hours = calloc(2 * n + 1, sizeof *hours);
    int rc = hours ? 0 : orl_error_no_memory(err);
    for (size_t i = 0; i < n && rc == 0; i++) {
        hours[i] = direct_hours(run, i);
        hours[n + i] = hours[i] < ase_hours;
    }
    if (rc == 0)
        rc = write_grids(run, "leed_summary/results/ase_hours_above", "res", hours, 0, err);
    if (rc == 0)
        rc = write_grids(run, "leed_summary/pass_fail/ASE", "pf", hours + n, 0, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++) {
        json_t *values = zeros(run);
        char name[300], file[256];
        for (size_t c = 0; c < use->n_columns; c++)
            json_array_set_new(values, run->report->year.step_of_column[use->columns[c]],
                               json_real(sunny_share(run, g, use->columns[c])));
        orl_annual_file_name(run->report->grids[g].name, file, sizeof file);
        snprintf(name, sizeof name, "%s.json", file);
        rc = write_json(
            run, "leed_summary/datacollections/ase_percentage_above", name,
            orl_recipe_hourly(
                run, orl_result_data_type("Percentage above 1000 direct lux", "Fraction"), "%",
                json_pack("{s:s}", "SensorGrid", run->report->grids[g].name), values),
            err);
    }
    if (rc == 0)
        rc = write_json(run, "leed_summary/datacollections/ase_percentage_above", "grids_info.json",
                        orl_recipe_grids_info(run, NULL), err);
    free(hours);
    return rc;
}

static int write_legends(const struct orl_recipe_run *run, struct orl_error *err)
{
    char path[ORL_RESULT_PATH];
    int rc = orl_result_path(&run->out, path, err, "leed_summary/results/da/vis_metadata.json");
    if (rc == 0)
        rc = orl_result_legend(path, "Daylight Autonomy", "Fraction", "%", 100, ORL_COLORS_COMFORT,
                               err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err,
                             "leed_summary/results/ase_hours_above/vis_metadata.json");
    return rc ? rc
              : orl_result_legend(path, "Hours above direct threshold", "Time", "hr", ase_hours,
                                  ORL_COLORS_ORIGINAL, err);
}

static int write_leed_summaries(const struct orl_recipe_run *run, struct orl_error *err)
{
    static const char folder[] = "leed_summary";
    struct passing all;
    json_t *grids = summarise_grids(run, LUX_300, true, &all), *summary = json_object(),
           *uncontrolled = uncontrolled_hours(run);
    add_passing(summary, &all, orl_recipe_has_areas(run), true);
    add_credits(summary, grids, uncontrolled);
    int rc = write_json(run, folder, "summary.json", json_incref(summary), err);
    if (rc == 0)
        rc = write_json(run, folder, "summary_grid.json", json_incref(grids), err);
    if (rc == 0)
        rc = write_json(run, folder, "states_schedule_err.json", json_incref(uncontrolled), err);
    if (rc == 0)
        rc = write_json(run, folder, "states_schedule.json", states_to_json(run), err);
    if (rc == 0)
        rc = write_json(run, folder, "grids_info.json", orl_recipe_grids_info(run, NULL), err);
    json_decref(summary);
    json_decref(grids);
    json_decref(uncontrolled);
    return rc;
}

int orl_recipe_write_leed(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    int rc = keep_autonomy(run, job, err);
    if (rc || job + 1 < run->n_jobs)
        return rc;
    rc = orl_recipe_write_hours(run, err);
    if (rc == 0)
        rc = write_leed_summaries(run, err);
    if (rc == 0)
        rc = write_grids(run, "leed_summary/results/da", "da",
                         autonomy_of(run, CONTROLLED, LUX_300), 2, err);
    if (rc == 0)
        rc = write_passing(run, "leed_summary/pass_fail/DA", LUX_300, err);
    if (rc == 0)
        rc = write_ase(run, err);
    return rc ? rc : write_legends(run, err);
}

/* ---- WELL ------------------------------------------------------------------------------------ */

/* WELL v2, L01 and L06: the level, the shares of the area, and the names of files. */
static const struct {
    const char *name, *folder;
    int level;
} features[] = {{"L01", "l01", LUX_150}, {"L06", "l06", LUX_300}};
enum { L01, L06, FEATURES };

/* Returns the share of all sensors with so many lux in half of the daylight hours, percent. */
static double daylight_share(const struct orl_recipe_run *run, double lx)
{
    size_t n = 0;
    for (size_t i = 0; i < run->report->n_sensors; i++)
        n += orl_recipe_metric(run, ORL_METRIC_DA, ORL_WHEN_DAYLIGHT, lx, 0, i) >= time_share;
    return 100 * (double)n / (double)run->report->n_sensors;
}

/* Returns the feature's summary: by LM-83, and by EN 17037. */
static json_t *feature_to_json(const struct orl_recipe_run *run, int f, const struct passing *all,
                               bool is_controlled)
{
    const double sda = percent(all->sda[CONTROLLED], all->weight), least = daylight_share(run, 100),
                 middle = daylight_share(run, 200), target = daylight_share(run, 300);
    json_t *lm = json_pack("{s:s, s:f, s:f}", "method", "IES LM-83-12", "sda", sda,
                           "total_floor_area", orl_recipe_has_areas(run) ? all->weight : 0.0),
           *en = json_pack("{s:s}", "method", "EN 17037");
    if (f == L01) {
        json_object_set_new(lm, "comply", json_boolean(is_controlled && sda >= 30));
        json_object_set_new(en, "comply", json_boolean(middle > 30));
    } else {
        json_object_set_new(lm, "points",
                            json_integer(!is_controlled ? 0
                                         : sda >= 75    ? 2
                                         : sda >= 55    ? 1
                                                        : 0));
        json_object_set_new(en, "points", json_integer(target <= 50 ? 0 : least > 95 ? 2 : 1));
    }
    return json_pack("[o, o]", lm, en);
}

static int write_feature(const struct orl_recipe_run *run, int f, struct orl_error *err)
{
    char folder[96], name[128];
    struct passing all;
    json_t *grids = summarise_grids(run, features[f].level, false, &all), *summary = json_object(),
           *uncontrolled = uncontrolled_hours(run);
    const bool is_controlled = json_object_size(uncontrolled) == 0;
    snprintf(folder, sizeof folder, "well_summary/ies_lm/%s_ies_lm_summary", features[f].folder);
    add_passing(summary, &all, orl_recipe_has_areas(run), false);
    if (f == L06)
        add_credits(summary, grids, uncontrolled);
    int rc = write_json(run, folder, "ies_lm_summary.json", json_incref(summary), err);
    if (rc == 0)
        rc = write_json(run, folder, "ies_lm_summary_grid.json", json_incref(grids), err);
    if (rc == 0)
        rc = write_json(run, folder, "states_schedule.json", states_to_json(run), err);
    if (rc == 0)
        rc = write_json(run, folder, "states_schedule_err.json", json_incref(uncontrolled), err);
    if (rc == 0)
        rc = write_json(run, folder, "grids_info.json", orl_recipe_grids_info(run, NULL), err);
    if (rc == 0) {
        snprintf(name, sizeof name, "%s/results/da", folder);
        rc = write_grids(run, name, "da", autonomy_of(run, CONTROLLED, features[f].level), 2, err);
    }
    if (rc == 0) {
        snprintf(name, sizeof name, "well_summary/ies_lm/pass_fail/%s", features[f].name);
        rc = write_passing(run, name, features[f].level, err);
    }
    if (rc == 0) {
        snprintf(name, sizeof name, "%s_well_summary.json", features[f].folder);
        rc = write_json(run, "well_summary", name, feature_to_json(run, f, &all, is_controlled),
                        err);
    }
    json_decref(summary);
    json_decref(grids);
    json_decref(uncontrolled);
    return rc;
}

/* Returns the requirements of the standard that the summaries are judged by. */
static json_t *well_version(void)
{
    return json_pack(
        "{s:s, s:{s:{s:i, s:i, s:i}, s:{s:i, s:i, s:i}}, s:{s:{s:{s:i, s:i, s:i}, s:{s:i, s:i, "
        "s:i}}, s:{s:{s:i, s:i, s:i}, s:{s:i, s:i, s:i, s:i, s:i}}}}",
        "Version", "WELL v2", "L01", "IES LM-83", "sda_target_illuminance", 150, "sda_occupancy",
        50, "sda_threshold", 30, "EN 17037", "target_illuminance", 200, "daylit_hours", 50,
        "sda_threshold", 30, "L06", "Tier 1", "IES LM-83", "sda_target_illuminance", 300,
        "sda_occupancy", 50, "sda_threshold", 55, "EN 17037", "target_illuminance", 300,
        "daylit_hours", 50, "sda_threshold", 50, "Tier 2", "IES LM-83", "sda_target_illuminance",
        300, "sda_occupancy", 50, "sda_threshold", 75, "EN 17037", "target_illuminance", 300,
        "minimum_illuminance", 100, "daylit_hours", 50, "sda_target_threshold", 50,
        "sda_minimum_threshold", 95);
}

int orl_recipe_write_well(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    int rc = keep_autonomy(run, job, err);
    if (rc || job + 1 < run->n_jobs)
        return rc;
    rc = orl_recipe_write_hours(run, err);
    if (rc == 0)
        rc = orl_recipe_write_daylight_hours(run, err);
    if (rc == 0)
        rc = orl_recipe_write_en17037_folder(run, "well_summary/en17037", err);
    for (int f = 0; f < FEATURES && rc == 0; f++)
        rc = write_feature(run, f, err);
    return rc ? rc : write_json(run, "well_summary", "well_version.json", well_version(), err);
}
