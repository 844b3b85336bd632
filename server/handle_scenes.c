#include "handlers.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "reply.h"
#include "scene_upload.h"
#include "server.h"
#include "stored_item.h"
#include "unzip.h"

/* A request's scene, between the loop and the pool. */
struct scene_post {
    struct orl_scene_upload upload;
    int rc;
    struct orl_error err;
};

static void scene_post_free(void *state)
{
    struct scene_post *post = state;
    orl_scene_upload_done(&post->upload);
    free(post);
}

/* ---- On the pool ---------------------------------------------------------------------------- */

/* Every argument "main" of the query. */
static enum MHD_Result add_main(void *ctx, enum MHD_ValueKind kind, const char *key,
                                const char *value)
{
    struct scene_post *post = ctx;
    (void)kind;
    if (strcmp(key, "main") == 0 && value)
        post->rc = orl_scene_upload_add_main(&post->upload, value, &post->err);
    return post->rc ? MHD_NO : MHD_YES;
}

static void take_apart(struct orl_request *request)
{
    struct scene_post *post = request->state;
    const struct orl_folders *folders = &request->server->folders;
    struct orl_file body;
    post->rc = orl_body_view(&request->body, folders, &body, &post->err);
    if (post->rc == 0)
        MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, add_main, post);
    if (post->rc)
        return;
    const char *type = orl_request_header(request, MHD_HTTP_HEADER_CONTENT_TYPE);
    if (type && strncasecmp(type, "multipart/", 10) == 0)
        post->rc = orl_scene_upload_multipart(&post->upload, request->connection, &body, folders,
                                              &post->err);
    else if (orl_is_zip_type(type))
        post->rc = orl_scene_upload_zip(&post->upload, &body, folders, &post->err);
    else
        post->rc = orl_scene_upload_json(&post->upload, &body, folders, &post->err);
}

static void check_and_keep(struct orl_request *request)
{
    struct scene_post *post = request->state;
    post->rc = orl_scene_upload_check(&post->upload, &post->err);
    if (post->rc == 0)
        post->rc = orl_scene_upload_keep(&post->upload, &request->server->folders, &post->err);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

static void insert_and_reply(struct orl_request *request)
{
    struct scene_post *post = request->state;
    bool created = false;
    if (post->rc == 0)
        post->rc = orl_scene_insert(&request->server->db, post->upload.id, &post->upload.bundle,
                                    post->upload.summary, &created, &post->err);
    if (post->rc)
        orl_reply_error(request, &post->err);
    else
        orl_reply_stored_item(request, &orl_item_scene, post->upload.id, created ? 201 : 200,
                              &created);
}

/* A scene that is here already is not checked again. */
static void look_up(struct orl_request *request)
{
    struct scene_post *post = request->state;
    struct orl_stored_item item;
    bool found = false, created = false;
    if (post->rc == 0)
        post->rc = orl_scene_find(&request->server->db, post->upload.id, &item, &found, &post->err);
    if (post->rc) {
        orl_reply_error(request, &post->err);
    } else if (found) {
        free(item.summary);
        orl_reply_stored_item(request, &orl_item_scene, post->upload.id, 200, &created);
    } else {
        orl_request_work(request, check_and_keep, insert_and_reply);
    }
}

void orl_handle_scene_post(struct orl_request *request)
{
    struct scene_post *post = calloc(1, sizeof *post);
    if (!post) {
        orl_reply_json(request, 500, NULL);
        return;
    }
    request->state = post;
    request->free_state = scene_post_free;
    orl_request_work(request, take_apart, look_up);
}

void orl_handle_scene_get(struct orl_request *request)
{
    orl_reply_stored_item(request, &orl_item_scene, request->params[0], 200, NULL);
}
