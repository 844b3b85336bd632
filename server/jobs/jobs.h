/*
 * Jobs: the state machine and the queue, held in memory and mirrored in the database.
 *
 *     queued -> running -> succeeded | failed | cancelled
 *     queued -> cancelled
 *     running -> queued      when the daemon stops or was killed
 *
 * Identical jobs share a computation (job_results.h).
 *
 * A row is written before a client can see the state. To make it safe from a power cut too, the
 * code that answers the client must ask wal.h. Jobs run in the order of job_queue.h, at most as
 * many at once as configured. A job that was running when the daemon was killed is queued again,
 * and from then on runs alone. It fails when the daemon has ended because of it (crash.h)
 * ORL_SERVER_ATTEMPTS times. An orderly stop does not count as an attempt.
 *
 * Memory: one struct orl_jobs_job for every job that has not been removed (about a kilobyte), and
 * its outcome, name and tags.
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_JOBS_JOBS_H
#define ORL_SERVER_JOBS_JOBS_H

#include <jansson.h>
#include <stdbool.h>
#include <uv.h>

#include "cache/map_cache.h"
#include "health/crash.h"
#include "health/machine_memory.h"
#include "jobs/job_queue.h"
#include "process/log.h"
#include "runner/worker/worker.h"
#include "store/durability/wal.h"
#include "store/files/blobs.h"
#include "store/files/removal.h"
#include "store/rows/stored_jobs.h"

struct orl_jobs;

/* One job; read-only outside this folder. */
struct orl_jobs_job {
    struct orl_jobs *jobs;
    struct orl_job_row row; /* outcome and problem point to the two below */
    struct orl_queue_entry waiting;
    char *outcome, *problem;   /* JSON text, owned */
    struct orl_labels labels;  /* name and tags of the row */
    double achieved;           /* error reached, once requested; job_results.h */
    bool measured;             /* achieved has been read */
    uint64_t outcome_bytes;    /* size of the files in the outcome, once the job has ended */
    struct orl_worker *worker; /* while running; a leader's */
    double started_s;          /* monotonic clock, while running */
    bool cancelled, requeue;   /* how to treat ORL_ERR_CANCELLED from the worker */
    bool timed_out;            /* stopped by the time limit */
    bool finishing;            /* a leader whose results are being copied to its followers */
    bool unsaved;              /* the row in the database is out of date */
    uint64_t commit;           /* commit with the row, or a later one: wal.h */
    bool fetched;              /* the last fetch time is not yet saved to the row */
    /* job_results.h. leader is NULL in a leader. */
    struct orl_jobs_job *leader, *followers, *next_follower, *next_leader;
    struct orl_jobs_job *older, *newer, *same_bucket;
};

struct orl_jobs_env {
    uv_loop_t *loop;
    struct orl_db *db;
    struct orl_wal_sync *wal_sync; /* for commits to db */
    const struct orl_folders *folders;
    struct orl_blobs *blobs;
    struct orl_map_cache *maps;
    struct orl_memory_cache *memory_cache; /* memory cache shared by all jobs; or NULL */
    const struct orl_slurm_config *slurm;  /* NULL: no job is split into parts */
    const struct orl_previous_exit
        *previous_exit;        /* end of the previous daemon; for orl_jobs_open */
    struct orl_memory *memory; /* account of the memory of running jobs */
    char program[ORL_SHA_HEX]; /* checkpoints.h */
    const struct orl_log *log;
    struct orl_metrics *metrics;
    uint32_t threads; /* total over all jobs */
    uint32_t max_running;
    uint32_t job_timeout_s;                  /* time limit of a job */
    bool paused;                             /* initial value of orl_jobs_pause */
    const struct orl_retention_clock *clock; /* clock of the jobs' age */
    uint32_t keep_jobs, keep_days;           /* limits for ended jobs; 0 days: forever */
    /* Called when a job is new, its state has changed, or it was asked to stop. */
    void (*changed)(void *ctx, const struct orl_jobs_job *job);
    void (*removing)(void *ctx,
                     const struct orl_jobs_job *job); /* called before a job is removed */
    void (*idle)(void *ctx); /* called once no job runs after a stop or drain */
    void *ctx;
};

/* Loads every job, recovers those that were running, and starts those that can start. Borrows env's
 * pointers. */
int orl_jobs_open(const struct orl_jobs_env *env, struct orl_jobs **ret_jobs,
                  struct orl_error *err);
void orl_jobs_close(struct orl_jobs *jobs); /* no job may be running; NULL is allowed */

/* Starts no more jobs. Calls env.idle once none runs, possibly before it returns. */
void orl_jobs_drain(struct orl_jobs *jobs);
/* Starts no more jobs, stops running ones and queues them again; then calls env.idle. */
void orl_jobs_stop(struct orl_jobs *jobs);

/* Writes rows that could not be written when they changed, as with a full disk. Called
 * periodically. */
void orl_jobs_save(struct orl_jobs *jobs);

/* Starts jobs that waited for memory, now that more is free. */
void orl_jobs_memory_freed(struct orl_jobs *jobs);

/* While paused, no job starts, as on a full disk; running jobs continue. */
void orl_jobs_pause(struct orl_jobs *jobs, bool paused);

/* Returns true if the queue is full. */
bool orl_jobs_full(const struct orl_jobs *jobs);
/* The properties of a new job. Borrowed. */
struct orl_job_submission {
    enum orl_job_request_kind kind;
    int priority;
    const char *scene, *document; /* the document is a blob */
    const char *identity;         /* job_document.h */
    struct orl_labels labels;     /* copied */
    uint64_t result_bytes;        /* expected */
    uint64_t memory_bytes;        /* job_estimate.h */
    const char *client;           /* handle_jobs.c */
    const char *owner;            /* id of its token; "": tokens are not required */
    const char *request_key;      /* the client's Idempotency-Key, or NULL */
};
/* Returns the job that was submitted with this Idempotency-Key of client and owner less than
 * ORL_SERVER_KEY_S ago; NULL: none. */
int orl_jobs_by_key(struct orl_jobs *jobs, const char *client, const char *owner,
                    const char *request_key, const struct orl_jobs_job **ret_job,
                    struct orl_error *err);
/* Queues a job. *ret_job belongs to jobs. */
int orl_jobs_submit(struct orl_jobs *jobs, const struct orl_job_submission *submission,
                    const struct orl_jobs_job **ret_job, struct orl_error *err);
/* Cancels a job for good. Queued: at once. Running: soon. Ended: ORL_ERR_INVALID unless already
 * cancelled. */
int orl_jobs_cancel(struct orl_jobs *jobs, const char *id, struct orl_error *err);

/*
 * Removes an ended job, with its results. ORL_ERR_INVALID if the job waits, runs, or computes for
 * others.
 */
int orl_jobs_remove(struct orl_jobs *jobs, const char *id, struct orl_error *err);
/* Returns true if the job neither waits nor runs, nor computes for others. */
bool orl_jobs_ended(const struct orl_jobs_job *job);
/* Returns true if a job that waits or runs needs the scene. */
bool orl_jobs_need_scene(const struct orl_jobs *jobs, const char *scene);

const struct orl_jobs_job *orl_jobs_find(const struct orl_jobs *jobs, const char *id);
/*
 * Returns the job with that id, or the only one whose id begins with these digits, ORL_JOB_PREFIX
 * or more. NULL: none, or several (*ret_several).
 */
enum { ORL_JOB_PREFIX = 4 };
const struct orl_jobs_job *orl_jobs_find_prefix(const struct orl_jobs *jobs, const char *prefix,
                                                bool *ret_several);
/* Returns the newest job; ->older leads to the others. */
const struct orl_jobs_job *orl_jobs_newest(const struct orl_jobs *jobs);
/* Returns the name of the job's state for clients. A running job that was asked to stop is
 * "cancelling" until it ends. */
const char *orl_jobs_state_name(const struct orl_jobs_job *job);
extern const char orl_jobs_cancelling[];
/* Returns the worker that computes the job, maybe for others too; NULL if none does. */
struct orl_worker *orl_jobs_worker(const struct orl_jobs_job *job);
/* Calls visit with each running job, including those that share a computation. */
void orl_jobs_running(const struct orl_jobs *jobs,
                      void (*visit)(void *ctx, const struct orl_jobs_job *job), void *ctx);
/* Returns the job's position in the queue: 1 for the next to run; 0 if it does not wait. */
size_t orl_jobs_position(const struct orl_jobs *jobs, const struct orl_jobs_job *job);
/* Returns the client whose turn in the queue the job uses: its token's id, or else its client's
 * name. */
const char *orl_jobs_fairness_key(const struct orl_jobs_job *job);
/* Returns the number of jobs of that token id that wait or run. Time is linear in the number of
 * jobs that wait or run. */
size_t orl_jobs_of_owner(const struct orl_jobs *jobs, const char *owner);
size_t orl_jobs_count(const struct orl_jobs *jobs, enum orl_job_state state);

#endif
