/*
 * POST /v1/plans: the plan of a render job, with reasons, without rendering it. A child makes it
 * (checks/child/child_scene.c), like checks of uploads; nothing is stored.
 */
#include "handlers/handlers.h"

#include <stdlib.h>
#include <string.h>

#include "checks/check_client.h"
#include "checks/checks.h"
#include "checks/job_manifest.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "runner/estimate/job_estimate.h"
#include "runner/runner.h"
#include "server.h"
#include "store/rows/scenes.h"
#include "json/encode.h"

struct plan_post {
    struct orl_job_manifest manifest;
    struct orl_bundle scene;
    struct orl_blob_claims claims; /* claims on the scene's files */
    struct orl_check check;
    char *text; /* the answer */
    int rc;
    struct orl_error err;
};

static void plan_post_free(void *state)
{
    struct plan_post *post = state;
    orl_job_manifest_done(&post->manifest);
    orl_bundle_done(&post->scene);
    orl_blobs_release_files(&post->claims);
    free(post->text);
    free(post);
}

/* ---- On the pool ---------------------------------------------------------------------------- */

static void read_document(struct orl_request *request)
{
    struct plan_post *post = request->state;
    struct orl_file body;
    post->rc = orl_body_view(&request->body, &request->server->folders, &body, &post->err);
    if (post->rc == 0)
        post->rc = orl_job_manifest_read(&body, &post->manifest, &post->err);
}

/* Reads a large document in a child. */
static void check_document(struct orl_request *request)
{
    struct plan_post *post = request->state;
    const char *path = NULL;
    orl_job_manifest_done(&post->manifest); /* left by an earlier attempt */
    post->rc = orl_body_file(&request->body, &request->server->folders, &path, &post->err);
    if (post->rc == 0)
        post->rc = orl_check_client_job(&post->check.call, path, &post->manifest, &post->err);
}

/* Replaces the work that the child estimated by the place where such a job would run. */
static int add_runner(const struct orl_server *server, struct plan_post *post)
{
    json_t *doc = json_loads(post->text, 0, NULL);
    const json_t *work_pair = json_object_get(doc, "work");
    const json_int_t work_class = json_integer_value(json_array_get(work_pair, 0));
    const struct orl_job_work work = {work_class >= 0 && work_class < ORL_WORK_CLASS_COUNT
                                          ? (enum orl_job_work_class)work_class
                                          : ORL_WORK_INDIVISIBLE,
                                      json_number_value(json_array_get(work_pair, 1))};
    char why[ORL_WHY_MAX];
    int rc = json_object_del(doc, "work");
    if (server->config.runner.slurm) {
        const bool in_parts = orl_job_is_split(&work, server->slurm.least_s, why);
        rc |= json_object_set_new(doc, "runner", orl_runner_to_json(in_parts, why, NULL));
    }
    free(post->text);
    post->text = rc ? NULL : orl_json_text(doc, JSON_COMPACT);
    json_decref(doc);
    return post->text ? 0 : orl_error_set(&post->err, ORL_ERR_NOMEM, "out of memory for a plan");
}

static void make_plan(struct orl_request *request)
{
    struct plan_post *post = request->state;
    const char *path = NULL;
    free(post->text);
    post->text = NULL;
    post->rc = orl_body_file(&request->body, &request->server->folders, &path, &post->err);
    if (post->rc == 0)
        post->rc =
            orl_check_client_plan(&post->check.call, &post->scene, path, &post->text, &post->err);
    if (post->rc == 0)
        post->rc = add_runner(request->server, post);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

/* Checks that the scene is stored, with the files that the document names. */
static int find_scene(struct orl_request *request, struct plan_post *post)
{
    struct orl_server *server = request->server;
    int rc = orl_scene_files(&server->db, &server->folders, post->manifest.scene, &post->scene,
                             &post->err);
    if (rc == 0 && post->scene.count == 0) {
        rc = orl_error_set(&post->err, ORL_ERR_NOT_FOUND, "no scene of that id is stored");
        orl_error_at(&post->err, NULL, 0, "scene");
        orl_error_hint(&post->err, "Upload it with POST /v1/scenes first");
    }
    if (rc == 0)
        rc = orl_job_inputs_check(&post->manifest, &post->scene, &post->err);
    return rc ? rc : orl_blobs_claim_files(server->blobs, &post->scene, &post->claims, &post->err);
}

static void plan_made(struct orl_request *request)
{
    struct plan_post *post = request->state;
    if (!orl_check_finish(&post->check, &post->rc, &post->err))
        return;
    if (post->rc) {
        orl_reply_error(request, &post->err);
        return;
    }
    orl_reply_json_text(request, 200, post->text, strlen(post->text));
    orl_reply_header(request, "Cache-Control", "no-store");
}

static void start_plan(struct orl_request *request)
{
    struct plan_post *post = request->state;
    if (post->rc == 0)
        post->rc = find_scene(request, post);
    if (post->rc)
        orl_reply_error(request, &post->err);
    else
        orl_check_begin(&request->server->checks, &post->check, request, make_plan, plan_made);
}

static void start_plan_after_check(struct orl_request *request)
{
    struct plan_post *post = request->state;
    if (orl_check_finish(&post->check, &post->rc, &post->err))
        start_plan(request);
}

void orl_handle_plan_post(struct orl_request *request)
{
    struct plan_post *post = orl_request_new_state(request, sizeof *post, plan_post_free);
    if (!post)
        return;
    if (request->body.size <= ORL_SERVER_SMALL_JSON)
        orl_request_work(request, read_document, start_plan);
    else
        orl_check_begin(&request->server->checks, &post->check, request, check_document,
                        start_plan_after_check);
}
