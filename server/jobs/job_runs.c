#include "jobs/job_runs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "jobs/job_results.h"
#include "process/limits.h"
#include "process/times.h"
#include "runner/checkpoints.h"
#include "store/rows/scenes.h"

/* ---- BSDFs that jobs make -------------------------------------------------------------------- */

/*
 * A BSDF is stored so that scenes can name it by its id. It is stored before the job becomes
 * succeeded, so clients that see that state find it. Meanwhile the job is `finishing`, as in
 * job_results.h. A job whose BSDF cannot be stored fails. The file's blob is made on the pool.
 */

typedef void bsdf_done(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome);

struct bsdf_storing {
    uv_work_t work;
    struct orl_jobs_job *job;
    struct orl_worker_outcome outcome;
    bsdf_done *done;
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
                                        "cannot store the BSDF: %s", strerror(errno));
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
                     bsdf_done *done)
{
    struct orl_worker_outcome own = *outcome;
    own.code = orl_error_set(&own.err, ORL_ERR_NOMEM, "out of memory for the job's BSDF");
    orl_made_bsdf_free(own.bsdf);
    own.bsdf = NULL;
    done(job, &own);
}

/* Starts to store the BSDF. done is called in a later turn of the loop, with a copy of outcome. The
 * copy has no bsdf, and its code and err report a failure. Returns false if the outcome has no
 * BSDF; done is not called then. */
static bool start_bsdf_storing(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome,
                               bsdf_done *done)
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

/* ---- Leaders and followers ------------------------------------------------------------------- */

static void end_jobs(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                     const struct orl_result_fanout *fanout);

static void add_leader(struct orl_jobs_job *job)
{
    job->next_leader = job->jobs->leaders;
    job->jobs->leaders = job;
}

void orl_runs_remove_leader(struct orl_jobs_job *job)
{
    struct orl_jobs_job **at = &job->jobs->leaders;
    while (*at != job)
        at = &(*at)->next_leader;
    *at = job->next_leader;
}

/* Returns true if no job needs the computation any more. The last follower of a cancelled leader
 * stays a follower after it is cancelled, until it has received the partial results. */
static bool is_abandoned(const struct orl_jobs_job *leader)
{
    const bool cancelled = leader->cancelled || leader->row.state == ORL_JOB_CANCELLED;
    return cancelled && (!leader->followers || leader->followers->cancelled);
}

static bool is_ending(const struct orl_jobs_job *leader)
{
    return leader->requeue || leader->finishing || leader->timed_out || is_abandoned(leader);
}

/* Limits followers, since results for each of them are recorded in one turn of the loop. */
static bool has_max_followers(const struct orl_jobs_job *leader)
{
    size_t count = 0;
    for (const struct orl_jobs_job *job = leader->followers; job; job = job->next_follower)
        count++;
    return count >= ORL_SERVER_DEDUP_FOLLOWERS;
}

/* Returns a job that waits or runs and asks for identical results. */
static struct orl_jobs_job *find_leader(const struct orl_jobs *jobs, const char *identity)
{
    struct orl_jobs_job *leader = *identity ? jobs->leaders : NULL;
    while (leader && (is_ending(leader) || strcmp(leader->row.identity, identity) != 0 ||
                      has_max_followers(leader)))
        leader = leader->next_leader;
    return leader;
}

static void mark_running(struct orl_jobs_job *job)
{
    /* Count the attempt before the start, so that a crash just after the start counts too. */
    job->row.attempts++;
    job->row.started_ms = orl_time_now_ms();
    job->started_s = orl_time_steady_s();
    orl_jobs_set_state(job, ORL_JOB_RUNNING);
}

/* Raises the leader's priority to that of a new follower. */
static void raise_priority(struct orl_jobs_job *leader, const struct orl_jobs_job *job)
{
    struct orl_queue *queue = job->jobs->queue;
    struct orl_worker_outcome failed = {0};
    if (leader->waiting.priority >= job->row.priority)
        return;
    orl_queue_remove(queue, &leader->waiting);
    leader->waiting.priority = job->row.priority;
    failed.code = orl_queue_add(queue, &leader->waiting, orl_jobs_fairness_key(job), &failed.err);
    if (failed.code)
        end_jobs(leader, &failed, NULL);
}

void orl_runs_enqueue(struct orl_jobs_job *job)
{
    struct orl_jobs_job *leader = find_leader(job->jobs, job->row.identity);
    struct orl_error err;
    job->waiting.priority = job->row.priority;
    job->waiting.order = job->row.seq;
    if (leader) {
        orl_dedup_follow(leader, job);
        if (leader->worker)
            mark_running(job);
        else
            raise_priority(leader, job);
    } else if (orl_queue_add(job->jobs->queue, &job->waiting, orl_jobs_fairness_key(job), &err)) {
        orl_jobs_fail(job, &err);
    } else {
        add_leader(job);
    }
}

/* Returns the next waiting job, and leaves it in the queue. */
static struct orl_jobs_job *next_job(const struct orl_jobs *jobs)
{
    struct orl_queue_entry *entry = orl_queue_first(jobs->queue);
    if (!entry)
        return NULL;
    return (struct orl_jobs_job *)((char *)entry - offsetof(struct orl_jobs_job, waiting));
}

/* Copies the list of results into the job. Returns false if there is no memory; the job then has no
 * results. */
static bool copy_outcome(struct orl_jobs_job *job, const char *summary)
{
    char *outcome = summary ? strdup(summary) : NULL;
    free(job->outcome);
    job->outcome = NULL;
    job->outcome_bytes = 0;
    if (summary && (!outcome || !orl_job_results_count(outcome, &job->outcome_bytes))) {
        free(outcome);
        return false;
    }
    job->outcome = outcome;
    return true;
}

/* Ends one job of a computation with its outcome. */
static void end_job(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome)
{
    const bool cancelled = outcome->code == ORL_ERR_CANCELLED && job->cancelled;
    const bool taken = (outcome->code != 0 && !cancelled) || copy_outcome(job, outcome->summary);
    struct orl_error err;
    if (!taken && !cancelled) {
        orl_error_set(&err, ORL_ERR_NOMEM, "out of memory for the job's results");
        orl_jobs_fail(job, &err);
    } else if (outcome->code == 0) {
        orl_jobs_set_state(job, ORL_JOB_SUCCEEDED);
    } else if (cancelled) {
        orl_jobs_set_state(job, ORL_JOB_CANCELLED);
    } else if (outcome->code == ORL_ERR_CANCELLED && job->requeue) {
        job->requeue = false;
        job->row.attempts--;
        job->row.started_ms = 0;
        orl_jobs_set_state(job, ORL_JOB_QUEUED);
        orl_runs_enqueue(job);
    } else {
        orl_jobs_fail(job, &outcome->err);
    }
    /* Remove partial results too, as of a job stopped by the time limit. */
    if ((outcome->code == 0 || outcome->summary) && !orl_job_results_exist(job))
        orl_job_results_remove_files(job->jobs, job->row.id);
}

/* ---- The end of a computation ---------------------------------------------------------------- */

static void end_follower(const struct orl_jobs_job *leader, struct orl_jobs_job *job,
                         const struct orl_worker_outcome *outcome,
                         const struct orl_result_fanout *fanout)
{
    struct orl_worker_outcome own = *outcome;
    job->leader = NULL;
    job->next_follower = NULL;
    if (own.code == 0)
        own.code = orl_result_fanout_find(fanout, leader, job, &own.err);
    else if (job->cancelled && own.summary &&
             orl_result_fanout_find(fanout, leader, job, &own.err) != 0)
        own.summary = NULL; /* cancelled, and without partial results */
    end_job(job, &own);
}

/* Ends the leader, unless it was cancelled before, and all its followers. */
static void end_jobs(struct orl_jobs_job *leader, const struct orl_worker_outcome *outcome,
                     const struct orl_result_fanout *fanout)
{
    const bool requeue = leader->requeue, ended = leader->row.state >= ORL_JOB_SUCCEEDED;
    struct orl_jobs_job *followers = leader->followers;
    orl_runs_remove_leader(leader);
    leader->followers = NULL;
    if (!ended)
        end_job(leader, outcome);
    while (followers) {
        struct orl_jobs_job *job = followers;
        followers = job->next_follower;
        job->requeue = requeue;
        end_follower(leader, job, outcome, fanout);
    }
    if (ended && (outcome->code == 0 || outcome->summary))
        orl_job_results_remove_files(leader->jobs, leader->row.id);
}

/* Returns the outcome; if the time limit stopped the job, with the error of the limit. */
static struct orl_worker_outcome apply_time_limit(const struct orl_jobs_job *leader,
                                                  const struct orl_worker_outcome *outcome)
{
    struct orl_worker_outcome own = *outcome;
    if (outcome->code != ORL_ERR_CANCELLED || !leader->timed_out || is_abandoned(leader) ||
        leader->requeue)
        return own;
    own.code = orl_error_set(&own.err, ORL_ERR_LIMIT,
                             "the job was stopped after %u s, the longest time that a job may run",
                             leader->jobs->env.job_timeout_s);
    orl_error_hint(&own.err, "Ask for less, or give the job its own deadline (accuracy); the "
                             "daemon's --job-timeout sets the limit");
    return own;
}

static void finish_computation(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome,
                               const struct orl_result_fanout *fanout)
{
    struct orl_jobs *jobs = job->jobs;
    const struct orl_worker_outcome own = apply_time_limit(job, outcome);
    job->timed_out = false;
    jobs->n_workers--;
    orl_memory_release(jobs->env.memory, job->row.memory_bytes);
    jobs->alone = false;
    if (job->followers)
        orl_jobs_batch_begin(jobs);
    end_jobs(job, &own, fanout);
    if (jobs->batch)
        orl_jobs_batch_end(jobs);
    orl_jobs_request_sync(jobs);
    orl_metrics_job(jobs->env.metrics, outcome->code ? job->row.state : ORL_JOB_SUCCEEDED,
                    &outcome->tally);
    free(outcome->summary);
    if (jobs->stopping && jobs->n_workers == 0)
        jobs->env.idle(jobs->env.ctx);
    orl_runs_start_next(jobs);
}

static void end_worker(struct orl_jobs_job *job, const struct orl_worker_outcome *outcome)
{
    const bool has_results = outcome->code == 0 || (outcome->summary && is_abandoned(job));
    if (!has_results || !orl_result_fanout_start(job, outcome, finish_computation))
        finish_computation(job, outcome, NULL);
}

void orl_runs_log_parts(const struct orl_jobs_job *job)
{
    const struct orl_log *log = job->jobs->env.log;
    struct orl_worker_part_news news;
    while (job->worker && orl_worker_part_news(job->worker, &news)) {
        const bool failed = strcmp(news.what, "failed") == 0;
        orl_log_event(log, failed ? ORL_LOG_WARN : ORL_LOG_INFO, "job-part", "sssisdiis", "job",
                      job->row.id, "what", news.what, "wave", news.round, "part",
                      (int64_t)news.part, "slurm", *news.slurm ? news.slurm : NULL, "ran_s",
                      news.ran_s, "minutes", (int64_t)news.limits.minutes, "mib",
                      (int64_t)news.limits.mib, "why", *news.why ? news.why : NULL);
    }
}

/* Adds the counts of a job's parts to the totals of ended jobs. */
static void end_parts(const struct orl_jobs_job *job, const struct orl_parts_count *parts)
{
    const struct orl_jobs_env *env = &job->jobs->env;
    orl_metrics_parts(&env->metrics->parts, parts);
    if (parts->rounds > 0)
        orl_log_event(env->log, ORL_LOG_INFO, "job-parts", "siiid", "job", job->row.id, "done",
                      (int64_t)parts->done, "again", (int64_t)parts->again, "waves",
                      (int64_t)parts->rounds, "lost_s", parts->lost_s);
}

static void job_done(void *ctx, const struct orl_worker_outcome *outcome)
{
    struct orl_jobs_job *job = ctx;
    orl_runs_log_parts(job);
    job->worker = NULL;
    end_parts(job, &outcome->tally.parts);
    if (outcome->code == 0 && start_bsdf_storing(job, outcome, end_worker))
        return;
    orl_made_bsdf_free(outcome->bsdf);
    end_worker(job, outcome);
}

static int start_job(struct orl_jobs_job *job, struct orl_error *err)
{
    struct orl_jobs *jobs = job->jobs;
    struct orl_worker_spec spec = {
        .folders = jobs->env.folders,
        .maps = orl_map_cache_store(jobs->env.maps),
        .memory_cache = jobs->env.memory_cache,
        .slurm = jobs->env.slurm,
        .memory_bytes = job->row.memory_bytes,
        .threads = jobs->env.threads / jobs->env.max_running,
        .done = job_done,
        .ctx = job,
    };
    snprintf(spec.job_id, sizeof spec.job_id, "%s", job->row.id);
    orl_checkpoint_key(jobs->env.program,
                       *job->row.identity ? job->row.identity : job->row.document, job->row.scene,
                       spec.key);
    snprintf(spec.document, sizeof spec.document, "%s", job->row.document);
    snprintf(spec.scene, sizeof spec.scene, "%s", job->row.scene);
    orl_blob_path(jobs->env.folders, job->row.document, spec.document_path);
    int rc = orl_scene_files(jobs->env.db, jobs->env.folders, job->row.scene, &spec.bundle, err);
    if (rc)
        return rc;
    orl_jobs_batch_begin(jobs);
    mark_running(job);
    for (struct orl_jobs_job *at = job->followers; at; at = at->next_follower)
        mark_running(at);
    orl_jobs_batch_end(jobs);
    rc = orl_worker_start(jobs->env.loop, &spec, &job->worker, err);
    if (rc == 0) {
        jobs->n_workers++;
        orl_memory_reserve(jobs->env.memory, job->row.memory_bytes);
    }
    return rc;
}

/* Returns true if the job ran when the daemon ended abruptly, and may be the cause. Orderly stops
 * do not count. */
static bool is_suspect(const struct orl_jobs_job *job)
{
    bool suspect = job->row.attempts > 0;
    for (const struct orl_jobs_job *at = job->followers; at && !suspect; at = at->next_follower)
        suspect = at->row.attempts > 0;
    return suspect;
}

/*
 * Returns true if the job's memory is free. A next job that waits also makes large checks of
 * uploads wait. It never waits if nothing else runs that would free memory.
 */
static bool has_memory(struct orl_jobs *jobs, const struct orl_jobs_job *job)
{
    struct orl_memory *memory = jobs->env.memory;
    const bool fits = orl_memory_available(memory) >= job->row.memory_bytes ||
                      (jobs->n_workers == 0 && memory->checks == 0);
    memory->wanted = fits ? 0 : job->row.memory_bytes;
    if (!fits && jobs->waiting_for_memory != job)
        orl_log_event(jobs->env.log, ORL_LOG_INFO, "job-waits-for-memory", "sii", "job",
                      job->row.id, "wants_bytes", (int64_t)job->row.memory_bytes, "free_bytes",
                      (int64_t)orl_memory_available(memory));
    jobs->waiting_for_memory = fits ? NULL : job;
    return fits;
}

void orl_runs_end_memory_wait(const struct orl_jobs_job *job)
{
    if (job->jobs->waiting_for_memory != job)
        return;
    job->jobs->waiting_for_memory = NULL;
    job->jobs->env.memory->wanted = 0;
}

void orl_jobs_memory_freed(struct orl_jobs *jobs)
{
    if (jobs && jobs->waiting_for_memory)
        orl_runs_start_next(jobs);
}

/*
 * Starts jobs while workers and memory allow. A suspect runs alone. So if one of several jobs
 * caused the daemon's end, it fails by itself and the others go on. A suspect keeps its place: no
 * job passes it while the jobs before it end.
 */
void orl_runs_start_next(struct orl_jobs *jobs)
{
    while (!jobs->stopping && !jobs->paused && jobs->n_workers < jobs->env.max_running &&
           !jobs->alone) {
        struct orl_jobs_job *job = next_job(jobs);
        struct orl_worker_outcome failed = {0};
        const bool suspect = job && is_suspect(job);
        if (!job)
            jobs->env.memory->wanted = 0;
        if (!job || (suspect && jobs->n_workers > 0) || !has_memory(jobs, job))
            return;
        orl_queue_pop(jobs->queue);
        failed.code = start_job(job, &failed.err);
        if (failed.code)
            end_jobs(job, &failed, NULL);
        else
            jobs->alone = suspect;
    }
}
