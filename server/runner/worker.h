/*
 * One running job on the libuv pool.
 *
 * The loop thread queues as many pool works as the crew has members: the first leads (reads the
 * document, runs what it asks for, writes the results), the others serve it
 * (oriel/crew.h). They run at a lower priority than the loop. Progress goes through atomics, and
 * news of maps and of studies through a mutex that is held for copies only, so that a status poll
 * never waits. Nothing here touches the database.
 *
 * A render job with a goal has results after each of its rounds, any other has each view as soon as
 * it is rendered, in the folder that it works in, and one of several skies the result of each; the
 * latter two's stay there when it is stopped rather than cancelled, and when the daemon is killed
 * (checkpoints.h), as do rows of a year. Skies that are done stay for good when the job is
 * cancelled.
 *
 * Results: written to partial/<job>, synced, then moved to results/<job> as a whole; only then done
 * is called with code 0.
 *
 * Ownership: start takes the bundle; the worker frees itself after done returns.
 * Threads: every function here on the loop thread.
 */
#ifndef ORL_SERVER_RUNNER_WORKER_H
#define ORL_SERVER_RUNNER_WORKER_H

#include <uv.h>

#include <oriel/annual_report.h>
#include <oriel/run.h>
#include <oriel/study.h>

#include "health/metrics.h"
#include "parts/sharing.h"
#include "runner/shared_place.h"
#include "store/bundle.h"
#include "store/jobs.h"

struct orl_worker;

enum { ORL_WORKER_SKY = 80, ORL_WORKER_WARNINGS = 32 }; /* as in job_output.h */

/* A BSDF that a job has made, for scenes to name by its id. Owned. */
#define ORL_BSDF_MADE_FILE "bsdf.xml" /* of the results */
struct orl_made_bsdf {
    char id[ORL_SHA_HEX], name[256]; /* name: for messages */
    uint64_t bytes;
    char *summary; /* JSON text, as of one that is uploaded */
};
void orl_made_bsdf_free(struct orl_made_bsdf *bsdf); /* NULL is allowed */

struct orl_worker_outcome {
    int code;             /* 0 or a negative orl_err */
    struct orl_error err; /* why, when code is not 0 */
    struct orl_job_tally tally;
    /* JSON text, see job_output.h; owned by done, or NULL. A cancelled job of several skies has one
     * when some of them were done: their results are where they stay. */
    char *summary;
    struct orl_made_bsdf *bsdf; /* owned by done, or NULL */
};

struct orl_worker_spec {
    char job_id[ORL_JOB_ID];
    char document_path[ORL_PATH_MAX], document[ORL_SHA_HEX]; /* and its digest */
    char scene[ORL_SHA_HEX];                                 /* what the bundle is: bundle.h */
    char key[ORL_SHA_HEX];                                   /* of what is kept: checkpoints.h */
    struct orl_bundle bundle;
    const struct orl_folders *folders; /* borrowed */
    struct orl_map_store maps;
    struct orl_shelf *shelf;              /* borrowed; or NULL */
    const struct orl_shared_place *place; /* borrowed; NULL: no job goes in parts */
    uint64_t memory_bytes;                /* that it is thought to take: job_memory.h */
    uint32_t threads;
    /* On the loop thread, once, when no pool thread works for the job any more. */
    void (*done)(void *ctx, const struct orl_worker_outcome *outcome);
    void *ctx;
};

/* What became of a part, for the log. */
struct orl_worker_part_news {
    char what[8], wave[ORL_WAVE_NAME], slurm[32], why[200]; /* why: "" where there is none */
    uint32_t part;
    double ran_s;
    struct orl_part_limits limits;
};

struct orl_job_progress {
    enum orl_stage stage;
    double stage_fraction, job_fraction;
    double eta_s;                 /* seconds that the job is thought to have left; NaN: not known */
    enum orl_technique technique; /* ORL_TECHNIQUE_AUTO until the plan is made */
    struct orl_map_info maps[ORL_RESULT_MAPS];
    size_t n_maps;
    size_t n_views;             /* there to fetch, of a job without a goal */
    struct orl_outcome outcome; /* of a job with a goal, after its first round */
    size_t n_skies, skies_done; /* of a job with several; else 0 */
    char sky[ORL_WORKER_SKY];   /* the one under way, or "" */
    /* The first few so far, each once; valid until the loop's next turn. */
    const char *const *warnings;
    size_t n_warnings;
    /* Of a study, once its first run is under way; else runs are 0. */
    struct orl_study_step step;
    size_t n_settings;                    /* points it will have */
    const struct orl_study_point *points; /* those it has; valid until the loop's next turn */
    size_t n_points;
    struct orl_annual_refinement year; /* of one with accuracy, after its first round */
    /* Where jobs may go in parts; "" else. */
    char why_here[ORL_WHY_MAX]; /* this one does, or does not, since */
    bool in_parts;
    struct orl_parts_count parts;
};

/* Takes spec->bundle whether it succeeds or not. */
int orl_worker_start(uv_loop_t *loop, struct orl_worker_spec *spec, struct orl_worker **ret_worker,
                     struct orl_error *err);
/* Asks it to stop; done still comes, with ORL_ERR_CANCELLED unless it was faster. */
void orl_worker_cancel(struct orl_worker *worker);
/* The same, but what is done is kept for when it starts anew. */
void orl_worker_stop(struct orl_worker *worker);
/* The oldest since it was asked last; false: there is none. Loop thread. */
bool orl_worker_part_news(struct orl_worker *worker, struct orl_worker_part_news *ret_news);
void orl_worker_progress(struct orl_worker *worker, struct orl_job_progress *ret_progress);

/*
 * What a job has to show before it ends: the summary of its results as they stand (job_output.h)
 * and the folder that they are in, which goes when the job ends. NULL: nothing yet. The caller's.
 */
char *orl_worker_results(struct orl_worker *worker, char ret_folder[ORL_PATH_MAX]);

#endif
