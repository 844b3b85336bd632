/*
 * /v1/jobs: submitting a job (POST), and its status (GET), cancelling (POST .../cancel) and removal
 * (DELETE).
 *
 * The states of a job (jobs/jobs.h). A running job is cancelled once its threads have noticed:
 *
 *     POST --> queued --------> running ------> succeeded, failed --+
 *              |    ^           |     |                             |
 *              |    +-----------+     |                             +-- DELETE --> removed
 *              |     daemon ended     | cancel                      |
 *              | cancel               v                             |
 *              +------------------> cancelled ----------------------+
 *
 * The steps of submitting, in the order of time. A step that fails sends the error, and no later
 * step runs. In the right column, `pool` marks steps that block, and `child` those that read
 * untrusted data in a child (checks/checks.h):
 *
 *     orl_handle_job_post      reads the headers: the client's name and the Idempotency-Key
 *     read_document            reads a small document, and computes its digest            pool
 *     check_document           does so for a large document                               child
 *     look_up_references       finds the scene and its files, and estimates the memory
 *     check_inputs             reads the files that the document names, if any            child
 *     check_capacity           claims the document's blob, and checks the storage budget
 *     store_document           moves the document to its blob                             pool
 *     submit_job               queues the job; replies 202 once its row is on disk
 */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <arpa/inet.h>
#include <oriel/base/json_read.h>

#include "checks/check_client.h"
#include "checks/checks.h"
#include "checks/job_manifest.h"
#include "handlers/handlers.h"
#include "handlers/jobs/job_status.h"
#include "http/access/access.h"
#include "http/context.h"
#include "http/request/request.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "runner/estimate/job_estimate.h"
#include "server.h"
#include "store/rows/scenes.h"
#include "uploads/uploads.h"

/*
 * The name of a request's client, as job documents show it. If tokens are not required, clients
 * choose their own names, and the job queue is fair between names. If they are required, the queue
 * is fair between token ids (orl_jobs_fairness_key).
 */
enum { CLIENT_NAME = 80, CLIENT_OWN_NAME = 64 };

enum { REQUEST_KEY_MAX = 255 };

/* A job being submitted. */
struct job_post {
    struct orl_job_manifest manifest;
    struct orl_job_memory memory;
    struct orl_job_inputs inputs;
    struct orl_job_inputs_found found; /* results of reading them */
    struct orl_check check;
    char document[ORL_SHA_HEX], client[CLIENT_NAME];
    char key[REQUEST_KEY_MAX + 1]; /* Idempotency-Key; "": none */
    struct orl_blobs *blobs;       /* holds a claim on the document; NULL: no claim */
    struct orl_blob_claims claims; /* claims on the input files */
    int rc;
    struct orl_error err;
};

static void job_post_free(void *state)
{
    struct job_post *post = state;
    if (post->blobs)
        orl_blobs_release(post->blobs, post->document);
    orl_blobs_release_files(&post->claims);
    orl_job_inputs_done(&post->inputs);
    orl_job_manifest_done(&post->manifest);
    free(post);
}

/* ---- The steps of submitting, defined below in this order ------------------------------------ */

static void read_document(struct orl_request *request);
static void check_document(struct orl_request *request);
static void look_up_checked_document(struct orl_request *request);
static void look_up_references(struct orl_request *request);
static void check_inputs(struct orl_request *request);
static void inputs_checked(struct orl_request *request);
static void check_capacity(struct orl_request *request);
static void store_document(struct orl_request *request);
static void submit_job(struct orl_request *request);

/* ---- Replies --------------------------------------------------------------------------------- */

static void reply_document(struct orl_request *request, unsigned status,
                           const struct orl_jobs_job *job)
{
    const struct orl_server *server = request->server;
    size_t size = 0;
    if (job->row.state < ORL_JOB_SUCCEEDED) {
        orl_reply_json(request, status, orl_job_status(server->jobs, job));
        return;
    }
    const char *text = orl_status_cache_text(server->statuses, server->jobs, job, &size);
    orl_reply_json_text(request, status, text, size);
}

static void reply_job(struct orl_request *request, unsigned status, const struct orl_jobs_job *job)
{
    char location[80];
    snprintf(request->job, sizeof request->job, "%s", job->row.id);
    reply_document(request, status, job);
    orl_reply_header(request, "Cache-Control", "no-store");
    if (status == 202) {
        snprintf(location, sizeof location, "/v1/jobs/%s", job->row.id);
        orl_reply_header(request, "Location", location);
        orl_reply_header(request, "Retry-After", "1");
    }
}

/* Replies 202 after the job's row is on disk. */
static void reply_accepted(struct orl_request *request, const struct orl_jobs_job *job)
{
    reply_job(request, 202, job);
    orl_reply_when_durable(request);
}

static bool refuse_when_full(struct orl_request *request)
{
    if (!orl_jobs_full(request->server->jobs))
        return !orl_client_may_queue(request);
    orl_reply_problem(request, 429, "queue-full", "Too many jobs are waiting",
                      "%u jobs are queued; try again when some have run", ORL_SERVER_QUEUE);
    orl_reply_header(request, "Retry-After", "30");
    return true;
}

/*
 * Replies if a request with this key was answered before. An equal document gets the job that was
 * made then, another one a 422 (draft-ietf-httpapi-idempotency-key-header).
 */
static bool answer_by_key(struct orl_request *request)
{
    struct job_post *post = request->state;
    const struct orl_jobs_job *job = NULL;
    struct orl_error err;
    if (!*post->key)
        return false;
    if (orl_jobs_by_key(request->server->jobs, post->client, orl_access_owner(request), post->key,
                        &job, &err)) {
        orl_reply_error(request, &err);
        return true;
    }
    if (!job)
        return false;
    if (strcmp(job->row.document, post->document) == 0)
        reply_accepted(request, job);
    else
        orl_reply_problem(request, 422, "idempotency-key", "The Idempotency-Key was used before",
                          "it was sent with another document, which became the job %s",
                          job->row.id);
    return true;
}

/* ---- The headers ----------------------------------------------------------------------------- */

static bool is_name(const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i < length; i++)
        if (text[i] < 0x20 || text[i] > 0x7e)
            return false;
    return length >= 1 && length <= CLIENT_OWN_NAME;
}

static void name_by_address(const struct orl_request *request, char ret_name[CLIENT_NAME])
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    char text[INET6_ADDRSTRLEN] = "unknown";
    if (info && info->client_addr && info->client_addr->sa_family == AF_INET6) {
        struct sockaddr_in6 v6;
        memcpy(&v6, info->client_addr, sizeof v6);
        inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
    } else if (info && info->client_addr && info->client_addr->sa_family == AF_INET) {
        struct sockaddr_in v4;
        memcpy(&v4, info->client_addr, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
    }
    snprintf(ret_name, CLIENT_NAME, "address:%s", text);
}

/*
 * Writes the client's name. With tokens it is "token:" and the token's name. Without tokens it is
 * "name:" and the header X-Oriel-Client, or else "address:" and the address. Returns false after a
 * 400: the header must have 1 to 64 printable ASCII characters.
 */
static bool read_client_name(struct orl_request *request, char ret_name[CLIENT_NAME])
{
    const char *own = orl_request_header(request, "X-Oriel-Client");
    if (request->context->config->needs_token) {
        snprintf(ret_name, CLIENT_NAME, "token:%s", request->token);
        return true;
    }
    if (!own) {
        name_by_address(request, ret_name);
        return true;
    }
    if (!is_name(own)) {
        orl_reply_problem(request, 400, "invalid", "A header is not understood",
                          "X-Oriel-Client must be a name of 1 to %d printable characters",
                          CLIENT_OWN_NAME);
        return false;
    }
    snprintf(ret_name, CLIENT_NAME, "name:%s", own);
    return true;
}

/* Reads the key, in quotes (a structured string) or without. Returns false after a 400. */
static bool read_key(struct orl_request *request, const char *key,
                     char ret_key[REQUEST_KEY_MAX + 1])
{
    const size_t length = key ? strlen(key) : 0;
    const bool quoted = length >= 2 && key[0] == '"' && key[length - 1] == '"';
    bool good = !key || (length > (quoted ? 2 : 0) && length - (quoted ? 2 : 0) <= REQUEST_KEY_MAX);
    for (size_t i = 0; i < length && good; i++)
        good = key[i] >= 0x20 && key[i] <= 0x7e;
    if (!good)
        orl_reply_problem(request, 400, "invalid", "A header is not understood",
                          "an Idempotency-Key must have 1 to %d printable characters",
                          REQUEST_KEY_MAX);
    else if (key)
        snprintf(ret_key, REQUEST_KEY_MAX + 1, "%.*s", (int)(length - (quoted ? 2 : 0)),
                 key + quoted);
    return good;
}

void orl_handle_job_post(struct orl_request *request)
{
    const char *key = orl_request_header(request, "Idempotency-Key");
    if (request->server->stop.draining) {
        orl_reply_stopping(request);
        return;
    }
    if (!key && refuse_when_full(request))
        return;
    struct job_post *post = orl_request_new_state(request, sizeof *post, job_post_free);
    if (!post)
        return;
    if (!read_client_name(request, post->client) || !read_key(request, key, post->key))
        return;
    if (request->body.size <= ORL_SERVER_SMALL_JSON)
        orl_request_work(request, read_document, look_up_references);
    else
        orl_check_begin(&request->server->checks, &post->check, request, check_document,
                        look_up_checked_document);
}

/* ---- The document ---------------------------------------------------------------------------- */

/* Reads a small document. */
static void read_document(struct orl_request *request)
{
    struct job_post *post = request->state;
    struct orl_file body;
    post->rc = orl_body_view(&request->body, &request->server->folders, &body, &post->err);
    if (post->rc == 0)
        orl_sha256_hex(body.data, body.size, post->document);
    if (post->rc == 0)
        post->rc = orl_job_manifest_read(&body, &post->manifest, &post->err);
}

/* Reads a large document in a child. */
static void check_document(struct orl_request *request)
{
    struct job_post *post = request->state;
    const struct orl_folders *folders = &request->server->folders;
    const char *path = NULL;
    struct orl_file body;
    post->rc = orl_body_view(&request->body, folders, &body, &post->err);
    if (post->rc == 0)
        post->rc = orl_body_file(&request->body, folders, &path, &post->err);
    if (post->rc)
        return;
    orl_sha256_hex(body.data, body.size, post->document);
    post->rc = orl_check_client_job(&post->check.call, path, &post->manifest, &post->err);
}

static void look_up_checked_document(struct orl_request *request)
{
    struct job_post *post = request->state;
    if (orl_check_finish(&post->check, &post->rc, &post->err))
        look_up_references(request);
}

/* ---- The scene and the memory ---------------------------------------------------------------- */

static uint64_t number_at(const json_t *object, const char *name)
{
    return (uint64_t)json_integer_value(json_object_get(object, name));
}

static uint64_t larger(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

/* Bytes of a row of measurements with its mirror images, while they are fitted. */
enum { MEASURED_ROW = 400 };

/* Adds the scene's quantities to the memory estimate, and checks that the scene suits this kind of
 * job. */
static int estimate_memory(struct orl_server *server, struct job_post *post,
                           const struct orl_bundle *bundle)
{
    struct orl_stored_item scene = {.summary = NULL};
    bool found = false;
    const int rc = orl_scene_find(&server->db, post->manifest.scene, &scene, &found, &post->err);
    if (rc)
        return rc;
    json_t *summary = orl_json_read_stored(scene.summary);
    free(scene.summary);
    if (found && !summary)
        return orl_error_no_memory(&post->err);
    post->memory = post->manifest.needs;
    post->memory.surfaces = larger(number_at(summary, "surfaces"), post->found.surfaces);
    post->memory.triangles = larger(number_at(summary, "triangles"), post->found.triangles);
    post->memory.matrix_bytes = post->found.matrix_bytes;
    post->memory.file_sensors = post->found.sensors;
    post->memory.year_rows = post->found.year_rows;
    const struct orl_upload_contents contents = {
        number_at(summary, "sources"), number_at(json_object_get(summary, "measurements"), "rows")};
    post->memory.bsdf_made_bytes += MEASURED_ROW * contents.measured_rows;
    json_decref(summary);
    for (size_t i = 0; i < bundle->count; i++)
        if (orl_is_xml_name(bundle->files[i].name))
            post->memory.bsdf_bytes += bundle->files[i].bytes;
    return orl_job_kinds[post->manifest.kind].check_contents(&contents, &post->err);
}

/* Refuses a job that can never fit in memory. Called before and after reading its sensors. */
static int check_memory(const struct orl_server *server, struct job_post *post)
{
    const uint64_t most = orl_memory_limit(&server->memory);
    return orl_job_memory_estimate(&post->memory) <= most
               ? 0
               : orl_job_memory_refuse(&post->memory, most, &post->err);
}

/* Checks that everything the document refers to is stored. */
static int check_references(struct orl_server *server, struct job_post *post)
{
    const struct orl_job_manifest *manifest = &post->manifest;
    struct orl_bundle bundle = {0};
    int rc = orl_scene_files(&server->db, &server->folders, manifest->scene, &bundle, &post->err);
    if (rc == 0 && bundle.count == 0) {
        rc = orl_error_set(&post->err, ORL_ERR_NOT_FOUND, "no scene of that id is stored");
        orl_error_at(&post->err, NULL, 0, "scene");
        orl_error_hint(&post->err, "Upload it with POST /v1/scenes first");
    }
    if (rc == 0)
        rc = orl_job_inputs_check(manifest, &bundle, &post->err);
    if (rc == 0)
        rc = estimate_memory(server, post, &bundle);
    if (rc == 0 && post->inputs.files.count == 0)
        rc = orl_job_inputs_collect(manifest, &bundle, &post->inputs, &post->err);
    orl_bundle_done(&bundle);
    return rc ? rc : check_memory(server, post);
}

static void look_up_references(struct orl_request *request)
{
    struct job_post *post = request->state;
    if (*post->document && answer_by_key(request))
        return;
    if (post->rc == 0 && refuse_when_full(request))
        return;
    if (post->rc == 0)
        post->rc = check_references(request->server, post);
    if (post->rc == 0)
        post->rc = orl_blobs_claim_files(request->server->blobs, &post->inputs.files, &post->claims,
                                         &post->err);
    if (post->rc)
        orl_reply_error(request, &post->err);
    else if (post->inputs.files.count > 0)
        orl_check_begin(&request->server->checks, &post->check, request, check_inputs,
                        inputs_checked);
    else
        check_capacity(request);
}

/* ---- The files that the document names ------------------------------------------------------- */

static void check_inputs(struct orl_request *request)
{
    struct job_post *post = request->state;
    const char *document = NULL;
    post->rc = post->inputs.whole_scene
                   ? orl_body_file(&request->body, &request->server->folders, &document, &post->err)
                   : 0;
    if (post->rc == 0)
        post->rc = orl_check_client_inputs(&post->check.call, &post->inputs, document, &post->found,
                                           &post->err);
}

static void inputs_checked(struct orl_request *request)
{
    struct job_post *post = request->state;
    if (!orl_check_finish(&post->check, &post->rc, &post->err))
        return;
    if (post->rc)
        orl_reply_error(request, &post->err);
    else
        check_capacity(request);
}

/* ---- Storage and the queue ------------------------------------------------------------------- */

static void check_capacity(struct orl_request *request)
{
    struct job_post *post = request->state;
    struct orl_server *server = request->server;
    const bool here = orl_blob_exists(&server->folders, post->document);
    post->rc = orl_blobs_claim(server->blobs, post->document, &post->err);
    if (post->rc) {
        orl_reply_error(request, &post->err);
        return;
    }
    post->blobs = server->blobs;
    const uint64_t bytes = post->manifest.result_bytes + (here ? 0 : request->body.size);
    if (!orl_reply_if_full(request, bytes))
        orl_request_work(request, store_document, submit_job);
}

static void store_document(struct orl_request *request)
{
    struct job_post *post = request->state;
    const struct orl_folders *folders = &request->server->folders;
    char path[ORL_PATH_MAX];
    post->rc = orl_body_take_file(&request->body, folders, path, &post->err);
    if (post->rc)
        return;
    post->rc = orl_blob_store(folders, path, post->document, &post->err);
    if (post->rc)
        unlink(path);
}

/* Cancels a job whose id could not be sent (out of memory). The client will retry, and only a key
 * would lead it to this job. */
static void cancel_unacknowledged(struct orl_server *server, const struct orl_jobs_job *job)
{
    struct orl_error err = {0};
    if (orl_jobs_cancel(server->jobs, job->row.id, &err))
        orl_log_event(&server->log, ORL_LOG_WARN, "job-not-withdrawn", "ss", "job", job->row.id,
                      "why", err.message);
}

static void submit_job(struct orl_request *request)
{
    struct job_post *post = request->state;
    const struct orl_jobs_job *job = NULL;
    /* Check the key again, since the request may have come twice at once. */
    if (post->rc == 0 && answer_by_key(request))
        return;
    if (post->rc == 0 && refuse_when_full(request))
        return;
    if (post->rc == 0) /* again, since the scene may have been removed meanwhile */
        post->rc = check_references(request->server, post);
    /* Sensors of files and hours of an annual job have been counted by now. */
    const uint64_t read_bytes = post->manifest.sensor_bytes * post->found.sensors +
                                post->manifest.hour_bytes * orl_job_memory_hours(&post->memory) +
                                ORL_MATRIX_CHANNELS * orl_job_memory_windows(&post->memory);
    const uint64_t result_bytes = post->manifest.result_bytes + read_bytes;
    if (post->rc == 0 && read_bytes > 0 && orl_reply_if_full(request, result_bytes))
        return;
    const struct orl_job_submission submission = {.kind = post->manifest.kind,
                                                  .priority = post->manifest.priority,
                                                  .scene = post->manifest.scene,
                                                  .labels = post->manifest.labels,
                                                  .document = post->document,
                                                  .identity = post->manifest.identity,
                                                  .result_bytes = result_bytes,
                                                  .memory_bytes =
                                                      orl_job_memory_estimate(&post->memory),
                                                  .client = post->client,
                                                  .owner = orl_access_owner(request),
                                                  .request_key = *post->key ? post->key : NULL};
    if (post->rc == 0)
        post->rc = orl_jobs_submit(request->server->jobs, &submission, &job, &post->err);
    if (post->rc) {
        orl_reply_error(request, &post->err);
        return;
    }
    reply_accepted(request, job);
    if (request->status != 202 && !submission.request_key)
        cancel_unacknowledged(request->server, job);
}

/* ---- Status, cancelling, removal ------------------------------------------------------------- */

void orl_handle_job_get(struct orl_request *request)
{
    const struct orl_jobs_job *job = orl_job_of_path(request);
    if (!job)
        return;
    reply_job(request, 200, job);
    orl_job_reply_when_ended(request, job);
}

void orl_handle_job_cancel(struct orl_request *request)
{
    const struct orl_jobs_job *job = orl_job_of_path(request);
    struct orl_error err;
    if (!job || !orl_access_check_owner(request, job->row.owner))
        return;
    if (orl_jobs_cancel(request->server->jobs, job->row.id, &err) == 0) {
        reply_job(request, job->row.state == ORL_JOB_RUNNING ? 202 : 200, job);
        orl_reply_when_durable(request);
    } else if (err.code == ORL_ERR_INVALID)
        orl_reply_problem(request, 409, "finished", "The job is finished", "%s", err.message);
    else
        orl_reply_error(request, &err);
}

void orl_handle_job_delete(struct orl_request *request)
{
    struct orl_server *server = request->server;
    struct orl_error err;
    /* Needs the whole id: a prefix sent again might match another job by then. */
    const struct orl_jobs_job *job = orl_jobs_find(server->jobs, request->params[0]);
    if (!job) {
        orl_reply_not_found(request, "job");
        return;
    }
    if (!orl_access_check_owner(request, job->row.owner))
        return;
    if (orl_jobs_remove(server->jobs, request->params[0], &err) == 0) {
        orl_reply_no_content(request);
        orl_reply_when_durable(request);
    } else if (err.code == ORL_ERR_INVALID)
        orl_reply_in_use(request, err.message);
    else
        orl_reply_error(request, &err);
}
