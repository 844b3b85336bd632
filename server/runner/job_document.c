#include "runner/job_document.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/sha256.h>

#include "runner/estimate/job_estimate.h"
#include "json/decode.h"
#include "json/encode.h"

int orl_job_document_decode(json_t *document, struct orl_job_request *ret_job_request,
                            char **ret_scene_id, struct orl_error *err)
{
    struct orl_job_request job_request;
    char *scene = NULL;
    int rc = orl_job_request_from_json(document, ORL_JOB_REMOTE, &job_request, &scene, err);
    if (rc)
        return rc;
    rc = orl_job_kinds[job_request.kind].check_limits
             ? orl_job_kinds[job_request.kind].check_limits(&job_request, err)
             : 0;
    if (rc)
        orl_job_request_done(&job_request);
    else
        *ret_job_request = job_request;
    return orl_json_return_text(scene, ret_scene_id, rc);
}

int orl_job_document_read(const char *text, size_t size, struct orl_job_request *ret_job_request,
                          struct orl_error *err)
{
    json_t *document = NULL;
    int rc = orl_json_parse(NULL, text, size, &document, err);
    if (rc)
        return rc;
    rc = orl_job_document_decode(document, ret_job_request, NULL, err);
    json_decref(document);
    return rc;
}

int orl_job_document_set_scene(struct orl_job_request *job_request, const struct orl_bundle *bundle,
                               struct orl_error *err)
{
    const size_t count = orl_bundle_main_count(bundle);
    if (count == 0)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "the job's scene is not stored");
    char **names = calloc(count, sizeof *names);
    size_t n = 0;
    bool all = names != NULL;
    for (size_t i = 0; all && i < bundle->count; i++) {
        if (bundle->files[i].resource)
            continue;
        names[n] = strdup(bundle->files[i].name);
        all = names[n++] != NULL;
    }
    orl_job_request_set_scene(job_request, names, n);
    return all ? 0 : orl_error_no_memory(err);
}

void orl_job_document_identity(const json_t *document, char ret_identity[ORL_SHA_HEX])
{
    const char *kind = json_string_value(json_object_get(document, "kind"));
    json_t *request = json_copy((json_t *)(uintptr_t)document);
    json_object_del(request, "priority");
    if (!kind || strncmp(kind, "bsdf_", 5) != 0)
        json_object_del(request, "name");
    json_object_del(request, "tags");
    char *text = orl_json_text(request, JSON_COMPACT | JSON_SORT_KEYS);
    ret_identity[0] = '\0';
    if (text)
        orl_sha256_hex(text, strlen(text), ret_identity);
    free(text);
    json_decref(request);
}
