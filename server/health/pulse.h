/*
 * The watchdog of the daemon's latency. It measures how long the loop's turns take, during which
 * all other events wait, and how long the pool takes to start work. Once a second it queues empty
 * work on the pool, unless the last one still waits.
 *
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HEALTH_PULSE_H
#define ORL_SERVER_HEALTH_PULSE_H

#include <stdbool.h>
#include <uv.h>

#include "health/metrics.h"

struct orl_pulse {
    uv_loop_t *loop;
    uint64_t turn_ns,
        idle_ns; /* turn_ns: end of the last turn; idle_ns: the loop's total idle time until then */
    struct orl_histogram turns;
    double longest_s; /* longest turn so far */
    uv_work_t ping;
    bool asked;    /* true while a ping is pending */
    double at_s;   /* time of the ping */
    double last_s; /* latency of the last finished ping */
};

/* Starts measuring. Call it before the loop runs. */
void orl_pulse_open(struct orl_pulse *pulse, uv_loop_t *loop);
/* Ends a turn: the loop is about to wait for events. */
void orl_pulse_turn(struct orl_pulse *pulse);
/* Queues a ping on the pool. Called about every second. */
void orl_pulse_ask(struct orl_pulse *pulse);

/* Returns the larger of the pending ping's age and the last one's latency, in seconds. */
double orl_pulse_pool_s(const struct orl_pulse *pulse);

#endif
