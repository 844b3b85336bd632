/* GET /v1/scenes and GET /v1/bsdfs: stored objects, their uses, and when they were last used. */
#include "handlers/handlers.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "handlers/pagination.h"
#include "http/response/reply.h"
#include "process/limits.h"
#include "process/times.h"
#include "server.h"
#include "store/rows/scene_lists.h"
#include "json/encode.h"

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
        return orl_page_refuse(request, "cursor is of the link to the next page");
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
        if (json_array_append_new(list, json_stringn(ids, length))) {
            json_decref(list);
            return NULL;
        }
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
        orl_page_refuse(request, "scene is the id of one, 64 hexadecimal digits"))
        reply_list(request, &bsdfs, scene);
}
