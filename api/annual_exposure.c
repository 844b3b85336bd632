#include "annual_exposure.h"

#include <stdio.h>

#include "encode.h"
#include "members.h"

enum { NAME_MAX_BYTES = 63 };

/* ---- The wish -------------------------------------------------------------------------------- */

static int decode_place(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    double numbers[3];
    if (!json_is_array(value) || json_array_size(value) != 3)
        return orl_json_wrong_type(value, path, "an array of 3 numbers", err);
    for (size_t i = 0; i < 3; i++) {
        const int rc = orl_json_real(json_array_get(value, i), path, &numbers[i], err);
        if (rc)
            return rc;
    }
    *(struct orl_vec3 *)into = orl_v3(numbers[0], numbers[1], numbers[2]);
    return 0;
}

static int decode_point(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_exposure_point *point = into;
    const struct orl_json_member members[] = {
        {"name", .text = &point->name, .longest = NAME_MAX_BYTES},
        {"at", .decode = decode_place, .into = &point->at, .required = true},
        {0}};
    return orl_json_members(value, path, members, err);
}

static int name_points(struct orl_exposure_wish *wish, struct orl_error *err)
{
    for (size_t i = 0; i < wish->n_points; i++)
        if (!wish->points[i].name && asprintf(&wish->points[i].name, "point%zu", i + 1) < 0) {
            wish->points[i].name = NULL;
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        }
    return 0;
}

int orl_annual_exposure_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_exposure_wish *wish = into;
    const struct orl_json_list points = {.items = &wish->points,
                                         .count = &wish->n_points,
                                         .size = sizeof *wish->points,
                                         .most = ORL_EXPOSURE_MOST_POINTS,
                                         .each = decode_point,
                                         .empty = "no point is given"};
    const struct orl_json_member members[] = {
        {"points", .list = &points, .required = true},
        {"least_altitude", .real = &wish->least_altitude_deg, .least = 0, .most = 90},
        {0}};
    const int rc = orl_json_members(value, path, members, err);
    return rc ? rc : name_points(wish, err);
}

/* ---- What was found -------------------------------------------------------------------------- */

json_t *orl_annual_exposure_to_json(const struct orl_exposure_wish *wish,
                                    const struct orl_annual_report *report)
{
    json_t *array = json_array();
    if (report->n_exposures == 0) {
        json_decref(array);
        return json_null();
    }
    for (size_t i = 0; array && i < report->n_exposures; i++) {
        const struct orl_exposure *e = &report->exposures[i];
        json_t *point = json_pack("{s:o, s:f, s:i, s:i, s:f, s:s}", "name",
                                  orl_json_from_text(wish->points[i].name), "hours", e->hours,
                                  "month", e->month, "day", e->day, "last_day_hours",
                                  e->last_day_hours, "level", orl_exposure_level_name(e->level));
        if (json_array_append_new(array, point) < 0) {
            json_decref(array);
            array = NULL;
        }
    }
    return json_pack("{s:f, s:o}", "least_altitude", wish->least_altitude_deg, "points", array);
}
