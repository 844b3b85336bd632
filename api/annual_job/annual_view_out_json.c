#include "annual_job/annual_view_out_json.h"

#include <math.h>

#include "job/named_points_json.h"
#include "json/encode.h"
#include "json/members.h"

enum { WORD_MAX_BYTES = 1024 };
static const double highest_eye = 10; /* highest eye above a sensor, in metres */

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_name(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_string(value, path, WORD_MAX_BYTES, into, err);
}

int orl_annual_view_out_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_view_out_request *view_out_request = into;
    const struct orl_json_list points = {.items = &view_out_request->points,
                                         .count = &view_out_request->n_points,
                                         .size = sizeof *view_out_request->points,
                                         .most = ORL_VIEW_OUT_MOST_POINTS,
                                         .each = orl_named_point_from_json,
                                         .empty = "no point is given"};
    const struct orl_json_list openings = {.items = &view_out_request->openings,
                                           .count = &view_out_request->n_openings,
                                           .size = sizeof *view_out_request->openings,
                                           .most = ORL_VIEW_OUT_MOST_NAMES,
                                           .each = decode_name,
                                           .empty = "no opening is named"};
    const struct orl_json_list ground = {.items = &view_out_request->ground,
                                         .count = &view_out_request->n_ground,
                                         .size = sizeof *view_out_request->ground,
                                         .most = ORL_VIEW_OUT_MOST_NAMES,
                                         .each = decode_name,
                                         .empty = "no ground is named"};
    const struct orl_json_member members[] = {{"points", .list = &points},
                                              {"above_sensors",
                                               .real = &view_out_request->above_sensors,
                                               .least = -highest_eye, .most = highest_eye},
                                              {"openings", .list = &openings},
                                              {"ground", .list = &ground},
                                              {0}};
    const int rc = orl_json_members(value, path, members, err);
    if (rc == 0 && !orl_view_out_is_requested(view_out_request))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "from where? \"points\", \"above_sensors\", or both are wanted");
    return rc ? rc : orl_places_name(view_out_request->points, view_out_request->n_points, err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

static json_t *layers_to_json(unsigned layers)
{
    static const char *const names[] = {"sky", "landscape", "ground"};
    json_t *array = json_array();
    for (unsigned i = 0; array && i < 3; i++)
        if (layers & 1U << i)
            array = orl_json_append(array, json_string(names[i]));
    return array;
}

static json_t *points_to_json(const struct orl_view_out_request *view_out_request,
                              const struct orl_annual_report *report)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < view_out_request->n_points; i++) {
        const struct orl_view_out *view = &report->views[i];
        array =
            orl_json_append(array, json_pack("{s:o, s:f, s:o, s:o, s:s}", "name",
                                             orl_json_from_text(view_out_request->points[i].name),
                                             "sight_angle", view->sight_angle_deg, "distance",
                                             orl_json_from_real(view->distance_m), "layers",
                                             layers_to_json(view->layers), "level",
                                             orl_view_level_name(view->level)));
    }
    return array;
}

static json_t *grids_to_json(const struct orl_annual_report *report)
{
    json_t *array = json_array();
    for (size_t g = 0; array && report->view_shares && g < report->n_grids; g++) {
        const struct orl_view_shares *shares = &report->view_shares[g];
        array = orl_json_append(array, json_pack("{s:o, s:{s:f, s:f, s:f}, s:s}", "grid",
                                                 orl_json_from_text(report->grids[g].name),
                                                 "shares", "minimum", shares->percent[0], "medium",
                                                 shares->percent[1], "high", shares->percent[2],
                                                 "level", orl_view_level_name(shares->level)));
    }
    return array;
}

json_t *orl_annual_view_out_to_json(const struct orl_view_out_request *view_out_request,
                                    const struct orl_annual_report *report)
{
    if (!report->views)
        return json_null();
    return json_pack("{s:o, s:o}", "points", points_to_json(view_out_request, report), "grids",
                     grids_to_json(report));
}
