/*
 * Whether the daemon keeps up: how long the loop's turns take, in which everybody else waits, and
 * how long the pool takes to begin with what it is given. Once a second a work that does nothing is
 * queued, unless the last one still waits.
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
        idle_ns; /* when the last turn ended; that the loop had been idle until then */
    struct orl_histogram turns;
    double longest_s; /* turn, ever */
    uv_work_t ping;
    bool asked;    /* the pool, which has not answered yet */
    double at_s;   /* when */
    double last_s; /* that the last answer took */
};

/* Before the loop runs. */
void orl_pulse_open(struct orl_pulse *pulse, uv_loop_t *loop);
/* The loop is about to wait for something to do. */
void orl_pulse_turn(struct orl_pulse *pulse);
/* To be called every second or so. */
void orl_pulse_ask(struct orl_pulse *pulse);

/* That the pool has not answered yet, or that its last answer took. */
double orl_pulse_pool_s(const struct orl_pulse *pulse);

#endif
