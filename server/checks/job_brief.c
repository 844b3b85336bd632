#include "checks/job_brief.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/json_read.h>
#include <oriel/limits.h>

#include "jobs/job_share.h"
#include "runner/job_output.h"
#include "runner/kinds.h"

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
    orl_labels_done(&brief->labels);
    memset(brief, 0, sizeof *brief);
}

/* Maximum number of files that a document may name, over all roles. */
enum { FILES_MAX = ORL_LIMIT_SKIES + 2 * ORL_LIMIT_VIEWS + ORL_LIMIT_GRIDS + 2 };

static int add_file(void *ctx, const struct orl_task_file *named, struct orl_error *err)
{
    struct orl_job_brief *brief = ctx;
    const char *entry = named->entry;
    if (brief->n_files == FILES_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "the document names more than %d files",
                             FILES_MAX);
    if (brief->n_files == brief->room) {
        const size_t room = 2 * brief->room + 8;
        struct orl_named_file *grown = realloc(brief->files, room * sizeof *grown);
        if (!grown)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        brief->files = grown;
        brief->room = room;
    }
    struct orl_named_file *file = &brief->files[brief->n_files++];
    *file = (struct orl_named_file){named->role, strdup(named->name), strdup(named->place),
                                    entry ? strdup(entry) : NULL};
    return file->name && file->place && (file->entry || !entry)
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
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
    brief.kind = task.kind;
    brief.priority = task.priority;
    brief.labels = task.labels;
    task.labels = (struct orl_labels){0};
    brief.result_bytes = orl_kinds[task.kind].result_bytes(&task);
    brief.sensor_bytes = orl_kinds[task.kind].sensor_bytes(&task);
    if (orl_kinds[task.kind].hour_bytes)
        brief.hour_bytes = orl_kinds[task.kind].hour_bytes(&task);
    orl_kinds[task.kind].needs(&task, &brief.needs);
    brief.whole = orl_kinds[task.kind].whole && orl_kinds[task.kind].whole(&task);
    snprintf(brief.scene, sizeof brief.scene, "%s", scene);
    rc = orl_task_files(&task, add_file, &brief, err);
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
    const struct orl_job_memory *needs = &brief->needs;
    json_t *files = json_array();
    for (size_t i = 0; files && i < brief->n_files; i++) {
        const struct orl_named_file *file = &brief->files[i];
        if (json_array_append_new(files, json_pack("[s, s, i, s?]", file->name, file->place,
                                                   (int)file->role, file->entry))) {
            json_decref(files);
            return NULL;
        }
    }
    return json_pack(
        "{s:i, s:i, s:s*, s:s*, s:s, s:s, s:I, s:I, s:I, s:b, s:[I, I, I, I, I, I, I, I, I, I], "
        "s:o}",
        "kind", (int)brief->kind, "priority", brief->priority, "name", brief->labels.name, "tags",
        brief->labels.tags, "scene", brief->scene, "identity", brief->identity, "result_bytes",
        (json_int_t)brief->result_bytes, "sensor_bytes", (json_int_t)brief->sensor_bytes,
        "hour_bytes", (json_int_t)brief->hour_bytes, "whole", (int)brief->whole, "needs",
        (json_int_t)needs->sensors, (json_int_t)needs->photons, (json_int_t)needs->pixels,
        (json_int_t)needs->hour_bytes, (json_int_t)needs->bsdf_made_bytes,
        (json_int_t)needs->mask_pixels, (json_int_t)needs->array_bytes, (json_int_t)needs->windows,
        (json_int_t)needs->seats, (json_int_t)needs->window_groups, "files", files);
}

static int read_files(struct orl_job_brief *brief, const json_t *files, struct orl_error *err)
{
    for (size_t i = 0; i < json_array_size(files); i++) {
        const json_t *entry = json_array_get(files, i);
        const json_int_t role = json_integer_value(json_array_get(entry, 2));
        const struct orl_task_file file = {(enum orl_file_role)role,
                                           json_string_value(json_array_get(entry, 0)),
                                           json_string_value(json_array_get(entry, 1)),
                                           json_string_value(json_array_get(entry, 3))};
        const bool good = file.name && file.place && role >= 0 && role < ORL_FILE_ROLES;
        const int rc = good ? add_file(brief, &file, err) : ORL_ERR_INTERNAL;
        if (rc)
            return rc;
    }
    return 0;
}

static bool read_needs(struct orl_job_memory *needs, const json_t *numbers)
{
    uint64_t *const places[] = {&needs->sensors,      &needs->photons,         &needs->pixels,
                                &needs->hour_bytes,   &needs->bsdf_made_bytes, &needs->mask_pixels,
                                &needs->array_bytes,  &needs->windows,         &needs->seats,
                                &needs->window_groups};
    enum { PLACES = sizeof places / sizeof *places };
    bool good = json_array_size(numbers) == PLACES;
    for (size_t i = 0; i < PLACES && good; i++) {
        const json_int_t value = json_integer_value(json_array_get(numbers, i));
        good = value >= 0;
        *places[i] = good ? (uint64_t)value : 0;
    }
    return good;
}

/* Validates the labels again: a child that read untrusted data may send anything. */
static bool read_labels(struct orl_labels *labels, const char *name, const char *tags)
{
    struct orl_error err;
    json_t *list = tags ? orl_json_reread(tags) : NULL;
    json_t *doc = json_pack("{s:s*, s:o*}", "name", name, "tags", list);
    const bool good = doc && (list || !tags) && orl_labels_from_json(doc, labels, &err) == 0;
    json_decref(doc);
    return good;
}

int orl_job_brief_from_json(const json_t *json, struct orl_job_brief *ret_brief,
                            struct orl_error *err)
{
    struct orl_job_brief brief = {0};
    const char *scene = NULL, *identity = NULL, *name = NULL, *tags = NULL;
    const json_t *files = NULL, *needs = NULL;
    int kind = 0, whole = 0;
    json_int_t result_bytes = 0, sensor_bytes = 0, hour_bytes = 0;
    int rc = json_unpack(
        (json_t *)(uintptr_t)json, "{s:i, s:i, s?s, s?s, s:s, s:s, s:I, s:I, s:I, s:b, s:o, s:o}",
        "kind", &kind, "priority", &brief.priority, "name", &name, "tags", &tags, "scene", &scene,
        "identity", &identity, "result_bytes", &result_bytes, "sensor_bytes", &sensor_bytes,
        "hour_bytes", &hour_bytes, "whole", &whole, "needs", &needs, "files", &files);
    if (rc || kind < 0 || kind >= ORL_TASK_KIND_COUNT || !orl_is_sha256(scene) ||
        (*identity && !orl_is_sha256(identity)) || brief.priority < 0 ||
        brief.priority > ORL_PRIORITY_MAX || result_bytes < 0 || sensor_bytes < 0 ||
        hour_bytes < 0 || !read_needs(&brief.needs, needs) ||
        !read_labels(&brief.labels, name, tags))
        return orl_error_set(err, ORL_ERR_INTERNAL, "a check answered what makes no sense");
    brief.kind = (enum orl_task_kind)kind;
    snprintf(brief.scene, sizeof brief.scene, "%s", scene);
    snprintf(brief.identity, sizeof brief.identity, "%s", identity);
    brief.result_bytes = (uint64_t)result_bytes;
    brief.sensor_bytes = (uint64_t)sensor_bytes;
    brief.hour_bytes = (uint64_t)hour_bytes;
    brief.whole = whole != 0;
    rc = read_files(&brief, files, err);
    if (rc)
        orl_job_brief_done(&brief);
    else
        *ret_brief = brief;
    return rc;
}
