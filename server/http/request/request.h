/*
 * One HTTP request, from its first header to its last byte sent (request.c), and its body (body.c).
 */
#ifndef ORL_SERVER_HTTP_REQUEST_REQUEST_H
#define ORL_SERVER_HTTP_REQUEST_REQUEST_H

#include <microhttpd.h>
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include <oriel/base/files.h>

#include "http/quota/quota.h"
#include "http/request/parse_request.h"
#include "store/durability/wal.h"
#include "store/files/folders.h"
#include "store/rows/stored_jobs.h"
#include "store/rows/stored_tokens.h"

/*
 * The body of one request: in memory while small, spilled to a file below tmp/ when larger.
 *
 * The loop thread appends. When append returns true, the caller suspends the connection and has a
 * pool thread flush. Afterwards a pool thread views the whole body. A body larger than its limit is
 * read and dropped (over is set), so that an answer can still be sent.
 * Threads: one at a time.
 */

struct orl_body {
    uint64_t size, limit;
    bool over;   /* larger than limit */
    bool failed; /* a write failed; err has the reason */
    struct orl_error err;
    char *buffer;
    size_t used;
    int fd; /* the open file; -1 while all data is in the buffer */
    char path[ORL_PATH_MAX];
    struct orl_reservation *reservation; /* bounds the bytes on disk; borrowed; NULL: no bound */
    uint64_t written, reserved;          /* bytes written to disk; bytes of them already reserved */
    struct orl_file view;
};

void orl_body_init(struct orl_body *body, uint64_t limit, struct orl_reservation *reservation);
void orl_body_done(struct orl_body *body); /* removes the file, unless the caller took it */

/* Appends data. Returns true if the buffer must be flushed before more arrives. size is at most
 * half the buffer. */
bool orl_body_append(struct orl_body *body, const char *data, size_t size);
/* Pool: writes the buffer to the file. */
void orl_body_flush(struct orl_body *body, const struct orl_folders *folders);
/* Pool: returns the whole body, valid until done. */
int orl_body_view(struct orl_body *body, const struct orl_folders *folders,
                  struct orl_file *ret_view, struct orl_error *err);
/* Pool: returns the path of a file with the whole body. The body owns the file; *ret_path is valid
 * until done. */
int orl_body_file(struct orl_body *body, const struct orl_folders *folders, const char **ret_path,
                  struct orl_error *err);
/* Pool: puts the whole body into a file that the caller then owns, to move away or remove. */
int orl_body_take_file(struct orl_body *body, const struct orl_folders *folders,
                       char ret_path[ORL_PATH_MAX], struct orl_error *err);

/*
 * The request.
 *
 * A handler runs on the loop thread once the body is complete. It either replies (reply.h) or calls
 * orl_request_work: `run` executes on the pool while the connection is suspended. Then `then`
 * executes on the loop thread, and may reply or call orl_request_work again. A handler keeps its
 * data between the two in state, which free_state frees with the request in any case.
 *
 * Invariant: a request has at most one pending operation: work on the pool, a check (checks.h), or
 * a wait for the disk (orl_reply_when_durable). Starting a second one would overwrite the callbacks
 * of the first. It is a bug of the handler: builds with ORL_DEBUG abort, others log it, let the
 * first operation finish, and reply 500.
 *
 * Threads: loop, except for run; between orl_request_work and then, only run touches the request.
 */

struct orl_http_context;
struct orl_server;
struct orl_route;
struct orl_request;

typedef void (*orl_request_step)(struct orl_request *request);

enum { ORL_ROUTE_PARAMS = 2, ORL_PARAM_MAX = 160, ORL_LOGGED_PATH = 200 };

struct orl_request {
    struct orl_http_context *context;
    struct orl_server *server; /* for handlers */
    struct MHD_Connection *connection;
    const struct orl_route *route; /* NULL: refused before a route was found */
    uint64_t id;
    double started_s;
    char method[16], path[ORL_LOGGED_PATH]; /* for the log; the path may be cut */
    char job[ORL_JOB_ID];                   /* the job concerned, once known; "": none */
    char token[ORL_TOKEN_NAME];             /* the name of its token; "-" for none */
    struct orl_token_row token_row;         /* row of that token, if tokens are required */
    char params[ORL_ROUTE_PARAMS][ORL_PARAM_MAX];
    struct orl_target target;           /* its authority, if given; its path is above */
    struct orl_client *client;          /* quota.h; NULL: the request was refused before */
    struct orl_reservation reservation; /* bytes on disk, in flight */
    struct orl_body body;
    const char *version_at; /* where MHD must find the version, unless the target has a NUL */
    bool headers_complete;  /* its headers are complete */
    bool too_long;          /* its target is too long */
    bool dispatched;        /* the handler has been called */
    bool unframed;          /* refused, and the end of the request is unknown */
    bool cross_origin;      /* sent by a page of an origin that --allow-origin names */

    struct MHD_Response *response; /* made, not yet queued */
    unsigned status;               /* status of the response made or queued; 0: none yet */

    uv_work_t work;
    orl_request_step run, then;
    struct orl_wal_sync_wait sync_wait; /* wait of its answer: orl_reply_when_durable */
    struct orl_check *check;            /* running check of its data, or NULL: checks.h */
    bool working;                       /* an operation is pending */
    bool started_twice; /* a handler tried to start a second one: the reply is a 500 */

    void *state;
    void (*free_state)(void *state);
};

/* Calls a step of the request. If it crashes, the report has the request's method and path. */
void orl_request_step_run(struct orl_request *request, orl_request_step step);

/* Calls run on the pool and then `then` on the loop. The handler must return without replying. */
void orl_request_work(struct orl_request *request, orl_request_step run, orl_request_step then);

/*
 * The parts of orl_request_work, for operations that start later or not on the pool. set_pending
 * makes the operation pending. If one is pending already, it changes nothing and returns false.
 * queue sends `run` to the pool. resume ends the operation: it calls `then` and resumes the
 * connection.
 */
bool orl_request_set_pending(struct orl_request *request, orl_request_step run,
                             orl_request_step then);
void orl_request_queue(struct orl_request *request);
void orl_request_resume(struct orl_request *request);

/* Returns the server's folders, for the lifetime of the request. Bytes written to tmp/ are reserved
 * in its reservation. */
struct orl_folders orl_request_folders(struct orl_request *request);

/* Return a query argument or header, or NULL. */
const char *orl_request_query(const struct orl_request *request, const char *name);
const char *orl_request_header(const struct orl_request *request, const char *name);

#endif
