/*
 * The interface between the HTTP layer and the daemon. Handlers know more: each request carries the
 * daemon for them, which this folder does not access.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_HTTP_CONTEXT_H
#define ORL_SERVER_HTTP_CONTEXT_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "health/metrics.h"
#include "http/access/link_key.h"
#include "http/quota/clients.h"
#include "http/router.h"
#include "process/config.h"
#include "process/log.h"
#include "store/database/db.h"
#include "store/durability/wal_sync.h"
#include "store/files/folders.h"

struct orl_server;

/* Callbacks into the daemon. */
struct orl_http_calls {
    /* Return true if so many more bytes fit: receive: of a body in flight; admit: to store for good
     * (maintenance/storage.h). */
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
    bool disk_full;      /* no new data is stored (disk_reserve.h) */
    bool stopping;       /* new requests are refused */
};

#endif
