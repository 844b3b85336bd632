/*
 * What the daemon has done since it started, counted for Prometheus (text format 0.0.4, as
 * handle_metrics.c writes it). What is so now (queue, connections, cache) is asked of its owners
 * when somebody looks.
 *
 * Histograms are cumulative on the way out only: an observation adds to one bucket.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HEALTH_METRICS_H
#define ORL_SERVER_HEALTH_METRICS_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/run.h>

#include "parts/sharing.h"
#include "store/jobs.h"

enum { ORL_METRICS_BUCKETS = 14, ORL_METRICS_ROUTES = 48, ORL_METRICS_CLASSES = 6 };

struct orl_histogram {
    uint64_t buckets[ORL_METRICS_BUCKETS + 1]; /* the last: above every bound */
    double sum;
};

/* What the computation of a job, or of a study's many, took and met with, however it ended. */
struct orl_job_tally {
    double stages_s[ORL_STAGE_COUNT]; /* of a render job that succeeded; else zeros */
    struct orl_health health;
    struct orl_parts_count parts; /* of one in parts */
};

struct orl_metrics {
    struct orl_histogram stages[ORL_STAGE_COUNT];
    /* By the route's place in the table (behind the last: no route), and hundreds of the status;
     * 0: the connection broke before there was an answer. */
    struct orl_histogram http[ORL_METRICS_ROUTES][ORL_METRICS_CLASSES];
    uint64_t ended[ORL_JOB_STATE_COUNT]; /* jobs that ran, by the state they ended in */
    struct orl_health health;
    struct orl_parts_count parts; /* of jobs that do not run any more; what waits or runs is 0 */
};

/* Upper bounds of the buckets, seconds: of requests, of stages. */
extern const double orl_metrics_http_s[ORL_METRICS_BUCKETS];
extern const double orl_metrics_stage_s[ORL_METRICS_BUCKETS];

/* Into the buckets of requests. */
void orl_metrics_observe(struct orl_histogram *histogram, double seconds);
void orl_metrics_request(struct orl_metrics *metrics, size_t route, unsigned status,
                         double seconds);
/* A run came back, and the job is in that state now. A tally of zeros adds nothing. */
void orl_metrics_job(struct orl_metrics *metrics, enum orl_job_state state,
                     const struct orl_job_tally *tally);
/* Adds what may be added up of the parts of a job. */
void orl_metrics_parts(struct orl_parts_count *sum, const struct orl_parts_count *parts);

#endif
