/*
 * The common part of the handlers of uploads: stored items (handle_stored_lists.c), and a scene
 * being uploaded (scene_upload.c).
 */
#ifndef ORL_SERVER_HANDLERS_SCENES_UPLOAD_H
#define ORL_SERVER_HANDLERS_SCENES_UPLOAD_H

#include <jansson.h>
#include <microhttpd.h>

#include "checks/checks.h"
#include "http/request/request.h"
#include "store/rows/scenes.h"

/*
 * Stored items, that is, scenes and BSDFs: content-addressed items with an id, a size, a date and a
 * summary.
 */

struct orl_item_kind {
    const char *name;   /* "scene" */
    const char *folder; /* "/v1/scenes" */
    int (*find)(struct orl_db *db, const char *id, struct orl_stored_item *ret_item,
                bool *ret_found, struct orl_error *err);
};
extern const struct orl_item_kind orl_item_scene, orl_item_bsdf;

/* Returns an item's document, as described below; NULL: out of memory. */
json_t *orl_stored_item_to_json(const char *id, const struct orl_stored_item *item,
                                const bool *created);

/*
 * Replies with the item's document: {"id", "created_at", "bytes", "summary"} and, when created is
 * given (after a POST), "created". 404 if there is no such item, 304 if the client has it.
 */
void orl_reply_stored_item(struct orl_request *request, const struct orl_item_kind *kind,
                           const char *id, unsigned status, const bool *created);

/* An item being uploaded: the first member of a handler's state. */
struct orl_item_upload {
    const struct orl_item_kind *kind;
    const char *id; /* borrowed */
    struct orl_check check;
    int rc;
    struct orl_error err; /* set if rc is not 0 */
};

/* Returns true if the item is stored. Sets rc if the database fails; does nothing if rc is set. */
bool orl_item_is_stored(struct orl_request *request);
/* Replies to the upload of an item that was stored before. If it was removed meanwhile, calls begin
 * to check it as a new one. */
void orl_item_reply_known(struct orl_request *request, orl_request_step begin);
/* Replies with the item whose row is there now, or with the error. */
void orl_item_reply_created(struct orl_request *request, bool created);

/*
 * A scene being uploaded: unpacked, identified by its content, checked, stored. Untrusted data is
 * read only in children (checks/). Pool threads, one at a time; handle_scenes.c writes the rows.
 */

struct orl_scene_upload {
    struct orl_bundle bundle; /* files still in tmp/ are removed by done */
    char id[ORL_SHA_HEX];
    json_t *choice; /* choices of a project: {"states", "sky"}; NULL: no choice */
    bool listed;    /* the summary must list what the project contains */
    bool guessed;   /* main files were not named (main_files.h) */
    char *mains;    /* main files in order, one per line; NULL: by each form's rules */
    char *summary;  /* JSON text, once checked */
};

void orl_scene_upload_done(struct orl_scene_upload *upload);

/* Adds a main file. Once any are named, only these are main files, in every form of upload. */
int orl_scene_upload_add_main(struct orl_scene_upload *upload, const char *names,
                              struct orl_error *err);

/* Choose a state of a project, "GROUP=STATE", or a sky by name. */
int orl_scene_upload_choose_state(struct orl_scene_upload *upload, const char *choice,
                                  struct orl_error *err);
int orl_scene_upload_choose_sky(struct orl_scene_upload *upload, const char *name,
                                struct orl_error *err);

/* Reads multipart/form-data; zips among its parts are unpacked after all others. */
int orl_scene_upload_multipart(struct orl_scene_upload *upload, struct MHD_Connection *connection,
                               const struct orl_file *body, const struct orl_folders *folders,
                               struct orl_check_call *call, struct orl_error *err);
/* Reads the file of a document (checks/child/child_checks.h). */
int orl_scene_upload_json(struct orl_scene_upload *upload, const char *path,
                          const struct orl_folders *folders, struct orl_check_call *call,
                          struct orl_error *err);
/* Reads a zip of the scene's folder (uploads.h). */
int orl_scene_upload_zip(struct orl_scene_upload *upload, const char *path,
                         const struct orl_folders *folders, struct orl_check_call *call,
                         struct orl_error *err);

/* Has the whole scene parsed as a job would parse it; fills summary. */
int orl_scene_upload_check(struct orl_scene_upload *upload, struct orl_check_call *call,
                           struct orl_error *err);
/* Moves the files to their places among the blobs. */
int orl_scene_upload_store(struct orl_scene_upload *upload, const struct orl_folders *folders,
                           struct orl_error *err);

#endif
