/*
 * Lists of stored objects (GET /v1/scenes, /v1/bsdfs and /v1/maps), the document of one item, and
 * the removal of maps.
 */
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/json_read.h>

#include "handlers/handlers.h"
#include "handlers/scenes/upload.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "process/times.h"
#include "server.h"
#include "store/rows/scenes.h"
#include "json/encode.h"

/* ---- One item -------------------------------------------------------------------------------- */

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
    return orl_json_checked(doc, doc && created &&
                                     json_object_set_new(doc, "created", json_boolean(*created)));
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

bool orl_item_is_stored(struct orl_request *request)
{
    struct orl_item_upload *upload = request->state;
    bool found = false;
    if (upload->rc == 0)
        upload->rc =
            upload->kind->find(&request->server->db, upload->id, NULL, &found, &upload->err);
    return found;
}

void orl_item_reply_created(struct orl_request *request, bool created)
{
    const struct orl_item_upload *upload = request->state;
    if (upload->rc) {
        orl_reply_error(request, &upload->err);
        return;
    }
    orl_reply_stored_item(request, upload->kind, upload->id, created ? 201 : 200, &created);
    orl_reply_when_durable(request); /* a concurrent upload may have written the row just now */
}

void orl_item_reply_known(struct orl_request *request, orl_request_step begin)
{
    const bool stored = orl_item_is_stored(request);
    if (!stored && ((struct orl_item_upload *)request->state)->rc == 0)
        begin(request);
    else
        orl_item_reply_created(request, false);
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static json_t *map_to_json(const struct orl_stored_map *map)
{
    char created[ORL_TIME_TEXT], used[ORL_TIME_TEXT];
    orl_time_format(map->created_ms, created);
    orl_time_format(map->last_used_ms, used);
    return json_pack("{s:s, s:s, s:I, s:I, s:I, s:f, s:I, s:f, s:s, s:s, s:b}", "kind",
                     map->info.kind, "key", map->info.key, "emitted", (json_int_t)map->info.emitted,
                     "stored", (json_int_t)map->info.stored, "bytes", (json_int_t)map->info.bytes,
                     "seconds", map->info.seconds, "hits", (json_int_t)map->hits, "seconds_saved",
                     map->seconds_saved, "created", created, "last_used", used, "in_use",
                     map->in_use);
}

void orl_handle_map_list(struct orl_request *request)
{
    struct orl_stored_map *maps = NULL;
    size_t count = 0;
    struct orl_error err;
    if (orl_map_cache_list(request->server->maps, &maps, &count, &err)) {
        orl_reply_error(request, &err);
        return;
    }
    json_t *list = json_array();
    for (size_t i = 0; i < count && i < ORL_SERVER_LIST && list; i++) {
        json_t *map = map_to_json(&maps[i]);
        if (!map || json_array_append_new(list, map)) {
            json_decref(list);
            list = NULL;
        }
    }
    free(maps);
    orl_reply_json(request, 200,
                   json_pack("{s:o, s:b}", "maps", list, "more", count > ORL_SERVER_LIST));
    orl_reply_header(request, "Cache-Control", "no-store");
}

void orl_handle_map_delete(struct orl_request *request)
{
    enum orl_map_removal removal = ORL_MAP_ABSENT;
    struct orl_error err;
    if (orl_map_cache_remove(request->server->maps, request->params[0], request->params[1],
                             &removal, &err))
        orl_reply_error(request, &err);
    else if (removal == ORL_MAP_IN_USE)
        orl_reply_in_use(request, "a job uses the map, or builds it");
    else
        orl_reply_removed(request, removal == ORL_MAP_REMOVED, "map");
    orl_reply_when_durable(request);
}

/* ---- Scenes and BSDFs: their uses, and when they were last used ------------------------------ */

struct list {
    json_t *items; /* NULL: out of memory */
    unsigned long limit;
    const char *scene; /* lists the BSDFs of this scene; NULL: all */
    bool more;
    struct orl_list_position last; /* place of the last item in it */
};

/* Reads a cursor, "1711107000123-<64 digits>"; if absent, the first page. Returns false after a
 * 400. */
static bool read_cursor(struct orl_request *request, struct orl_list_position *ret_position)
{
    const char *cursor = orl_request_query(request, "cursor");
    *ret_position = (struct orl_list_position){.created_ms = INT64_MAX};
    if (!cursor)
        return true;
    const size_t digits = strspn(cursor, "0123456789");
    if (digits == 0 || digits > 15 || cursor[digits] != '-' || !orl_is_sha256(cursor + digits + 1))
        return orl_page_refuse(request, "cursor must be copied from the link to the next page");
    ret_position->created_ms = strtoll(cursor, NULL, 10);
    snprintf(ret_position->id, sizeof ret_position->id, "%s", cursor + digits + 1);
    return true;
}

/* Appends an item, and takes ownership of it. An item beyond the limit only shows that there are
 * more. */
static int add_item(struct list *list, json_t *item, const struct orl_list_position *position)
{
    if (json_array_size(list->items) == list->limit) {
        list->more = true;
        json_decref(item);
        return 0;
    }
    list->last = *position;
    if (item && json_array_append_new(list->items, item) == 0)
        return 0;
    json_decref(list->items);
    list->items = NULL;
    return ORL_ERR_NOMEM;
}

static int add_scene(void *ctx, const struct orl_listed_scene *scene)
{
    char created[ORL_TIME_TEXT], used[ORL_TIME_TEXT];
    orl_time_format(scene->position.created_ms, created);
    orl_time_format(scene->last_used_ms, used);
    return add_item(ctx,
                    json_pack("{s:s, s:s, s:I, s:s, s:I, s:I}", "id", scene->position.id,
                              "created_at", created, "bytes", (json_int_t)scene->bytes, "last_used",
                              used, "jobs_under_way", (json_int_t)scene->jobs_under_way, "jobs",
                              (json_int_t)scene->all_jobs),
                    &scene->position);
}

/* Returns the ids of a list separated by commas. */
static json_t *split_ids(const char *ids)
{
    json_t *list = json_array();
    while (list && *ids) {
        const size_t length = strcspn(ids, ",");
        list = orl_json_append(list, json_stringn(ids, length));
        ids += length + (ids[length] == ',');
    }
    return list;
}

static int add_bsdf(void *ctx, const struct orl_listed_bsdf *bsdf)
{
    char created[ORL_TIME_TEXT], used[ORL_TIME_TEXT];
    orl_time_format(bsdf->position.created_ms, created);
    orl_time_format(bsdf->last_used_ms, used);
    return add_item(ctx,
                    json_pack("{s:s, s:o, s:s, s:b, s:I, s:s, s:I, s:o}", "id", bsdf->position.id,
                              "name", orl_json_from_text(bsdf->name), "created_at", created,
                              "by_itself", bsdf->by_itself, "bytes", (json_int_t)bsdf->bytes,
                              "last_used", used, "scene_count", (json_int_t)bsdf->n_scenes,
                              "scenes", split_ids(bsdf->scenes)),
                    &bsdf->position);
}

static int read_scenes(struct orl_db *db, const struct orl_list_position *after, struct list *list,
                       struct orl_error *err)
{
    return orl_scene_rows(db, after, list->limit + 1, add_scene, list, err);
}

static int read_bsdfs(struct orl_db *db, const struct orl_list_position *after, struct list *list,
                      struct orl_error *err)
{
    return orl_bsdf_rows(db, after, list->scene, list->limit + 1, add_bsdf, list, err);
}

struct kind {
    const char *path, *member;
    int (*read)(struct orl_db *db, const struct orl_list_position *after, struct list *list,
                struct orl_error *err);
};

static void reply_items(struct orl_request *request, const struct list *list,
                        const struct kind *kind)
{
    static const char *const link_arguments[] = {"limit", "scene", NULL};
    char cursor[ORL_SHA_HEX + 24];
    orl_reply_json(request, 200,
                   json_pack("{s:o, s:b}", kind->member, list->items, "more", list->more));
    orl_reply_header(request, "Cache-Control", "no-store");
    if (!list->more)
        return;
    snprintf(cursor, sizeof cursor, "%lld-%s", (long long)list->last.created_ms, list->last.id);
    orl_page_link(request, kind->path, link_arguments, cursor);
}

static void reply_list(struct orl_request *request, const struct kind *kind, const char *scene)
{
    struct list list = {.limit = 100, .scene = scene};
    struct orl_list_position after;
    struct orl_error err;
    if (!orl_page_limit(request, &list.limit) || !read_cursor(request, &after))
        return;
    list.items = json_array();
    const int rc = kind->read(&request->server->db, &after, &list, &err);
    if (rc && list.items) {
        json_decref(list.items);
        orl_reply_error(request, &err);
    } else {
        reply_items(request, &list, kind);
    }
}

void orl_handle_scene_list(struct orl_request *request)
{
    static const struct kind scenes = {"/v1/scenes", "scenes", read_scenes};
    reply_list(request, &scenes, NULL);
}

void orl_handle_bsdf_list(struct orl_request *request)
{
    static const struct kind bsdfs = {"/v1/bsdfs", "bsdfs", read_bsdfs};
    const char *scene = orl_request_query(request, "scene");
    if (!scene || orl_is_sha256(scene) ||
        orl_page_refuse(request, "scene must be the id of a scene, 64 hexadecimal digits"))
        reply_list(request, &bsdfs, scene);
}
