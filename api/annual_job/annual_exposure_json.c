#include "annual_job/annual_exposure_json.h"

#include "job/named_points_json.h"
#include "json/encode.h"
#include "json/members.h"

/* ---- Request --------------------------------------------------------------------------------- */

int orl_annual_exposure_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_exposure_request *exposure_request = into;
    const struct orl_json_list points = {.items = &exposure_request->points,
                                         .count = &exposure_request->n_points,
                                         .size = sizeof *exposure_request->points,
                                         .most = ORL_EXPOSURE_MOST_POINTS,
                                         .each = orl_named_point_from_json,
                                         .empty = "no point is given"};
    const struct orl_json_member members[] = {
        {"points", .list = &points, .required = true},
        {"least_altitude", .real = &exposure_request->least_altitude_deg, .least = 0, .most = 90},
        {0}};
    const int rc = orl_json_members(value, path, members, err);
    return rc ? rc : orl_places_name(exposure_request->points, exposure_request->n_points, err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

json_t *orl_annual_exposure_to_json(const struct orl_exposure_request *exposure_request,
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
                                  orl_json_from_text(exposure_request->points[i].name), "hours",
                                  e->hours, "month", e->month, "day", e->day, "last_day_hours",
                                  e->last_day_hours, "level", orl_exposure_level_name(e->level));
        if (json_array_append_new(array, point) < 0) {
            json_decref(array);
            array = NULL;
        }
    }
    return json_pack("{s:f, s:o}", "least_altitude", exposure_request->least_altitude_deg, "points",
                     array);
}
