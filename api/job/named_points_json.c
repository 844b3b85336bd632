#include "job/named_points_json.h"

#include <stdio.h>

#include <oriel/base/coordinates.h>

#include "json/members.h"

enum { NAME_MAX_BYTES = 63 };

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
        {"name", .text = &place->name, .longest = NAME_MAX_BYTES},
        {"at", .decode = orl_point_from_json, .into = &place->at, .required = true},
        {0}};
    return orl_json_members(value, path, members, err);
}

int orl_places_name(struct orl_named_point *places, size_t n, struct orl_error *err)
{
    for (size_t i = 0; i < n; i++)
        if (!places[i].name && asprintf(&places[i].name, "point%zu", i + 1) < 0) {
            places[i].name = NULL;
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        }
    return 0;
}
