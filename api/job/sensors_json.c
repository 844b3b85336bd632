#include "job/sensors_json.h"

#include <stdio.h>

#include <oriel/base/coordinates.h>
#include <oriel/base/limits.h>

#include "json/members.h"

enum { FILE_NAME_MAX_BYTES = 1024 };

static int decode_sensor(const json_t *row, const char *path, void *into, struct orl_error *err)
{
    struct orl_sensor *sensor = into;
    double v[6] = {0};
    int rc = orl_json_array(row, path, 6, err);
    if (rc == 0 && json_array_size(row) != 6)
        rc = orl_json_fail(err, ORL_ERR_INVALID, path,
                           "six numbers are wanted: x, y, z and the direction dx, dy, dz");
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
    const struct orl_json_member members[] = {
        {"file", .text = &job->sensors_file, .longest = FILE_NAME_MAX_BYTES, .required = true},
        {0}};
    const struct orl_json_list list = {.items = &job->sensors,
                                       .count = &job->n_sensors,
                                       .size = sizeof *job->sensors,
                                       .most = ORL_LIMIT_SENSORS,
                                       .each = decode_sensor};
    return json_is_object(sensors) ? orl_json_members(sensors, path, members, err)
                                   : orl_json_list(sensors, path, &list, err);
}
