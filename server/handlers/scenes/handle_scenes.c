#include "handlers/handlers.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "checks/checks.h"
#include "handlers/scenes/upload.h"
#include "http/response/reply.h"
#include "server.h"
#include "uploads/uploads.h"

/* A scene being uploaded, shared by the loop and the pool. */
struct scene_post {
    struct orl_item_upload item;
    struct orl_scene_upload upload;
    struct orl_blobs *blobs;
    size_t claimed; /* number of files claimed, from the first */
};

static void scene_post_free(void *state)
{
    struct scene_post *post = state;
    for (size_t i = 0; i < post->claimed; i++)
        orl_blobs_release(post->blobs, post->upload.bundle.files[i].sha);
    orl_scene_upload_done(&post->upload);
    free(post);
}

/* ---- On the pool ---------------------------------------------------------------------------- */

/* Reads an argument of the query: a main file, or a choice of a project. */
static enum MHD_Result add_main(void *ctx, enum MHD_ValueKind kind, const char *key,
                                const char *value)
{
    struct scene_post *post = ctx;
    (void)kind;
    if (strcmp(key, "main") == 0 && value)
        post->item.rc = orl_scene_upload_add_main(&post->upload, value, &post->item.err);
    else if (strcmp(key, "state") == 0 && value)
        post->item.rc = orl_scene_upload_choose_state(&post->upload, value, &post->item.err);
    else if (strcmp(key, "sky") == 0 && value)
        post->item.rc = orl_scene_upload_choose_sky(&post->upload, value, &post->item.err);
    return post->item.rc ? MHD_NO : MHD_YES;
}

static void split_upload(struct orl_request *request)
{
    struct scene_post *post = request->state;
    const struct orl_folders held = orl_request_folders(request), *folders = &held;
    const char *type = orl_request_header(request, MHD_HTTP_HEADER_CONTENT_TYPE);
    struct orl_check_call *call = &post->item.check.call;
    struct orl_file body;
    const char *path = NULL;
    orl_scene_upload_done(&post->upload); /* left by an earlier attempt */
    const bool parts = type && strncasecmp(type, "multipart/", 10) == 0;
    post->item.rc = parts ? orl_body_view(&request->body, folders, &body, &post->item.err)
                          : orl_body_file(&request->body, folders, &path, &post->item.err);
    if (post->item.rc == 0)
        MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, add_main, post);
    if (post->item.rc)
        return;
    if (parts)
        post->item.rc = orl_scene_upload_multipart(&post->upload, request->connection, &body,
                                                   folders, call, &post->item.err);
    else if (orl_is_zip_type(type))
        post->item.rc = orl_scene_upload_zip(&post->upload, path, folders, call, &post->item.err);
    else
        post->item.rc = orl_scene_upload_json(&post->upload, path, folders, call, &post->item.err);
}

static void check_and_store(struct orl_request *request)
{
    struct scene_post *post = request->state;
    post->item.rc = orl_scene_upload_check(&post->upload, &post->item.check.call, &post->item.err);
    if (post->item.rc == 0)
        post->item.rc =
            orl_scene_upload_store(&post->upload, &request->server->folders, &post->item.err);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

static void insert_and_reply(struct orl_request *request)
{
    struct scene_post *post = request->state;
    bool created = false;
    if (!orl_check_finish(&post->item.check, &post->item.rc, &post->item.err))
        return;
    if (post->item.rc == 0)
        post->item.rc =
            orl_scene_insert(&request->server->db, post->upload.id, &post->upload.bundle,
                             post->upload.summary, &created, &post->item.err);
    orl_item_reply_created(request, created);
}

/* Claims all files, so that none is removed from now on. A BSDF that was uploaded earlier may have
 * been removed before. */
static int claim_files(const struct orl_folders *folders, struct scene_post *post)
{
    const struct orl_bundle *bundle = &post->upload.bundle;
    for (size_t i = 0; i < bundle->count; i++) {
        const struct orl_bundle_file *file = &bundle->files[i];
        const int rc = orl_blobs_claim(post->blobs, file->sha, &post->item.err);
        if (rc)
            return rc;
        post->claimed++;
        if (!file->temporary && !orl_blob_exists(folders, file->sha)) {
            orl_error_set(&post->item.err, ORL_ERR_NOT_FOUND, "no BSDF of that id is stored");
            orl_error_hint(&post->item.err, "Upload it with POST /v1/bsdfs first");
            orl_error_at(&post->item.err, NULL, 0, file->name);
            return ORL_ERR_NOT_FOUND;
        }
    }
    return 0;
}

/* Returns the bytes of the files that are not stored yet. */
static uint64_t count_new_bytes(const struct orl_folders *folders, const struct orl_bundle *bundle)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < bundle->count; i++)
        bytes += orl_blob_exists(folders, bundle->files[i].sha) ? 0 : bundle->files[i].bytes;
    return bytes;
}

/* Starts the check of files that are claimed. */
static void begin_check(struct orl_request *request)
{
    struct scene_post *post = request->state;
    const struct orl_folders *folders = &request->server->folders;
    if (!orl_reply_if_full(request, count_new_bytes(folders, &post->upload.bundle)))
        orl_check_begin(&request->server->checks, &post->item.check, request, check_and_store,
                        insert_and_reply);
}

/* Stores the files of a known scene again, which only repairs damage in the store. */
static void store_files_again(struct orl_request *request)
{
    struct scene_post *post = request->state;
    post->item.rc =
        orl_scene_upload_store(&post->upload, &request->server->folders, &post->item.err);
}

static void reply_known(struct orl_request *request)
{
    orl_item_reply_known(request, begin_check);
}

/* Looks the scene up. A scene that is stored already is not checked again. */
static void look_up_scene(struct orl_request *request)
{
    struct scene_post *post = request->state;
    if (!orl_check_finish(&post->item.check, &post->item.rc, &post->item.err))
        return;
    const bool found = orl_item_is_stored(request);
    post->blobs = request->server->blobs;
    if (post->item.rc == 0)
        post->item.rc = claim_files(&request->server->folders, post);
    if (post->item.rc)
        orl_reply_error(request, &post->item.err);
    else if (found)
        orl_request_work(request, store_files_again, reply_known);
    else
        begin_check(request);
}

void orl_handle_scene_post(struct orl_request *request)
{
    struct scene_post *post = orl_request_new_state(request, sizeof *post, scene_post_free);
    if (!post)
        return;
    post->item.kind = &orl_item_scene;
    post->item.id = post->upload.id;
    orl_check_begin(&request->server->checks, &post->item.check, request, split_upload,
                    look_up_scene);
}

void orl_handle_scene_get(struct orl_request *request)
{
    orl_reply_stored_item(request, &orl_item_scene, request->params[0], 200, NULL);
}

void orl_handle_scene_delete(struct orl_request *request)
{
    struct orl_server *server = request->server;
    const char *id = request->params[0];
    char(*blobs)[ORL_SHA_HEX] = NULL;
    size_t count = 0;
    bool removed = false;
    struct orl_error err;
    if (orl_jobs_need_scene(server->jobs, id)) {
        orl_reply_in_use(request, "queued or running jobs need the scene");
        return;
    }
    if (orl_scene_drop(&server->db, id, &blobs, &count, &removed, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    for (size_t i = 0; i < count; i++)
        orl_blobs_remove_unused(server->blobs, blobs[i]);
    free(blobs);
    orl_reply_removed(request, removed, "scene");
    orl_reply_when_durable(request);
}
