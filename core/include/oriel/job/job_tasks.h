/*
 * Distributed jobs: a job is split into tasks that many processes, on many machines, can compute.
 * Tasks are photon maps, ranges of sensors, views, skies, chunks of a year's sensors, and runs of a
 * study. The set of tasks depends on the job alone. A task is identified by its kind and a key, a
 * digest of all its inputs. Its result lies in the run's store, as photon maps do.
 *
 * Every process runs the job in the same way. When a run reaches tasks that the store lacks, it
 * calls `claim` to learn which of them it must compute; the others are read from the store. A run
 * that computes no tasks combines the results of the others in the job's own order. The bytes are
 * those of a single process, for any number of processes in any order. A run that computes some of
 * the tasks ends when these are complete. In a job with a goal, rounds depend on earlier rounds;
 * their tasks are requested round by round.
 *
 * Jobs with a deadline are not distributed, since their results depend on the machine.
 */
#ifndef ORIEL_JOB_JOB_TASKS_H
#define ORIEL_JOB_JOB_TASKS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_JOB_TASK_KIND = 16, ORL_JOB_TASK_KEY = 65 };

struct orl_job_task {
    char kind[ORL_JOB_TASK_KIND]; /* "sensors", "view", "sky", "global", "annual", ... */
    char key[ORL_JOB_TASK_KEY];   /* lower-case hex */
    double work;                  /* work relative to other tasks of the same call, above 0 */
    double core_s;  /* single-core seconds, estimated to within a factor of several; 0: not known */
    uint64_t bytes; /* memory in bytes beside that of the job itself; 0: little */
};

/* Progress callback while a run waits: the completed share, 0..1, of the tasks computed by others.
 * Called by the lead thread. */
struct orl_job_tasks_watch {
    void (*reported)(void *ctx, double share);
    void *ctx;
};

struct orl_job_tasks {
    void *ctx;
    const char *job; /* digest of the job and all its files; part of the keys */
    /*
     * Assigns tasks that the store lacks; they are independent of each other. Sets ret_here for
     * those that this run must compute; all are false beforehand. When it returns 0, the others are
     * in the store, or will never be requested. ORL_ERR_CANCELLED ends a run that has computed its
     * tasks. Called by the lead thread. watch may be NULL. NULL: the run computes all tasks; call
     * it by orl_job_tasks_claim.
     */
    int (*claim)(void *ctx, const struct orl_job_task *tasks, size_t n, bool *ret_here,
                 const struct orl_job_tasks_watch *watch, struct orl_error *err);
    /* Called by the lead thread when the run has computed its tasks of a call. True: nothing more
     * is needed from this run; it ends with ORL_ERR_CANCELLED, without combining the others'
     * results. NULL: the run continues. */
    bool (*should_stop)(void *ctx);
};

static inline int orl_job_tasks_claim(const struct orl_job_tasks *tasks,
                                      const struct orl_job_task *wanted, size_t n, bool *ret_here,
                                      const struct orl_job_tasks_watch *watch,
                                      struct orl_error *err)
{
    if (tasks->claim)
        return tasks->claim(tasks->ctx, wanted, n, ret_here, watch, err);
    for (size_t i = 0; i < n; i++)
        ret_here[i] = true;
    return 0;
}

static inline bool orl_job_tasks_should_stop(const struct orl_job_tasks *tasks)
{
    return tasks->should_stop && tasks->should_stop(tasks->ctx);
}

/*
 * Store in a folder shared by many processes on many machines. Tasks and maps are
 * <folder>/<kind>-<key>.opm. Each is written under a name private to the process and then renamed,
 * so that it is whole or absent. If two processes make the same file the later one stays; they are
 * equal. Maps are never topped up there. All fields but the folder are zero beforehand. Used by the
 * lead thread only.
 */
struct orl_shared_store {
    char folder[4096];
    char owner[128];              /* id of this process: host and process number */
    struct orl_job_task *pending; /* missed requests: files to be committed or abandoned */
    size_t n_pending, capacity;
};
struct orl_map_store;
void orl_shared_store_init(struct orl_shared_store *state, struct orl_map_store *ret_store);
void orl_shared_store_done(struct orl_shared_store *state);

#endif
