/*
 * Previews of stored objects, made each time in a child (checks/child_looks.h): GET
 * /v1/scenes/ID/outline, a scene's floor plan; GET /v1/bsdfs/ID/polar, the directions into which a
 * BSDF scatters light; and GET /v1/bsdfs/ID for BSDFs that came with a scene. For other BSDFs the
 * summary of their check is stored.
 */
#include "resources/handlers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "checks/ask.h"
#include "checks/checks.h"
#include "http/query.h"
#include "http/reply.h"
#include "resources/stored_item.h"
#include "server.h"
#include "store/scene_lists.h"

/* Limits of the arguments: a scene's heights in any unit; incidence is less than 90 degrees from
 * the normal. */
static const double highest = 1e9, most_theta_deg = 89.9, most_phi_deg = 360;

struct look {
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

static void look_free(void *state)
{
    struct look *look = state;
    if (look->blobs)
        orl_blobs_release(look->blobs, look->bsdf);
    orl_blobs_release_files(&look->claims);
    orl_bundle_done(&look->scene);
    free(look->text);
    free(look);
}

/* ---- On the pool ---------------------------------------------------------------------------- */

static void make_floor_plan(struct orl_request *request)
{
    struct look *look = request->state;
    free(look->text);
    look->text = NULL;
    look->rc =
        orl_ask_outline(&look->check.asking, &look->scene, look->height, &look->text, &look->err);
}

static void make_polar(struct orl_request *request)
{
    struct look *look = request->state;
    char path[ORL_PATH_MAX];
    free(look->text);
    look->text = NULL;
    orl_blob_path(&request->server->folders, look->bsdf, path);
    look->rc = orl_ask_polar(&look->check.asking, path, &look->from, &look->text, &look->err);
}

static void check_scene_bsdf(struct orl_request *request)
{
    struct look *look = request->state;
    char path[ORL_PATH_MAX];
    free(look->text);
    look->text = NULL;
    orl_blob_path(&request->server->folders, look->bsdf, path);
    look->rc =
        orl_ask_bsdf(&look->check.asking, path, look->of_scene.name, &look->text, &look->err);
}

/* ---- On the loop ---------------------------------------------------------------------------- */

/* Looks the object up. err is set on failure only. */
static int find_object(struct orl_request *request, const struct orl_item_kind *kind,
                       bool *ret_found, struct orl_error *err)
{
    struct orl_stored_item item = {.summary = NULL};
    const int rc = kind->find(&request->server->db, request->params[0], &item, ret_found, err);
    free(item.summary);
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

static void reply_look(struct orl_request *request)
{
    struct look *look = request->state;
    if (!orl_check_ended(&look->check, &look->rc, &look->err))
        return;
    if (look->rc) {
        bool found = true;
        mark_corrupt(&look->err);
        if (find_object(request, look->kind, &found, &look->err) == 0 && !found)
            orl_reply_not_found(request, look->kind->name); /* it was removed meanwhile */
        else
            orl_reply_error(request, &look->err);
        return;
    }
    /* The id is a digest, so the content never changes. */
    orl_reply_json_text(request, 200, look->text, strlen(look->text));
    orl_reply_header(request, "Cache-Control", "private, max-age=86400");
}

/* Makes the request's state. Returns NULL after a reply: the object does not exist, or an error. */
static struct look *make_look(struct orl_request *request, const struct orl_item_kind *kind)
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
    struct look *look = calloc(1, sizeof *look);
    if (!look) {
        orl_reply_json(request, 503, NULL);
        return NULL;
    }
    look->kind = kind;
    request->state = look;
    request->free_state = look_free;
    return look;
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
    struct look *look = request->state;
    memcpy(look->bsdf, request->params[0], ORL_SHA_HEX);
    if (orl_blobs_claim(server->blobs, look->bsdf, &look->err)) {
        orl_reply_error(request, &look->err);
        return;
    }
    look->blobs = server->blobs;
    orl_check_begin(&server->checks, &look->check, request, work, done);
}

void orl_handle_scene_outline(struct orl_request *request)
{
    struct orl_server *server = request->server;
    struct look *look = make_look(request, &orl_item_scene);
    if (!look)
        return;
    look->height = NAN;
    if (!read_argument(request, "height", -highest, highest, &look->height))
        return;
    if (orl_scene_files(&server->db, &server->folders, request->params[0], &look->scene,
                        &look->err) ||
        orl_blobs_claim_files(server->blobs, &look->scene, &look->claims, &look->err))
        orl_reply_error(request, &look->err);
    else
        orl_check_begin(&server->checks, &look->check, request, make_floor_plan, reply_look);
}

void orl_handle_bsdf_polar(struct orl_request *request)
{
    struct look *look = make_look(request, &orl_item_bsdf);
    if (!look)
        return;
    const char *from = orl_request_query(request, "from");
    if (from && strcmp(from, "front") != 0 && strcmp(from, "back") != 0) {
        orl_reply_problem(request, 400, "invalid", "An argument is none that there is",
                          "from has to be front or back");
        return;
    }
    look->from.front = !from || strcmp(from, "front") == 0;
    if (!read_argument(request, "theta_deg", 0, most_theta_deg, &look->from.theta_deg) ||
        !read_argument(request, "phi_deg", 0, most_phi_deg, &look->from.phi_deg))
        return;
    start_bsdf_check(request, make_polar, reply_look);
}

/* Replies for a BSDF of a scene. A scene may contain XML files that are not BSDFs. */
static void reply_bsdf(struct orl_request *request)
{
    struct look *look = request->state;
    const char *id = request->params[0];
    if (!orl_check_ended(&look->check, &look->rc, &look->err))
        return;
    if (look->rc == ORL_ERR_SYNTAX || look->rc == ORL_ERR_INVALID ||
        look->rc == ORL_ERR_UNSUPPORTED || look->rc == ORL_ERR_RANGE) {
        orl_reply_problem(request, 404, "no-such-resource", "There is no such resource",
                          "the scene's file '%s' is none: %s", look->of_scene.name,
                          look->err.message);
        return;
    }
    if (look->rc) {
        orl_reply_error(request, &look->err);
        return;
    }
    const struct orl_stored_item item = {look->of_scene.created_ms, look->of_scene.bytes,
                                         look->text};
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
    struct look *look = make_look(request, &orl_item_bsdf);
    if (look) {
        look->of_scene = of_scene;
        start_bsdf_check(request, check_scene_bsdf, reply_bsdf);
    }
}
