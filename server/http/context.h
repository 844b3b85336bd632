/*
 * What HTTP needs of the daemon, and all that it knows of it. Handlers know more: a request carries
 * the daemon itself for them, which nothing in this folder looks into.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_SERVER_HTTP_CONTEXT_H
#define ORL_SERVER_HTTP_CONTEXT_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "health/metrics.h"
#include "http/clients.h"
#include "http/link_key.h"
#include "http/router.h"
#include "process/config.h"
#include "process/log.h"
#include "store/db.h"
#include "store/folders.h"
#include "store/settling.h"

struct orl_server;

/* What it asks of the daemon. */
struct orl_http_calls {
    /* Is there room for so many bytes more: of a body on its way, for good? (upkeep/storage.h) */
    bool (*receive)(struct orl_server *server, struct orl_hold *hold, uint64_t bytes);
    bool (*admit)(struct orl_server *server, const struct orl_hold *hold, uint64_t bytes);
    struct orl_room *(*room)(struct orl_server *server);
    uint64_t (*budget)(const struct orl_server *server);
    /* How many jobs of a token, by its id, wait or run. */
    uint64_t (*jobs_of)(const struct orl_server *server, const char *owner);
    void (*swept)(struct orl_server *server);  /* a second has passed */
    void (*worked)(struct orl_server *server); /* a request's work came back from the pool */
};

/* Borrows everything. */
struct orl_http_context {
    struct orl_server *server;
    const struct orl_http_calls *calls;
    uv_loop_t *loop;
    const struct orl_config *config;
    const struct orl_routes *routes;
    const struct orl_log *log;
    const struct orl_folders *folders;
    struct orl_db *db;
    struct orl_settling *settling;
    unsigned char link_key[ORL_LINK_KEY_BYTES];
    sqlite3_stmt *token_finder; /* where tokens are needed */
    struct orl_metrics *metrics;
    struct orl_clients clients;
    struct orl_request *begun; /* the last one, while its target is read; or NULL */
    uint64_t requests;         /* served or under way; the last one's id */
    unsigned working;          /* requests whose work is on the pool, or whose answer waits */
    bool disk_full;            /* nothing new is kept (disk_room.h) */
    bool stopping;             /* what is asked from now on is refused */
};

#endif
