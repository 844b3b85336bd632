/*
 * The pool of check children on the daemon's side: keepers (keeper.h) and requests to their
 * children. There are as many keepers as checks ran at once; each is kept for the next check.
 *
 * Threads: orl_lanes_run on any thread, the rest on the loop's.
 */
#ifndef ORL_SERVER_CHECKS_LANES_H
#define ORL_SERVER_CHECKS_LANES_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

#include <oriel/error.h>

struct orl_lanes;

/* Starts the first keeper. NULL: out of memory. */
struct orl_lanes *orl_lanes_new(void);
/* Frees the lanes. No check may be running; NULL is allowed. */
void orl_lanes_free(struct orl_lanes *lanes);

/* The resource bound that ended a child. */
enum orl_child_bound {
    ORL_CHILD_NONE,
    ORL_CHILD_MEMORY,
    ORL_CHILD_CPU,
    ORL_CHILD_FAULT,
    ORL_CHILD_KILLED /* no bound of its own: the system ran out of memory */
};

struct orl_asking {
    struct orl_lanes *lanes;
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
 * disconnected. If the child died, asking->met is the cause. The error then names the bound:
 * ORL_ERR_LIMIT; ORL_ERR_UNSUPPORTED for a fault; ORL_ERR_NOMEM if no bound of its own was met.
 */
int orl_lanes_run(struct orl_asking *asking, const json_t *request, json_t **ret_result,
                  struct orl_error *err);

#endif
