/* Request and result of a year: defaults, validation, names, and freeing. */
#include <oriel/annual/annual.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/coordinates.h>
#include <oriel/base/limits.h>

#include "annual/matrices/matrix_terms.h"

static const double usual_ground = 0.2;

void orl_annual_request_init(struct orl_annual_request *request)
{
    *request = (struct orl_annual_request){.ground_reflectance = usual_ground};
}

void orl_annual_request_done(struct orl_annual_request *request)
{
    if (!request)
        return;
    for (size_t i = 0; request->scene_files && i < request->n_scene_files; i++)
        free(request->scene_files[i]);
    for (size_t i = 0; request->grids && i < request->n_grids; i++)
        free(request->grids[i].name);
    for (size_t i = 0; request->groups && i < request->n_groups; i++)
        orl_window_group_done(&request->groups[i]);
    for (size_t i = 0; request->terms && i < request->n_terms; i++)
        orl_matrix_term_done(&request->terms[i]);
    free(request->groups);
    free(request->terms);
    free(request->scene_files);
    free(request->weather_file);
    free(request->sensors);
    free(request->grids);
    *request = (struct orl_annual_request){0};
}

static int check_sensors(const struct orl_annual_request *request, struct orl_error *err)
{
    if (request->n_sensors > ORL_LIMIT_SENSORS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu sensors are more than %lu",
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

int orl_annual_validate_numbers(const struct orl_annual_request *request, struct orl_error *err)
{
    if (!(fabs(request->north_deg) <= 360))
        return orl_error_set(err, ORL_ERR_RANGE, "north is given in degrees, -360 to 360");
    if (!(request->ground_reflectance >= 0 && request->ground_reflectance <= 1))
        return orl_error_set(err, ORL_ERR_RANGE, "the ground reflects a share from 0 to 1");
    if (request->samples > ORL_ANNUAL_MOST_SAMPLES)
        return orl_error_set(err, ORL_ERR_LIMIT, "%u paths a sensor are more than %d",
                             request->samples, ORL_ANNUAL_MOST_SAMPLES);
    if (request->sun_halvings > ORL_ANNUAL_MOST_HALVINGS)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "the distance between the sun's nodes is halved at most %d times",
                             ORL_ANNUAL_MOST_HALVINGS);
    if (request->photons > ORL_ANNUAL_MOST_PHOTONS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%u photons are more than %d", request->photons,
                             ORL_ANNUAL_MOST_PHOTONS);
    if (request->technique == ORL_ANNUAL_PRECOMPUTED &&
        (request->n_groups > 0 || request->n_terms > 0))
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "precomputed photons are of one state of the scene: a year with "
                             "shades or others' matrices goes by paths");
    for (size_t i = 0; i < request->n_grids; i++) {
        const struct orl_annual_grid *g = &request->grids[i];
        if (g->first > request->n_sensors || g->count > request->n_sensors - g->first)
            return orl_error_set(err, ORL_ERR_RANGE, "grid %zu goes beyond the last sensor", i + 1);
        if (i > 0 && g->first < g[-1].first + g[-1].count)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "grid %zu begins before the end of the one before it", i + 1);
    }
    if (request->coefficients && request->n_groups > 0)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "daylight coefficients are of one state: a year with shades has none");
    int code = orl_matrix_terms_validate(request, err);
    if (code == 0)
        code = orl_shades_validate(request, err);
    return code < 0 ? code : check_sensors(request, err);
}

int orl_annual_validate(const struct orl_annual_request *request, struct orl_error *err)
{
    if (request->n_scene_files == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "the year names no scene files");
    if (!request->weather_file)
        return orl_error_set(err, ORL_ERR_INVALID, "the year names no weather file");
    if (request->n_sensors == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "the year is asked for at no sensor");
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
    for (size_t i = 0; result->warnings && i < result->n_warnings; i++)
        free(result->warnings[i]);
    free(result->warnings);
    for (size_t i = 0; result->scene_read && i < result->n_scene_read; i++)
        free(result->scene_read[i]);
    free(result->scene_read);
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
