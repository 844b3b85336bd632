#include "handlers/scenes/stored_item.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/json_read.h>

#include "http/response/reply.h"
#include "process/times.h"
#include "server.h"

const struct orl_item_kind orl_item_scene = {"scene", "/v1/scenes", orl_scene_find};
const struct orl_item_kind orl_item_bsdf = {"BSDF", "/v1/bsdfs", orl_bsdf_find};

json_t *orl_stored_item_to_json(const char *id, const struct orl_stored_item *item,
                                const bool *created)
{
    char when[ORL_TIME_TEXT];
    orl_time_format(item->created_ms, when);
    json_t *summary = orl_json_read_stored(item->summary);
    json_t *doc = json_pack("{s:s, s:s, s:I, s:o}", "id", id, "created_at", when, "bytes",
                            (json_int_t)item->bytes, "summary", summary);
    if (doc && created && json_object_set_new(doc, "created", json_boolean(*created))) {
        json_decref(doc);
        return NULL;
    }
    return doc;
}

void orl_reply_stored_item(struct orl_request *request, const struct orl_item_kind *kind,
                           const char *id, unsigned status, const bool *created)
{
    struct orl_stored_item item;
    struct orl_error err;
    bool found = false;
    char location[ORL_PARAM_MAX + 32];
    if (kind->find(&request->server->db, id, &item, &found, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    if (!found) {
        orl_reply_not_found(request, kind->name);
        return;
    }
    if (created || !orl_reply_if_none_match(request, id)) {
        orl_reply_json(request, status, orl_stored_item_to_json(id, &item, created));
        orl_reply_etag(request, id);
    }
    if (created) {
        snprintf(location, sizeof location, "%s/%s", kind->folder, id);
        orl_reply_header(request, "Location", location);
    }
    free(item.summary);
}
