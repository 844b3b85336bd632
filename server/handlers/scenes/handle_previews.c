/*
 * Previews of stored objects, made each time in a child (checks/child/child_scene.c): GET
 * /v1/scenes/ID/outline, a scene's floor plan; GET /v1/bsdfs/ID/polar, the directions into which a
 * BSDF scatters light; and GET /v1/bsdfs/ID for BSDFs that came with a scene. For other BSDFs the
 * summary of their check is stored.
 */
#include "handlers/handlers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "checks/check_client.h"
#include "checks/checks.h"
#include "handlers/scenes/upload.h"
#include "http/request/parse_request.h"
#include "http/response/reply.h"
#include "server.h"
#include "store/rows/scenes.h"

/* Limits of the arguments: a scene's heights in any unit; incidence is less than 90 degrees from
 * the normal. */
static const double highest = 1e9, most_theta_deg = 89.9, most_phi_deg = 360;

struct preview {
    const struct orl_item_kind *kind;
    double height;             /* height of the floor plan; NAN: half-way up */
    struct orl_incidence from; /* incidence of the polar plot */
    struct orl_bundle scene;
    struct orl_blob_claims claims; /* on the scene's files */
    char bsdf[ORL_SHA_HEX];
    struct orl_scene_bsdf of_scene; /* the BSDF, if it came with a scene */
    struct orl_blobs *blobs;        /* holds a claim on the BSDF; NULL: no claim */
    struct orl_check check;
    char *text; /* the answer */
    int rc;
    struct orl_error err;
};

static void preview_free(void *state)
{
    struct preview *preview = state;
    if (preview->blobs)
        orl_blobs_release(preview->blobs, preview->bsdf);
    orl_blobs_release_files(&preview->claims);
    orl_bundle_done(&preview->scene);
    free(preview->text);
    free(preview);
}

/* ---- On the pool ---------------------------------------------------------------------------- */

static void make_floor_plan(struct orl_request *request)
{
    struct preview *preview = request->state;
    free(preview->text);
    preview->text = NULL;
    preview->rc = orl_check_client_outline(&preview->check.call, &preview->scene, preview->height,
                                           &preview->text, &preview->err);
}

static void make_polar(struct orl_request *request)
{
    struct preview *preview = request->state;
    char path[ORL_PATH_MAX];
    free(preview->text);
    preview->text = NULL;
    orl_blob_path(&request->server->folders, preview->bsdf, path);
    preview->rc = orl_check_client_polar(&preview->check.call, path, &preview->from, &preview->text,
                                         &preview->err);
}

static void check_scene_bsdf(struct orl_request *request)
{
    struct preview *preview = request->state;
    char path[ORL_PATH_MAX];
    free(preview->text);
    preview->text = NULL;
    orl_blob_path(&request->server->folders, preview->bsdf, path);
    preview->rc = orl_check_client_bsdf(&preview->check.call, path, preview->of_scene.name,
                                        &preview->text, &preview->err);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

/* Looks the object up. err is set on failure only. */
static int find_object(struct orl_request *request, const struct orl_item_kind *kind,
                       bool *ret_found, struct orl_error *err)
{
    const int rc = kind->find(&request->server->db, request->params[0], NULL, ret_found, err);
    if (rc || *ret_found || kind != &orl_item_bsdf)
        return rc;
    struct orl_scene_bsdf bsdf;
    return orl_scene_bsdf_find(&request->server->db, request->params[0], &bsdf, ret_found, err);
}

/* Turns an error into ORL_ERR_CORRUPT. The stored object was valid once, so it is damaged, or the
 * daemon has a fault; the client has none. */
static void mark_corrupt(struct orl_error *err)
{
    if (err->code != ORL_ERR_LIMIT && err->code != ORL_ERR_NOMEM && err->code != ORL_ERR_IO)
        err->code = ORL_ERR_CORRUPT;
}

static void reply_preview(struct orl_request *request)
{
    struct preview *preview = request->state;
    if (!orl_check_finish(&preview->check, &preview->rc, &preview->err))
        return;
    if (preview->rc) {
        bool found = true;
        mark_corrupt(&preview->err);
        if (find_object(request, preview->kind, &found, &preview->err) == 0 && !found)
            orl_reply_not_found(request, preview->kind->name); /* it was removed meanwhile */
        else
            orl_reply_error(request, &preview->err);
        return;
    }
    /* The id is a digest, so the content never changes. */
    orl_reply_json_text(request, 200, preview->text, strlen(preview->text));
    orl_reply_header(request, "Cache-Control", "private, max-age=86400");
}

/* Makes the request's state. Returns NULL after a reply: the object does not exist, or an error. */
static struct preview *make_preview(struct orl_request *request, const struct orl_item_kind *kind)
{
    struct orl_error err;
    bool found = false;
    if (find_object(request, kind, &found, &err)) {
        orl_reply_error(request, &err);
        return NULL;
    }
    if (!found) {
        orl_reply_not_found(request, kind->name);
        return NULL;
    }
    struct preview *preview = orl_request_new_state(request, sizeof *preview, preview_free);
    if (preview)
        preview->kind = kind;
    return preview;
}

/* Reads a number from an argument, if given. Returns false after a reply: it is invalid. */
static bool read_argument(struct orl_request *request, const char *name, double low, double high,
                          double *number)
{
    const char *text = orl_request_query(request, name);
    if (!text || orl_query_number(text, low, high, number))
        return true;
    orl_reply_problem(request, 400, "invalid", "An argument is out of range",
                      "%s has to be a number from %g to %g", name, low, high);
    return false;
}

/* Claims the request's BSDF while it is read, and starts its check. */
static void start_bsdf_check(struct orl_request *request, void (*work)(struct orl_request *request),
                             void (*done)(struct orl_request *request))
{
    struct orl_server *server = request->server;
    struct preview *preview = request->state;
    memcpy(preview->bsdf, request->params[0], ORL_SHA_HEX);
    if (orl_blobs_claim(server->blobs, preview->bsdf, &preview->err)) {
        orl_reply_error(request, &preview->err);
        return;
    }
    preview->blobs = server->blobs;
    orl_check_begin(&server->checks, &preview->check, request, work, done);
}

void orl_handle_scene_outline(struct orl_request *request)
{
    struct orl_server *server = request->server;
    struct preview *preview = make_preview(request, &orl_item_scene);
    if (!preview)
        return;
    preview->height = NAN;
    if (!read_argument(request, "height", -highest, highest, &preview->height))
        return;
    if (orl_scene_files(&server->db, &server->folders, request->params[0], &preview->scene,
                        &preview->err) ||
        orl_blobs_claim_files(server->blobs, &preview->scene, &preview->claims, &preview->err))
        orl_reply_error(request, &preview->err);
    else
        orl_check_begin(&server->checks, &preview->check, request, make_floor_plan, reply_preview);
}

void orl_handle_bsdf_polar(struct orl_request *request)
{
    struct preview *preview = make_preview(request, &orl_item_bsdf);
    if (!preview)
        return;
    const char *from = orl_request_query(request, "from");
    if (from && strcmp(from, "front") != 0 && strcmp(from, "back") != 0) {
        orl_reply_problem(request, 400, "invalid", "An argument is invalid",
                          "from has to be front or back");
        return;
    }
    preview->from.front = !from || strcmp(from, "front") == 0;
    if (!read_argument(request, "theta_deg", 0, most_theta_deg, &preview->from.theta_deg) ||
        !read_argument(request, "phi_deg", 0, most_phi_deg, &preview->from.phi_deg))
        return;
    start_bsdf_check(request, make_polar, reply_preview);
}

/* Replies for a BSDF of a scene. A scene may contain XML files that are not BSDFs. */
static void reply_bsdf(struct orl_request *request)
{
    struct preview *preview = request->state;
    const char *id = request->params[0];
    if (!orl_check_finish(&preview->check, &preview->rc, &preview->err))
        return;
    if (preview->rc == ORL_ERR_SYNTAX || preview->rc == ORL_ERR_INVALID ||
        preview->rc == ORL_ERR_UNSUPPORTED || preview->rc == ORL_ERR_RANGE) {
        orl_reply_problem(request, 404, "no-such-resource", "There is no such resource",
                          "the scene's file '%s' is not a BSDF: %s", preview->of_scene.name,
                          preview->err.message);
        return;
    }
    if (preview->rc) {
        orl_reply_error(request, &preview->err);
        return;
    }
    const struct orl_stored_item item = {preview->of_scene.created_ms, preview->of_scene.bytes,
                                         preview->text};
    orl_reply_json(request, 200, orl_stored_item_to_json(id, &item, NULL));
    orl_reply_etag(request, id);
}

void orl_handle_bsdf_get(struct orl_request *request)
{
    struct orl_scene_bsdf of_scene;
    struct orl_error err;
    bool found = false;
    if (orl_scene_bsdf_find(&request->server->db, request->params[0], &of_scene, &found, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    if (!found) {
        orl_reply_stored_item(request, &orl_item_bsdf, request->params[0], 200, NULL);
        return;
    }
    if (orl_reply_if_none_match(request, request->params[0]))
        return;
    struct preview *preview = make_preview(request, &orl_item_bsdf);
    if (preview) {
        preview->of_scene = of_scene;
        start_bsdf_check(request, check_scene_bsdf, reply_bsdf);
    }
}
