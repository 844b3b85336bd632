/*
 * The interface between the HTTP layer and the daemon, and the table of routes (router.c). Handlers
 * know more: each request carries the daemon for them, which this folder does not access.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_HTTP_CONTEXT_H
#define ORL_SERVER_HTTP_CONTEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "health/metrics.h"
#include "http/access/access.h"
#include "http/quota/quota.h"
#include "http/request/request.h"
#include "process/config.h"
#include "process/log.h"
#include "store/database/db.h"
#include "store/durability/wal.h"
#include "store/files/folders.h"
#include "store/rows/stored_tokens.h"

struct orl_server;

/* Callbacks into the daemon. */
struct orl_http_calls {
    /* Return true if so many more bytes fit. reserve_body: bytes of a body in flight.
     * reserve_storage: bytes to store for good (maintenance/storage.h). */
    bool (*reserve_body)(struct orl_server *server, struct orl_reservation *reservation,
                         uint64_t bytes);
    bool (*reserve_storage)(struct orl_server *server, const struct orl_reservation *reservation,
                            uint64_t bytes);
    struct orl_quota *(*upload_quota)(struct orl_server *server);
    uint64_t (*budget)(const struct orl_server *server);
    /* Returns the number of jobs of a token, by its id, that wait or run. */
    uint64_t (*jobs_of)(const struct orl_server *server, const char *owner);
    void (*on_tick)(struct orl_server *server);   /* called every second */
    void (*work_done)(struct orl_server *server); /* after each work of a request on the pool */
    void (*on_served)(struct orl_server *server); /* after connections have been read and written */
};

/* State of the HTTP layer. Borrows its pointers. */
struct orl_http_context {
    struct orl_server *server;
    const struct orl_http_calls *calls;
    uv_loop_t *loop;
    const struct orl_config *config;
    const struct orl_routes *routes;
    const struct orl_log *log;
    const struct orl_folders *folders;
    struct orl_db *db;
    struct orl_wal_sync *wal_sync;
    unsigned char link_key[ORL_LINK_KEY_BYTES];
    sqlite3_stmt *token_statement; /* if tokens are required */
    struct orl_metrics *metrics;
    struct orl_clients clients;
    struct orl_request *being_parsed; /* the last one, while its target is parsed; or NULL */
    uint64_t requests;                /* number of requests so far; the last one's id */
    unsigned working;    /* requests whose work is on the pool, or whose answer waits */
    unsigned unanswered; /* requests whose handler was called, but not all of its answer sent */
    bool disk_full;      /* no new data is stored (storage.h) */
    bool stopping;       /* new requests are refused */
};

/*
 * The router: finds a request's route in a table of methods, paths and handlers (handlers.h has the
 * daemon's table).
 */

struct orl_route {
    const char *method;         /* GET also serves HEAD */
    const char *path;           /* "/v1/jobs/{}/files/{*}": each {} is a parameter without slashes,
                                   {*} the rest */
    enum orl_token_scope scope; /* scope that a token needs, if tokens are required */
    orl_request_step handler;
    uint64_t max_body;        /* 0: no body is read */
    const char *const *types; /* accepted media types of the body, ended by NULL; NULL: any */
    bool by_link;             /* true if a signed link may replace a token (access.h) */
};

struct orl_routes {
    const struct orl_route *table;
    size_t count;
};

/*
 * Finds the route. Returns 0 and fills ret_route and ret_params, or an HTTP status: 404, or 405
 * with the allowed methods in ret_allow.
 */
unsigned orl_router_find(const struct orl_routes *routes, const char *method, const char *url,
                         const struct orl_route **ret_route,
                         char ret_params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX], char ret_allow[64]);

/* Returns the route's place in the table; one past the last for NULL. */
size_t orl_router_index(const struct orl_routes *routes, const struct orl_route *route);

/* Writes the accepted media types as "a, b or c". Returns ret_types. */
const char *orl_router_types(const struct orl_route *route, char ret_types[160]);

/* Returns true if the route accepts the media type of a Content-Type header (NULL: none). */
bool orl_router_accepts(const struct orl_route *route, const char *content_type);

#endif
