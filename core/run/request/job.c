#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/input_checks.h>
#include <oriel/base/limits.h>
#include <oriel/job/run.h>

#include "base/memory/memory.h"
#include "light/daylight/daylight.h"
#include "metrics/glare.h"
#include "render/film/film.h"
#include "run/request/job_inputs.h"
#include "run/run_state.h"
#include "run/stages/run_stages.h"

void orl_sky_request_init(struct orl_sky_request *request)
{
    *request = (struct orl_sky_request){
        .ground_reflectance = 0.2, .turbidity = 2.45, .direct_normal_lx = -1};
}

void orl_job_init(struct orl_job *job)
{
    memset(job, 0, sizeof *job);
    job->technique = ORL_TECHNIQUE_AUTO;
    job->seed = 1;
    job->photons_global = ORL_PHOTONS_BY_PLAN;
    job->photons_caustic = ORL_PHOTONS_BY_PLAN;
    orl_sky_request_init(&job->sky);
    job->goal.at = 0.95;
}

void orl_job_done(struct orl_job *job)
{
    if (!job)
        return;
    orl_texts_free(job->scene_files, job->n_scene_files);
    free(job->sky.weather_file);
    for (size_t i = 0; i < job->n_skies; i++) {
        free(job->skies[i].name);
        free(job->skies[i].request.weather_file);
    }
    free(job->skies);
    free(job->sensors_file);
    free(job->sensors);
    for (size_t i = 0; i < job->n_grids; i++) {
        free(job->grids[i].name);
        free(job->grids[i].file);
    }
    free(job->grids);
    for (size_t i = 0; i < job->n_views; i++) {
        free(job->views[i].name);
        free(job->views[i].view);
        free(job->views[i].file);
        free(job->views[i].entry);
        free(job->views[i].false_color.points);
    }
    free(job->views);
    memset(job, 0, sizeof *job);
}

/* Returns true if a view's files would collide with those of another: "a.error" beside "a", which
 * has a.error.png. same: length of their common prefix. */
static bool is_part_of(const char *name, const char *of, size_t same)
{
    if (of[same] != '\0' || name[same] != '.')
        return false;
    for (int i = 0; i < ORL_PICTURES; i++) {
        const char *ending = orl_picture_ending((enum orl_picture)i), *dot = strchr(ending, '.');
        if (dot && strlen(name + same + 1) == (size_t)(dot - ending) &&
            strncmp(name + same + 1, ending, (size_t)(dot - ending)) == 0)
            return true;
    }
    return false;
}

static int validate_names(const struct orl_job *job, size_t index, struct orl_error *err)
{
    const char *name = job->views[index].name;
    for (size_t i = 0; i < index; i++) {
        const char *other = job->views[i].name;
        size_t same = 0;
        while (name[same] == other[same] && name[same])
            same++;
        if (name[same] == other[same])
            return orl_error_set(err, ORL_ERR_INVALID, "two views are named '%s'", name);
        if (is_part_of(name, other, same) || is_part_of(other, name, same))
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "views named '%s' and '%s': the part after the dot is reserved "
                                 "for further pictures of a view",
                                 other, name);
    }
    return 0;
}

static int validate_view(const struct orl_job *job, size_t index, struct orl_error *err)
{
    const struct orl_view_request *v = &job->views[index];
    struct orl_view view;
    int code;
    const size_t length = v->name ? strlen(v->name) : 0;
    if (length == 0 || length > 100 || v->name[0] == '.')
        return orl_error_set(err, ORL_ERR_INVALID, "view %zu needs a name of 1 to 100 characters",
                             index);
    for (size_t i = 0; i < length; i++)
        if (!isalnum((unsigned char)v->name[i]) && !strchr("-_.", v->name[i]))
            return orl_error_set(
                err, ORL_ERR_INVALID,
                "view name '%s' may contain only letters, digits, '-', '_' and '.'", v->name);
    code = validate_names(job, index, err);
    if (code < 0)
        return code;
    if (v->width < 1 || v->height < 1 || v->width > ORL_LIMIT_IMAGE_SIDE ||
        v->height > ORL_LIMIT_IMAGE_SIDE || (uint64_t)v->width * v->height > ORL_LIMIT_IMAGE_PIXELS)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "view '%s': %u x %u pixels; each side must be from 1 to %u, and at "
                             "most %lu pixels are allowed",
                             v->name, v->width, v->height, ORL_LIMIT_IMAGE_SIDE,
                             ORL_LIMIT_IMAGE_PIXELS);
    if (!(v->pixel_aspect >= 0 && v->pixel_aspect <= 1000))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "view '%s': the pixel aspect is %g; it must lie between 0 and 1000",
                             v->name, v->pixel_aspect);
    if (v->irradiance && v->metrics)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "view '%s': glare metrics need radiance, not irradiance", v->name);
    if (v->metrics && v->glare.task.angle_rad > 0 &&
        (v->glare.task.x > v->width || v->glare.task.y > v->height))
        return orl_error_set(err, ORL_ERR_RANGE, "view '%s': its task lies outside the picture",
                             v->name);
    code = orl_view_parse(v->view ? v->view : "", &view, err);
    /* Other options in the file may complete the view. */
    if (v->file && code != ORL_ERR_SYNTAX)
        return 0;
    if (code == 0 && v->metrics != 0)
        code = orl_glare_view_check(&view, &v->glare, err);
    if (code < 0)
        orl_error_at(err, NULL, 0, v->name);
    return code;
}

static bool too_many(uint64_t photons)
{
    return photons > ORL_LIMIT_PHOTONS && photons != ORL_PHOTONS_BY_PLAN;
}

bool orl_job_asks_for_glare(const struct orl_job *job)
{
    for (size_t i = 0; i < job->n_views; i++)
        if (job->views[i].metrics != 0)
            return true;
    return false;
}

static int validate_goal(const struct orl_job *job, struct orl_error *err)
{
    const struct orl_goal *g = &job->goal;
    const bool by_error = g->relative_error != 0, by_time = g->deadline_s != 0;
    const bool by_dgp = g->dgp_error != 0;
    if (!by_error && !by_time && !by_dgp)
        return 0;
    if (by_error + by_time + by_dgp > 1)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a job can have one accuracy goal or a deadline, not both");
    if (by_dgp && !(g->dgp_error >= 1e-5 && g->dgp_error <= 1))
        return orl_error_set(err, ORL_ERR_RANGE, "accuracy.dgp_error must be from 0.00001 to 1");
    if (by_dgp && !orl_job_asks_for_glare(job)) {
        orl_error_set(err, ORL_ERR_INVALID, "accuracy.dgp_error: no view asks for metrics");
        orl_error_hint(err, "Give a view \"metrics\": [\"dgp\"]");
        return ORL_ERR_INVALID;
    }
    if (by_error && !(g->relative_error > 0 && g->relative_error <= 10))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "accuracy.relative_error must be a fraction above 0, at most 10");
    if (by_time && !(g->deadline_s > 0 && g->deadline_s <= (double)ORL_LIMIT_DEADLINE_S))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "accuracy.deadline_s must be above 0, at most %lu seconds",
                             ORL_LIMIT_DEADLINE_S);
    if (!(g->at > 0 && g->at <= 1))
        return orl_error_set(err, ORL_ERR_RANGE, "accuracy.at must be a share above 0, at most 1");
    if (job->photons_global != ORL_PHOTONS_BY_PLAN || job->photons_caustic != ORL_PHOTONS_BY_PLAN ||
        job->gather_samples || job->pixel_samples)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a job with an accuracy goal or a deadline chooses its photons and "
                             "samples itself: leave them out");
    return 0;
}

static int validate_sky_name(const struct orl_job *job, size_t index, struct orl_error *err)
{
    const char *name = job->skies[index].name;
    const size_t length = name ? strlen(name) : 0;
    if (length == 0 || length > 64)
        return orl_error_set(err, ORL_ERR_INVALID, "a sky needs a name of 1 to 64 characters");
    for (size_t i = 0; i < length; i++)
        if (!isalnum((unsigned char)name[i]) && !strchr("-_", name[i]))
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "sky name '%s' may contain only letters, digits, '-' and '_'",
                                 name);
    if (strcmp(name, "result") == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "no sky may be named 'result'");
    return 0;
}

/* Sorts by name, and by position in the job for equal names. */
static int compare_skies(const void *a, const void *b)
{
    const struct orl_named_sky *x = *(const struct orl_named_sky *const *)a;
    const struct orl_named_sky *y = *(const struct orl_named_sky *const *)b;
    const int by_name = strcmp(x->name, y->name);
    return by_name != 0 ? by_name : (x > y) - (x < y);
}

/* Reports the first sky that repeats an earlier name. */
static int validate_own_names(const struct orl_job *job, struct orl_error *err)
{
    const struct orl_named_sky **sorted = malloc(job->n_skies * sizeof(struct orl_named_sky *));
    const struct orl_named_sky *repeated = NULL;
    char place[32];
    if (!sorted)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu skies", job->n_skies);
    for (size_t i = 0; i < job->n_skies; i++)
        sorted[i] = &job->skies[i];
    qsort(sorted, job->n_skies, sizeof(struct orl_named_sky *), compare_skies);
    for (size_t i = 1; i < job->n_skies; i++)
        if (strcmp(sorted[i - 1]->name, sorted[i]->name) == 0 &&
            (!repeated || sorted[i] < repeated))
            repeated = sorted[i];
    free(sorted);
    if (!repeated)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "two skies are named '%s'", repeated->name);
    orl_error_hint(err, "Give each sky a different \"name\"");
    snprintf(place, sizeof place, "skies[%zu]", (size_t)(repeated - job->skies));
    orl_error_at(err, NULL, 0, place);
    return ORL_ERR_INVALID;
}

static int validate_skies(const struct orl_job *job, struct orl_error *err)
{
    int code = 0;
    if (job->n_skies == 0)
        return orl_daylight_check(&job->sky, err);
    if (job->sky.model != ORL_SKY_OF_SCENE)
        code = orl_error_set(err, ORL_ERR_INVALID,
                             "a job can have either \"sky\" or \"skies\", not both");
    else if (job->n_skies > ORL_LIMIT_SKIES)
        code = orl_error_set(err, ORL_ERR_LIMIT, "%zu skies; at most %u are allowed", job->n_skies,
                             ORL_LIMIT_SKIES);
    else if (job->n_skies * job->n_views > ORL_LIMIT_PICTURES)
        code = orl_error_set(err, ORL_ERR_LIMIT,
                             "%zu views under %zu skies: at most %u pictures are allowed",
                             job->n_views, job->n_skies, ORL_LIMIT_PICTURES);
    else if (job->n_skies * job->n_sensors > ORL_LIMIT_SENSORS)
        code = orl_error_set(err, ORL_ERR_LIMIT,
                             "%zu sensors under %zu skies: at most %lu values are allowed",
                             job->n_sensors, job->n_skies, ORL_LIMIT_SENSORS);
    if (code < 0) {
        orl_error_at(err, NULL, 0, "skies");
        return code;
    }
    for (size_t i = 0; i < job->n_skies && code == 0; i++) {
        char place[32];
        code = validate_sky_name(job, i, err);
        if (code == 0 && job->skies[i].request.model == ORL_SKY_OF_SCENE)
            code = orl_error_set(err, ORL_ERR_INVALID, "no sky is given here");
        if (code == 0)
            code = orl_daylight_check(&job->skies[i].request, err);
        snprintf(place, sizeof place, "skies[%zu]", i);
        if (code < 0)
            orl_error_at(err, NULL, 0, place);
    }
    return code < 0 ? code : validate_own_names(job, err);
}

/* Validates a sequence. Its files begin with "sequence.", those of a sky with its name. */
static int validate_sequence(const struct orl_job *job, struct orl_error *err)
{
    if (!job->sequence.asked)
        return 0;
    if (job->n_skies == 0 || job->n_views == 0)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a sequence needs views and several \"skies\": %s",
                             job->n_views == 0 ? "the job has no views" : "the job has no skies");
    if (job->n_skies > ORL_LIMIT_SEQUENCE)
        return orl_error_set(err, ORL_ERR_LIMIT, "a sequence of %zu skies; at most %u are allowed",
                             job->n_skies, ORL_LIMIT_SEQUENCE);
    for (size_t i = 0; i < job->n_skies; i++)
        if (strcmp(job->skies[i].name, "sequence") == 0)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "no sky may be named 'sequence' if the job has a sequence");
    for (size_t i = 0; i < job->n_views; i++)
        if (job->views[i].formats && !(job->views[i].formats & ORL_PICTURE_BIT(ORL_PICTURE_HDR)))
            return orl_error_set(
                err, ORL_ERR_INVALID,
                "view '%s': a sequence needs HDR pictures, but \"formats\" excludes them",
                job->views[i].name);
    return 0;
}

static bool has_sensors(const struct orl_job *job)
{
    return job->n_sensors > 0 || job->sensors_file || job->n_grids > 0;
}

static int validate_heat_map(const struct orl_job *job, struct orl_error *err)
{
    static const char prefix[] = "sensors.map";
    if (!job->heat_map.asked)
        return 0;
    if (!has_sensors(job))
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a heat map needs sensors, but the job has none");
    for (size_t i = 0; i < job->n_views; i++)
        if (strncmp(job->views[i].name, prefix, sizeof prefix - 1) == 0)
            return orl_error_set(
                err, ORL_ERR_INVALID,
                "view name '%s': names that begin with '%s' are reserved for heat maps",
                job->views[i].name, prefix);
    return 0;
}

int orl_job_validate(const struct orl_job *job, struct orl_error *err)
{
    if (!has_sensors(job) && job->n_views == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "a job needs sensors, views or both");
    if (job->n_sensors > ORL_LIMIT_SENSORS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu sensors; at most %lu are allowed",
                             job->n_sensors, ORL_LIMIT_SENSORS);
    if (job->n_views > ORL_LIMIT_VIEWS)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu views; at most %u are allowed", job->n_views,
                             ORL_LIMIT_VIEWS);
    if (too_many(job->photons_global) || too_many(job->photons_caustic))
        return orl_error_set(err, ORL_ERR_LIMIT, "at most %lu photons are allowed in a map",
                             ORL_LIMIT_PHOTONS);
    if (job->photons_global < 1)
        return orl_error_set(err, ORL_ERR_INVALID, "photons.global must be at least 1");
    for (size_t i = 0; i < job->n_sensors; i++) {
        const struct orl_sensor *s = &job->sensors[i];
        char what[32];
        snprintf(what, sizeof what, "sensor %zu", i);
        int code = orl_check_point(s->position, what, err);
        if (code == 0)
            code = orl_check_direction(s->direction, what, err);
        if (code < 0)
            return code;
    }
    for (size_t i = 0; i < job->n_views; i++) {
        const int code = validate_view(job, i, err);
        if (code < 0)
            return code;
    }
    int code = orl_grids_validate(job, err);
    if (code == 0)
        code = validate_heat_map(job, err);
    if (code == 0)
        code = validate_sequence(job, err);
    if (code == 0)
        code = validate_goal(job, err);
    return code < 0 ? code : validate_skies(job, err);
}

void orl_view_result_done(struct orl_view_result *view)
{
    free(view->name);
    for (int i = 0; i < ORL_PICTURES; i++)
        free(view->files[i]);
    free(view->points);
    orl_glare_done(view->glare);
    free(view->glare);
    *view = (struct orl_view_result){.seconds = view->seconds};
}

void orl_sensor_files_done(struct orl_sensor_files *files)
{
    free(files->csv);
    free(files->res);
    for (size_t i = 0; i < files->n_maps; i++) {
        free(files->maps[i].png);
        free(files->maps[i].svg);
        free(files->maps[i].dat);
    }
    *files = (struct orl_sensor_files){.csv = NULL};
}

void orl_result_done(struct orl_result *result)
{
    if (!result)
        return;
    free(result->illuminance_lx);
    free(result->standard_error_lx);
    free(result->bias_estimate_lx);
    free(result->interval_95_lx);
    free(result->doubts);
    for (size_t i = 0; i < result->n_views; i++)
        orl_view_result_done(&result->views[i]);
    free(result->views);
    orl_sensor_files_done(&result->sensor_files);
    orl_grid_results_done(result);
    orl_texts_free(result->warnings, result->n_warnings);
    memset(result, 0, sizeof *result);
}

const char *orl_stage_name(enum orl_stage stage)
{
    static const char *const names[ORL_STAGE_COUNT] = {"load",    "bvh",  "plan",
                                                       "photons", "maps", "render"};
    return stage < ORL_STAGE_COUNT ? names[stage] : "unknown";
}

bool orl_goal_is_set(const struct orl_goal *goal)
{
    return goal->relative_error > 0 || goal->deadline_s > 0 || goal->dgp_error > 0;
}

/* Samples per pixel, and the number of rounds. */

uint32_t orl_run_pixel_samples(const struct orl_run_state *state)
{
    const uint32_t asked = state->job->pixel_samples;
    return asked                                ? asked
           : orl_job_asks_for_glare(state->job) ? ORL_DEFAULT_GLARE_PIXEL_SAMPLES
                                                : ORL_DEFAULT_PIXEL_SAMPLES;
}

/* Returns the number of rounds. By photon maps each costs the full time of the views, however few
 * the photons: use the fewest whose spread has some degrees of freedom. */
uint32_t orl_run_count_batches(const struct orl_run_state *state)
{
    enum { OF_PATHS = 8, OF_MAPS = 4 };
    const uint32_t most = orl_run_pixel_samples(state);
    if (!orl_job_asks_for_glare(state->job))
        return 1;
    if (!orl_technique_facts(state->result->plan.technique)->samples_paths)
        return OF_MAPS;
    return most < OF_PATHS ? most : OF_PATHS;
}
