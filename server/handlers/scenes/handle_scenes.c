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
    struct orl_scene_upload upload;
    struct orl_blobs *blobs;
    struct orl_check check;
    size_t claimed; /* number of files claimed, from the first */
    int rc;
    struct orl_error err;
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
        post->rc = orl_scene_upload_add_main(&post->upload, value, &post->err);
    else if (strcmp(key, "state") == 0 && value)
        post->rc = orl_scene_upload_choose_state(&post->upload, value, &post->err);
    else if (strcmp(key, "sky") == 0 && value)
        post->rc = orl_scene_upload_choose_sky(&post->upload, value, &post->err);
    return post->rc ? MHD_NO : MHD_YES;
}

static void split_upload(struct orl_request *request)
{
    struct scene_post *post = request->state;
    const struct orl_folders held = orl_request_folders(request), *folders = &held;
    const char *type = orl_request_header(request, MHD_HTTP_HEADER_CONTENT_TYPE);
    struct orl_check_call *call = &post->check.call;
    struct orl_file body;
    const char *path = NULL;
    orl_scene_upload_done(&post->upload); /* left by an earlier attempt */
    const bool parts = type && strncasecmp(type, "multipart/", 10) == 0;
    post->rc = parts ? orl_body_view(&request->body, folders, &body, &post->err)
                     : orl_body_file(&request->body, folders, &path, &post->err);
    if (post->rc == 0)
        MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, add_main, post);
    if (post->rc)
        return;
    if (parts)
        post->rc = orl_scene_upload_multipart(&post->upload, request->connection, &body, folders,
                                              call, &post->err);
    else if (orl_is_zip_type(type))
        post->rc = orl_scene_upload_zip(&post->upload, path, folders, call, &post->err);
    else
        post->rc = orl_scene_upload_json(&post->upload, path, folders, call, &post->err);
}

static void check_and_store(struct orl_request *request)
{
    struct scene_post *post = request->state;
    post->rc = orl_scene_upload_check(&post->upload, &post->check.call, &post->err);
    if (post->rc == 0)
        post->rc = orl_scene_upload_store(&post->upload, &request->server->folders, &post->err);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

static void insert_and_reply(struct orl_request *request)
{
    struct scene_post *post = request->state;
    bool created = false;
    if (!orl_check_finish(&post->check, &post->rc, &post->err))
        return;
    if (post->rc == 0)
        post->rc = orl_scene_insert(&request->server->db, post->upload.id, &post->upload.bundle,
                                    post->upload.summary, &created, &post->err);
    if (post->rc) {
        orl_reply_error(request, &post->err);
        return;
    }
    orl_reply_stored_item(request, &orl_item_scene, post->upload.id, created ? 201 : 200, &created);
    orl_reply_when_durable(request);
}

/* Claims all files, so that none is removed from now on. A BSDF that was uploaded earlier may have
 * been removed before. */
static int claim_files(const struct orl_folders *folders, struct scene_post *post)
{
    const struct orl_bundle *bundle = &post->upload.bundle;
    for (size_t i = 0; i < bundle->count; i++) {
        const struct orl_bundle_file *file = &bundle->files[i];
        const int rc = orl_blobs_claim(post->blobs, file->sha, &post->err);
        if (rc)
            return rc;
        post->claimed++;
        if (!file->temporary && !orl_blob_exists(folders, file->sha)) {
            orl_error_set(&post->err, ORL_ERR_NOT_FOUND, "no BSDF of that id is stored");
            orl_error_hint(&post->err, "Upload it with POST /v1/bsdfs first");
            orl_error_at(&post->err, NULL, 0, file->name);
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
        orl_check_begin(&request->server->checks, &post->check, request, check_and_store,
                        insert_and_reply);
}

/* Looks the scene up. *ret_found is true if it is stored. */
static void find_stored_scene(struct orl_request *request, bool *ret_found)
{
    struct scene_post *post = request->state;
    struct orl_stored_item item;
    *ret_found = false;
    post->rc = orl_scene_find(&request->server->db, post->upload.id, &item, ret_found, &post->err);
    if (post->rc == 0 && *ret_found)
        free(item.summary);
}

/* Stores the files of a known scene again, which only repairs damage in the store. */
static void store_files_again(struct orl_request *request)
{
    struct scene_post *post = request->state;
    post->rc = orl_scene_upload_store(&post->upload, &request->server->folders, &post->err);
}

/* Replies for a known scene. If it was removed meanwhile, it is checked as a new one. */
static void reply_known(struct orl_request *request)
{
    struct scene_post *post = request->state;
    bool created = false, found = false;
    if (post->rc == 0)
        find_stored_scene(request, &found);
    if (post->rc) {
        orl_reply_error(request, &post->err);
    } else if (!found) {
        begin_check(request);
    } else {
        orl_reply_stored_item(request, &orl_item_scene, post->upload.id, 200, &created);
        orl_reply_when_durable(request); /* a concurrent upload may have written the row just now */
    }
}

/* Looks the scene up. A scene that is stored already is not checked again. */
static void look_up_scene(struct orl_request *request)
{
    struct scene_post *post = request->state;
    bool found = false;
    if (!orl_check_finish(&post->check, &post->rc, &post->err))
        return;
    if (post->rc == 0)
        find_stored_scene(request, &found);
    post->blobs = request->server->blobs;
    if (post->rc == 0)
        post->rc = claim_files(&request->server->folders, post);
    if (post->rc)
        orl_reply_error(request, &post->err);
    else if (found)
        orl_request_work(request, store_files_again, reply_known);
    else
        begin_check(request);
}

void orl_handle_scene_post(struct orl_request *request)
{
    struct scene_post *post = calloc(1, sizeof *post);
    if (!post) {
        orl_reply_json(request, 503, NULL);
        return;
    }
    request->state = post;
    request->free_state = scene_post_free;
    orl_check_begin(&request->server->checks, &post->check, request, split_upload, look_up_scene);
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
