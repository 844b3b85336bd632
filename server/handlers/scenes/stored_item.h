/*
 * The common part of scenes and BSDFs: content-addressed items with an id, a size, a date and a
 * summary.
 */
#ifndef ORL_SERVER_HANDLERS_SCENES_STORED_ITEM_H
#define ORL_SERVER_HANDLERS_SCENES_STORED_ITEM_H

#include <jansson.h>

#include "http/request/request.h"
#include "store/rows/scenes.h"

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

#endif
