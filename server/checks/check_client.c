#include "checks/check_client.h"

#include <stdlib.h>

#include "checks/child/messages.h"
#include "process/limits.h"
#include "uploads/uploads.h"
#include "json/encode.h"

/* ---- One request ---------------------------------------------------------------------------- */

/* Sends the request to a child. Takes ownership of the request. */
static int run_request(struct orl_check_call *call, json_t *request, json_t **ret_result,
                       struct orl_error *err)
{
    json_t *bounds = json_pack("{s:I, s:I}", "memory", (json_int_t)call->memory, "cpu_s",
                               (json_int_t)call->cpu_s);
    int rc = request && bounds && json_object_update(request, bounds) == 0
                 ? 0
                 : orl_error_no_memory(err);
    if (rc == 0)
        rc = orl_check_pool_run(call, request, ret_result, err);
    json_decref(bounds);
    json_decref(request);
    return rc;
}

/* Returns the result as text. digits: significant digits of its numbers; 0: all. */
static int request_text(struct orl_check_call *call, json_t *request, int digits, char **ret_text,
                        struct orl_error *err)
{
    json_t *result = NULL;
    const int rc = run_request(call, request, &result, err);
    if (rc)
        return rc;
    *ret_text = orl_json_text(result, JSON_COMPACT | JSON_REAL_PRECISION((size_t)digits));
    json_decref(result);
    return *ret_text ? 0 : orl_error_no_memory(err);
}

int orl_check_client_scene(struct orl_check_call *call, const struct orl_bundle *bundle,
                           const json_t *choice, char **ret_summary, struct orl_error *err)
{
    return request_text(call,
                        json_pack("{s:s, s:o, s:O*}", "kind", "scene", "files",
                                  orl_mapped_inputs_to_json(bundle), "choice", choice),
                        0, ret_summary, err);
}

int orl_check_client_bsdf(struct orl_check_call *call, const char *path, const char *name,
                          char **ret_summary, struct orl_error *err)
{
    return request_text(call,
                        json_pack("{s:s, s:s, s:s}", "kind", "bsdf", "path", path, "name", name), 0,
                        ret_summary, err);
}

int orl_check_client_outline(struct orl_check_call *call, const struct orl_bundle *scene,
                             double height, char **ret_outline, struct orl_error *err)
{
    return request_text(call,
                        json_pack("{s:s, s:o, s:o}", "kind", "outline", "height",
                                  orl_json_from_real(height), "files",
                                  orl_mapped_inputs_to_json(scene)),
                        7, ret_outline, err);
}

int orl_check_client_polar(struct orl_check_call *call, const char *path,
                           const struct orl_incidence *from, char **ret_polar,
                           struct orl_error *err)
{
    return request_text(call,
                        json_pack("{s:s, s:s, s:b, s:f, s:f}", "kind", "polar", "path", path,
                                  "front", from->front, "theta_deg", from->theta_deg, "phi_deg",
                                  from->phi_deg),
                        5, ret_polar, err);
}

int orl_check_client_plan(struct orl_check_call *call, const struct orl_bundle *scene,
                          const char *path, char **ret_plans, struct orl_error *err)
{
    return request_text(call,
                        json_pack("{s:s, s:s, s:o}", "kind", "plan", "path", path, "files",
                                  orl_mapped_inputs_to_json(scene)),
                        0, ret_plans, err);
}

int orl_check_client_job(struct orl_check_call *call, const char *path,
                         struct orl_job_manifest *ret_manifest, struct orl_error *err)
{
    json_t *result = NULL;
    int rc = run_request(call, json_pack("{s:s, s:s}", "kind", "job", "path", path), &result, err);
    if (rc == 0)
        rc = orl_job_manifest_from_json(result, ret_manifest, err);
    json_decref(result);
    return rc;
}

int orl_check_client_inputs(struct orl_check_call *call, const struct orl_job_inputs *inputs,
                            const char *document, struct orl_job_inputs_found *ret_found,
                            struct orl_error *err)
{
    json_t *result = NULL;
    struct orl_job_inputs_found found = {0};
    uint64_t *places[ORL_JOB_INPUTS_COUNTS];
    orl_job_inputs_counts(&found, places);
    int rc = run_request(call,
                         json_pack("{s:s, s:o, s:O*, s:s*}", "kind", "inputs", "files",
                                   orl_mapped_inputs_to_json(&inputs->files), "uses", inputs->uses,
                                   "path", document),
                         &result, err);
    if (rc == 0 && !orl_counts_from_json(result, places, ORL_JOB_INPUTS_COUNTS))
        rc = orl_error_set(err, ORL_ERR_INTERNAL, "the check process sent an invalid reply");
    if (rc == 0)
        *ret_found = found;
    json_decref(result);
    return rc;
}

/* ---- Files that a child unpacks -------------------------------------------------------------- */

struct file_receiver {
    const struct orl_folders *folders;
    struct orl_bundle files; /* received so far; all are resources */
    struct orl_incoming incoming;
    uint64_t bytes; /* includes the upload's other files */
};

static int receive_file(void *ctx, const char *name, struct orl_error *err)
{
    struct file_receiver *t = ctx;
    orl_incoming_end(&t->incoming);
    return orl_incoming_begin(&t->incoming, t->folders, name, true, err);
}

static int receive_data(void *ctx, const char *data, size_t size, struct orl_error *err)
{
    struct file_receiver *t = ctx;
    t->bytes += size;
    if (t->incoming.fd < 0)
        return orl_error_set(err, ORL_ERR_INTERNAL, "the check process sent an invalid reply");
    if (t->bytes > ORL_SERVER_SCENE_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT,
                             "the unpacked upload is larger than a scene may be");
    return orl_incoming_append(&t->incoming, data, size, err);
}

/* Receives the files that the child unpacks. Takes ownership of the request. The caller owns
 * *ret_files, even after an error. */
static int request_files(struct orl_check_call *call, json_t *request,
                         const struct orl_folders *folders, uint64_t before,
                         struct orl_bundle *ret_files, json_t **ret_result, struct orl_error *err)
{
    struct file_receiver t = {.folders = folders, .bytes = before};
    orl_incoming_init(&t.incoming, &t.files);
    call->file = receive_file;
    call->data = receive_data;
    call->ctx = &t;
    const int rc = run_request(call, request, ret_result, err);
    call->file = NULL;
    call->data = NULL;
    orl_incoming_end(&t.incoming);
    *ret_files = t.files;
    return rc;
}

/* ---- Zips ------------------------------------------------------------------------------------ */

/* The request that guesses the roles of a zip's files. */
struct role_request {
    struct orl_check_call *call;
    const json_t *choice; /* NULL: roles are not guessed */
};

static int request_roles(void *ctx, struct orl_bundle *files, unsigned *ret_places,
                         struct orl_error *err)
{
    const struct role_request *role_request = ctx;
    json_t *result = NULL;
    int rc =
        run_request(role_request->call,
                    json_pack("{s:s, s:o, s:O}", "kind", "roles", "files",
                              orl_mapped_inputs_to_json(files), "choice", role_request->choice),
                    &result, err);
    if (rc == 0 && json_array_size(result) != files->count)
        rc = orl_error_set(err, ORL_ERR_INTERNAL, "the check process sent an invalid reply");
    for (size_t i = 0; i < files->count && rc == 0; i++)
        ret_places[i] = (unsigned)json_integer_value(json_array_get(result, i));
    json_decref(result);
    return rc;
}

int orl_check_client_unzip(struct orl_check_call *call, const char *path,
                           const struct orl_folders *folders, const json_t *choice,
                           struct orl_bundle *bundle, struct orl_error *err)
{
    struct role_request role_request = {call, choice};
    struct orl_bundle files = {0};
    json_t *result = NULL;
    int rc = request_files(call, json_pack("{s:s, s:s}", "kind", "unzip", "path", path), folders,
                           orl_bundle_bytes(bundle), &files, &result, err);
    json_decref(result);
    if (rc == 0)
        rc = orl_unzip_finish(&files, choice ? request_roles : NULL, &role_request, bundle, err);
    orl_bundle_done(&files);
    return rc;
}

/* ---- Scene documents ------------------------------------------------------------------------- */

int orl_check_client_document(struct orl_check_call *call, const char *path,
                              const struct orl_folders *folders, const json_t *choice,
                              struct orl_bundle *bundle, json_t **ret_bsdfs, struct orl_error *err)
{
    struct role_request role_request = {call, choice};
    struct orl_bundle files = {0};
    json_t *rest = NULL;
    int rc = request_files(call, json_pack("{s:s, s:s}", "kind", "files", "path", path), folders,
                           orl_bundle_bytes(bundle), &files, &rest, err);
    const json_t *resources = json_object_get(rest, "resources");
    if (rc == 0 && json_is_true(json_object_get(rest, "model"))) {
        rc = orl_unzip_finish(&files, choice ? request_roles : NULL, &role_request, bundle, err);
        json_decref(rest);
        orl_bundle_done(&files);
        return rc;
    }
    if (rc == 0 && json_array_size(resources) != files.count)
        rc = orl_error_set(err, ORL_ERR_INTERNAL, "the check process sent an invalid reply");
    for (size_t i = 0; i < files.count && rc == 0; i++)
        files.files[i].resource = json_is_true(json_array_get(resources, i));
    if (rc == 0)
        rc = orl_bundle_move(&files, bundle, err);
    if (rc == 0)
        *ret_bsdfs = json_incref(json_object_get(rest, "bsdfs"));
    json_decref(rest);
    orl_bundle_done(&files);
    return rc;
}
