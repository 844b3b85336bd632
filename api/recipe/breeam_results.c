/* BREEAM International New Construction, Hea 01, criterion 4b: hours of the year in which a room's
 * average, and its darkest point, have so many lux. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "recipe/recipe_run.h"

/* Requirements of a type of room, by its program type in Honeybee: "BREEAM::BUILDING::ROOM". The
 * first row is for all other programs. */
static const struct requirement {
    const char *program, *building;
    int credits;
    double area;                 /* % of the area that must comply */
    double average_lx, least_lx; /* least 0: no requirement */
    double hours;
} requirements[] = {
    {"Office_buildings::Occupied_spaces", "Office buildings", 2, 80, 300, 90, 2000},
    {"Education_buildings::Preschools", "Education buildings", 2, 80, 300, 90, 2000},
    {"Education_buildings::Higher_education", "Education buildings", 2, 80, 300, 90, 2000},
    {"Education_buildings::Higher_education", "Education buildings", 1, 60, 300, 90, 2000},
    {"Healthcare_buildings::Staff_and_public_areas", "Healthcare buildings", 2, 80, 300, 90, 2650},
    {"Healthcare_buildings::Staff_and_public_areas", "Healthcare buildings", 1, 80, 300, 90, 2000},
    {"Healthcare_buildings::Patients_areas_and_consulting_rooms", "Healthcare buildings", 2, 80,
     300, 90, 2650},
    {"Healthcare_buildings::Patients_areas_and_consulting_rooms", "Healthcare buildings", 1, 80,
     300, 90, 2000},
    {"Multi_residential_buildings::Kitchen", "Multi-residential buildings", 2, 100, 100, 30, 3450},
    {"Multi_residential_buildings::Living_rooms_dining_rooms_studies",
     "Multi-residential buildings", 2, 100, 100, 30, 3450},
    {"Multi_residential_buildings::Non_residential_or_communal_spaces",
     "Multi-residential buildings", 2, 80, 200, 60, 2650},
    {"Retail_buildings::Sales_areas", "Retail buildings", 1, 35, 200, 200, 2650},
    {"Retail_buildings::Other_occupied_areas", "Retail buildings", 1, 80, 200, 60, 2650},
    {"Prison_buildings::Cells_and_custody_cells", "Prison buildings", 2, 80, 100, 0, 3150},
    {"Prison_buildings::Internal_association_or_atrium", "Prison buildings", 2, 80, 300, 210, 2650},
    {"Prison_buildings::Patient_care_spaces", "Prison buildings", 2, 80, 300, 210, 2650},
    {"Prison_buildings::Teaching_lecture_and_seminar_spaces", "Prison buildings", 2, 80, 300, 90,
     2000},
    {"Cr\xc3\xa8"
     "che_buildings::Occupied_spaces",
     "Cr\xc3\xa8"
     "che buildings",
     2, 80, 300, 90, 2000},
    {"Other_buildings::Occupied_spaces", "Other buildings", 1, 80, 300, 90, 2000},
};
enum { REQUIREMENTS = sizeof requirements / sizeof *requirements, OF_PROGRAM = 2 };
#define PREFIX "BREEAM::"

/* Hours of a grid, for each requirement of its program. */
struct grid_hours {
    size_t first_rule, n_rules; /* rows of the table above */
    double area, average_h[OF_PROGRAM], least_h[OF_PROGRAM];
    size_t darkest; /* sensor of the grid with the fewest hours */
    bool has_average[OF_PROGRAM], has_least[OF_PROGRAM];
};

/* Returns the first row for a program; unknown ones, and none, are offices. */
static size_t find_program(const char *program)
{
    if (program && strcmp(program, PREFIX "Creche_buildings::Occupied_spaces") == 0)
        program = PREFIX "Cr\xc3\xa8"
                         "che_buildings::Occupied_spaces";
    for (size_t i = 0; i < REQUIREMENTS && program; i++)
        if (strncmp(program, PREFIX, strlen(PREFIX)) == 0 &&
            strcmp(program + strlen(PREFIX), requirements[i].program) == 0)
            return i;
    return 0;
}

/* Returns the hours in which the mean over the grid's sensors has so many lux. */
static double average_hours(const struct orl_recipe_run *run, const struct orl_annual_grid *grid,
                            double lx)
{
    double hours = 0;
    for (size_t c = 0; c < run->result->n_columns; c++) {
        double sum = 0;
        for (size_t k = 0; k < grid->count; k++)
            sum += (double)orl_annual_row(run->result, run->result->total, grid->first + k)[c];
        if (sum / (double)grid->count >= lx)
            hours += 1.0 / run->report->year.steps.per_hour;
    }
    return hours;
}

static void count_hours(const struct orl_recipe_run *run, const struct orl_annual_grid *grid,
                        struct grid_hours *hours)
{
    const struct orl_model_grid *of_model = orl_recipe_grid(run, grid->name);
    hours->first_rule = find_program(of_model ? of_model->program : NULL);
    for (size_t i = hours->first_rule;
         i < REQUIREMENTS &&
         strcmp(requirements[i].program, requirements[hours->first_rule].program) == 0;
         i++)
        hours->n_rules++;
    for (size_t k = 0; k < grid->count; k++)
        hours->area += orl_recipe_sensor_area(run, of_model, k);
    for (size_t r = 0; r < hours->n_rules; r++) {
        const struct requirement *rule = &requirements[hours->first_rule + r];
        hours->average_h[r] = average_hours(run, grid, rule->average_lx);
        hours->least_h[r] = INFINITY;
        for (size_t k = 0; k < grid->count; k++) {
            const double h = orl_recipe_metric(run, ORL_METRIC_HOURS, ORL_WHEN_ALWAYS,
                                               rule->least_lx, 0, grid->first + k);
            if (h < hours->least_h[r]) {
                hours->least_h[r] = h;
                hours->darkest = k;
            }
        }
        hours->has_average[r] = hours->average_h[r] >= rule->hours;
        hours->has_least[r] = rule->least_lx == 0 || hours->least_h[r] >= rule->hours;
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* Writes 3 (complies), 2 (average), 1 (darkest point) or 0 for all sensors of each grid. */
static int write_passing(const struct orl_recipe_run *run, const struct grid_hours *all,
                         struct orl_error *err)
{
    char path[ORL_RESULT_PATH], name[256];
    int rc = orl_result_path(&run->out, path, err, "breeam_summary/pass_fail/grids_info.json");
    if (rc == 0)
        rc = orl_result_json(path, orl_recipe_grids_info(run, NULL), err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        double *values = calloc(grid->count + 1, sizeof *values), value = 0;
        for (size_t r = 0; r < all[g].n_rules && value < 3; r++)
            value = all[g].has_average[r] && all[g].has_least[r] ? 3
                    : all[g].has_average[r]                      ? 2
                    : all[g].has_least[r]                        ? 1
                                                                 : value;
        for (size_t k = 0; values && k < grid->count; k++)
            values[k] = value;
        orl_annual_file_name(grid->name, name, sizeof name);
        rc = values ? orl_result_path(&run->out, path, err, "breeam_summary/pass_fail/%s.pf", name)
                    : orl_error_no_memory(err);
        if (rc == 0)
            rc = orl_result_numbers(path, values, grid->count, 0, err);
        free(values);
    }
    return rc;
}

static json_t *program_to_json(const struct requirement *rule)
{
    return json_sprintf(PREFIX "%s", rule->program);
}

static int write_grids(const struct orl_recipe_run *run, const struct grid_hours *all,
                       struct orl_error *err)
{
    json_t *summary = json_object(), *darkest = json_object();
    char path[ORL_RESULT_PATH], name[256];
    for (size_t g = 0; g < run->report->n_grids; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        const struct orl_model_grid *of_model = orl_recipe_grid(run, grid->name);
        const struct requirement *rule = &requirements[all[g].first_rule];
        const struct orl_sensor *sensor = &run->job->request.sensors[grid->first + all[g].darkest];
        orl_annual_file_name(grid->name, name, sizeof name);
        json_object_set_new(
            summary, name,
            json_pack("{s:s, s:o, s:s, s:f, s:f}", "type", rule->building, "program-type",
                      program_to_json(rule), "display-name",
                      of_model ? of_model->display_name : grid->name, "average-illuminance-hours",
                      all[g].average_h[all[g].n_rules - 1], "minimum-illuminance-hours",
                      all[g].least_h[all[g].n_rules - 1]));
        json_object_set_new(darkest, name,
                            json_pack("{s:s, s:[f, f, f], s:[f, f, f]}", "type", "Sensor", "pos",
                                      sensor->position.x, sensor->position.y, sensor->position.z,
                                      "dir", sensor->direction.x, sensor->direction.y,
                                      sensor->direction.z));
    }
    int rc = orl_result_path(&run->out, path, err, "breeam_summary/grid_summary.json");
    rc = rc ? rc : orl_result_json(path, json_incref(summary), err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err,
                             "breeam_summary/minimum_illuminance_sensors.json");
    rc = rc ? rc : orl_result_json(path, json_incref(darkest), err);
    json_decref(summary);
    json_decref(darkest);
    return rc;
}

/* Sums up the grids of a program: its credits, areas, and hours weighted by areas. */
static json_t *sum_program(const struct orl_recipe_run *run, const struct grid_hours *all,
                           size_t first_rule, size_t n_rules)
{
    double area = 0, average_h = 0, least_h = 0, complying = 0;
    int credits = 0;
    for (size_t r = n_rules; r-- > 0;) {
        double of_rule = 0;
        area = average_h = least_h = 0;
        for (size_t g = 0; g < run->report->n_grids; g++) {
            if (all[g].first_rule != first_rule)
                continue;
            area += all[g].area;
            of_rule += all[g].has_average[r] && all[g].has_least[r] ? all[g].area : 0;
            average_h += all[g].average_h[0] * all[g].area;
            least_h += all[g].least_h[0] * all[g].area;
        }
        complying = of_rule;
        if (100 * of_rule / area >= requirements[first_rule + r].area &&
            requirements[first_rule + r].credits > credits)
            credits = requirements[first_rule + r].credits;
    }
    return json_pack("{s:o, s:i, s:b, s:f, s:f, s:f, s:s, s:i, s:i}", "program_type",
                     program_to_json(&requirements[first_rule]), "credits", credits, "comply",
                     credits > 0, "total_area", area, "area_comply", complying, "area_comply_%",
                     100 * complying / area, "type", requirements[first_rule].building,
                     "average-illuminance-hours", (int)(average_h / area),
                     "minimum-illuminance-hours", (int)(least_h / area));
}

/* Adds a program to its building: a building complies if all of its programs do, and has the
 * credits of the least. */
static void add_to_building(json_t *buildings, const json_t *program)
{
    const char *type = json_string_value(json_object_get(program, "type"));
    const json_int_t credits = json_integer_value(json_object_get(program, "credits"));
    const double area = json_number_value(json_object_get(program, "total_area"));
    json_t *building;
    size_t i;
    json_array_foreach(buildings, i, building)
    {
        if (strcmp(json_string_value(json_object_get(building, "type")), type) != 0)
            continue;
        const json_int_t before = json_integer_value(json_object_get(building, "credits"));
        const double area_before = json_number_value(json_object_get(building, "total_area"));
        json_object_set_new(building, "credits", json_integer(credits < before ? credits : before));
        json_object_set_new(building, "comply", json_boolean(credits > 0 && before > 0));
        json_object_set_new(building, "total_area", json_real(area_before + area));
        return;
    }
    json_array_append_new(buildings,
                          json_pack("{s:s, s:b, s:I, s:f}", "type", type, "comply", credits > 0,
                                    "credits", credits, "total_area", area));
}

int orl_recipe_write_breeam(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    struct grid_hours *all = calloc(run->report->n_grids + 1, sizeof *all);
    char path[ORL_RESULT_PATH];
    (void)job;
    if (!all)
        return orl_error_no_memory(err);
    json_t *programs = json_array(), *buildings = json_array();
    int rc = orl_recipe_write_hours(run, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++)
        count_hours(run, &run->report->grids[g], &all[g]);
    for (size_t i = 0; i < REQUIREMENTS && rc == 0; i++)
        for (size_t g = 0; g < run->report->n_grids; g++)
            if (all[g].first_rule == i) {
                json_array_append_new(programs, sum_program(run, all, i, all[g].n_rules));
                add_to_building(buildings, json_array_get(programs, json_array_size(programs) - 1));
                break;
            }
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "breeam_summary/program_summary.json");
    rc = rc ? rc : orl_result_json(path, json_incref(programs), err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "breeam_summary/summary.json");
    rc = rc ? rc : orl_result_json(path, json_incref(buildings), err);
    if (rc == 0)
        rc = write_grids(run, all, err);
    if (rc == 0)
        rc = write_passing(run, all, err);
    json_decref(programs);
    json_decref(buildings);
    free(all);
    return rc;
}
