/*
 * Counters for Prometheus, and the watchdog that measures the latency of the event loop and the
 * pool.
 */
#ifndef ORL_SERVER_HEALTH_METRICS_H
#define ORL_SERVER_HEALTH_METRICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include <oriel/job/run.h>

#include "distributed/distributed_job.h"
#include "store/rows/stored_jobs.h"

/*
 * Counters of the daemon since its start, for Prometheus (text format 0.0.4, written by
 * handle_metrics.c). Current values (queue, connections, cache) are read from their owners when
 * metrics are requested.
 *
 * Histograms become cumulative only in the output: an observation adds to one bucket.
 * Threads: the loop thread only.
 */

enum { ORL_METRICS_BUCKETS = 14, ORL_METRICS_ROUTES = 48, ORL_METRICS_CLASSES = 6 };

struct orl_histogram {
    uint64_t buckets[ORL_METRICS_BUCKETS + 1]; /* the last one: above every bound */
    double sum;
};

/* Stage times and health counters of a job's computation, or of all computations of a study,
 * however it ended. */
struct orl_job_tally {
    double stages_s[ORL_STAGE_COUNT]; /* stage times of a successful render job; else zeros */
    struct orl_health health;
    struct orl_parts_count parts; /* counts of a job in parts */
};

struct orl_metrics {
    struct orl_histogram stages[ORL_STAGE_COUNT];
    /* Indexed by the route's place in the table (one past the last: no route), then by hundreds of
     * the status. 0: the connection broke before a reply. */
    struct orl_histogram http[ORL_METRICS_ROUTES][ORL_METRICS_CLASSES];
    uint64_t ended[ORL_JOB_STATE_COUNT]; /* jobs that ran, by their final state */
    struct orl_health health;
    struct orl_parts_count parts; /* counts of ended jobs; waiting and running are 0 */
};

/* Upper bounds of the buckets in seconds, for requests and for stages. */
extern const double orl_metrics_http_s[ORL_METRICS_BUCKETS];
extern const double orl_metrics_stage_s[ORL_METRICS_BUCKETS];

/* Adds a request's duration to the bucket of its route and status. */
void orl_metrics_request(struct orl_metrics *metrics, size_t route, unsigned status,
                         double seconds);
/* Counts a finished run and the job's state. An all-zero tally adds nothing. */
void orl_metrics_job(struct orl_metrics *metrics, enum orl_job_state state,
                     const struct orl_job_tally *tally);
/* Adds the additive counts of a job's parts to *sum. */
void orl_metrics_parts(struct orl_parts_count *sum, const struct orl_parts_count *parts);

/*
 * The watchdog of the daemon's latency. It measures how long the loop's turns take, during which
 * all other events wait, and how long the pool takes to start work. Once a second it queues empty
 * work on the pool, unless the last one still waits.
 *
 * Threads: the loop thread only.
 */

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
