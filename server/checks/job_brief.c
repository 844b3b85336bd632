#include "checks/job_brief.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "jobs/job_share.h"
#include "runner/job_output.h"

void orl_job_brief_done(struct orl_job_brief *brief)
{
    if (!brief)
        return;
    for (size_t i = 0; i < brief->n_files; i++) {
        free(brief->files[i].name);
        free(brief->files[i].place);
        free(brief->files[i].entry);
    }
    free(brief->files);
    memset(brief, 0, sizeof *brief);
}

/* Room for all is there already. */
static int add_file(struct orl_job_brief *brief, const char *name, const char *place,
                    const char *entry, struct orl_error *err)
{
    if (!name)
        return 0;
    struct orl_named_file *file = &brief->files[brief->n_files++];
    *file = (struct orl_named_file){strdup(name), strdup(place), entry ? strdup(entry) : NULL};
    return file->name && file->place && (file->entry || !entry)
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

static int add_files(struct orl_job_brief *brief, const struct orl_job *job, struct orl_error *err)
{
    brief->files = calloc(job->n_skies + 2 * job->n_views + 2, sizeof *brief->files);
    if (!brief->files)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    int rc = add_file(brief, job->sensors_file, "sensors.file", NULL, err);
    if (rc == 0)
        rc = add_file(brief, job->sky.weather_file, "sky.weather.file", NULL, err);
    for (size_t i = 0; i < job->n_skies && rc == 0; i++) {
        char place[48];
        snprintf(place, sizeof place, "skies[%zu].weather.file", i);
        rc = add_file(brief, job->skies[i].request.weather_file, place, NULL, err);
    }
    for (size_t i = 0; i < job->n_views && rc == 0; i++) {
        char place[48];
        snprintf(place, sizeof place, "views[%zu].file", i);
        rc = add_file(brief, job->views[i].file, place, job->views[i].entry, err);
        const char *mask = job->views[i].glare.mask;
        snprintf(place, sizeof place, "views[%zu].glare.mask", i);
        if (rc == 0 && mask[0])
            rc = add_file(brief, mask, place, NULL, err);
    }
    return rc;
}

static uint64_t photons_of(uint64_t target)
{
    return target == ORL_PHOTONS_BY_PLAN ? ORL_DEFAULT_PHOTONS : target;
}

static void count_needs(struct orl_job_brief *brief, const struct orl_task *task,
                        const struct orl_job *job)
{
    brief->sensors = job->n_sensors;
    brief->photons = photons_of(job->photons_global) + photons_of(job->photons_caustic);
    for (size_t i = 0; task->kind == ORL_TASK_STUDY && i < task->of.study.n_photons; i++)
        if (2 * task->of.study.photons[i] > brief->photons)
            brief->photons = 2 * task->of.study.photons[i];
    for (size_t i = 0; i < job->n_views; i++) {
        const uint64_t pixels = (uint64_t)job->views[i].width * job->views[i].height;
        brief->pixels = pixels > brief->pixels ? pixels : brief->pixels;
    }
}

int orl_job_brief_read(const struct orl_file *document, struct orl_job_brief *ret_brief,
                       struct orl_error *err)
{
    struct orl_job_brief brief = {0};
    struct orl_task task;
    char *scene = NULL;
    int rc = orl_job_read(document->data, document->size, &task, &scene, err);
    if (rc)
        return rc;
    const struct orl_job *job = orl_task_job(&task);
    brief.kind = task.kind;
    brief.priority = task.priority;
    brief.result_bytes = orl_job_output_expect(&task);
    brief.sensor_bytes = orl_job_output_expect_sensor(&task);
    snprintf(brief.scene, sizeof brief.scene, "%s", scene);
    count_needs(&brief, &task, job);
    rc = add_files(&brief, job, err);
    orl_task_done(&task);
    free(scene);
    if (rc) {
        orl_job_brief_done(&brief);
        return rc;
    }
    orl_share_identity(document->data, document->size, brief.identity);
    *ret_brief = brief;
    return 0;
}

/* ---- Between processes ----------------------------------------------------------------------- */

json_t *orl_job_brief_to_json(const struct orl_job_brief *brief)
{
    json_t *files = json_array();
    for (size_t i = 0; files && i < brief->n_files; i++)
        if (json_array_append_new(files, json_pack("[s, s, s?]", brief->files[i].name,
                                                   brief->files[i].place, brief->files[i].entry))) {
            json_decref(files);
            return NULL;
        }
    return json_pack("{s:i, s:i, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:o}", "kind", (int)brief->kind,
                     "priority", brief->priority, "scene", brief->scene, "identity",
                     brief->identity, "result_bytes", (json_int_t)brief->result_bytes,
                     "sensor_bytes", (json_int_t)brief->sensor_bytes, "sensors",
                     (json_int_t)brief->sensors, "photons", (json_int_t)brief->photons, "pixels",
                     (json_int_t)brief->pixels, "files", files);
}

static int take_files(struct orl_job_brief *brief, const json_t *files, struct orl_error *err)
{
    brief->files = calloc(json_array_size(files) + 1, sizeof *brief->files);
    if (!brief->files)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < json_array_size(files); i++) {
        const json_t *entry = json_array_get(files, i);
        const char *name = json_string_value(json_array_get(entry, 0));
        const char *place = json_string_value(json_array_get(entry, 1));
        const char *which = json_string_value(json_array_get(entry, 2));
        const int rc = name && place ? add_file(brief, name, place, which, err) : ORL_ERR_INTERNAL;
        if (rc)
            return rc;
    }
    return 0;
}

int orl_job_brief_from_json(const json_t *json, struct orl_job_brief *ret_brief,
                            struct orl_error *err)
{
    struct orl_job_brief brief = {0};
    const char *scene = NULL, *identity = NULL;
    const json_t *files = NULL;
    int kind = 0;
    json_int_t result_bytes = 0, sensor_bytes = 0, sensors = 0, photons = 0, pixels = 0;
    int rc =
        json_unpack((json_t *)(uintptr_t)json, "{s:i, s:i, s:s, s:s, s:I, s:I, s:I, s:I, s:I, s:o}",
                    "kind", &kind, "priority", &brief.priority, "scene", &scene, "identity",
                    &identity, "result_bytes", &result_bytes, "sensor_bytes", &sensor_bytes,
                    "sensors", &sensors, "photons", &photons, "pixels", &pixels, "files", &files);
    if (rc || kind < 0 || kind >= ORL_TASK_KIND_COUNT || !orl_is_sha256(scene) ||
        (*identity && !orl_is_sha256(identity)) || brief.priority < 0 ||
        brief.priority > ORL_PRIORITY_MAX || result_bytes < 0 || sensor_bytes < 0 || sensors < 0 ||
        photons < 0 || pixels < 0 ||
        json_array_size(files) > ORL_LIMIT_SKIES + 2 * ORL_LIMIT_VIEWS + 2)
        return orl_error_set(err, ORL_ERR_INTERNAL, "a check answered what makes no sense");
    brief.kind = (enum orl_task_kind)kind;
    snprintf(brief.scene, sizeof brief.scene, "%s", scene);
    snprintf(brief.identity, sizeof brief.identity, "%s", identity);
    brief.result_bytes = (uint64_t)result_bytes;
    brief.sensor_bytes = (uint64_t)sensor_bytes;
    brief.sensors = (uint64_t)sensors;
    brief.photons = (uint64_t)photons;
    brief.pixels = (uint64_t)pixels;
    rc = take_files(&brief, files, err);
    if (rc)
        orl_job_brief_done(&brief);
    else
        *ret_brief = brief;
    return rc;
}
