#include "result/result_json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "job/job_members_json.h"
#include "view/view_json.h"
#include "json/encode.h"

/*
 * In json_pack, jansson's "o" steals the reference and fails if it is NULL. So one check at the
 * end of each function covers all its parts.
 */
json_t *orl_map_info_to_json(const struct orl_map_info *info)
{
    return json_pack("{s:s, s:s, s:I, s:I, s:I, s:I, s:f, s:b}", "kind", info->kind, "key",
                     info->key, "emitted", (json_int_t)info->emitted, "stored",
                     (json_int_t)info->stored, "reused", (json_int_t)info->reused, "bytes",
                     (json_int_t)info->bytes, "seconds", info->seconds, "cached",
                     (int)info->cached);
}

static json_t *timings_to_json(const struct orl_result *result)
{
    json_t *timings = json_object();
    int rc = timings ? 0 : -1;
    for (int stage = 0; stage < ORL_STAGE_COUNT && rc == 0; stage++)
        rc = json_object_set_new(timings, orl_stage_name((enum orl_stage)stage),
                                 json_real(result->timings_s[stage]));
    if (rc == 0)
        rc = json_object_set_new(timings, "total", json_real(result->total_s));
    return orl_json_checked(timings, rc);
}

static json_t *maps_to_json(const struct orl_result *result)
{
    json_t *maps = json_array();
    for (size_t i = 0; i < result->n_maps; i++)
        maps = orl_json_append(maps, orl_map_info_to_json(&result->maps[i]));
    return maps;
}

/* Returns NULL if the value is unknown. */
static json_t *number_of(const double *values, size_t index)
{
    return values ? orl_json_from_real(values[index]) : NULL;
}

static json_t *interval_of(const struct orl_result *result, size_t index)
{
    if (!result->interval_95_lx)
        return NULL;
    const double *interval = result->interval_95_lx[index];
    return json_pack("[o, o]", orl_json_from_real(interval[0]), orl_json_from_real(interval[1]));
}

/* Returns the reasons why the value is unreliable, or NULL if it is reliable. */
static json_t *doubts_of(const struct orl_result *result, size_t index)
{
    const unsigned doubts = result->doubts ? result->doubts[index] : 0;
    json_t *json = doubts ? json_array() : NULL;
    for (unsigned i = 0; json && i < ORL_DOUBTS; i++)
        if (doubts & 1U << i)
            json_array_append_new(json, json_string(orl_doubt_name((enum orl_doubt)(1U << i))));
    return json;
}

static json_t *sensors_to_json(const struct orl_result *result)
{
    json_t *sensors = json_array();
    for (size_t i = 0; i < result->n_sensors; i++) {
        /* JSON has no NaN: a broken sensor becomes null, and all others are still reported. */
        json_t *lux = orl_json_from_real(result->illuminance_lx[i]);
        json_t *se = number_of(result->standard_error_lx, i);
        json_t *bias = number_of(result->bias_estimate_lx, i);
        sensors = orl_json_append(
            sensors, json_pack("{s:o, s:o*, s:o*, s:o*, s:o*}", "illuminance_lx", lux,
                               "standard_error_lx", se, "bias_estimate_lx", bias, "interval_95_lx",
                               interval_of(result, i), "unreliable", doubts_of(result, i)));
    }
    return sensors;
}

static json_t *view_to_json(const struct orl_view_result *view)
{
    json_t *json = json_pack("{s:s, s:f}", "name", view->name, "seconds", view->seconds);
    const bool told =
        json && orl_pictures_to_json(view, json) == 0 &&
        (!view->glare ||
         json_object_set_new(json, "glare", orl_glare_to_json(view->glare, view->metrics)) == 0);
    return orl_json_checked(json, !told);
}

static json_t *views_to_json(const struct orl_result *result)
{
    json_t *views = json_array();
    for (size_t i = 0; i < result->n_views; i++) {
        views = orl_json_append(views, view_to_json(&result->views[i]));
    }
    return views;
}

static json_t *health_to_json(const struct orl_health *h)
{
    const struct {
        const char *name;
        uint64_t count;
    } counts[] = {
        {"non_finite", h->non_finite},
        {"bsdf_clamped", h->bsdf_clamped},
        {"bsdf_rescaled", h->bsdf_rescaled},
        {"degenerate", h->degenerate},
        {"photons_capped", h->photons_capped},
        {"paths_capped", h->paths_capped},
        {"rays_leaked", h->rays_leaked},
        {"sparse_estimates", h->sparse},
        {"bsdf_values", h->bsdf_values},
        {"surfaces", h->surfaces},
        {"instances", h->instances},
        {"photons", h->photons},
        {"paths", h->paths},
        {"rays", h->rays},
        {"estimates", h->estimates},
    };
    json_t *health =
        json_pack("{s:f, s:f}", "flux_w", h->flux_w, "flux_capped_w", h->flux_capped_w);
    for (size_t i = 0; health && i < sizeof counts / sizeof *counts; i++)
        health = orl_json_checked(
            health,
            json_object_set_new(health, counts[i].name, json_integer((json_int_t)counts[i].count)));
    return health;
}

static json_t *warnings_to_json(const struct orl_result *result)
{
    json_t *warnings = json_array();
    for (size_t i = 0; i < result->n_warnings; i++)
        warnings = orl_json_append(warnings, orl_json_from_text(result->warnings[i]));
    return warnings;
}

static json_t *course_to_json(const struct orl_outcome *outcome)
{
    json_t *error_history = json_array();
    for (uint32_t i = 0; i < outcome->n_error_history; i++)
        error_history = orl_json_append(
            error_history, json_pack("{s:f, s:f}", "seconds", outcome->error_history[i].seconds,
                                     "error", outcome->error_history[i].error));
    return error_history;
}

json_t *orl_outcome_to_json(const struct orl_outcome *outcome)
{
    if (!outcome->asked)
        return NULL;
    json_t *asked = outcome->goal.dgp_error > 0
                        ? json_pack("{s:f}", "dgp_error", outcome->goal.dgp_error)
                    : outcome->goal.deadline_s > 0
                        ? json_pack("{s:f, s:f}", "deadline_s", outcome->goal.deadline_s, "at",
                                    outcome->goal.at)
                        : json_pack("{s:f, s:f}", "relative_error", outcome->goal.relative_error,
                                    "at", outcome->goal.at);
    return json_pack("{s:o, s:b, s:o, s:I, s:s, s:o}", "asked", asked, "met", (int)outcome->met,
                     "achieved", orl_json_from_real(outcome->achieved), "rounds",
                     (json_int_t)outcome->rounds, "why", outcome->why, "course",
                     course_to_json(outcome));
}

/* Encodes the cost. Predictions are null if the run gave no result. */
static json_t *cost_to_json(const struct orl_result *result)
{
    const struct orl_cost *cost = &result->cost;
    const bool known = cost->model[0] != '\0';
    return json_pack("{s:o, s:I, s:I, s:{s:o, s:o, s:o, s:s}}", "seconds", timings_to_json(result),
                     "rays", (json_int_t)cost->rays, "photons", (json_int_t)cost->photons, "next",
                     "error", orl_json_from_real(known ? cost->error : NAN), "halve_s",
                     orl_json_from_real(known ? cost->halve_s : NAN), "one_percent_s",
                     orl_json_from_real(known ? cost->one_percent_s : NAN), "model", cost->model);
}

static json_t *curve_to_json(const struct orl_accuracy_curve *curve)
{
    json_t *points = json_array();
    for (uint32_t i = 0; i < curve->n_points && points; i++)
        if (json_array_append_new(points,
                                  json_pack("{s:f, s:f}", "seconds", curve->points[i].seconds,
                                            "error", curve->points[i].error))) {
            json_decref(points);
            return NULL;
        }
    return json_pack("{s:s, s:I, s:o, s:s}", "technique", orl_technique_name(curve->technique),
                     "threads", (json_int_t)curve->threads, "points", points, "model",
                     curve->model);
}

json_t *orl_planned_to_json(const struct orl_result *result, const struct orl_accuracy_curve *curve)
{
    return json_pack("{s:o, s:o, s:o}", "plan", orl_plan_to_json(&result->plan), "warnings",
                     warnings_to_json(result), "curve", curve ? curve_to_json(curve) : json_null());
}

static json_t *cross_check_to_json(const struct orl_cross_check *check)
{
    if (check->paths == 0)
        return NULL;
    const char *differs_in =
        check->sensors_off > 0 ? orl_light_class_name(check->differs_in) : NULL;
    return json_pack("{s:I, s:I, s:I, s:s*, s:o, s:o}", "paths", (json_int_t)check->paths,
                     "sensors", (json_int_t)check->sensors, "sensors_off",
                     (json_int_t)check->sensors_off, "differs_in", differs_in, "ratio",
                     orl_json_from_real(check->ratio), "ratio_error",
                     orl_json_from_real(check->ratio_error));
}

json_t *orl_result_to_json(const struct orl_result *result, const char *state)
{
    json_t *dark = result->sky_given ? json_boolean(result->sky_dark) : NULL;
    json_t *summary = result->n_sensors > 0 && result->n_grids == 0
                          ? orl_sensor_summary_to_json(result, 0, result->n_sensors)
                          : NULL;
    return json_pack(
        "{s:s, s:I, s:I, s:o, s:o, s:o, s:o, s:o*, s:o, s:o, s:o, s:o*, s:o*, s:o*, s:o*, s:o*, "
        "s:s*, s:o}",
        "state", state, "threads", (json_int_t)result->threads, "seed", (json_int_t)result->seed,
        "plan", orl_plan_to_json(&result->plan), "timings_s", timings_to_json(result), "maps",
        maps_to_json(result), "sensors", sensors_to_json(result), "summary", summary, "views",
        views_to_json(result), "health", health_to_json(&result->health), "warnings",
        warnings_to_json(result), "dark", dark, "accuracy", orl_outcome_to_json(&result->outcome),
        "cross_check", cross_check_to_json(&result->cross_check), "sensor_files",
        orl_sensor_files_to_json(&result->sensor_files), "grids", orl_grids_to_json(result),
        "grids_info", result->grids_info, "cost", cost_to_json(result));
}

json_t *orl_sky_result_to_json(const struct orl_result *result, const char *sky)
{
    json_t *doc = orl_result_to_json(result, "succeeded");
    return orl_json_checked(doc, doc && json_object_set_new(doc, "sky", json_string(sky)));
}

json_t *orl_skies_result_new(uint64_t seed, uint32_t threads)
{
    json_t *timings = json_pack("{s:f}", "total", 0.0);
    for (int stage = 0; stage < ORL_STAGE_COUNT; stage++)
        json_object_set_new(timings, orl_stage_name((enum orl_stage)stage), json_real(0));
    return json_pack("{s:s, s:I, s:I, s:o, s:[], s:[]}", "state", "running", "threads",
                     (json_int_t)threads, "seed", (json_int_t)seed, "timings_s", timings, "skies",
                     "warnings");
}

static int add_timings(json_t *sums, const json_t *timings)
{
    const char *stage;
    json_t *sum;
    void *next;
    int rc = 0;
    json_object_foreach_safe(sums, next, stage, sum)
    {
        const double seconds = json_number_value(json_object_get(timings, stage));
        rc |= json_real_set(sum, json_real_value(sum) + seconds);
    }
    return rc;
}

static int add_warnings(json_t *all, const json_t *warnings)
{
    const json_t *warning, *known;
    size_t i, k;
    int rc = 0;
    json_array_foreach(warnings, i, warning)
    {
        bool is_known = false;
        json_array_foreach(all, k, known)
        {
            is_known = is_known || json_equal(known, warning);
        }
        if (!is_known)
            rc |= json_array_append(all, (json_t *)(uintptr_t)warning);
    }
    return rc;
}

static json_t *illuminances_of(const json_t *result)
{
    json_t *values = json_array();
    const json_t *sensor;
    size_t i;
    json_array_foreach(json_object_get(result, "sensors"), i, sensor)
    {
        json_array_append(values, json_object_get(sensor, "illuminance_lx"));
    }
    return values;
}

int orl_skies_result_add(json_t *results, const json_t *result)
{
    const char *name = json_string_value(json_object_get(result, "sky"));
    const json_t *timings = json_object_get(result, "timings_s");
    const json_t *plan = json_object_get(result, "plan");
    char file[96];
    snprintf(file, sizeof file, "%.80s.json", name ? name : "");
    json_t *entry = json_pack(
        "{s:s?, s:s, s:O, s:O, s:O, s:o, s:O, s:O*}", "name", name, "file", file, "dark",
        json_object_get(result, "dark"), "technique", json_object_get(plan, "technique"), "seconds",
        json_object_get(timings, "total"), "illuminance_lx", illuminances_of(result), "views",
        json_object_get(result, "views"), "accuracy", json_object_get(result, "accuracy"));
    if (!entry || json_array_append_new(json_object_get(results, "skies"), entry))
        return -1;
    return add_timings(json_object_get(results, "timings_s"), timings) |
           add_warnings(json_object_get(results, "warnings"), json_object_get(result, "warnings"));
}

int orl_skies_result_end(json_t *results, const char *state)
{
    return json_object_set_new(results, "state", json_string(state));
}

/* Bounds of an empty or infinite scene are not finite, which JSON cannot express; they become
 * null. */
static json_t *point_to_json(const double point[3])
{
    json_t *array = json_array();
    int rc = array ? 0 : -1;
    for (int axis = 0; axis < 3 && rc == 0; axis++) {
        json_t *number = json_real(point[axis]);
        rc = json_array_append_new(array, number ? number : json_null());
    }
    return orl_json_checked(array, rc);
}

json_t *orl_scene_summary_to_json(const struct orl_scene_summary *summary)
{
    json_t *referenced = json_array();
    for (size_t i = 0; i < summary->n_referenced; i++)
        referenced = orl_json_append(referenced, json_string(summary->referenced[i]));
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:{s:o, s:o}, s:s, s:o}", "surfaces",
        (json_int_t)summary->surfaces, "placed_surfaces", (json_int_t)summary->placed_surfaces,
        "materials", (json_int_t)summary->materials, "sources", (json_int_t)summary->sources,
        "triangles", (json_int_t)summary->triangles, "bsdfs", (json_int_t)summary->bsdfs, "bounds",
        "min", point_to_json(summary->bounds_min), "max", point_to_json(summary->bounds_max),
        "digest", summary->digest, "referenced", referenced);
}

json_t *orl_floor_plan_to_json(const struct orl_floor_plan *plan)
{
    json_t *lines = json_array();
    for (size_t i = 0; lines && i < plan->count; i++) {
        const double *line = plan->lines[i];
        lines =
            orl_json_append(lines, json_pack("[f, f, f, f]", line[0], line[1], line[2], line[3]));
    }
    return json_pack("{s:o, s:{s:o, s:o}, s:o, s:b}", "height", orl_json_from_real(plan->height),
                     "bounds", "min", point_to_json(plan->low), "max", point_to_json(plan->high),
                     "lines", lines, "more", (int)plan->more);
}
