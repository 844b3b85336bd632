#include "handlers/handlers.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "checks/check_client.h"
#include "checks/checks.h"
#include "handlers/scenes/upload.h"
#include "http/response/reply.h"
#include "server.h"
#include "store/rows/scenes.h"

/* A BSDF being uploaded. */
struct upload {
    char name[256]; /* for messages; the sender's name for it */
    char id[ORL_SHA_HEX];
    uint64_t bytes;
    char *summary;           /* JSON text */
    struct orl_blobs *blobs; /* holds a claim on the file; NULL: no claim */
    struct orl_check check;
    bool stored; /* its file is stored as a blob already */
    int rc;
    struct orl_error err;
};

static void upload_free(void *state)
{
    struct upload *upload = state;
    if (upload->blobs)
        orl_blobs_release(upload->blobs, upload->id);
    free(upload->summary);
    free(upload);
}

/* ---- On the pool ---------------------------------------------------------------------------- */

static void hash_upload(struct orl_request *request)
{
    struct upload *upload = request->state;
    struct orl_file file;
    upload->rc = orl_body_view(&request->body, &request->server->folders, &file, &upload->err);
    if (upload->rc == 0)
        orl_sha256_hex(file.data, file.size, upload->id);
    upload->bytes = upload->rc == 0 ? file.size : 0;
}

/* Stores the file. For a known BSDF this only repairs damage in the store. */
static void store_file(struct orl_request *request)
{
    struct upload *upload = request->state;
    const struct orl_folders *folders = &request->server->folders;
    char path[ORL_PATH_MAX];
    if (upload->stored)
        return;
    upload->rc = orl_body_take_file(&request->body, folders, path, &upload->err);
    if (upload->rc)
        return;
    upload->rc = orl_blob_store(folders, path, upload->id, &upload->err);
    if (upload->rc)
        unlink(path);
    else
        upload->stored = true;
}

static void check_and_store(struct orl_request *request)
{
    struct upload *upload = request->state;
    const struct orl_folders *folders = &request->server->folders;
    char blob[ORL_PATH_MAX];
    const char *file = blob;
    upload->rc = 0; /* left by an earlier attempt */
    if (upload->stored)
        orl_blob_path(folders, upload->id, blob);
    else
        upload->rc = orl_body_file(&request->body, folders, &file, &upload->err);
    if (upload->rc == 0)
        upload->rc = orl_check_client_bsdf(&upload->check.call, file, upload->name,
                                           &upload->summary, &upload->err);
    if (upload->rc == 0)
        store_file(request);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

static void insert_and_reply(struct orl_request *request)
{
    struct upload *upload = request->state;
    bool created = false;
    if (!orl_check_finish(&upload->check, &upload->rc, &upload->err))
        return;
    if (upload->rc == 0)
        upload->rc = orl_bsdf_insert(&request->server->db, upload->id, upload->name, upload->bytes,
                                     upload->summary, &created, &upload->err);
    if (upload->rc) {
        orl_reply_error(request, &upload->err);
        return;
    }
    orl_reply_stored_item(request, &orl_item_bsdf, upload->id, created ? 201 : 200, &created);
    orl_reply_when_durable(request);
}

/* Starts the check of a file that is claimed. */
static void begin_check(struct orl_request *request)
{
    struct upload *upload = request->state;
    const bool here = orl_blob_exists(&request->server->folders, upload->id);
    if (!orl_reply_if_full(request, here ? 0 : upload->bytes))
        orl_check_begin(&request->server->checks, &upload->check, request, check_and_store,
                        insert_and_reply);
}

/* Looks the BSDF up. *ret_found is true if it is stored. */
static void find_stored_bsdf(struct orl_request *request, bool *ret_found)
{
    struct upload *upload = request->state;
    struct orl_stored_item item;
    *ret_found = false;
    upload->rc = orl_bsdf_find(&request->server->db, upload->id, &item, ret_found, &upload->err);
    if (upload->rc == 0 && *ret_found)
        free(item.summary);
}

/* Replies for a known BSDF. If it was removed meanwhile, it is checked as a new one. */
static void reply_known(struct orl_request *request)
{
    struct upload *upload = request->state;
    bool created = false, found = false;
    if (upload->rc == 0)
        find_stored_bsdf(request, &found);
    if (upload->rc) {
        orl_reply_error(request, &upload->err);
    } else if (!found) {
        begin_check(request);
    } else {
        orl_reply_stored_item(request, &orl_item_bsdf, upload->id, 200, &created);
        orl_reply_when_durable(request); /* a concurrent upload may have written the row just now */
    }
}

static void look_up_bsdf(struct orl_request *request)
{
    struct upload *upload = request->state;
    bool found = false;
    if (upload->rc == 0)
        find_stored_bsdf(request, &found);
    if (upload->rc == 0)
        upload->rc = orl_blobs_claim(request->server->blobs, upload->id, &upload->err);
    if (upload->rc) {
        orl_reply_error(request, &upload->err);
        return;
    }
    upload->blobs = request->server->blobs;
    if (found)
        orl_request_work(request, store_file, reply_known);
    else
        begin_check(request);
}

void orl_handle_bsdf_post(struct orl_request *request)
{
    const char *name = orl_request_query(request, "name");
    struct upload *upload = calloc(1, sizeof *upload);
    struct orl_error err;
    request->state = upload;
    request->free_state = upload_free;
    if (!upload) {
        orl_error_set(&err, ORL_ERR_NOMEM, "out of memory");
        orl_reply_error(request, &err);
        return;
    }
    if (name && orl_bundle_check_name(name, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    snprintf(upload->name, sizeof upload->name, "%s", name ? name : "bsdf.xml");
    orl_request_work(request, hash_upload, look_up_bsdf);
}

void orl_handle_bsdf_delete(struct orl_request *request)
{
    struct orl_server *server = request->server;
    const char *id = request->params[0];
    struct orl_stored_item item = {.summary = NULL};
    bool found = false, removed = false, needed = false;
    struct orl_error err;
    int rc = orl_bsdf_find(&server->db, id, &item, &found, &err);
    free(item.summary);
    if (rc == 0 && found)
        rc = orl_blob_in_scene(&server->db, id, &needed, &err);
    if (rc == 0 && needed) {
        orl_reply_in_use(request, "stored scenes use the BSDF");
        return;
    }
    if (rc == 0 && found)
        rc = orl_bsdf_drop(&server->db, id, &removed, &err);
    if (rc) {
        orl_reply_error(request, &err);
        return;
    }
    if (removed)
        orl_blobs_remove_unused(server->blobs, id);
    orl_reply_removed(request, removed, "BSDF");
    orl_reply_when_durable(request);
}
