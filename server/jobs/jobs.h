/*
 * Jobs: the state machine and the queue, held in memory and mirrored in the database.
 *
 *     queued -> running -> succeeded | failed | cancelled
 *     queued -> cancelled
 *     running -> queued      when the daemon stops or was killed
 *
 * Identical jobs share a computation (job_share.h).
 *
 * A row is written before a state is shown to anyone; whether it is safe from a power cut too is
 * settling.h's, and for whoever answers to ask. Jobs run in the order of queue.h, at most as
 * many at once as configured. A job that was running when the daemon was killed is queued again,
 * and from then on runs alone; when the daemon has ended through it (blame.h) ORL_SERVER_ATTEMPTS
 * times it fails. An orderly stop does not count as an attempt.
 *
 * Memory: one struct orl_jobs_job for every job that has not been removed (about a kilobyte), and
 * what its outcome, name and tags take.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_JOBS_H
#define ORL_SERVER_JOBS_JOBS_H

#include <jansson.h>
#include <stdbool.h>
#include <uv.h>

#include "cache/map_cache.h"
#include "health/blame.h"
#include "health/memory.h"
#include "jobs/queue.h"
#include "process/log.h"
#include "runner/worker.h"
#include "store/blobs.h"
#include "store/jobs.h"
#include "store/retention_clock.h"
#include "store/settling.h"

struct orl_jobs;

/* What a job is made of; read-only outside jobs.c. */
struct orl_jobs_job {
    struct orl_jobs *jobs;
    struct orl_job_row row; /* outcome and problem point to the two below */
    struct orl_queue_entry waiting;
    char *outcome, *problem;   /* JSON text, owned */
    struct orl_labels labels;  /* row's name and tags */
    double achieved;           /* the error that it came to, once somebody asks; job_results.h */
    bool measured;             /* somebody has */
    uint64_t outcome_bytes;    /* of the files that the outcome lists, once it has ended */
    struct orl_worker *worker; /* while running; a leader's */
    double started_s;          /* steady clock, while running */
    bool cancelled, requeue;   /* what to make of ORL_ERR_CANCELLED */
    bool late;                 /* it was stopped since it ran for too long */
    bool settling;             /* a leader whose results are being given to those who follow */
    bool unsaved;              /* the row in the database is an older one */
    uint64_t commit;           /* that wrote it, or a later one: settling.h */
    bool fetched;              /* its row does not know yet when last */
    /* job_share.h. A leader has leader NULL. */
    struct orl_jobs_job *leader, *followers, *next_follower, *next_leader;
    struct orl_jobs_job *older, *newer, *same_bucket;
};

struct orl_jobs_env {
    uv_loop_t *loop;
    struct orl_db *db;
    struct orl_settling *settling; /* of what is committed to it */
    const struct orl_folders *folders;
    struct orl_blobs *blobs;
    struct orl_map_cache *maps;
    struct orl_shelf *shelf;              /* of all jobs; or NULL */
    const struct orl_shared_place *place; /* NULL: no job goes in parts */
    const struct orl_past *past;          /* how the daemon before ended; while jobs are opened */
    struct orl_memory *memory;            /* whoever starts is held against it */
    char program[ORL_SHA_HEX];            /* program.h */
    const struct orl_log *log;
    struct orl_metrics *metrics;
    uint32_t threads; /* over all jobs */
    uint32_t at_once;
    uint32_t job_timeout_s;                  /* that one may run */
    bool held;                               /* at first: orl_jobs_hold */
    const struct orl_retention_clock *clock; /* by which they grow old */
    uint32_t keep_jobs, keep_days;           /* of those that have ended; no days: for ever */
    /* It is new, or its state has changed, or it has been told to stop. */
    void (*changed)(void *ctx, const struct orl_jobs_job *job);
    void (*leaving)(void *ctx, const struct orl_jobs_job *job); /* it is about to be removed */
    void (*idle)(void *ctx); /* after orl_jobs_stop, when nothing runs any more */
    void *ctx;
};

/* Loads every job, recovers those that were running, starts what can start. Borrows env's parts. */
int orl_jobs_open(const struct orl_jobs_env *env, struct orl_jobs **ret_jobs,
                  struct orl_error *err);
void orl_jobs_close(struct orl_jobs *jobs); /* nothing may run; NULL is allowed */

/* Starts no more jobs; calls env.idle once none runs, maybe before it returns. */
void orl_jobs_drain(struct orl_jobs *jobs);
/* Starts no more jobs, stops those that run and queues them again; then calls env.idle. */
void orl_jobs_stop(struct orl_jobs *jobs);

/* Writes those rows that could not be written when they changed, as with a full disk. To be called
 * now and then. */
void orl_jobs_save(struct orl_jobs *jobs);

/* There is more memory than there was: starts what waited for it. */
void orl_jobs_memory_freed(struct orl_jobs *jobs);

/* While held none starts, as on a full disk; those that run go on. */
void orl_jobs_hold(struct orl_jobs *jobs, bool held);

/* Is there room in the queue? */
bool orl_jobs_full(const struct orl_jobs *jobs);
/* What a new job is. Borrowed. */
struct orl_jobs_order {
    enum orl_task_kind kind;
    int priority;
    const char *scene, *document; /* the document is a blob */
    const char *identity;         /* job_share.h */
    struct orl_labels labels;     /* copied */
    uint64_t result_bytes;        /* to be expected */
    uint64_t memory_bytes;        /* job_memory.h */
    const char *client;           /* client_name.h */
    const char *owner;            /* the id of its token; "": none was needed */
    const char *request_key;      /* the client's Idempotency-Key, or NULL */
};
/* The job that the key of client and owner made less than ORL_SERVER_KEY_S ago; NULL: none. */
int orl_jobs_by_key(struct orl_jobs *jobs, const char *client, const char *owner,
                    const char *request_key, const struct orl_jobs_job **ret_job,
                    struct orl_error *err);
/* Queues a job. *ret_job belongs to jobs. */
int orl_jobs_submit(struct orl_jobs *jobs, const struct orl_jobs_order *order,
                    const struct orl_jobs_job **ret_job, struct orl_error *err);
/* For good. Queued: cancelled at once. Running: soon. Finished: ORL_ERR_INVALID unless cancelled.
 */
int orl_jobs_cancel(struct orl_jobs *jobs, const char *id, struct orl_error *err);

/*
 * Removes a job that has ended, with its results. One that waits or runs, or computes for others,
 * is in use: ORL_ERR_INVALID.
 */
int orl_jobs_remove(struct orl_jobs *jobs, const char *id, struct orl_error *err);
/* Does it neither wait nor run, nor compute for others? */
bool orl_jobs_ended(const struct orl_jobs_job *job);
/* Does a job that waits or runs need the scene? */
bool orl_jobs_need_scene(const struct orl_jobs *jobs, const char *scene);

const struct orl_jobs_job *orl_jobs_find(const struct orl_jobs *jobs, const char *id);
/*
 * The job of that id, or the only one whose id begins so, of ORL_JOB_PREFIX digits at least. NULL:
 * there is none; *ret_several: there are others.
 */
enum { ORL_JOB_PREFIX = 4 };
const struct orl_jobs_job *orl_jobs_find_begun(const struct orl_jobs *jobs, const char *prefix,
                                               bool *ret_several);
/* The newest job; go on with ->older. */
const struct orl_jobs_job *orl_jobs_newest(const struct orl_jobs *jobs);
/* The name of its state, as clients see it: one that runs, and has been told to stop, is
 * "cancelling" until it has. */
const char *orl_jobs_state_name(const struct orl_jobs_job *job);
extern const char orl_jobs_cancelling[];
/* What computes the job, maybe for others too; NULL while nothing does. */
struct orl_worker *orl_jobs_worker(const struct orl_jobs_job *job);
/* Calls visit with each job that runs, those that share a computation too. */
void orl_jobs_running(const struct orl_jobs *jobs,
                      void (*visit)(void *ctx, const struct orl_jobs_job *job), void *ctx);
/* 1 for the next to run; 0 when it does not wait. */
size_t orl_jobs_position(const struct orl_jobs *jobs, const struct orl_jobs_job *job);
/* The client that a job's turn in the queue counts for: its token's id, else its client. */
const char *orl_jobs_turn_key(const struct orl_jobs_job *job);
/* Returns how many jobs of that token's id wait or run. Time goes with the number of all that do.
 */
size_t orl_jobs_of_owner(const struct orl_jobs *jobs, const char *owner);
size_t orl_jobs_count(const struct orl_jobs *jobs, enum orl_job_state state);

#endif
