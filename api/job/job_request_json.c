#include "job/job_request_json.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/suggest.h>

#include "job/study_json.h"
#include "schemas.h"
#include "json/decode.h"

/* ---- Kinds ----------------------------------------------------------------------------------- */

static const char *const kind_names[ORL_JOB_KIND_COUNT] = {
    [ORL_JOB_KIND_RENDER] = "render",     [ORL_JOB_KIND_STUDY] = "study",
    [ORL_JOB_KIND_ANNUAL] = "annual",     [ORL_JOB_KIND_BSDF_MAKE] = "bsdf_make",
    [ORL_JOB_KIND_BSDF_FIT] = "bsdf_fit",
};

/* Decodes the document as one of its kind, into the member of that kind. */
static int decode_kind(const json_t *doc, enum orl_job_origin origin,
                       struct orl_job_request *job_request, char **ret_scene_id,
                       struct orl_error *err)
{
    switch (job_request->kind) {
    case ORL_JOB_KIND_STUDY:
        return orl_study_from_json(doc, origin, &job_request->of.study, ret_scene_id, err);
    case ORL_JOB_KIND_ANNUAL:
        return orl_annual_job_from_json(doc, origin, &job_request->of.annual, ret_scene_id, err);
    case ORL_JOB_KIND_BSDF_MAKE:
        return orl_bsdf_make_from_json(doc, origin, &job_request->of.bsdf_make, ret_scene_id, err);
    case ORL_JOB_KIND_BSDF_FIT:
        return orl_bsdf_fit_from_json(doc, origin, &job_request->of.bsdf_fit, ret_scene_id, err);
    default:
        return orl_job_from_json(doc, origin, &job_request->of.render, ret_scene_id, err);
    }
}

static int validate_kind(const struct orl_job_request *job_request, struct orl_error *err)
{
    switch (job_request->kind) {
    case ORL_JOB_KIND_STUDY:
        return orl_study_request_validate(&job_request->of.study, err);
    case ORL_JOB_KIND_ANNUAL:
        return orl_annual_job_validate(&job_request->of.annual, err);
    case ORL_JOB_KIND_BSDF_MAKE:
        return orl_bsdf_make_validate(&job_request->of.bsdf_make, err);
    case ORL_JOB_KIND_BSDF_FIT:
        return orl_bsdf_fit_validate(&job_request->of.bsdf_fit, err);
    default:
        return orl_job_validate(&job_request->of.render, err);
    }
}

static void free_kind(struct orl_job_request *job_request)
{
    if (job_request->kind == ORL_JOB_KIND_STUDY)
        orl_study_request_done(&job_request->of.study);
    else if (job_request->kind == ORL_JOB_KIND_ANNUAL)
        orl_annual_job_done(&job_request->of.annual);
    else if (job_request->kind == ORL_JOB_KIND_BSDF_MAKE)
        orl_bsdf_make_request_done(&job_request->of.bsdf_make);
    else if (job_request->kind == ORL_JOB_KIND_BSDF_FIT)
        orl_bsdf_fit_request_done(&job_request->of.bsdf_fit);
    else
        orl_job_done(&job_request->of.render);
}

const char *orl_job_request_kind_name(enum orl_job_request_kind kind)
{
    return kind < ORL_JOB_KIND_COUNT ? kind_names[kind] : "unknown";
}

enum orl_job_request_kind orl_job_request_kind_from_name(const char *name)
{
    unsigned kind = 0;
    while (kind < ORL_JOB_KIND_COUNT && strcmp(kind_names[kind], name) != 0)
        kind++;
    return (enum orl_job_request_kind)kind;
}

void orl_job_request_done(struct orl_job_request *job_request)
{
    if (!job_request)
        return;
    free_kind(job_request);
    orl_labels_done(&job_request->labels);
}

/* ---- The document ---------------------------------------------------------------------------- */

static int read_kind(const json_t *doc, enum orl_job_request_kind *ret_kind, struct orl_error *err)
{
    const json_t *value = json_object_get(doc, "kind");
    const char *name = json_string_value(value);
    *ret_kind = !value ? ORL_JOB_KIND_RENDER
                : name ? orl_job_request_kind_from_name(name)
                       : ORL_JOB_KIND_COUNT;
    if (*ret_kind < ORL_JOB_KIND_COUNT)
        return 0;
    struct orl_suggestion suggestion = {.word = name ? name : ""};
    for (unsigned kind = 0; kind < ORL_JOB_KIND_COUNT; kind++)
        orl_suggestion_add(&suggestion, kind_names[kind]);
    orl_json_fail(
        err, ORL_ERR_INVALID, "kind",
        "\"render\" (the default), \"study\", \"annual\", \"bsdf_make\" or \"bsdf_fit\" is "
        "expected here");
    orl_suggestion_hint(&suggestion, err);
    return ORL_ERR_INVALID;
}

static int read_priority(const json_t *doc, int *ret_priority, struct orl_error *err)
{
    const json_t *value = json_object_get(doc, "priority");
    uint64_t priority = ORL_PRIORITY_DEFAULT;
    const int rc = value ? orl_json_whole(value, "priority", orl_schema_priority.from,
                                          orl_schema_priority.to, &priority, err)
                         : 0;
    if (rc == 0)
        *ret_priority = (int)priority;
    return rc;
}

int orl_job_request_from_json(const json_t *doc, enum orl_job_origin origin,
                              struct orl_job_request *ret_job_request, char **ret_scene_id,
                              struct orl_error *err)
{
    struct orl_job_request job_request = {.kind = ORL_JOB_KIND_RENDER};
    char *scene_id = NULL;
    int rc = read_kind(doc, &job_request.kind, err);
    if (rc == 0)
        rc = read_priority(doc, &job_request.priority, err);
    if (rc == 0)
        rc = orl_labels_from_json(doc, &job_request.labels, err);
    if (rc == 0)
        rc = decode_kind(doc, origin, &job_request, &scene_id, err);
    if (rc) {
        orl_labels_done(&job_request.labels);
        return rc;
    }
    rc = validate_kind(&job_request, err);
    if (rc)
        orl_job_request_done(&job_request);
    else
        *ret_job_request = job_request;
    return orl_json_return_text(scene_id, ret_scene_id, rc);
}

const struct orl_job *orl_job_request_render_job(const struct orl_job_request *job_request)
{
    return job_request->kind == ORL_JOB_KIND_RENDER  ? &job_request->of.render
           : job_request->kind == ORL_JOB_KIND_STUDY ? &job_request->of.study.job
                                                     : NULL;
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* Addresses of a job request's main file names and their number. */
struct scene_file_list {
    char ***files;
    size_t *count;
};

static struct scene_file_list scene_of(struct orl_job_request *job_request)
{
    struct orl_job *job = job_request->kind == ORL_JOB_KIND_STUDY ? &job_request->of.study.job
                                                                  : &job_request->of.render;
    struct orl_annual_request *year = &job_request->of.annual.request;
    struct orl_bsdf_make_request *panel = &job_request->of.bsdf_make;
    struct orl_bsdf_fit_request *sample = &job_request->of.bsdf_fit;
    return job_request->kind == ORL_JOB_KIND_ANNUAL
               ? (struct scene_file_list){&year->scene_files, &year->n_scene_files}
           : job_request->kind == ORL_JOB_KIND_BSDF_MAKE
               ? (struct scene_file_list){&panel->files, &panel->n_files}
           : job_request->kind == ORL_JOB_KIND_BSDF_FIT
               ? (struct scene_file_list){&sample->files, &sample->n_files}
               : (struct scene_file_list){&job->scene_files, &job->n_scene_files};
}

char *const *orl_job_request_scene(const struct orl_job_request *job_request, size_t *ret_count)
{
    const struct scene_file_list place = scene_of((struct orl_job_request *)(uintptr_t)job_request);
    *ret_count = *place.count;
    return *place.files;
}

void orl_job_request_set_scene(struct orl_job_request *job_request, char **files, size_t count)
{
    const struct scene_file_list place = scene_of(job_request);
    *place.files = files;
    *place.count = count;
}

struct file_visitor {
    int (*visit)(void *ctx, const struct orl_job_request_file *file, struct orl_error *err);
    void *ctx;
    struct orl_error *err;
};

static int visit_file(const struct file_visitor *v, enum orl_file_role role, const char *name,
                      const char *entry, const char *format, ...)
    __attribute__((format(printf, 5, 6)));
/* Visits a file; names that are NULL or empty are skipped. */
static int visit_file(const struct file_visitor *v, enum orl_file_role role, const char *name,
                      const char *entry, const char *format, ...)
{
    char place[64];
    va_list args;
    if (!name || !*name)
        return 0;
    va_start(args, format);
    vsnprintf(place, sizeof place, format, args);
    va_end(args);
    const struct orl_job_request_file file = {role, name, place, entry};
    return v->visit(v->ctx, &file, v->err);
}

static int visit_weather(const struct file_visitor *v, const struct orl_sky_request *sky,
                         const char *place)
{
    char year[16];
    snprintf(year, sizeof year, "%d", sky->weather_year);
    return visit_file(v, ORL_FILE_WEATHER, sky->weather_file, sky->weather_year ? year : NULL, "%s",
                      place);
}

static int visit_job(const struct file_visitor *v, const struct orl_job *job)
{
    int rc = visit_file(v, ORL_FILE_SENSORS, job->sensors_file, NULL, "sensors.file");
    for (size_t i = 0; i < job->n_grids && rc == 0; i++)
        rc =
            visit_file(v, ORL_FILE_SENSORS, job->grids[i].file, NULL, "grids[%zu].sensors.file", i);
    if (rc == 0)
        rc = visit_weather(v, &job->sky, "sky.weather.file");
    for (size_t i = 0; i < job->n_skies && rc == 0; i++) {
        char place[64];
        snprintf(place, sizeof place, "skies[%zu].weather.file", i);
        rc = visit_weather(v, &job->skies[i].request, place);
    }
    for (size_t i = 0; i < job->n_views && rc == 0; i++) {
        const struct orl_view_request *view = &job->views[i];
        rc = visit_file(v, ORL_FILE_VIEW, view->file, view->entry, "views[%zu].file", i);
        if (rc == 0)
            rc = visit_file(v, ORL_FILE_MASK, view->glare.mask, NULL, "views[%zu].glare.mask", i);
    }
    return rc;
}

static int visit_group(const struct file_visitor *v, const struct orl_window_group *group, size_t g)
{
    int rc = visit_file(v, ORL_FILE_SCHEDULE, group->schedule_file, NULL,
                        "shades[%zu].schedule.file", g);
    for (size_t s = 0; s < group->n_states && rc == 0; s++)
        for (size_t i = 0; i < group->states[s].n_files && rc == 0; i++)
            rc = visit_file(v, ORL_FILE_SCENE, group->states[s].files[i], NULL,
                            "shades[%zu].states[%zu].files[%zu]", g, s, i);
    return rc;
}

static int visit_term(const struct file_visitor *v, const struct orl_matrix_term *term, size_t i)
{
    const struct {
        const char *member, *name;
    } files[] = {{"coefficients", term->coefficients},
                 {"view", term->view},
                 {"transmission", term->transmission},
                 {"daylight", term->daylight},
                 {"sky", term->sky}};
    int rc = 0;
    for (size_t k = 0; k < sizeof files / sizeof *files && rc == 0; k++)
        rc = visit_file(v, ORL_FILE_MATRIX, files[k].name, NULL, "matrices[%zu].%s", i,
                        files[k].member);
    return rc;
}

static int visit_year(const struct file_visitor *v, const struct orl_annual_job *year)
{
    char number[16];
    snprintf(number, sizeof number, "%d", year->request.weather_year);
    int rc = visit_file(v, ORL_FILE_YEAR, year->request.weather_file,
                        year->request.weather_year ? number : NULL, "weather");
    if (rc == 0)
        rc = visit_file(v, ORL_FILE_OCCUPANCY, year->report_request.occupancy_file, NULL,
                        "occupancy.file");
    for (size_t g = 0; g < year->request.n_grids && rc == 0; g++)
        rc = year->bare ? visit_file(v, ORL_FILE_SENSORS, year->grid_files[g], NULL, "sensors.file")
                        : visit_file(v, ORL_FILE_SENSORS, year->grid_files[g], NULL,
                                     "grids[%zu].sensors.file", g);
    for (size_t g = 0; g < year->request.n_groups && rc == 0; g++)
        rc = visit_group(v, &year->request.groups[g], g);
    for (size_t i = 0; i < year->request.n_terms && rc == 0; i++)
        rc = visit_term(v, &year->request.terms[i], i);
    return rc;
}

int orl_job_request_files(const struct orl_job_request *job_request,
                          int (*visit)(void *ctx, const struct orl_job_request_file *file,
                                       struct orl_error *err),
                          void *ctx, struct orl_error *err)
{
    const struct file_visitor v = {visit, ctx, err};
    const struct orl_job *job = orl_job_request_render_job(job_request);
    if (job_request->kind == ORL_JOB_KIND_BSDF_MAKE || job_request->kind == ORL_JOB_KIND_BSDF_FIT)
        return 0;
    return job ? visit_job(&v, job) : visit_year(&v, &job_request->of.annual);
}
