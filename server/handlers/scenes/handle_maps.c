#include "handlers/handlers.h"

#include <jansson.h>
#include <stdlib.h>

#include "http/response/reply.h"
#include "process/limits.h"
#include "process/times.h"
#include "server.h"

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
