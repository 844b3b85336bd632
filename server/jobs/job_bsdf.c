#include "jobs/job_bsdf.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "jobs/job_runs.h"
#include "store/rows/scenes.h"

struct bsdf_storing {
    uv_work_t work;
    struct orl_jobs_job *job;
    struct orl_worker_outcome outcome;
    orl_job_bsdf_done *done;
};

/* Makes the blob as a hard link to the results' file; neither is ever written to again. */
static void store_blob(uv_work_t *work)
{
    struct bsdf_storing *k = work->data;
    const struct orl_folders *folders = k->job->jobs->env.folders;
    char from[ORL_PATH_MAX], to[ORL_PATH_MAX];
    orl_folders_path(folders, from, "results/%s/" ORL_BSDF_MADE_FILE, k->job->row.id);
    orl_folders_temporary(folders, to);
    if (link(from, to) != 0) {
        k->outcome.code = orl_error_set(&k->outcome.err, orl_err_of_errno(errno),
                                        "cannot keep the BSDF: %s", strerror(errno));
        return;
    }
    k->outcome.code = orl_blob_store(folders, to, k->outcome.bsdf->id, &k->outcome.err);
    if (k->outcome.code)
        unlink(to);
}

static void insert_bsdf(uv_work_t *work, int status)
{
    struct bsdf_storing *k = work->data;
    const struct orl_jobs_env *env = &k->job->jobs->env;
    struct orl_worker_outcome *outcome = &k->outcome;
    struct orl_made_bsdf *bsdf = outcome->bsdf;
    bool created;
    (void)status;
    if (outcome->code == 0)
        outcome->code = orl_bsdf_insert(env->db, bsdf->id, bsdf->name, bsdf->bytes, bsdf->summary,
                                        &created, &outcome->err);
    orl_blobs_release(env->blobs, bsdf->id);
    orl_made_bsdf_free(bsdf);
    outcome->bsdf = NULL;
    k->job->finishing = false;
    k->done(k->job, outcome);
    free(k);
}

/* Fails the job for want of memory, as if its BSDF could not be stored. */
static void fail_job(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome,
                     orl_job_bsdf_done *done)
{
    struct orl_worker_outcome own = *outcome;
    own.code = orl_error_set(&own.err, ORL_ERR_NOMEM, "out of memory for the job's BSDF");
    orl_made_bsdf_free(own.bsdf);
    own.bsdf = NULL;
    done(job, &own);
}

bool orl_job_bsdf_start(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome,
                        orl_job_bsdf_done *done)
{
    const struct orl_jobs_env *env = &job->jobs->env;
    struct bsdf_storing *k = outcome->bsdf ? calloc(1, sizeof *k) : NULL;
    if (!outcome->bsdf)
        return false;
    if (!k || orl_blobs_claim(env->blobs, outcome->bsdf->id, NULL)) {
        free(k);
        fail_job(job, outcome, done);
        return true;
    }
    k->work.data = k;
    k->job = job;
    k->outcome = *outcome;
    k->done = done;
    job->finishing = true;
    uv_queue_work(env->loop, &k->work, store_blob, insert_bsdf);
    return true;
}
