/*
 * What a worker's lead does: reads the document, runs it, keeps and writes what comes of it. Inside
 * of worker.h; between worker.c and worker_*.c alone.
 */
#ifndef ORL_SERVER_RUNNER_WORKER_RUN_H
#define ORL_SERVER_RUNNER_WORKER_RUN_H

#include <jansson.h>
#include <pthread.h>
#include <stdatomic.h>

#include <oriel/eta.h>

#include "runner/job_output.h"
#include "runner/worker.h"

enum { ORL_WORKER_WHOLE = 1000000, ORL_WORKER_NEWS = 4096 };

/* The job being rendered: the document's, or that under one of its skies. */
struct orl_worker_part {
    const struct orl_job *job;
    const char *prefix;    /* of its files' names */
    json_t *files;         /* what it has made so far, as job_output.h lists it */
    struct orl_error lost; /* why one of them is not there */
};

struct orl_worker {
    struct orl_worker_spec spec;
    struct orl_crew *crew;
    struct orl_worker_member *members;
    uint32_t queued;                   /* works that have not come back; loop thread */
    struct orl_worker_outcome outcome; /* the lead's, then the loop's once all are back */
    atomic_bool cancel, stopped;
    bool keeps; /* parts that are done, when stopped; the lead's */
    atomic_int stage, stage_ppm, job_ppm, technique;
    pthread_mutex_t news_mutex;
    struct orl_eta eta; /* by the steady clock */
    struct orl_map_info maps[ORL_RESULT_MAPS];
    size_t n_maps;
    struct orl_outcome rounds; /* as the last round left it */
    char *results;             /* their summary, or that of the views done; owned */
    size_t n_views;            /* done */
    json_t *files;             /* theirs; the lead's */
    size_t n_skies, skies_done;
    char sky[ORL_WORKER_SKY];            /* that is under way, of several */
    char *warnings[ORL_WORKER_WARNINGS]; /* owned; those below n_warnings never change */
    size_t n_warnings;
    struct orl_worker_part part; /* the lead's, while it renders */
    char output[ORL_PATH_MAX];   /* where they are; set before there are any */
    struct orl_study_step step;
    struct orl_study_point *points; /* room for n_settings; those below n_points never change */
    size_t n_settings, n_points;
    struct orl_annual_refinement year; /* as the last round of a year left it */
    struct orl_sharing sharing;        /* the lead's, of a job in parts */
    bool in_parts;                     /* set before the run */
    char why_here[ORL_WHY_MAX];
    struct orl_parts_count parts;
    struct orl_worker_part_news *news; /* owned: a ring of ORL_WORKER_NEWS; or NULL */
    size_t n_news, first_news;
};

/* Everything the lead does; returns the job's code. */
int orl_worker_lead(struct orl_worker *worker, struct orl_error *err);

/* ---- What kinds of jobs do, by worker_run.c's table --------------------------------------------
 */

/* worker_study.c, worker_annual.c, worker_bsdf.c; of render jobs the two below. */
int orl_worker_run_study(struct orl_worker *worker, struct orl_task *task,
                         const struct orl_files *files, struct orl_error *err);
int orl_worker_run_annual(struct orl_worker *worker, struct orl_task *task,
                          const struct orl_files *files, struct orl_error *err);
int orl_worker_run_bsdf(struct orl_worker *worker, struct orl_task *task,
                        const struct orl_files *files, struct orl_error *err);
int orl_worker_run_fit(struct orl_worker *worker, struct orl_task *task,
                       const struct orl_files *files, struct orl_error *err);

/* ---- worker_render.c ---------------------------------------------------------------------------
 */

/* What orl_run is to tell of a job without several skies, and of one sky. */
struct orl_run_env orl_worker_env(struct orl_worker *worker, const struct orl_files *files);
/* News of the seconds that the job has left; NaN is none. */
void orl_worker_take_left(struct orl_worker *worker, double left_s);
/* Shows the files that are done. */
void orl_worker_show_files(struct orl_worker *worker);
/* Adds what a run met with, however it ended, and the seconds of one that went well. */
void orl_worker_spent(void *ctx, const struct orl_result *spent);
void orl_worker_add_times(struct orl_worker *worker, const struct orl_result *result);
int orl_worker_render(struct orl_worker *worker, const struct orl_job *job,
                      const struct orl_files *files, struct orl_error *err);

/* ---- worker_shared.c ---------------------------------------------------------------------------
 */

/* Whether the job goes in parts; then all is laid out for them. The caller ends it, after an error,
 * too. */
int orl_worker_share(struct orl_worker *worker, const struct orl_task *task, struct orl_error *err);
/* With the run's code: what a job that was stopped has made, and its tasks, are left for when it
 * starts anew. */
void orl_worker_unshare(struct orl_worker *worker, int code);

/* ---- worker_skies.c ----------------------------------------------------------------------------
 */

int orl_worker_render_skies(struct orl_worker *worker, const struct orl_job *job,
                            const struct orl_files *files, struct orl_error *err);

#endif
