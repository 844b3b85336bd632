/*
 * Request and result of a year, with window groups, viewpoints and matrix terms: defaults,
 * validation, names, and freeing.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_glare.h>
#include <oriel/base/input_checks.h>
#include <oriel/base/limits.h>

#include "annual/matrices/imported_matrices.h"

static const double usual_ground = 0.2;

void orl_annual_request_init(struct orl_annual_request *request)
{
    *request = (struct orl_annual_request){.ground_reflectance = usual_ground};
}

static void free_names(char **names, size_t n)
{
    for (size_t i = 0; names && i < n; i++)
        free(names[i]);
    free(names);
}

void orl_annual_request_done(struct orl_annual_request *request)
{
    if (!request)
        return;
    for (size_t i = 0; request->grids && i < request->n_grids; i++)
        free(request->grids[i].name);
    for (size_t i = 0; request->groups && i < request->n_groups; i++)
        orl_window_group_done(&request->groups[i]);
    for (size_t i = 0; request->terms && i < request->n_terms; i++)
        orl_matrix_term_done(&request->terms[i]);
    free(request->groups);
    free(request->terms);
    free_names(request->scene_files, request->n_scene_files);
    free(request->weather_file);
    free(request->sensors);
    free(request->grids);
    *request = (struct orl_annual_request){0};
}

static int check_sensors(const struct orl_annual_request *request, struct orl_error *err)
{
    if (request->n_sensors > ORL_LIMIT_SENSORS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu sensors are too many: the limit is %lu",
                             request->n_sensors, ORL_LIMIT_SENSORS);
    for (size_t i = 0; i < request->n_sensors; i++) {
        const struct orl_sensor *s = &request->sensors[i];
        char what[32];
        snprintf(what, sizeof what, "sensor %zu", i + 1);
        int code = orl_check_point(s->position, what, err);
        if (code == 0)
            code = orl_check_direction(s->direction, what, err);
        if (code < 0)
            return code;
    }
    return 0;
}

const char *orl_annual_technique_name(enum orl_annual_technique technique)
{
    static const char *const names[ORL_ANNUAL_TECHNIQUES] = {"paths", "precomputed"};
    return names[technique];
}

/* Checks that the request can be computed by matrices. Returns 0, ORL_ERR_INVALID or _LIMIT. */
static int orl_matrix_terms_validate(const struct orl_annual_request *request,
                                     struct orl_error *err)
{
    struct orl_annual_grid all;
    if (request->n_terms > ORL_MATRICES_MOST_TERMS)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "%zu terms of matrices are too many: the limit is %d",
                             request->n_terms, ORL_MATRICES_MOST_TERMS);
    if (request->n_terms > 0 && request->n_groups > 0)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "matrices describe one state: a year computed from matrices cannot have shades");
    if (request->n_terms > 0 && request->coefficients)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a year computed from matrices cannot write daylight coefficients");
    for (size_t i = 0; i < request->n_terms; i++) {
        const struct orl_matrix_term *t = &request->terms[i];
        const bool three = t->view && t->transmission && t->daylight;
        const bool any = t->view || t->transmission || t->daylight;
        if (!t->sky || (t->coefficients ? any : !three))
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "matrices[%zu]: give a sky, and either coefficients, or view, "
                                 "transmission and daylight",
                                 i);
        if (!orl_matrix_term_grid(request, t, &all))
            return orl_error_set(err, ORL_ERR_INVALID, "matrices[%zu]: no grid is named '%.100s'",
                                 i, t->grid);
    }
    return 0;
}

int orl_annual_validate_numbers(const struct orl_annual_request *request, struct orl_error *err)
{
    if (!(fabs(request->north_deg) <= 360))
        return orl_error_set(err, ORL_ERR_RANGE, "north must be from -360 to 360 degrees");
    if (!(request->ground_reflectance >= 0 && request->ground_reflectance <= 1))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "the reflectance of the ground must be from 0 to 1");
    if (request->samples > ORL_ANNUAL_MOST_SAMPLES)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "%u paths per sensor are too many: the limit is %d", request->samples,
                             ORL_ANNUAL_MOST_SAMPLES);
    if (request->sun_halvings > ORL_ANNUAL_MOST_HALVINGS)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "the spacing of the sun positions can be halved at most %d times",
                             ORL_ANNUAL_MOST_HALVINGS);
    if (request->photons > ORL_ANNUAL_MOST_PHOTONS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%u photons are too many: the limit is %d",
                             request->photons, ORL_ANNUAL_MOST_PHOTONS);
    if (request->technique == ORL_ANNUAL_PRECOMPUTED &&
        (request->n_groups > 0 || request->n_terms > 0))
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "precomputed photons describe one state of the scene: with shades or "
                             "imported matrices, use the technique \"paths\"");
    for (size_t i = 0; i < request->n_grids; i++) {
        const struct orl_annual_grid *g = &request->grids[i];
        if (g->first > request->n_sensors || g->count > request->n_sensors - g->first)
            return orl_error_set(err, ORL_ERR_RANGE, "grid %zu goes beyond the last sensor", i + 1);
        if (i > 0 && g->first < g[-1].first + g[-1].count)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "grid %zu begins before the previous grid ends", i + 1);
    }
    if (request->coefficients && request->n_groups > 0)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "daylight coefficients describe one state: a year with shades has none");
    int code = orl_matrix_terms_validate(request, err);
    if (code == 0)
        code = orl_shades_validate(request, err);
    return code < 0 ? code : check_sensors(request, err);
}

int orl_annual_validate(const struct orl_annual_request *request, struct orl_error *err)
{
    if (request->n_scene_files == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "the annual job names no scene files");
    if (!request->weather_file)
        return orl_error_set(err, ORL_ERR_INVALID, "the annual job names no weather file");
    if (request->n_sensors == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "the annual job has no sensors");
    return orl_annual_validate_numbers(request, err);
}

/* ---- The result ---- */

const char *orl_annual_stage_name(enum orl_annual_stage stage)
{
    static const char *const names[ORL_ANNUAL_STAGES] = {
        [ORL_ANNUAL_LOAD] = "load", [ORL_ANNUAL_SKIES] = "skies", [ORL_ANNUAL_PATHS] = "paths",
        [ORL_ANNUAL_SUN] = "sun",   [ORL_ANNUAL_HOURS] = "hours",
    };
    return stage < ORL_ANNUAL_STAGES ? names[stage] : "";
}

const char *orl_annual_cache_kind_name(enum orl_annual_cache_kind kind)
{
    static const char *const names[ORL_ANNUAL_CACHE_KINDS] = {[ORL_ANNUAL_CACHE_SUN_WEIGHTS] =
                                                                  "suns",
                                                              [ORL_ANNUAL_CACHE_SUN_MAP] = "map",
                                                              [ORL_ANNUAL_CACHE_PATHS] = "paths",
                                                              [ORL_ANNUAL_CACHE_SUNLIGHT] = "sun"};
    return kind < ORL_ANNUAL_CACHE_KINDS ? names[kind] : "";
}

void orl_annual_done(struct orl_annual_result *result)
{
    if (!result)
        return;
    free_names(result->warnings, result->n_warnings);
    free_names(result->scene_read, result->n_scene_read);
    free(result->steps);
    free(result->step_of_column);
    free(result->states);
    free(result->overcast);
    free(result->overcast_se);
    free(result->coherence);
    free(result->coefficients);
    free(result->total);
    free(result->direct);
    free(result->se);
    *result = (struct orl_annual_result){0};
}

/* Window groups of a request: validation and freeing. */

void orl_window_group_done(struct orl_window_group *group)
{
    if (!group)
        return;
    for (size_t i = 0; group->states && i < group->n_states; i++) {
        free(group->states[i].name);
        free_names(group->states[i].files, group->states[i].n_files);
        free(group->states[i].material);
    }
    free_names(group->windows, group->n_windows);
    free(group->name);
    free(group->states);
    free(group->series);
    free(group->schedule_file);
    free(group->spans);
    free(group->control.grid);
    orl_viewpoint_request_done(&group->control.viewpoints);
    *group = (struct orl_window_group){.name = NULL};
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static int check_states(const struct orl_window_group *group, struct orl_error *err)
{
    if (group->n_states == 0 || group->n_states > ORL_SHADES_MOST_STATES)
        return orl_error_set(err, ORL_ERR_LIMIT, "'%.100s' has %zu states, but needs 1 to %d",
                             group->name, group->n_states, ORL_SHADES_MOST_STATES);
    for (size_t i = 0; i < group->n_states; i++) {
        const struct orl_shade_state *state = &group->states[i];
        if ((state->material || state->dark) && group->n_windows == 0)
            return orl_error_set(
                err, ORL_ERR_INVALID,
                "the state '%.100s' changes windows, but '%.100s' names no windows", state->name,
                group->name);
        if (state->material && state->dark)
            return orl_error_set(
                err, ORL_ERR_INVALID,
                "the state '%.100s' of '%.100s' cannot be dark and have a material", state->name,
                group->name);
        for (size_t k = 0; k < i; k++)
            if (strcasecmp(group->states[k].name, state->name) == 0)
                return orl_error_set(err, ORL_ERR_INVALID,
                                     "two states of '%.100s' are named '%.100s'", group->name,
                                     state->name);
    }
    return 0;
}

static int no_state(const struct orl_window_group *group, uint32_t state, struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_RANGE, "'%.100s' has no state %u: its last state is %zu",
                         group->name, state, group->n_states - 1);
}

static bool has_grid(const struct orl_annual_request *request, const char *name)
{
    for (size_t i = 0; i < request->n_grids; i++)
        if (request->grids[i].name && strcasecmp(request->grids[i].name, name) == 0)
            return true;
    return false;
}

static int check_control(const struct orl_annual_request *request,
                         const struct orl_window_group *group, struct orl_error *err)
{
    const struct orl_shade_control *control = &group->control;
    if (control->kind == ORL_SHADES_NO_CONTROL)
        return 0;
    if (control->state >= group->n_states)
        return no_state(group, control->state, err);
    if (control->kind == ORL_SHADES_BY_GLARE) {
        if (control->viewpoints.n_viewpoints == 0 ||
            !(control->above_dgp > 0 && control->above_dgp < 1))
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "the control of '%.100s' needs a seat, and a DGP between 0 and 1",
                                 group->name);
        return orl_viewpoints_validate(&control->viewpoints, request, err);
    }
    if (!(control->above_lx > 0) || !(control->share_percent >= 0 && control->share_percent <= 100))
        return orl_error_set(
            err, ORL_ERR_RANGE,
            "the control of '%.100s' needs an illuminance above 0 lx, and a share of 0 to 100 %%",
            group->name);
    if (control->grid && !has_grid(request, control->grid))
        return orl_error_set(err, ORL_ERR_INVALID,
                             "'%.100s' is controlled by the grid '%.100s', which does not exist",
                             group->name, control->grid);
    return 0;
}

static int check_hours(const struct orl_window_group *group, struct orl_error *err)
{
    const bool controlled = group->control.kind != ORL_SHADES_NO_CONTROL;
    const bool listed = group->series || group->schedule_file;
    if (listed + (group->n_spans > 0) + controlled > 1)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "'%.100s' has more than one of schedule, rules and control",
                             group->name);
    for (size_t i = 0; group->series && i < group->n_series; i++)
        if (group->series[i] >= group->n_states)
            return no_state(group, group->series[i], err);
    for (size_t i = 0; i < group->n_spans; i++) {
        const struct orl_shade_span *s = &group->spans[i];
        if (s->state >= group->n_states)
            return no_state(group, s->state, err);
        if (s->from_month < 1 || s->from_month > 12 || s->to_month < 1 || s->to_month > 12 ||
            !(s->from_h >= 0 && s->from_h <= 24 && s->to_h >= 0 && s->to_h <= 24))
            return orl_error_set(
                err, ORL_ERR_RANGE,
                "a rule of '%.100s' needs months from 1 to 12, and hours from 0 to 24",
                group->name);
    }
    return 0;
}

int orl_shades_validate(const struct orl_annual_request *request, struct orl_error *err)
{
    int code = 0;
    if (request->n_groups > ORL_SHADES_MOST_GROUPS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu window groups are too many: the limit is %d",
                             request->n_groups, ORL_SHADES_MOST_GROUPS);
    for (size_t g = 0; g < request->n_groups && code == 0; g++) {
        const struct orl_window_group *group = &request->groups[g];
        for (size_t k = 0; k < g && code == 0; k++)
            if (strcasecmp(request->groups[k].name, group->name) == 0)
                code = orl_error_set(err, ORL_ERR_INVALID, "two window groups are named '%.100s'",
                                     group->name);
        if (code == 0)
            code = check_states(group, err);
        if (code == 0)
            code = check_hours(group, err);
        if (code == 0)
            code = check_control(request, group, err);
    }
    if (code < 0)
        orl_error_at(err, NULL, 0, "shades");
    return code;
}

/* Viewpoints of a request and their results: validation and freeing. */

void orl_viewpoint_request_done(struct orl_viewpoint_request *viewpoint_request)
{
    for (size_t i = 0; viewpoint_request->viewpoints && i < viewpoint_request->n_viewpoints; i++)
        free(viewpoint_request->viewpoints[i].name);
    free(viewpoint_request->viewpoints);
    *viewpoint_request = (struct orl_viewpoint_request){.viewpoints = NULL};
}

void orl_viewpoint_hours_free(struct orl_viewpoint_hours *hours, size_t n)
{
    for (size_t i = 0; hours && i < n; i++) {
        free(hours[i].dgp);
        free(hours[i].low);
        free(hours[i].high);
        free(hours[i].eye_lx);
    }
    free(hours);
}

/* ---- Validation ------------------------------------------------------------------------------ */

int orl_viewpoints_validate(const struct orl_viewpoint_request *viewpoint_request,
                            const struct orl_annual_request *request, struct orl_error *err)
{
    static const double steepest = 0.999; /* sine of the altitude: 87.4 degrees */
    if (viewpoint_request->n_viewpoints == 0)
        return 0;
    if (request->n_terms > 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "glare needs a scene: a year computed from matrices has none");
    for (size_t i = 0; i < viewpoint_request->n_viewpoints; i++) {
        const struct orl_viewpoint *viewpoint = &viewpoint_request->viewpoints[i];
        char what[96];
        snprintf(what, sizeof what, "the seat '%.64s'", viewpoint->name);
        int code = orl_check_point(viewpoint->at, what, err);
        if (code == 0)
            code = orl_check_direction(viewpoint->towards, what, err);
        if (code < 0)
            return code;
        if (!(fabs(viewpoint->towards.z) <= steepest * orl_length(viewpoint->towards)))
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "'%s' looks straight up or down, so its view has no up direction",
                                 viewpoint->name);
    }
    return 0;
}

/* Matrix terms of a request: freeing, and their grids. */

void orl_matrix_term_done(struct orl_matrix_term *term)
{
    if (!term)
        return;
    free(term->grid);
    free(term->coefficients);
    free(term->view);
    free(term->transmission);
    free(term->daylight);
    free(term->sky);
    *term = (struct orl_matrix_term){.grid = NULL};
}

const struct orl_annual_grid *orl_matrix_term_grid(const struct orl_annual_request *request,
                                                   const struct orl_matrix_term *term,
                                                   struct orl_annual_grid *room)
{
    *room = (struct orl_annual_grid){NULL, 0, request->n_sensors};
    if (!term->grid)
        return room;
    for (size_t i = 0; i < request->n_grids; i++)
        if (request->grids[i].name && strcmp(request->grids[i].name, term->grid) == 0)
            return &request->grids[i];
    return NULL;
}
