/*
 * Checks of uploads: of what strangers send before it is accepted, in children (keeper.h), for each
 * of which a pool thread waits. At most ORL_SERVER_CHECKS are under way at once, which leaves a
 * pool thread for everybody else, and no more than there is memory for (memory.h); the others wait
 * for their turn (turns.h), as long as --check-timeout, then they are told to come again
 * (503). A check that takes longer than that is given up (its upload is refused, 413), and so are
 * all of them when the daemon stops.
 *
 * Threads: the loop thread, but for what is said to be the pool's.
 */
#ifndef ORL_SERVER_CHECKS_CHECKS_H
#define ORL_SERVER_CHECKS_CHECKS_H

#include <stdatomic.h>
#include <stdbool.h>

#include <uv.h>

#include "checks/lanes.h"
#include "health/memory.h"
#include "http/request.h"
#include "process/config.h"

/* One check; lies in the request's state, all zero at first. */
struct orl_check {
    struct orl_checks *checks;
    struct orl_request *request;
    orl_request_step run, then;
    struct orl_asking asking; /* of children, on the pool */
    atomic_bool cancel;
    atomic_llong started_ms; /* on the steady clock; 0: it waits */
    bool late, starved;      /* that is why it was cancelled: too long at it, or waiting, ... */
    bool yields;             /* ... or others are to have their turn */
    bool whole;              /* it is granted all the memory that one may have */
    bool is_long;            /* it has yielded before */
    long long waits_since_ms;
    struct orl_check *next;
};

/* Borrows what is not its own. */
struct orl_checks {
    const struct orl_config *config;
    struct orl_memory *memory;
    struct orl_lanes *lanes;  /* to children */
    void (*freed)(void *ctx); /* memory that jobs may wait for is free again */
    void *ctx;
    bool stopping;                       /* all of them are to end */
    struct orl_check *running, *waiting; /* waiting: the first come first */
    unsigned count;                      /* that run */
    uv_timer_t turns;                    /* while any waits */
};

void orl_checks_open(struct orl_checks *checks, uv_loop_t *loop);
/* When the loop is to end; none may be under way. */
void orl_checks_close(struct orl_checks *checks);

/*
 * As orl_request_work, when it is its turn: run on the pool is to ask children by check->asking
 * (ask.h), then calls orl_check_ended before anything else. It may run up to three times:
 * once more with more memory, and once more after it has yielded.
 */
void orl_check_begin(struct orl_checks *checks, struct orl_check *check,
                     struct orl_request *request, orl_request_step run, orl_request_step then);

/*
 * Lets the next one begin. False: there is nothing more to do for now: it is done again, or what
 * was asked has been answered for, since the daemon stops, is short of memory, or the client is
 * gone. Where the check took too long *rc and err say so.
 */
bool orl_check_ended(struct orl_check *check, int *rc, struct orl_error *err);

/* To be called every second or so, and when the daemon stops. */
void orl_checks_sweep(struct orl_checks *checks);

#endif
