/*
 * The work of a job's lead thread: it reads the document, runs it, and stores the results. Internal
 * to worker.h; only worker.c and worker_*.c include it.
 */
#ifndef ORL_SERVER_RUNNER_WORKER_WORKER_RUN_H
#define ORL_SERVER_RUNNER_WORKER_WORKER_RUN_H

#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

#include <oriel/base/eta.h>

#include "runner/job_output.h"
#include "runner/worker/worker.h"

enum { ORL_WORKER_WHOLE = 1000000, ORL_WORKER_NEWS = 4096 };

/* The part being rendered: the document's job, or that job under one of its skies. */
struct orl_worker_part {
    const struct orl_job *job;
    const char *prefix;    /* prefix of its files' names */
    json_t *files;         /* files made so far, as job_output.h lists them */
    struct orl_error lost; /* reason why one of the files is missing */
};

struct orl_worker {
    struct orl_worker_spec spec;
    struct orl_thread_pool *pool;
    struct orl_worker_member *members;
    uint32_t queued;                   /* pool works that have not come back; loop thread */
    struct orl_worker_outcome outcome; /* the lead's, then the loop's once all are back */
    atomic_bool cancel, stopped;
    bool keeps_checkpoints; /* true if checkpoints stay when stopped; used by the lead */
    atomic_int stage, stage_ppm, job_ppm, technique;
    pthread_mutex_t news_mutex;
    struct orl_eta eta; /* by the monotonic clock */
    /* News of the job, except its stage, fractions, technique and remaining time: see above. */
    struct orl_job_progress progress;
    char *results;                       /* summary of the intermediate results; owned */
    json_t *files;                       /* files of the results; used by the lead */
    char *warnings[ORL_WORKER_WARNINGS]; /* owned; entries below n_warnings never change */
    struct orl_worker_part part;         /* used by the lead while it renders */
    char output[ORL_PATH_MAX];           /* folder of the results; set before there are any */
    struct orl_study_point *points; /* room for n_settings; entries below n_points never change */
    struct orl_distributed_job distributed; /* used by the lead, of a job in parts */
    struct orl_worker_part_news *news;      /* owned: a ring of ORL_WORKER_NEWS; or NULL */
    size_t n_news, first_news;
};

/* Does the lead's work. Returns the job's code. */
int orl_worker_lead(struct orl_worker *worker, struct orl_error *err);

/* ---- Runners of each kind of job, for worker_run.c's table ---------------------------------- */

/* Defined in worker_annual.c and worker_bsdf.c; render jobs use the functions below. */
int orl_worker_run_annual(struct orl_worker *worker, struct orl_job_request *job_request,
                          const struct orl_files *files, struct orl_error *err);
int orl_worker_run_bsdf(struct orl_worker *worker, struct orl_job_request *job_request,
                        const struct orl_files *files, struct orl_error *err);
int orl_worker_run_fit(struct orl_worker *worker, struct orl_job_request *job_request,
                       const struct orl_files *files, struct orl_error *err);

/* ---- worker_render.c ------------------------------------------------------------------------ */

/* Returns the callbacks of orl_run, for a job without several skies and for one sky. */
struct orl_run_env orl_worker_env(struct orl_worker *worker, const struct orl_files *files);
/* Reports the seconds that the job has left; NaN: no estimate. */
void orl_worker_set_eta(struct orl_worker *worker, double left_s);
/* Adds the health counters of a run, however it ended. */
void orl_worker_add_health(void *ctx, const struct orl_result *spent);
int orl_worker_render(struct orl_worker *worker, const struct orl_job *job,
                      const struct orl_files *files, struct orl_error *err);
/* Renders a job of several skies. */
int orl_worker_render_skies(struct orl_worker *worker, const struct orl_job *job,
                            const struct orl_files *files, struct orl_error *err);

/* ---- worker_parts.c ------------------------------------------------------------------------ */

/* Decides if the job is split into parts, and sets up its shared folder. The caller must call
 * orl_worker_end_parts, even after an error. */
int orl_worker_begin_parts(struct orl_worker *worker, const struct orl_job_request *job_request,
                           struct orl_error *err);
/* Ends the distributed job. code: the run's code. For a stopped job, finished parts and pending
 * tasks stay for the restart. */
void orl_worker_end_parts(struct orl_worker *worker, int code);

#endif
