/*
 * The daemon's side of checks in children: keepers (keeper.h), as many as there have been checks at
 * once, each kept for the next check, and what is asked of their children.
 *
 * Threads: orl_lanes_run on any, the rest on the loop's.
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
/* Nothing may run; NULL is allowed. */
void orl_lanes_free(struct orl_lanes *lanes);

/* Which bound a child met. */
enum orl_child_bound {
    ORL_CHILD_NONE,
    ORL_CHILD_MEMORY,
    ORL_CHILD_CPU,
    ORL_CHILD_FAULT,
    ORL_CHILD_KILLED /* none: the system had no memory left */
};

struct orl_asking {
    struct orl_lanes *lanes;
    uint64_t memory;           /* bytes that the child may have */
    uint32_t cpu_s;            /* and seconds of a processor */
    const atomic_bool *cancel; /* polled; NULL: never */
    int client_fd;             /* whose hanging up ends it; -1: nobody's */
    /* For files that the child unpacks; NULL where there are none. */
    int (*file)(void *ctx, const char *name, struct orl_error *err);
    int (*data)(void *ctx, const char *data, size_t size, struct orl_error *err);
    void *ctx;
    /* How it went. */
    enum orl_child_bound met;
    uint64_t peak_bytes;
};

/*
 * Asks, and waits for the verdict: 0 and *ret_result (the caller's), or what the child found wrong.
 * ORL_ERR_CANCELLED when *cancel or the client has hung up. Where the child died, asking->met says
 * of what, and the error names the bound: ORL_ERR_LIMIT, or ORL_ERR_UNSUPPORTED of a fault;
 * ORL_ERR_NOMEM where it was none of its own.
 */
int orl_lanes_run(struct orl_asking *asking, const json_t *request, json_t **ret_result,
                  struct orl_error *err);

#endif
