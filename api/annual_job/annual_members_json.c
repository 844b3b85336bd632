#include <math.h>
#include <stdio.h>

#include "annual_job/annual_members_json.h"
#include "job/job_members_json.h"
#include "schemas.h"
#include "json/decode.h"
#include "json/encode.h"

static int decode_term(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_matrix_term *term = into;
    const struct orl_json_member members[] = {
        {"grid", .text = &term->grid},         {"coefficients", .text = &term->coefficients},
        {"view", .text = &term->view},         {"transmission", .text = &term->transmission},
        {"daylight", .text = &term->daylight}, {"sky", .text = &term->sky},
        {"subtract", .flag = &term->subtract}, {0}};
    return orl_json_members(value, path, &orl_schema_matrix_term, members, err);
}

int orl_annual_matrices_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_annual_request *request = into;
    const struct orl_json_list list = {.items = &request->terms,
                                       .count = &request->n_terms,
                                       .size = sizeof *request->terms,
                                       .each = decode_term};
    return orl_json_list(value, path, &orl_schema_annual_request_matrices, &list, err);
}

/* ---- Request --------------------------------------------------------------------------------- */

int orl_annual_exposure_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_exposure_request *exposure_request = into;
    const struct orl_json_list points = {.items = &exposure_request->points,
                                         .count = &exposure_request->n_points,
                                         .size = sizeof *exposure_request->points,
                                         .each = orl_named_point_from_json};
    const struct orl_json_member members[] = {
        {"points", .list = &points},
        {"least_altitude", .real = &exposure_request->least_altitude_deg},
        {0}};
    const int rc = orl_json_members(value, path, &orl_schema_sun_exposure, members, err);
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

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_name(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_text_of(value, path, &orl_schema_file_name, into, err);
}

int orl_annual_view_out_from_json(const json_t *value, const char *path, void *into,
                                  struct orl_error *err)
{
    struct orl_view_out_request *view_out_request = into;
    const struct orl_json_list points = {.items = &view_out_request->points,
                                         .count = &view_out_request->n_points,
                                         .size = sizeof *view_out_request->points,
                                         .each = orl_named_point_from_json};
    const struct orl_json_list openings = {.items = &view_out_request->openings,
                                           .count = &view_out_request->n_openings,
                                           .size = sizeof *view_out_request->openings,
                                           .each = decode_name};
    const struct orl_json_list ground = {.items = &view_out_request->ground,
                                         .count = &view_out_request->n_ground,
                                         .size = sizeof *view_out_request->ground,
                                         .each = decode_name};
    const struct orl_json_member members[] = {
        {"points", .list = &points},
        {"above_sensors", .real = &view_out_request->above_sensors},
        {"openings", .list = &openings},
        {"ground", .list = &ground},
        {0}};
    const int rc = orl_json_members(value, path, &orl_schema_view_out, members, err);
    if (rc == 0 && !orl_view_out_is_requested(view_out_request))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "give \"points\", \"above_sensors\", or both");
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

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_viewpoint(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_viewpoint *viewpoint = into;
    const struct orl_json_member members[] = {
        {"name", .text = &viewpoint->name},
        {"at", .decode = orl_point_from_json, .into = &viewpoint->at},
        {"towards", .decode = orl_direction_from_json, .into = &viewpoint->towards},
        {0}};
    return orl_json_members(value, path, &orl_schema_seat, members, err);
}

static int name_viewpoints(struct orl_viewpoint_request *viewpoint_request, struct orl_error *err)
{
    for (size_t i = 0; i < viewpoint_request->n_viewpoints; i++)
        if (!viewpoint_request->viewpoints[i].name &&
            asprintf(&viewpoint_request->viewpoints[i].name, "seat%zu", i + 1) < 0) {
            viewpoint_request->viewpoints[i].name = NULL;
            return orl_error_no_memory(err);
        }
    return 0;
}

int orl_viewpoints_from_json(const json_t *value, const char *path, void *into,
                             struct orl_error *err)
{
    struct orl_viewpoint_request *viewpoint_request = into;
    const struct orl_json_list viewpoints = {.items = &viewpoint_request->viewpoints,
                                             .count = &viewpoint_request->n_viewpoints,
                                             .size = sizeof *viewpoint_request->viewpoints,
                                             .each = decode_viewpoint};
    const int rc = orl_json_list(value, path, &orl_schema_seats, &viewpoints, err);
    return rc ? rc : name_viewpoints(viewpoint_request, err);
}

int orl_annual_glare_from_json(const json_t *value, const char *path, void *into,
                               struct orl_error *err)
{
    const struct orl_json_member members[] = {
        {"seats", .decode = orl_viewpoints_from_json, .into = into}, {0}};
    return orl_json_members(value, path, &orl_schema_annual_glare, members, err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

static json_t *interval_of(const struct orl_annual_value *v)
{
    return json_pack("[o, o]", orl_json_from_real(v->low), orl_json_from_real(v->high));
}

static json_t *above_to_json(const struct orl_viewpoint_glare *viewpoint)
{
    json_t *array = json_array();
    for (int i = 0; array && i < ORL_GLARE_BOUNDS; i++)
        array = orl_json_append(array, json_pack("{s:f, s:f, s:o}", "dgp", orl_glare_bounds[i],
                                                 "percent", viewpoint->above[i].value,
                                                 "interval_95", interval_of(&viewpoint->above[i])));
    return array;
}

static json_t *worst_to_json(const struct orl_viewpoint_glare *viewpoint,
                             const struct orl_annual_result *result)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < viewpoint->n_worst; i++) {
        const struct orl_viewpoint_hour *hour = &viewpoint->worst[i];
        const struct orl_annual_step *step = &result->steps[hour->step];
        array = orl_json_append(array, json_pack("{s:i, s:i, s:f, s:f, s:o, s:f}", "month",
                                                 step->month, "day", step->day, "hour", step->hour,
                                                 "dgp", hour->dgp.value, "interval_95",
                                                 interval_of(&hour->dgp), "eye_lx", hour->eye_lx));
    }
    return array;
}

static json_t *viewpoint_to_json(const char *name, const struct orl_viewpoint_glare *viewpoint,
                                 const struct orl_annual_result *result)
{
    const bool sure = viewpoint->lowest == viewpoint->highest;
    return json_pack("{s:o, s:o, s:{s:f, s:o}, s:s, s:o}", "name", orl_json_from_text(name),
                     "above", above_to_json(viewpoint), "exceeded_5", "dgp",
                     viewpoint->exceeded.value, "interval_95", interval_of(&viewpoint->exceeded),
                     "protection", sure ? orl_glare_protection_name(viewpoint->level) : "undecided",
                     "worst", worst_to_json(viewpoint, result));
}

json_t *orl_annual_glare_to_json(const struct orl_viewpoint_request *viewpoint_request,
                                 const struct orl_annual_result *result,
                                 const struct orl_annual_report *report)
{
    if (report->n_viewpoints == 0)
        return json_null();
    json_t *array = json_array();
    for (size_t i = 0; array && i < report->n_viewpoints; i++)
        array = orl_json_append(array, viewpoint_to_json(viewpoint_request->viewpoints[i].name,
                                                         &report->viewpoints[i], result));
    return json_pack("{s:o, s:{s:f, s:o}}", "seats", array, "autonomy", "percent",
                     report->glare_autonomy.value, "interval_95",
                     interval_of(&report->glare_autonomy));
}
