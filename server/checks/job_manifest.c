#include "checks/job_manifest.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>
#include <oriel/base/json_read.h>
#include <oriel/base/limits.h>

#include "checks/child/messages.h"
#include "runner/estimate/job_estimate.h"
#include "runner/job_document.h"
#include "json/decode.h"
#include "json/encode.h"

void orl_job_manifest_done(struct orl_job_manifest *manifest)
{
    if (!manifest)
        return;
    for (size_t i = 0; i < manifest->n_files; i++) {
        free(manifest->files[i].name);
        free(manifest->files[i].location);
        free(manifest->files[i].entry);
    }
    free(manifest->files);
    orl_labels_done(&manifest->labels);
    memset(manifest, 0, sizeof *manifest);
}

/* Maximum number of files that a document may name, over all roles. */
enum { FILES_MAX = ORL_LIMIT_SKIES + 2 * ORL_LIMIT_VIEWS + ORL_LIMIT_GRIDS + 2 };

static int add_file(void *ctx, const struct orl_job_request_file *named, struct orl_error *err)
{
    struct orl_job_manifest *manifest = ctx;
    const char *entry = named->entry;
    if (manifest->n_files == FILES_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "the document names more than %d files",
                             FILES_MAX);
    if (!orl_array_reserve(&manifest->files, &manifest->capacity, manifest->n_files,
                           sizeof *manifest->files))
        return orl_error_no_memory(err);
    struct orl_named_file *file = &manifest->files[manifest->n_files++];
    *file = (struct orl_named_file){named->role, strdup(named->name), strdup(named->location),
                                    entry ? strdup(entry) : NULL};
    return file->name && file->location && (file->entry || !entry) ? 0 : orl_error_no_memory(err);
}

/* Fills a manifest from a document's request, but for its identity. */
static int fill_manifest(struct orl_job_manifest *manifest, struct orl_job_request *job_request,
                         struct orl_error *err)
{
    const struct orl_job_kind *kind = &orl_job_kinds[job_request->kind];
    manifest->kind = job_request->kind;
    manifest->priority = job_request->priority;
    manifest->labels = job_request->labels;
    job_request->labels = (struct orl_labels){0};
    manifest->result_bytes = kind->result_bytes(job_request);
    manifest->sensor_bytes = kind->sensor_bytes(job_request);
    manifest->hour_bytes = kind->hour_bytes ? kind->hour_bytes(job_request) : 0;
    manifest->whole_scene = kind->whole_scene && kind->whole_scene(job_request);
    kind->needs(job_request, &manifest->needs);
    return orl_job_request_files(job_request, add_file, manifest, err);
}

int orl_job_manifest_read(const struct orl_file *text, struct orl_job_manifest *ret_manifest,
                          struct orl_error *err)
{
    struct orl_job_manifest manifest = {0};
    struct orl_job_request job_request;
    json_t *document = NULL;
    char *scene = NULL;
    int rc = orl_json_parse(NULL, text->data, text->size, &document, err);
    if (rc)
        return rc;
    rc = orl_job_document_decode(document, &job_request, &scene, err);
    if (rc == 0) {
        rc = fill_manifest(&manifest, &job_request, err);
        snprintf(manifest.scene, sizeof manifest.scene, "%s", scene);
        orl_job_document_identity(document, manifest.identity);
        orl_job_request_done(&job_request);
        free(scene);
    }
    json_decref(document);
    if (rc)
        orl_job_manifest_done(&manifest);
    else
        *ret_manifest = manifest;
    return rc;
}

/* Lists the addresses of a document's needs, in the order in which they are sent. */
enum { NEEDS = 10 };
static void list_needs(struct orl_job_memory *needs, uint64_t *ret_places[NEEDS])
{
    uint64_t *const places[] = {&needs->sensors,      &needs->photons,         &needs->pixels,
                                &needs->hour_bytes,   &needs->bsdf_made_bytes, &needs->mask_pixels,
                                &needs->array_bytes,  &needs->windows,         &needs->viewpoints,
                                &needs->window_groups};
    memcpy(ret_places, places, sizeof places);
}

/* ---- Between processes ----------------------------------------------------------------------- */

json_t *orl_job_manifest_to_json(const struct orl_job_manifest *manifest)
{
    struct orl_job_memory needs = manifest->needs;
    uint64_t *places[NEEDS];
    json_t *files = json_array();
    list_needs(&needs, places);
    for (size_t i = 0; files && i < manifest->n_files; i++) {
        const struct orl_named_file *file = &manifest->files[i];
        files = orl_json_append(files, json_pack("[s, s, i, s?]", file->name, file->location,
                                                 (int)file->role, file->entry));
    }
    return json_pack(
        "{s:i, s:i, s:s*, s:s*, s:s, s:s, s:I, s:I, s:I, s:b, s:o, s:o}", "kind",
        (int)manifest->kind, "priority", manifest->priority, "name", manifest->labels.name, "tags",
        manifest->labels.tags, "scene", manifest->scene, "identity", manifest->identity,
        "result_bytes", (json_int_t)manifest->result_bytes, "sensor_bytes",
        (json_int_t)manifest->sensor_bytes, "hour_bytes", (json_int_t)manifest->hour_bytes, "whole",
        (int)manifest->whole_scene, "needs", orl_counts_to_json(places, NEEDS), "files", files);
}

static int read_files(struct orl_job_manifest *manifest, const json_t *files, struct orl_error *err)
{
    for (size_t i = 0; i < json_array_size(files); i++) {
        const json_t *entry = json_array_get(files, i);
        const json_int_t role = json_integer_value(json_array_get(entry, 2));
        const struct orl_job_request_file file = {(enum orl_file_role)role,
                                                  json_string_value(json_array_get(entry, 0)),
                                                  json_string_value(json_array_get(entry, 1)),
                                                  json_string_value(json_array_get(entry, 3))};
        const bool good = file.name && file.location && role >= 0 && role < ORL_FILE_ROLES;
        const int rc = good ? add_file(manifest, &file, err) : ORL_ERR_INTERNAL;
        if (rc)
            return rc;
    }
    return 0;
}

/* Validates the labels again: a child that read untrusted data may send anything. */
static bool read_labels(struct orl_labels *labels, const char *name, const char *tags)
{
    struct orl_error err;
    json_t *list = tags ? orl_json_read_stored(tags) : NULL;
    json_t *doc = json_pack("{s:s*, s:o*}", "name", name, "tags", list);
    const bool good = doc && (list || !tags) && orl_labels_from_json(doc, labels, &err) == 0;
    json_decref(doc);
    return good;
}

int orl_job_manifest_from_json(const json_t *json, struct orl_job_manifest *ret_manifest,
                               struct orl_error *err)
{
    struct orl_job_manifest manifest = {0};
    const char *scene = NULL, *identity = NULL, *name = NULL, *tags = NULL;
    const json_t *files = NULL, *needs = NULL;
    int kind = 0, whole_scene = 0;
    json_int_t result_bytes = 0, sensor_bytes = 0, hour_bytes = 0;
    uint64_t *places[NEEDS];
    list_needs(&manifest.needs, places);
    int rc = json_unpack(
        (json_t *)(uintptr_t)json, "{s:i, s:i, s?s, s?s, s:s, s:s, s:I, s:I, s:I, s:b, s:o, s:o}",
        "kind", &kind, "priority", &manifest.priority, "name", &name, "tags", &tags, "scene",
        &scene, "identity", &identity, "result_bytes", &result_bytes, "sensor_bytes", &sensor_bytes,
        "hour_bytes", &hour_bytes, "whole", &whole_scene, "needs", &needs, "files", &files);
    if (rc || kind < 0 || kind >= ORL_JOB_KIND_COUNT || !orl_is_sha256(scene) ||
        (*identity && !orl_is_sha256(identity)) || manifest.priority < 0 ||
        manifest.priority > ORL_PRIORITY_MAX || result_bytes < 0 || sensor_bytes < 0 ||
        hour_bytes < 0 || !orl_counts_from_json(needs, places, NEEDS) ||
        !read_labels(&manifest.labels, name, tags))
        return orl_error_set(err, ORL_ERR_INTERNAL, "the check process sent an invalid reply");
    manifest.kind = (enum orl_job_request_kind)kind;
    snprintf(manifest.scene, sizeof manifest.scene, "%s", scene);
    snprintf(manifest.identity, sizeof manifest.identity, "%s", identity);
    manifest.result_bytes = (uint64_t)result_bytes;
    manifest.sensor_bytes = (uint64_t)sensor_bytes;
    manifest.hour_bytes = (uint64_t)hour_bytes;
    manifest.whole_scene = whole_scene != 0;
    rc = read_files(&manifest, files, err);
    if (rc)
        orl_job_manifest_done(&manifest);
    else
        *ret_manifest = manifest;
    return rc;
}
