#include "annual_job/annual_glare_json.h"

#include <stdio.h>

#include "job/named_points_json.h"
#include "json/encode.h"
#include "json/members.h"

enum { NAME_MAX_BYTES = 63 };

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_viewpoint(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_viewpoint *viewpoint = into;
    const struct orl_json_member members[] = {
        {"name", .text = &viewpoint->name, .longest = NAME_MAX_BYTES},
        {"at", .decode = orl_point_from_json, .into = &viewpoint->at, .required = true},
        {"towards", .decode = orl_direction_from_json, .into = &viewpoint->towards,
         .required = true},
        {0}};
    return orl_json_members(value, path, members, err);
}

static int name_viewpoints(struct orl_viewpoint_request *viewpoint_request, struct orl_error *err)
{
    for (size_t i = 0; i < viewpoint_request->n_viewpoints; i++)
        if (!viewpoint_request->viewpoints[i].name &&
            asprintf(&viewpoint_request->viewpoints[i].name, "seat%zu", i + 1) < 0) {
            viewpoint_request->viewpoints[i].name = NULL;
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
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
                                             .most = ORL_GLARE_MOST_VIEWPOINTS,
                                             .each = decode_viewpoint,
                                             .empty = "no seat is given"};
    const int rc = orl_json_list(value, path, &viewpoints, err);
    return rc ? rc : name_viewpoints(viewpoint_request, err);
}

int orl_annual_glare_from_json(const json_t *value, const char *path, void *into,
                               struct orl_error *err)
{
    const struct orl_json_member members[] = {
        {"seats", .decode = orl_viewpoints_from_json, .into = into, .required = true}, {0}};
    return orl_json_members(value, path, members, err);
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
