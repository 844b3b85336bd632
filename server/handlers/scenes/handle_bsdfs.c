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
    struct orl_item_upload item;
    char name[256]; /* for messages; the sender's name for it */
    char id[ORL_SHA_HEX];
    uint64_t bytes;
    char *summary;           /* JSON text */
    struct orl_blobs *blobs; /* holds a claim on the file; NULL: no claim */
    bool stored;             /* its file is stored as a blob already */
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
    upload->item.rc =
        orl_body_view(&request->body, &request->server->folders, &file, &upload->item.err);
    if (upload->item.rc == 0)
        orl_sha256_hex(file.data, file.size, upload->id);
    upload->bytes = upload->item.rc == 0 ? file.size : 0;
}

/* Stores the file. For a known BSDF this only repairs damage in the store. */
static void store_file(struct orl_request *request)
{
    struct upload *upload = request->state;
    const struct orl_folders *folders = &request->server->folders;
    char path[ORL_PATH_MAX];
    if (upload->stored)
        return;
    upload->item.rc = orl_body_take_file(&request->body, folders, path, &upload->item.err);
    if (upload->item.rc)
        return;
    upload->item.rc = orl_blob_store(folders, path, upload->id, &upload->item.err);
    if (upload->item.rc)
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
    upload->item.rc = 0; /* left by an earlier attempt */
    if (upload->stored)
        orl_blob_path(folders, upload->id, blob);
    else
        upload->item.rc = orl_body_file(&request->body, folders, &file, &upload->item.err);
    if (upload->item.rc == 0)
        upload->item.rc = orl_check_client_bsdf(&upload->item.check.call, file, upload->name,
                                                &upload->summary, &upload->item.err);
    if (upload->item.rc == 0)
        store_file(request);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

static void insert_and_reply(struct orl_request *request)
{
    struct upload *upload = request->state;
    bool created = false;
    if (!orl_check_finish(&upload->item.check, &upload->item.rc, &upload->item.err))
        return;
    if (upload->item.rc == 0)
        upload->item.rc =
            orl_bsdf_insert(&request->server->db, upload->id, upload->name, upload->bytes,
                            upload->summary, &created, &upload->item.err);
    orl_item_reply_created(request, created);
}

/* Starts the check of a file that is claimed. */
static void begin_check(struct orl_request *request)
{
    struct upload *upload = request->state;
    const bool here = orl_blob_exists(&request->server->folders, upload->id);
    if (!orl_reply_if_full(request, here ? 0 : upload->bytes))
        orl_check_begin(&request->server->checks, &upload->item.check, request, check_and_store,
                        insert_and_reply);
}

static void reply_known(struct orl_request *request)
{
    orl_item_reply_known(request, begin_check);
}

static void look_up_bsdf(struct orl_request *request)
{
    struct upload *upload = request->state;
    const bool found = orl_item_is_stored(request);
    if (upload->item.rc == 0)
        upload->item.rc = orl_blobs_claim(request->server->blobs, upload->id, &upload->item.err);
    if (upload->item.rc) {
        orl_reply_error(request, &upload->item.err);
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
    struct upload *upload = orl_request_new_state(request, sizeof *upload, upload_free);
    struct orl_error err;
    if (!upload)
        return;
    upload->item.kind = &orl_item_bsdf;
    upload->item.id = upload->id;
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
    bool found = false, removed = false, needed = false;
    struct orl_error err;
    int rc = orl_bsdf_find(&server->db, id, NULL, &found, &err);
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
