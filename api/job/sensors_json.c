#include "job/job_members_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/input_checks.h>
#include <oriel/base/limits.h>

#include "schemas.h"
#include "view/view_json.h"
#include "json/decode.h"
#include "json/encode.h"

static int decode_sensor(const json_t *row, const char *path, void *into, struct orl_error *err)
{
    struct orl_sensor *sensor = into;
    double v[6] = {0};
    int rc = orl_json_array(row, path, 6, err);
    if (rc == 0 && json_array_size(row) != 6)
        rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                           "six numbers are expected: x, y, z and the direction dx, dy, dz");
    for (size_t k = 0; k < 6 && rc == 0; k++) {
        char at[ORL_JSON_PATH_MAX];
        snprintf(at, sizeof at, "%.120s[%zu]", path, k);
        rc = orl_json_real(json_array_get(row, k), at, &v[k], err);
    }
    const struct orl_sensor read = {orl_v3(v[0], v[1], v[2]), orl_v3(v[3], v[4], v[5])};
    if (rc)
        return rc;
    rc = orl_check_point(read.position, path, err);
    if (rc == 0)
        rc = orl_check_direction(read.direction, path, err);
    if (rc == 0)
        *sensor = read;
    else
        orl_error_at(err, NULL, 0, path);
    return rc;
}

/* Decodes the name of a sensor file, or a list of sensors. */
int orl_job_sensors_from_json(const json_t *sensors, const char *path, struct orl_job *job,
                              struct orl_error *err)
{
    const struct orl_json_member members[] = {{"file", .text = &job->sensors_file}, {0}};
    const struct orl_json_list list = {.items = &job->sensors,
                                       .count = &job->n_sensors,
                                       .size = sizeof *job->sensors,
                                       .each = decode_sensor};
    return json_is_object(sensors)
               ? orl_json_members(sensors, path, &orl_schema_sensor_file, members, err)
               : orl_json_list(sensors, path, &orl_schema_sensor_list, &list, err);
}

/* A grid while it is decoded. */
struct draft {
    char *name;
    struct orl_job part; /* holds only the grid's sensors */
};

static int decode_sensors(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    const int rc = orl_job_sensors_from_json(value, path, &draft->part, err);
    if (rc == 0 && draft->part.n_sensors == 0 && !draft->part.sensors_file)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "there are no sensors");
    return rc;
}

static int decode_grid(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    const struct orl_json_member members[] = {
        {"name", .text = &draft->name}, {"sensors", .decode = decode_sensors, .into = draft}, {0}};
    return orl_json_members(value, path, &orl_schema_grid, members, err);
}

/* Moves names and files into job, and appends copies of the sensors to the job's. */
static int move_drafts_to_job(struct draft *drafts, size_t n, struct orl_job *job,
                              struct orl_error *err)
{
    size_t sensors = job->n_sensors;
    for (size_t i = 0; i < n; i++)
        sensors += drafts[i].part.n_sensors;
    struct orl_sensor *grown = realloc(job->sensors, (sensors + 1) * sizeof *grown);
    if (grown)
        job->sensors = grown;
    job->grids = calloc(n + 1, sizeof *job->grids);
    if (!grown || !job->grids)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < n; i++) {
        struct orl_job *part = &drafts[i].part;
        job->grids[job->n_grids++] = (struct orl_grid_request){drafts[i].name, part->sensors_file,
                                                               job->n_sensors, part->n_sensors};
        if (part->n_sensors > 0)
            memcpy(job->sensors + job->n_sensors, part->sensors,
                   part->n_sensors * sizeof *part->sensors);
        job->n_sensors += part->n_sensors;
        drafts[i].name = NULL;
        part->sensors_file = NULL;
    }
    return 0;
}

int orl_grids_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_job *job = into;
    struct draft *drafts = NULL;
    size_t n = 0;
    const struct orl_json_list list = {
        .items = &drafts, .count = &n, .size = sizeof *drafts, .each = decode_grid};
    int rc = orl_json_list(value, path, &orl_schema_grids, &list, err);
    if (rc == 0 && (job->n_sensors > 0 || job->sensors_file))
        rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                           "a job can have \"sensors\" or \"grids\", not both");
    if (rc == 0)
        rc = move_drafts_to_job(drafts, n, job, err);
    for (size_t i = 0; drafts && i < n; i++) {
        free(drafts[i].name);
        orl_job_done(&drafts[i].part);
    }
    free(drafts);
    return rc;
}

json_t *orl_sensor_summary_to_json(const struct orl_result *result, size_t first, size_t count)
{
    const struct orl_sensor_summary s = orl_sensor_summary_of(result, first, count);
    return json_pack(
        "{s:o, s:[o, o], s:o, s:o, s:o, s:o}", "mean_lx", orl_json_from_real(s.mean_lx),
        "interval_95_lx", orl_json_from_real(s.interval_95_lx[0]),
        orl_json_from_real(s.interval_95_lx[1]), "minimum_lx", orl_json_from_real(s.minimum_lx),
        "maximum_lx", orl_json_from_real(s.maximum_lx), "uniformity",
        orl_json_from_real(s.uniformity), "share_300", orl_json_from_real(s.share_300));
}

json_t *orl_grids_to_json(const struct orl_result *result)
{
    json_t *grids = result->n_grids > 0 ? json_array() : NULL;
    for (size_t i = 0; i < result->n_grids && grids; i++) {
        const struct orl_grid_result *grid = &result->grids[i];
        if (json_array_append_new(
                grids, json_pack("{s:s, s:I, s:I, s:s*, s:s*, s:s*, s:o}", "name", grid->name,
                                 "first", (json_int_t)grid->first, "count", (json_int_t)grid->count,
                                 "res", grid->res, "npy", grid->npy, "map", grid->map, "summary",
                                 orl_sensor_summary_to_json(result, grid->first, grid->count)))) {
            json_decref(grids);
            return NULL;
        }
    }
    return grids;
}

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_threshold(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_heat_map_request *request = into;
    const struct orl_json_member number = {.real = &request->thresholds_lx[request->n_thresholds]};
    const int rc = orl_json_value(value, path, orl_schema_heat_map_thresholds.items, &number, err);
    request->n_thresholds += rc == 0;
    return rc;
}

static int decode_thresholds(const json_t *value, const char *path, void *request,
                             struct orl_error *err)
{
    return orl_json_each(value, path, &orl_schema_heat_map_thresholds, decode_threshold, request,
                         err);
}

/* Decodes the scene's unit of length. */
static int decode_unit(const json_t *value, const char *path, void *ret_unit, struct orl_error *err)
{
    char label[ORL_PICTURE_LABEL_MAX];
    const int rc = orl_label_from_json(value, path, label, err);
    if (rc)
        return rc;
    if (strlen(label) >= ORL_LENGTH_UNIT_MAX)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "it can have at most %d letters",
                             ORL_LENGTH_UNIT_MAX - 1);
    memcpy(ret_unit, label, strlen(label) + 1);
    return 0;
}

int orl_heat_map_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_heat_map_request *request = into;
    struct orl_false_color *colors = &request->colors;
    const struct orl_json_member members[] = {
        {"scale", .decode = orl_scale_from_json, .into = &colors->scale},
        {"decades", .real = &colors->decades},
        {"divisions", .whole_32 = &colors->divisions},
        {"palette", .decode = orl_palette_from_json, .into = &colors->palette},
        {"thresholds", .decode = decode_thresholds, .into = request},
        {"length_unit", .decode = decode_unit, .into = request->length_unit},
        {0}};
    request->asked = true;
    return orl_json_members(value, path, &orl_schema_heat_map, members, err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

json_t *orl_sensor_files_to_json(const struct orl_sensor_files *files)
{
    json_t *maps = json_array();
    if (!files->csv) {
        json_decref(maps);
        return NULL;
    }
    for (size_t i = 0; i < files->n_maps; i++)
        if (json_array_append_new(maps,
                                  json_pack("{s:s, s:s*, s:s*, s:I}", "png", files->maps[i].png,
                                            "svg", files->maps[i].svg, "dat", files->maps[i].dat,
                                            "sensors", (json_int_t)files->maps[i].sensors))) {
            json_decref(maps);
            return NULL;
        }
    return json_pack("{s:s, s:s*, s:o}", "csv", files->csv, "res", files->res, "maps", maps);
}

static int read_vector(const json_t *value, const char *path, struct orl_vec3 *ret,
                       struct orl_error *err)
{
    double numbers[3];
    if (!json_is_array(value) || json_array_size(value) != 3)
        return orl_json_wrong_type(value, path, "an array of 3 numbers", err);
    for (size_t i = 0; i < 3; i++) {
        const int rc = orl_json_real(json_array_get(value, i), path, &numbers[i], err);
        if (rc)
            return rc;
    }
    *ret = orl_v3(numbers[0], numbers[1], numbers[2]);
    return 0;
}

/* Sets path as the place of a check's error; returns code. */
static int with_path(int code, const char *path, struct orl_error *err)
{
    if (code < 0)
        orl_error_at(err, NULL, 0, path);
    return code;
}

int orl_point_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_vec3 point = {0, 0, 0};
    int rc = read_vector(value, path, &point, err);
    if (rc == 0)
        rc = with_path(orl_check_point(point, path, err), path, err);
    if (rc == 0)
        *(struct orl_vec3 *)into = point;
    return rc;
}

int orl_direction_from_json(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_vec3 direction = {0, 0, 0};
    int rc = read_vector(value, path, &direction, err);
    if (rc == 0)
        rc = with_path(orl_check_direction(direction, path, err), path, err);
    if (rc == 0)
        *(struct orl_vec3 *)into = direction;
    return rc;
}

int orl_named_point_from_json(const json_t *value, const char *path, void *into,
                              struct orl_error *err)
{
    struct orl_named_point *place = into;
    const struct orl_json_member members[] = {
        {"name", .text = &place->name},
        {"at", .decode = orl_point_from_json, .into = &place->at},
        {0}};
    return orl_json_members(value, path, &orl_schema_named_point, members, err);
}

int orl_places_name(struct orl_named_point *places, size_t n, struct orl_error *err)
{
    for (size_t i = 0; i < n; i++)
        if (!places[i].name && asprintf(&places[i].name, "point%zu", i + 1) < 0) {
            places[i].name = NULL;
            return orl_error_no_memory(err);
        }
    return 0;
}
