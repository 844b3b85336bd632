/*
 * The watchdog of the daemon's latency. It measures how long the loop's turns take, during which
 * all other events wait, and how long the pool takes to start work. Once a second it queues empty
 * work on the pool, unless the last one still waits.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HEALTH_LOOP_WATCHDOG_H
#define ORL_SERVER_HEALTH_LOOP_WATCHDOG_H

#include <stdbool.h>
#include <uv.h>

#include "health/metrics.h"

struct orl_loop_watchdog {
    uv_loop_t *loop;
    uint64_t turn_ns,
        idle_ns; /* turn_ns: end of the last turn; idle_ns: the loop's total idle time until then */
    struct orl_histogram turns;
    double longest_s; /* longest turn so far */
    uv_work_t ping;
    bool pending;     /* true while a ping is pending */
    double sent_s;    /* time of the ping */
    double latency_s; /* latency of the last finished ping */
};

/* Starts measuring. Call it before the loop runs. */
void orl_loop_watchdog_open(struct orl_loop_watchdog *watchdog, uv_loop_t *loop);
/* Ends a turn: the loop is about to wait for events. */
void orl_loop_watchdog_end_turn(struct orl_loop_watchdog *watchdog);
/* Queues a ping on the pool. Called about every second. */
void orl_loop_watchdog_ping(struct orl_loop_watchdog *watchdog);

/* Returns the larger of the pending ping's age and the last one's latency, in seconds. */
double orl_loop_watchdog_pool_s(const struct orl_loop_watchdog *watchdog);

#endif
