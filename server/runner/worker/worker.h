/*
 * One running job on the libuv pool.
 *
 * The loop thread queues one libuv work for each thread of the job's thread pool. The first is the
 * lead thread: it reads the document, runs the request, and writes the results. The others work for
 * the thread pool (oriel/base/thread_pool.h). They run at a lower priority than the loop. Progress
 * is reported by atomics. News of maps and of studies go through a mutex that is held for copies
 * only, so a status poll never waits. Nothing here accesses the database.
 *
 * Intermediate results are in the work folder. A render job with a goal has results after each of
 * its rounds. Other jobs have each view as soon as it is rendered, and jobs of several skies the
 * result of each sky. Views, skies, and rows of an annual job stay there if the job is stopped
 * rather than cancelled, or the daemon is killed (checkpoints.h). If a job is cancelled, its
 * finished skies become its results.
 *
 * Results: written to partial/<job>, synced, then moved to results/<job> as a whole; only then is
 * done called with code 0.
 *
 * Ownership: start takes the bundle; the worker frees itself after done returns.
 * Threads: every function here on the loop thread.
 */
#ifndef ORL_SERVER_RUNNER_WORKER_WORKER_H
#define ORL_SERVER_RUNNER_WORKER_WORKER_H

#include <uv.h>

#include <oriel/annual/annual_report.h>
#include <oriel/job/run.h>
#include <oriel/job/study.h>

#include "distributed/distributed_job.h"
#include "health/metrics.h"
#include "runner/runner.h"
#include "store/files/scene_bundle.h"
#include "store/rows/stored_jobs.h"

struct orl_worker;

/* ORL_WORKER_WARNINGS equals ORL_JOB_WARNINGS of job_output.h. */
enum { ORL_WORKER_SKY = 80, ORL_WORKER_WARNINGS = 32 };

/* A BSDF that a job has made, which scenes can name by its id. Owns its summary. */
#define ORL_BSDF_MADE_FILE "bsdf.xml" /* its file in the results */
struct orl_made_bsdf {
    char id[ORL_SHA_HEX], name[256]; /* name: for messages */
    uint64_t bytes;
    char *summary; /* JSON text, like that of an uploaded BSDF */
};
void orl_made_bsdf_free(struct orl_made_bsdf *bsdf); /* NULL is allowed */

struct orl_worker_outcome {
    int code;             /* 0 or a negative orl_err */
    struct orl_error err; /* reason if code is not 0 */
    struct orl_job_tally tally;
    /* JSON text, see job_output.h; owned by done, or NULL. A cancelled job of several skies has one
     * if some skies were finished; their results are then in results/<job>. */
    char *summary;
    struct orl_made_bsdf *bsdf; /* owned by done, or NULL */
};

struct orl_worker_spec {
    char job_id[ORL_JOB_ID];
    char document_path[ORL_PATH_MAX], document[ORL_SHA_HEX]; /* document: its digest */
    char scene[ORL_SHA_HEX];                                 /* id of the bundle: scene_bundle.h */
    char key[ORL_SHA_HEX];                                   /* key of checkpoints: checkpoints.h */
    struct orl_bundle bundle;
    const struct orl_folders *folders; /* borrowed */
    struct orl_map_store maps;
    struct orl_memory_cache *memory_cache; /* borrowed; or NULL */
    const struct orl_slurm_config *slurm;  /* borrowed; NULL: no job is split into parts */
    uint64_t memory_bytes;                 /* estimate: job_estimate.h */
    uint32_t threads;
    /* Called on the loop thread, once, when no pool thread works for the job any more. */
    void (*done)(void *ctx, const struct orl_worker_outcome *outcome);
    void *ctx;
};

/* An event of a part, for the log. */
struct orl_worker_part_news {
    char what[8], round[ORL_TASK_ROUND_NAME], slurm[32],
        why[200]; /* why: "" if there is no reason */
    uint32_t part;
    double ran_s;
    struct orl_part_limits limits;
};

struct orl_job_progress {
    enum orl_stage stage;
    double stage_fraction, job_fraction;
    double eta_s;                 /* estimated seconds left; NaN: unknown */
    enum orl_technique technique; /* ORL_TECHNIQUE_AUTO until the plan is made */
    struct orl_map_info maps[ORL_RESULT_MAPS];
    size_t n_maps;
    size_t n_views;             /* views that can be fetched, of a job without a goal */
    struct orl_outcome outcome; /* results of a job with a goal, after its first round */
    size_t n_skies, skies_done; /* skies of a job with several; else 0 */
    char sky[ORL_WORKER_SKY];   /* current sky, or "" */
    /* The first few warnings so far, without duplicates; valid until the loop's next turn. */
    const char *const *warnings;
    size_t n_warnings;
    /* Current run of a study, once its first run has started; otherwise runs are 0. */
    struct orl_study_step step;
    size_t n_settings;                    /* points that it will have */
    const struct orl_study_point *points; /* finished points; valid until the loop's next turn */
    size_t n_points;
    struct orl_annual_refinement year; /* accuracy of an annual job after its first round */
    /* Set only where jobs can be split into parts; otherwise "". */
    char why_here[ORL_WHY_MAX]; /* reason why this one is split, or is not */
    bool in_parts;
    struct orl_parts_count parts;
};

/* Starts a job. Takes ownership of spec->bundle even if it fails. */
int orl_worker_start(uv_loop_t *loop, struct orl_worker_spec *spec, struct orl_worker **ret_worker,
                     struct orl_error *err);
/* Asks the job to stop. done is still called, with ORL_ERR_CANCELLED unless the job ended first. */
void orl_worker_cancel(struct orl_worker *worker);
/* Asks the job to stop, but keeps its checkpoints for a restart. */
void orl_worker_stop(struct orl_worker *worker);
/* Returns the oldest news not returned yet; false: none. Loop thread. */
bool orl_worker_part_news(struct orl_worker *worker, struct orl_worker_part_news *ret_news);
void orl_worker_progress(struct orl_worker *worker, struct orl_job_progress *ret_progress);

/*
 * Returns the summary of the intermediate results (job_output.h), and the folder that they are in,
 * which is removed when the job ends. NULL: no results yet. The caller owns the text.
 */
char *orl_worker_results(struct orl_worker *worker, char ret_folder[ORL_PATH_MAX]);

#endif
