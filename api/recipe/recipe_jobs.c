/* Jobs of recipes: their inputs as Oriel's documents. */
#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/job/sun_position.h>

#include "recipe/recipe_run.h"
#include "recipe/recipe_sky.h"

#define SCHEDULE_FILE "recipe_schedule.txt"
#define CONSTANT_FILE "recipe_constant.wea"

int orl_recipe_add_job(struct orl_recipe_run *run, json_t *document, struct orl_error *err)
{
    if (!document)
        return orl_error_no_memory(err);
    run->documents[run->n_jobs++] = document;
    return 0;
}

static const char *file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* ---- Jobs under one sky ---------------------------------------------------------------------- */

/* Makes a job of the grids and views under a sky, which it takes. */
static json_t *make_render(const struct orl_recipe_run *run, json_t *sky)
{
    json_t *document = json_pack("{s:s, s:{s:O}, s:o, s:O}", "kind", "render", "scene", "project",
                                 json_object_get(run->inputs, "model"), "sky", sky, "seed",
                                 json_object_get(run->inputs, "seed"));
    json_t *samples = json_object_get(run->inputs, "samples");
    if (document && samples)
        json_object_set(document, "gather_samples", samples);
    return document;
}

/* CIE's overcast sky, and a ground that reflects a fifth: gensky -c -g 0.2. */
int orl_recipe_sky_job(struct orl_recipe_run *run, struct orl_error *err)
{
    return orl_recipe_add_job(
        run,
        make_render(run, json_pack("{s:{s:s, s:f, s:f}}", "cie", "type", "overcast",
                                   "diffuse_horizontal_lx", 100000.0, "ground_reflectance", 0.2)),
        err);
}

/* The sky alone lights the sensors: black ground, and no light by reflections. */
int orl_recipe_sky_view_job(struct orl_recipe_run *run, struct orl_error *err)
{
    const char *kind = orl_recipe_text(run->inputs, "cloudy-sky");
    json_t *document =
        make_render(run, json_pack("{s:{s:s, s:f, s:f}}", "cie", "type",
                                   strcmp(kind, "cloudy") == 0 ? "overcast" : "uniform",
                                   "diffuse_horizontal_lx", 100000.0, "ground_reflectance", 0.0));
    if (document)
        json_object_update_new(document, json_pack("{s:{s:s, s:s, s:s, s:s, s:s}, s:s}", "effects",
                                                   "interreflection", "skip", "exterior", "skip",
                                                   "glossy", "skip", "caustics", "skip", "lamps",
                                                   "skip", "dark", "expected"));
    return orl_recipe_add_job(run, document, err);
}

/* Refuses quantities that are not light as the eye sees it. */
static int check_metric(const struct orl_recipe_run *run, struct orl_error *err)
{
    const char *metric = orl_recipe_text(run->inputs, "metric");
    const bool of_views = orl_recipe_text(run->inputs, "view-filter") != NULL;
    if (strcmp(metric, "illuminance") == 0 || (of_views && strcmp(metric, "luminance") == 0))
        return 0;
    orl_error_set(err, ORL_ERR_UNSUPPORTED, "metric: %s is not supported for %s", metric,
                  of_views ? "views" : "grids");
    orl_error_hint(err, of_views ? "luminance and illuminance are" : "illuminance is");
    return ORL_ERR_UNSUPPORTED;
}

int orl_recipe_moment_job(struct orl_recipe_run *run, struct orl_error *err)
{
    json_t *sky = NULL;
    int rc = check_metric(run, err);
    if (rc == 0)
        rc = orl_recipe_sky_to_json(orl_recipe_text(run->inputs, "sky"), &sky, err);
    return rc ? rc : orl_recipe_add_job(run, make_render(run, sky), err);
}

/* ---- LEED, option 2 -------------------------------------------------------------------------- */

/* Returns the row with the most direct light within 15 days around the 21st of a month, in the hour
 * that begins then; NULL if there is none. Of equal ones the last, as in Honeybee. */
static const struct orl_recipe_weather_row *clearest_row(const struct orl_weather_rows *weather,
                                                         int month, int hour)
{
    static const short before[12] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    const struct orl_recipe_weather_row *best = NULL;
    for (size_t i = 0; i < weather->count; i++) {
        const struct orl_recipe_weather_row *row = &weather->rows[i];
        const int days = before[row->month - 1] + row->day - (before[month - 1] + 21);
        if ((int)floor(row->hour) != hour || days < -15 || days >= 15)
            continue;
        if (!best || row->direct_normal >= best->direct_normal)
            best = row;
    }
    return best;
}

/* LEED v4.1, option 2: a clear sky at the equinox, whose light is the mean of the clearest hours
 * around both equinoxes. */
static json_t *equinox_sky(const struct orl_recipe_run *run, int hour)
{
    const struct orl_weather_rows *weather = &run->weather;
    const struct orl_recipe_weather_row *spring = clearest_row(weather, 3, hour),
                                        *autumn = clearest_row(weather, 9, hour);
    if (!spring || !autumn)
        return NULL;
    const struct orl_sun_time time = {.latitude_deg = weather->latitude_deg,
                                      .longitude_deg = weather->longitude_deg,
                                      .time_zone_h = weather->time_zone_h,
                                      .month = 3,
                                      .day = 21,
                                      .hour = hour};
    double altitude, azimuth;
    orl_sun_angles(&time, &altitude, &azimuth);
    return json_pack(
        "{s:{s:f, s:f, s:f, s:f, s:f}, s:s}", "perez", "sun_altitude", altitude, "sun_azimuth",
        remainder(azimuth - orl_recipe_number(run->inputs, "north"), 360), "direct_normal_w_m2",
        (spring->direct_normal + autumn->direct_normal) / 2, "diffuse_horizontal_w_m2",
        (spring->diffuse_horizontal + autumn->diffuse_horizontal) / 2, "ground_reflectance", 0.2,
        "normalise", "gendaylit");
}

int orl_recipe_equinox_jobs(struct orl_recipe_run *run, struct orl_error *err)
{
    static const int hours[] = {9, 15};
    int rc = 0;
    for (size_t i = 0; i < sizeof hours / sizeof *hours && rc == 0; i++) {
        json_t *sky = equinox_sky(run, hours[i]);
        if (!sky)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "the weather file has no hours from %d:00 around 21 March and 21 "
                                 "September",
                                 hours[i]);
        rc = orl_recipe_add_job(run, make_render(run, sky), err);
    }
    return rc;
}

/* ---- Years ----------------------------------------------------------------------------------- */

json_t *orl_recipe_year_document(const struct orl_recipe_run *run)
{
    const json_t *inputs = run->inputs;
    json_t *samples = json_object_get(inputs, "samples");
    json_t *document = json_pack(
        "{s:s, s:{s:O}, s:s, s:O, s:O}", "kind", "annual", "scene", "project",
        json_object_get(inputs, "model"), "weather", file_name(orl_recipe_weather(inputs)), "north",
        json_object_get(inputs, "north"), "seed", json_object_get(inputs, "seed"));
    if (document && samples)
        json_object_set(document, "samples", samples);
    if (document && json_object_get(run->files, SCHEDULE_FILE))
        json_object_set_new(document, "occupancy", json_pack("{s:s}", "file", SCHEDULE_FILE));
    return document;
}

int orl_recipe_year_job(struct orl_recipe_run *run, struct orl_error *err)
{
    return orl_recipe_add_job(run, orl_recipe_year_document(run), err);
}

int orl_recipe_daylight_year_job(struct orl_recipe_run *run, struct orl_error *err)
{
    json_t *document = orl_recipe_year_document(run);
    if (document)
        json_object_set_new(document, "rules", json_pack("[s]", "EN 17037"));
    return orl_recipe_add_job(run, document, err);
}

/* The recipe replaces the weather by constant light, so that every hour with the sun up counts. Few
 * paths do, for direct sunlight needs none. */
int orl_recipe_sun_hours_job(struct orl_recipe_run *run, struct orl_error *err)
{
    static const double constant_w_m2 = 1000;
    char *text = orl_weather_rows_constant(&run->weather, constant_w_m2, constant_w_m2);
    json_t *document = text ? orl_recipe_year_document(run) : NULL;
    int rc = document ? 0 : orl_error_no_memory(err);
    if (rc == 0 && (json_object_set_new(run->files, CONSTANT_FILE, json_string(text)) ||
                    json_object_set_new(document, "weather", json_string(CONSTANT_FILE))))
        rc = orl_error_no_memory(err);
    if (rc == 0 && !json_object_get(document, "samples"))
        json_object_set_new(document, "samples", json_integer(16));
    free(text);
    return rc ? rc : orl_recipe_add_job(run, document, err);
}

/* ---- Glare ----------------------------------------------------------------------------------- */

/* Appends a seat for each sensor of a grid of the model, and its row to rows. */
static int add_seats(const json_t *asset, json_t *seats, json_t *rows)
{
    const json_t *sensor;
    size_t i;
    int rc = 0;
    json_array_foreach(json_object_get(asset, "sensors"), i, sensor)
    {
        json_t *at = json_object_get(sensor, "pos"), *towards = json_object_get(sensor, "dir"),
               *row = json_copy(at);
        char name[32];
        snprintf(name, sizeof name, "seat-%zu", json_array_size(seats));
        rc |= json_array_extend(row, towards);
        rc |= json_array_append_new(rows, row);
        rc |= json_array_append_new(
            seats, json_pack("{s:s, s:O, s:O}", "name", name, "at", at, "towards", towards));
    }
    return rc;
}

/* Makes the year of all grids that the filter keeps: each sensor is also a seat, in the same
 * order. */
int orl_recipe_glare_job(struct orl_recipe_run *run, struct orl_error *err)
{
    const char *pattern = orl_recipe_text(run->inputs, "grid-filter");
    const json_t *assets = json_object_get(
        json_object_get(json_object_get(run->model, "properties"), "radiance"), "sensor_grids");
    json_t *document = run->model ? orl_recipe_year_document(run) : NULL, *seats = json_array(),
           *grids = json_array();
    int rc = 0;
    if (!run->model)
        rc = orl_error_set(err, ORL_ERR_UNSUPPORTED,
                           "this recipe needs a Honeybee model, not a folder");
    for (size_t g = 0; g < run->grids.count && rc == 0; g++) {
        json_t *rows = json_array();
        if (fnmatch(pattern, run->grids.items[g].full_id, 0) == 0 &&
            (add_seats(json_array_get(assets, g), seats, rows) ||
             json_array_append_new(grids, json_pack("{s:s, s:O}", "name",
                                                    run->grids.items[g].full_id, "sensors", rows))))
            rc = orl_error_no_memory(err);
        json_decref(rows);
    }
    if (rc == 0 && json_array_size(seats) == 0)
        rc = orl_error_set(err, ORL_ERR_INVALID,
                           "the model has no sensors in grids that match '%s'", pattern);
    if (rc == 0 && (json_object_set(document, "grids", grids) ||
                    json_object_set_new(document, "glare", json_pack("{s:O}", "seats", seats))))
        rc = orl_error_no_memory(err);
    json_decref(seats);
    json_decref(grids);
    if (rc == 0)
        return orl_recipe_add_job(run, document, err);
    json_decref(document);
    return rc;
}
