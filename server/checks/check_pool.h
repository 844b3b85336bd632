/*
 * The pool of check children on the daemon's side: fork servers (fork_server.h) and requests to
 * their children. There are as many fork servers as checks ran at once; each is kept for the next
 * check.
 *
 * Threads: orl_check_pool_run on any thread, the rest on the loop's.
 */
#ifndef ORL_SERVER_CHECKS_CHECK_POOL_H
#define ORL_SERVER_CHECKS_CHECK_POOL_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include <oriel/base/error.h>

struct orl_check_pool;

/* Starts the first fork server. NULL: out of memory. */
struct orl_check_pool *orl_check_pool_new(void);
/* Frees the pool. No check may be running; NULL is allowed. */
void orl_check_pool_free(struct orl_check_pool *check_pool);

/* The resource bound that ended a child. */
enum orl_child_bound {
    ORL_CHILD_NONE,
    ORL_CHILD_MEMORY,
    ORL_CHILD_CPU,
    ORL_CHILD_FAULT,
    ORL_CHILD_KILLED /* no bound of its own: the system ran out of memory */
};

struct orl_check_call {
    struct orl_check_pool *check_pool;
    uint64_t memory;           /* bound on the child's memory, bytes */
    uint32_t cpu_s;            /* bound on the child's processor time, seconds */
    const atomic_bool *cancel; /* polled; NULL: never */
    int client_fd;             /* the check ends when this client disconnects; -1: no client */
    /* Callbacks for files that the child unpacks; NULL if there are none. */
    int (*file)(void *ctx, const char *name, struct orl_error *err);
    int (*data)(void *ctx, const char *data, size_t size, struct orl_error *err);
    void *ctx;
    /* Outcome of the check. */
    enum orl_child_bound met;
    uint64_t peak_bytes;
};

/*
 * Sends the request and waits for the verdict. Returns 0 and *ret_result, which the caller owns, or
 * the error that the child found. ORL_ERR_CANCELLED if *cancel is set or the client has
 * disconnected. If the child died, call->met is the cause. The error then names the bound:
 * ORL_ERR_LIMIT; ORL_ERR_UNSUPPORTED for a fault; ORL_ERR_NOMEM if no bound of its own was met.
 */
int orl_check_pool_run(struct orl_check_call *call, const json_t *request, json_t **ret_result,
                       struct orl_error *err);

#endif
