/* Checks of uploads (checks.c), and their scheduler (check_scheduler.c). */
#ifndef ORL_SERVER_CHECKS_CHECKS_H
#define ORL_SERVER_CHECKS_CHECKS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "checks/check_client.h"
#include "health/machine_memory.h"
#include "http/request/request.h"
#include "process/config.h"

/*
 * Checks of untrusted uploads before they are accepted. Children (child_checks.h) do the checks; a
 * pool thread waits for each. At most ORL_SERVER_CHECKS run at once, which leaves a pool thread for
 * other work, and no more than memory allows (machine_memory.h). The others wait for their turn, at
 * most for --check-timeout, and are then refused with 503 and Retry-After. A check that runs longer
 * than --check-timeout is cancelled and its upload refused with 413. All checks are cancelled when
 * the daemon stops.
 *
 * Threads: the loop thread, except where the pool is named.
 */

/* One check; part of the request's state. All zero at first. */
struct orl_check {
    struct orl_checks *checks;
    struct orl_request *request;
    orl_request_step run, then;
    struct orl_check_call call; /* request to a child, used on the pool */
    atomic_bool cancel;
    atomic_llong started_ms;        /* on the monotonic clock; 0: still waiting */
    bool timed_out, wait_timed_out; /* cancelled because it ran, or waited, for too long */
    bool preempted;                 /* cancelled to let another check have its turn */
    bool has_full_grant;            /* true if it has the largest memory grant of a single check */
    bool is_long;                   /* true if it has yielded before */
    long long waits_since_ms;
    struct orl_check *next;
};

/* The checks of the daemon. Borrows its pointers. */
struct orl_checks {
    const struct orl_config *config;
    struct orl_memory *memory;
    struct orl_check_pool *check_pool; /* child processes */
    void (*freed)(void *ctx);          /* called when memory that jobs may wait for is free again */
    void *ctx;
    bool stopping;                       /* true once all checks are to end */
    struct orl_check *running, *waiting; /* waiting: in order of arrival */
    unsigned count;                      /* running checks */
    uv_timer_t timer;                    /* runs while any check waits */
};

void orl_checks_open(struct orl_checks *checks, uv_loop_t *loop);
/* Closes the checks before the loop ends. No check may be under way. */
void orl_checks_close(struct orl_checks *checks);

/*
 * Begins a check, like orl_request_work, once it has its turn. `run` executes on the pool: it sends
 * requests to children by check->call (check_client.h). `then` must call orl_check_finish before
 * anything else. `run` may execute up to three times: once more with more memory, and once more
 * after the check has yielded.
 */
void orl_check_begin(struct orl_checks *checks, struct orl_check *check,
                     struct orl_request *request, orl_request_step run, orl_request_step then);

/*
 * Ends a check and starts the next one. Returns false if the caller has nothing more to do for now.
 * Either the check runs again, or the request is already answered: the daemon stops, memory is
 * short, or the client has disconnected. If the check took too long, *rc and err say so.
 */
bool orl_check_finish(struct orl_check *check, int *rc, struct orl_error *err);

/* Cancels checks that ran or waited too long. Called about every second, and at a stop. */
void orl_checks_sweep(struct orl_checks *checks);

/*
 * The scheduler of checks. It keeps long or large uploads of one client from delaying others:
 *
 * - The waiting client with the fewest running checks goes first, then the one that came first. If
 *   there are several clients, none gets all the slots.
 * - A check gets a small memory grant at first (ORL_SERVER_CHECK_FIRST, or its slot's share of the
 *   free memory). If that is not enough, its larger grant still leaves some memory for the others.
 * - A check is long if it has run for more than ORL_SERVER_CHECK_QUICK_MS, or has the larger grant.
 *   One slot is reserved for quick checks. If long checks hold all slots while another check waits,
 *   the last one started yields. It runs again from its start, in one of the other slots, and
 *   yields no more.
 *
 * If n clients have checks waiting, the quick check of another client waits for about n *
 * ORL_SERVER_CHECK_QUICK_MS at most.
 *
 * Threads: the loop thread.
 */

/* Returns the largest memory grant of one check, bytes. */
uint64_t orl_check_memory_limit(const struct orl_checks *checks);

/* Appends the check to the waiting list. */
void orl_check_enqueue(struct orl_checks *checks, struct orl_check *check);
/* Queues the checks whose turn has come on the pool. Cancelled ones are queued too, so that they
 * end with an error. */
void orl_checks_start(struct orl_checks *checks);
/* Removes the check from the running ones; does not start the next one. */
void orl_check_remove_running(struct orl_checks *checks, struct orl_check *check);

#endif
