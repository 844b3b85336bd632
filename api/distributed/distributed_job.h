/*
 * A job shared between processes (oriel/job/job_tasks.h). All of them see its folder (below),
 * which has the document, its files by name and digest, the tasks already made, and the parts. A
 * part is a file that names the tasks to make. `oriel part` executes one part, on any machine.
 *
 * A round is the set of tasks that a run requests at one time. They are divided, in order, into
 * parts of about equal work. The division depends only on the job and the number of parts. A part
 * that is lost or fails is tried three times; then the job ends with that part's error. A part
 * that exceeds Slurm's limit of time or memory is restarted with twice as much, at most five
 * times. These restarts do not count as tries (runner.h). A stopped run leaves the folder. The
 * next run of the same job, by the same version, reuses its tasks and waits for its parts that
 * are still active.
 */
#ifndef ORL_DISTRIBUTED_DISTRIBUTED_JOB_H
#define ORL_DISTRIBUTED_DISTRIBUTED_JOB_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

#include <oriel/base/error.h>
#include <oriel/job/job_tasks.h>
#include <oriel/job/run.h>

#include "distributed/runner.h"

enum { ORL_PARTS_MOST = 1000, ORL_PARTS_USUAL = 64 };

/* Counts of a run's parts by state. */
struct orl_parts_count {
    uint64_t waiting, running, done;
    uint64_t again; /* restarts, by this program or by Slurm */
    double lost_s;  /* seconds that the restarted parts had run */
    uint64_t held;  /* waiting parts held back until the shared folder's disk has room */
    uint32_t rounds;
};

/* An event of a part, for a log. All pointers are borrowed. */
struct orl_part_event {
    const char *what; /* "start", "end", "again", "failed" */
    const char *round;
    uint32_t part, task; /* task: Slurm's array job number; 0: none or unknown */
    double ran_s;        /* seconds that it was seen running */
    struct orl_part_limits limits;
    const char *why; /* reason for "again" or "failed"; else NULL */
};

/* Configuration; all pointers are borrowed until orl_distributed_job_done. */
struct orl_distributed_job_spec {
    const char *folder; /* the job's own folder: created, or reused */
    const json_t *doc;  /* the document; it names the scene's files by their names in files */
    const struct orl_shared_file *files;
    size_t n_files;
    uint32_t threads;         /* threads per part */
    uint32_t most;            /* most parts of a round, and at once */
    uint64_t memory_bytes;    /* estimated memory of the job; 0: unknown (runner.h) */
    const char *program;      /* path of the oriel program */
    bool slurm;               /* true: by Slurm; false: as processes on this machine */
    uint32_t most_processes;  /* number of these processes at once */
    const char *const *words; /* additional options for sbatch */
    size_t n_words;
    const atomic_bool *cancel;
    const atomic_bool *detach;  /* NULL, or a flag: if set, active parts outlive a cancel */
    double (*now_s)(void *ctx); /* a monotonic clock; accepts any ctx */
    /* Called by the lead when the count has changed. May be NULL. */
    void (*reported)(void *ctx, const struct orl_parts_count *count);
    /* Called by the lead for each event of a part. May be NULL. */
    void (*part_event)(void *ctx, const struct orl_part_event *event);
    void *ctx;
};

struct orl_distributed_job {
    struct orl_job_tasks tasks;
    struct orl_map_store store;
    struct orl_shared_store shared_store;
    struct orl_runner runner;
    struct orl_distributed_job_spec spec;
    char folder[4096], job[ORL_JOB_TASK_KEY];
    size_t n_reused; /* reused tasks of an earlier run */
    time_t began;
    struct orl_parts_count count, reported;
    const struct orl_job_tasks_watch *watch; /* for the active round; or NULL */
    uint64_t parts;                          /* parts started, including restarts */
    double opened_s, load_s;      /* time of opening; seconds until the first round, 0: none yet */
    double estimated_s, actual_s; /* estimated and actual seconds of ended parts */
};

/* Creates the folder and the runner. Call orl_distributed_job_done afterwards, also after an error.
 */
int orl_distributed_job_open(struct orl_distributed_job *distributed,
                             const struct orl_distributed_job_spec *spec, struct orl_error *err);
/* Ends the distributed job. remove: also removes the folder with all tasks. */
void orl_distributed_job_done(struct orl_distributed_job *distributed, bool remove);

/* Ends an abandoned job: cancels its Slurm tasks and removes its folder. May take a minute.
 * After an error some of it may be left. */
int orl_distributed_job_abandon(const char *folder, double (*now_s)(void *ctx),
                                struct orl_error *err);

/*
 * The folder of a shared job on disk (shared_folder.c):
 *
 *     job.json, files.json ({"NAME": "SHA-256"}), files/NAME   the job
 *     store/KIND-KEY.opm                                       tasks made
 *     WAVE-NUMBER.json, each with .done or .error              parts
 *     WAVE.wave                                                a round that has not ended
 *     WAVE.slurm                                               Slurm's job numbers
 *
 * Only its owner has access.
 */

struct orl_shared_file {
    const char *name, *path; /* name in the job, and path of the file */
};

/*
 * Creates the job's folder at path. It replaces the folder of another job, but keeps one of the
 * same job by the same program version. A folder that no run created is left alone: an error.
 * *ret_job: digest of the document and files. *ret_earlier: number of tasks from an earlier
 * run.
 */
int orl_shared_folder_make(const char *path, const json_t *doc, const struct orl_shared_file *files,
                           size_t n_files, char ret_job[ORL_JOB_TASK_KEY], size_t *ret_earlier,
                           struct orl_error *err);

/* Computes the digest of the document and files in such a folder, and checks the files against
 * their digests. */
int orl_shared_folder_verify(const char *folder, char ret_job[ORL_JOB_TASK_KEY], json_t **ret_doc,
                             struct orl_error *err);

/* Makes a network file system look again for files that were absent. */
void orl_shared_folder_refresh(const char *folder);

#endif
