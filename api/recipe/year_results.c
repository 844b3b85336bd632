/* Results of recipes of a year: metrics of annual daylight, hours of sun, and glare. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "recipe/recipe_run.h"

/* The metrics of annual daylight, and their folders. */
static const struct {
    const char *folder, *ending, *title;
    enum orl_metric_kind kind;
    enum orl_result_colors colors;
} metrics[] = {
    {"da", "da", "Daylight Autonomy", ORL_METRIC_DA, ORL_COLORS_COMFORT},
    {"cda", "cda", "Continuous Daylight Autonomy", ORL_METRIC_CDA, ORL_COLORS_COMFORT},
    {"udi", "udi", "Useful Daylight Illuminance", ORL_METRIC_UDI, ORL_COLORS_COMFORT},
    {"udi_lower", "udi", "Useful Daylight Illuminance Lower", ORL_METRIC_UDI_LOWER,
     ORL_COLORS_NUANCED},
    {"udi_upper", "udi", "Useful Daylight Illuminance Upper", ORL_METRIC_UDI_UPPER,
     ORL_COLORS_GLARE},
};
enum { METRICS = sizeof metrics / sizeof *metrics };

/* Lux of daylight autonomy, and the bounds of UDI. */
struct thresholds {
    double autonomy, lower, upper;
};

/* Reads "-t 300 -lt 100 -ut 3000"; all parts are optional. */
static int read_thresholds(const struct orl_recipe_run *run, struct thresholds *ret_thresholds,
                           struct orl_error *err)
{
    struct thresholds t = {300, 100, 3000};
    const struct {
        const char *name;
        double *value;
    } parts[] = {{"-t ", &t.autonomy}, {"-lt ", &t.lower}, {"-ut ", &t.upper}};
    const char *at = orl_recipe_text(run->inputs, "thresholds");
    while (at && *(at += strspn(at, " "))) {
        size_t i = 0;
        char *end = NULL;
        while (i < 3 && strncmp(at, parts[i].name, strlen(parts[i].name)) != 0)
            i++;
        const double value = i < 3 ? strtod(at + strlen(parts[i].name), &end) : 0;
        if (i == 3 || !(value > 0))
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "thresholds: '%.60s': -t, -lt and -ut are expected, each with its "
                                 "lux",
                                 at);
        *parts[i].value = value;
        at = end;
    }
    *ret_thresholds = t;
    return 0;
}

static double evaluate(const struct orl_recipe_run *run, int m, enum orl_annual_when when,
                       const struct thresholds *t, size_t sensor)
{
    const enum orl_metric_kind kind = metrics[m].kind;
    const double low = kind == ORL_METRIC_DA || kind == ORL_METRIC_CDA ? t->autonomy
                       : kind == ORL_METRIC_UDI_UPPER                  ? t->upper
                                                                       : t->lower;
    return orl_recipe_metric(run, kind, when, low, t->upper, sensor);
}

/* Writes the files of one metric. values: of all sensors. */
static int write_metric(const struct orl_recipe_run *run, int m, const double *values,
                        struct orl_error *err)
{
    char path[ORL_RESULT_PATH], name[256];
    int rc = orl_result_path(&run->out, path, err, "metrics/%s/grids_info.json", metrics[m].folder);
    if (rc == 0)
        rc = orl_result_json(path, orl_recipe_grids_info(run, NULL), err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "metrics/%s/vis_metadata.json",
                             metrics[m].folder);
    if (rc == 0)
        rc =
            orl_result_legend(path, metrics[m].title, "Fraction", "%", 100, metrics[m].colors, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        orl_annual_file_name(grid->name, name, sizeof name);
        rc = orl_result_path(&run->out, path, err, "metrics/%s/%s.%s", metrics[m].folder, name,
                             metrics[m].ending);
        if (rc == 0)
            rc = orl_result_numbers(path, values + grid->first, grid->count, 2, err);
    }
    return rc;
}

/* Writes mean, minimum, maximum and uniformity of each grid and metric. values: METRICS arrays. */
static int write_summary(const struct orl_recipe_run *run, double *const *values,
                         struct orl_error *err)
{
    char path[ORL_RESULT_PATH], *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return orl_error_no_memory(err);
    fputs("Sensor Grid,Sensor Grid ID", stream);
    for (int m = 0; m < METRICS; m++) {
        char upper[16];
        snprintf(upper, sizeof upper, "%s", metrics[m].folder);
        for (char *at = upper; *at; at++)
            *at = *at >= 'a' && *at <= 'z' ? (char)(*at - 'a' + 'A') : *at;
        fprintf(stream, ",%s-Mean,%s-Minimum,%s-Maximum,%s-Uniformity Ratio", upper, upper, upper,
                upper);
    }
    for (size_t g = 0; g < run->report->n_grids; g++) {
        const struct orl_annual_grid *grid = &run->report->grids[g];
        const struct orl_model_grid *of_model = orl_recipe_grid(run, grid->name);
        char name[256];
        orl_annual_file_name(grid->name, name, sizeof name);
        fprintf(stream, "\n%s,%s", of_model ? of_model->display_name : grid->name, name);
        for (int m = 0; m < METRICS; m++) {
            double sum = 0, least = INFINITY, most = -INFINITY;
            for (size_t i = grid->first; i < grid->first + grid->count; i++) {
                sum += values[m][i];
                least = fmin(least, values[m][i]);
                most = fmax(most, values[m][i]);
            }
            const double mean = sum / (double)grid->count;
            fprintf(stream, ",%.2f,%.2f,%.2f,%.2f", mean, least, most,
                    mean > 0 ? 100 * least / mean : 0.0);
        }
    }
    fputc('\n', stream);
    fclose(stream);
    int rc = orl_result_path(&run->out, path, err, "grid_summary.csv");
    if (rc == 0)
        rc = orl_result_text(path, text, size, err);
    free(text);
    return rc;
}

static int write_metrics(struct orl_recipe_run *run, enum orl_annual_when when,
                         struct orl_error *err)
{
    double *values[METRICS] = {NULL};
    struct thresholds thresholds = {0};
    int rc = read_thresholds(run, &thresholds, err);
    for (int m = 0; m < METRICS && rc == 0; m++) {
        values[m] = calloc(run->report->n_sensors + 1, sizeof *values[m]);
        if (!values[m]) {
            rc = orl_error_no_memory(err);
            break;
        }
        for (size_t i = 0; i < run->report->n_sensors; i++)
            values[m][i] = evaluate(run, m, when, &thresholds, i);
        rc = write_metric(run, m, values[m], err);
    }
    if (rc == 0)
        rc = write_summary(run, values, err);
    for (int m = 0; m < METRICS; m++)
        free(values[m]);
    return rc;
}

int orl_recipe_write_year(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    (void)job;
    const int rc = orl_recipe_write_hours(run, err);
    return rc ? rc : write_metrics(run, ORL_WHEN_OCCUPIED, err);
}

int orl_recipe_write_en17037(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    (void)job;
    int rc = orl_recipe_write_hours(run, err);
    if (rc == 0)
        rc = orl_recipe_write_daylight_hours(run, err);
    if (rc == 0)
        rc = write_metrics(run, ORL_WHEN_DAYLIGHT, err);
    return rc ? rc : orl_recipe_write_en17037_folder(run, "en17037", err);
}

/* ---- Hours of sun ---------------------------------------------------------------------------- */

/* Writes sun-up-hours.txt: the hour of the year of each column. */
static int write_columns(const struct orl_recipe_run *run, const char *folder,
                         struct orl_error *err)
{
    const struct orl_annual_timeline *year = &run->report->year;
    char path[ORL_RESULT_PATH], *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < year->n_columns; i++)
        fprintf(stream, "%.10g\n", (year->step_of_column[i] + 0.5) / year->steps.per_hour);
    fclose(stream);
    int rc = orl_result_path(&run->out, path, err, "%s/sun-up-hours.txt", folder);
    if (rc == 0)
        rc = orl_result_text(path, text, size, err);
    free(text);
    return rc;
}

/* Returns true if the middle of the sun is in front of the sensor and lights it. Without the first,
 * the upper half of a sun at the horizon would count for a sensor that looks down. */
static bool sees_sun(const struct orl_recipe_run *run, size_t sensor, size_t column)
{
    const struct orl_annual_step *step = &run->result->steps[run->result->step_of_column[column]];
    const double altitude = step->sun_altitude_deg * ORL_DEG_TO_RAD,
                 north = orl_recipe_number(run->inputs, "north"),
                 azimuth = (step->sun_azimuth_deg - north) * ORL_DEG_TO_RAD;
    const struct orl_vec3 sun =
        orl_v3(-sin(azimuth) * cos(altitude), -cos(azimuth) * cos(altitude), sin(altitude));
    const float *direct = orl_annual_row(run->result, run->result->direct, sensor);
    return direct[column] > 0 && orl_dot(run->job->request.sensors[sensor].direction, sun) > 0;
}

/* Writes a line per sensor of the grid, with a number per column, and a total per sensor. */
static int write_sun(const struct orl_recipe_run *run, const struct orl_annual_grid *grid,
                     struct orl_error *err)
{
    char path[ORL_RESULT_PATH], name[256], *text = NULL;
    size_t size = 0;
    double *sums = calloc(grid->count + 1, sizeof *sums);
    FILE *stream = sums ? open_memstream(&text, &size) : NULL;
    if (!stream) {
        free(sums);
        return orl_error_no_memory(err);
    }
    for (size_t k = 0; k < grid->count; k++) {
        for (size_t c = 0; c < run->result->n_columns; c++) {
            const bool sees = sees_sun(run, grid->first + k, c);
            fputs(sees ? "1" : "0", stream);
            fputc(c + 1 < run->result->n_columns ? '\t' : '\n', stream);
            sums[k] += sees / (double)run->report->year.steps.per_hour;
        }
    }
    fclose(stream);
    orl_annual_file_name(grid->name, name, sizeof name);
    int rc = orl_result_path(&run->out, path, err, "results/direct_sun_hours/%s.ill", name);
    if (rc == 0)
        rc = orl_result_text(path, text, size, err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "results/cumulative/%s.res", name);
    if (rc == 0)
        rc = orl_result_numbers(path, sums, grid->count, 2, err);
    free(text);
    free(sums);
    return rc;
}

int orl_recipe_write_sun_hours(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    static const char *const folders[] = {"results/direct_sun_hours", "results/cumulative"};
    const double timestep = run->report->year.steps.per_hour;
    char path[ORL_RESULT_PATH];
    int rc = 0;
    (void)job;
    for (int i = 0; i < 2 && rc == 0; i++) {
        rc = write_columns(run, folders[i], err);
        if (rc == 0)
            rc = orl_result_path(&run->out, path, err, "%s/grids_info.json", folders[i]);
        if (rc == 0)
            rc = orl_result_json(path, orl_recipe_grids_info(run, NULL), err);
    }
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "%s/timestep.txt", folders[0]);
    if (rc == 0)
        rc = orl_result_numbers(path, &timestep, 1, 0, err);
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++)
        rc = write_sun(run, &run->report->grids[g], err);
    return rc;
}

/* ---- Glare ----------------------------------------------------------------------------------- */

/* Writes DGP of each sensor and column, 0 outside the hours of use, and the share of the hours of
 * use without glare. Viewpoints are in the order of sensors. */
static int write_dgp(const struct orl_recipe_run *run, const struct orl_annual_grid *grid,
                     struct orl_error *err)
{
    const double bound = orl_recipe_number(run->inputs, "glare-threshold");
    const struct orl_annual_period *use = &run->report->periods[ORL_WHEN_OCCUPIED];
    char path[ORL_RESULT_PATH], name[256], *text = NULL;
    size_t size = 0;
    double *free_share = calloc(grid->count + 1, sizeof *free_share);
    FILE *stream = free_share ? open_memstream(&text, &size) : NULL;
    if (!stream) {
        free(free_share);
        return orl_error_no_memory(err);
    }
    for (size_t k = 0; k < grid->count; k++) {
        const float *dgp = run->report->viewpoint_hours[grid->first + k].dgp;
        double above_h = 0;
        for (size_t c = 0; c < run->result->n_columns; c++)
            fprintf(stream, "%.4f%c", isnan(dgp[c]) ? 0 : (double)dgp[c],
                    c + 1 < run->result->n_columns ? '\t' : '\n');
        for (size_t c = 0; c < use->n_columns; c++)
            above_h += dgp[use->columns[c]] > bound ? use->step_h : 0;
        free_share[k] = use->hours > 0 ? 100 * (1 - above_h / use->hours) : 0;
    }
    fclose(stream);
    orl_annual_file_name(grid->name, name, sizeof name);
    int rc = orl_result_path(&run->out, path, err, "results/%s.dgp", name);
    if (rc == 0)
        rc = orl_result_text(path, text, size, err);
    if (rc == 0)
        rc = orl_result_path(&run->out, path, err, "metrics/ga/%s.ga", name);
    if (rc == 0)
        rc = orl_result_numbers(path, free_share, grid->count, 2, err);
    free(text);
    free(free_share);
    return rc;
}

int orl_recipe_write_glare(struct orl_recipe_run *run, size_t job, struct orl_error *err)
{
    static const char *const folders[] = {"results", "metrics/ga"};
    char path[ORL_RESULT_PATH];
    int rc = write_columns(run, "results", err);
    (void)job;
    for (int i = 0; i < 2 && rc == 0; i++) {
        rc = orl_result_path(&run->out, path, err, "%s/grids_info.json", folders[i]);
        if (rc == 0)
            rc = orl_result_json(path, orl_recipe_grids_info(run, NULL), err);
    }
    for (size_t g = 0; g < run->report->n_grids && rc == 0; g++)
        rc = write_dgp(run, &run->report->grids[g], err);
    return rc;
}
