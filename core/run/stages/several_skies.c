/* Runs the job under several skies, one after the other. */
#include <oriel/job/skies.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/cache/scene_cache.h"
#include "run/distributed/task_work.h"
#include "run/estimate/progress.h"
#include "run/request/job_inputs.h"

/* Rough time under a sky without light, relative to others; for progress only. */
static const double dark_share = 0.1;
/* Weight of a sky's times relative to the next sky's. */
static const double kept = 0.9;
/* Distributed runs: share of the work that other processes do; the remainder is joining their
 * results. */
static const double distributed_share = 0.95;
/* A plan that takes this many seconds is not repeated for a curve. */
static const double long_plan_s = 20;

/* State of a job that runs through its skies. */
struct skies_run {
    struct orl_job job; /* the caller's, with the sensors of its file loaded */
    const struct orl_run_env *env;
    const struct orl_skies_env *skies;
    struct orl_scene *scene; /* shared by all skies; the first one reads it */
    double *shares;          /* share of each sky in the work; the sum is 1 */
    double before;           /* share of the finished skies */
    double from;             /* share of the work done by other processes */
    /* Shares of the skies that were run, and the seconds of their stages. Recent ones count more,
     * because the machine's load varies. */
    double ran, ran_s[ORL_STAGE_COUNT];
    double started_s;
};

static void name_place(struct orl_error *err, size_t index)
{
    char place[32];
    snprintf(place, sizeof place, "skies[%zu]", index);
    orl_error_at(err, NULL, 0, place);
}

/* Checks every sky and estimates its work. */
static int check_skies(struct skies_run *p, struct orl_error *err)
{
    struct orl_weather_cache weather = {0};
    double sum = 0;
    int code = 0;
    for (size_t i = 0; i < p->job.n_skies && code == 0; i++) {
        struct orl_daylight daylight = {0};
        code = orl_run_find_sky(p->env->files, &p->job.skies[i].request, &weather, &daylight, err);
        if (code < 0)
            name_place(err, i);
        p->shares[i] = daylight.black ? dark_share : 1;
        sum += p->shares[i];
    }
    for (size_t i = 0; i < p->job.n_skies; i++)
        p->shares[i] /= sum;
    orl_weather_cache_done(&weather);
    return code;
}

/* Reads sensors of a file once, and validates their number for this many skies. */
static int read_sensors(struct skies_run *p, struct orl_error *err)
{
    struct orl_job *job = &p->job;
    if (job->n_grids > 0) {
        const int read = orl_grids_read(&p->job, p->env->files, p->env->cancel, &job->grids,
                                        &job->sensors, &job->n_sensors, err);
        return read < 0 ? read : orl_job_validate(job, err);
    }
    if (!job->sensors_file)
        return 0;
    const int code = orl_sensors_load(p->env->files, job->sensors_file, p->env->cancel,
                                      &job->sensors, &job->n_sensors, err);
    if (code < 0)
        return code;
    job->sensors_file = NULL;
    return orl_job_validate(job, err);
}

/* Returns the job under a single sky. */
static struct orl_job single_sky_job(const struct orl_job *all, size_t index)
{
    struct orl_job job = *all;
    job.sky = all->skies[index].request;
    job.skies = NULL;
    job.n_skies = 0;
    job.sequence.asked = false;
    return job;
}

/* Returns the job under a sky with its part of the time left. */
static struct orl_job job_of_sky(const struct skies_run *p, size_t index)
{
    struct orl_job job = single_sky_job(&p->job, index);
    if (job.goal.deadline_s > 0) {
        const double now = p->env->now_s(p->env->ctx);
        const double left = fmax(job.goal.deadline_s - (now - p->started_s), 1e-3);
        job.goal.deadline_s = left * p->shares[index] / fmax(1 - p->before, p->shares[index]);
    }
    return job;
}

/* Adds a sky's times, without the stages that are done once for all skies. */
static void add_times(struct skies_run *p, size_t index, const struct orl_result *result)
{
    p->ran = kept * p->ran + p->shares[index];
    for (int i = ORL_STAGE_PLAN; i < ORL_STAGE_COUNT; i++)
        p->ran_s[i] = kept * p->ran_s[i] + result->timings_s[i];
}

/* Estimates a sky's stages from earlier skies; returns the seconds of all later skies. */
static double estimate_sky(const struct skies_run *p, size_t index,
                           double ret_stages_s[ORL_STAGE_COUNT])
{
    const double share = p->shares[index];
    double all = 0;
    for (int i = 0; i < ORL_STAGE_COUNT; i++) {
        ret_stages_s[i] = p->ran_s[i] / p->ran * share;
        all += p->ran_s[i];
    }
    return all / p->ran * fmax(1 - p->before - share, 0);
}

static int run_sky(struct skies_run *p, size_t index, struct orl_error *err)
{
    const struct orl_job job = job_of_sky(p, index);
    struct orl_run_env env = *p->env;
    struct orl_result result = {0};
    double stages_s[ORL_STAGE_COUNT];
    char prefix[80];
    snprintf(prefix, sizeof prefix, "%s.", p->job.skies[index].name);
    env.file_prefix = prefix;
    env.part_from = p->from + (1 - p->from) * p->before;
    env.part = (1 - p->from) * p->shares[index];
    if (p->ran > 0) {
        env.part_after_s = estimate_sky(p, index, stages_s);
        env.part_stages_s = stages_s;
    }
    if (p->skies->begins)
        p->skies->begins(p->skies->ctx, index, &job, prefix);
    int code = orl_run_with_scene(&job, &env, &p->scene, &result, err);
    if (code < 0) {
        if (err && (!err->primitive[0] || strcmp(err->primitive, "sky") == 0))
            name_place(err, index);
        return code;
    }
    add_times(p, index, &result);
    code = p->skies->done(p->skies->ctx, index, &result, err);
    orl_result_done(&result);
    return code;
}

/* ---- Skies as tasks ------------------------------------------------------------------------- */

/* Runs a sky and returns a marker. The sky's results are in the store as tasks of their own. */
static int make_sky_task(void *ctx, size_t index, void **ret_data, size_t *ret_size,
                         struct orl_error *err)
{
    static const uint32_t made = 1;
    const int code = run_sky(ctx, index, err);
    *ret_data = malloc(sizeof made);
    *ret_size = sizeof made;
    if (!*ret_data)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    memcpy(*ret_data, &made, sizeof made);
    return code;
}

static int load_sky_task(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                         struct orl_error *err)
{
    (void)ctx, (void)index, (void)data, (void)err;
    *ret_taken = size == sizeof(uint32_t);
    return 0;
}

static void name_sky_task(const struct skies_run *p, const char *job, size_t index,
                          struct orl_job_task *job_task)
{
    struct orl_sha256 hash;
    const uint64_t number = index;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, job, strlen(job) + 1);
    orl_sha256_add(&hash, &number, sizeof number);
    orl_task_key_end(&hash, job_task->key);
    snprintf(job_task->kind, sizeof job_task->kind, "sky");
    job_task->work = p->shares[index];
    job_task->core_s = orl_run_estimate_core_s(&p->job);
    job_task->bytes = orl_run_estimate_bytes(&p->job);
}

/* Reports progress while other processes work, extrapolated from the time so far. */
static void report_share(void *ctx, double share)
{
    const struct skies_run *p = ctx;
    const struct orl_run_env *env = p->env;
    const double done = distributed_share * share;
    const double elapsed = env->now_s(env->ctx) - p->started_s;
    if (env->progress)
        env->progress(env->ctx, ORL_STAGE_RENDER, share, done,
                      done > 0 ? elapsed * (1 - done) / done : (double)NAN);
}

/* Lets other processes make the tasks of each sky, and sets up an environment in which all of them
 * are found. */
static int distribute_skies(struct skies_run *p, struct orl_job_tasks *here,
                            struct orl_run_env *ret_env, struct orl_error *err)
{
    const struct orl_job_tasks *shared = p->env->tasks;
    const struct orl_run_env *env = p->env;
    struct orl_task_work work = {.n = p->job.n_skies,
                                 .ctx = p,
                                 .make = make_sky_task,
                                 .take = load_sky_task,
                                 .told = report_share};
    work.tasks = calloc(work.n + 1, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for tasks of a job");
    for (size_t i = 0; i < work.n; i++)
        name_sky_task(p, shared->job, i, &work.tasks[i]);
    *here = (struct orl_job_tasks){.job = shared->job};
    *ret_env = *p->env;
    ret_env->tasks = here;
    p->env = ret_env;
    const int code = orl_run_tasks(env, &work, err);
    free(work.tasks);
    p->from = distributed_share;
    return code;
}

int orl_run_skies(const struct orl_job *job, const struct orl_run_env *env,
                  const struct orl_skies_env *skies, struct orl_error *err)
{
    struct orl_job_tasks here;
    struct orl_run_env shared;
    struct skies_run p = {
        .job = *job, .env = env, .skies = skies, .started_s = env->now_s(env->ctx)};
    int code = orl_job_validate(job, err);
    if (code < 0)
        return code;
    if (job->n_skies == 0)
        return orl_error_set(err, ORL_ERR_INVALID, "the job has no list of skies");
    p.shares = calloc(job->n_skies, sizeof *p.shares);
    if (!p.shares)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    code = read_sensors(&p, err);
    if (code == 0)
        code = check_skies(&p, err);
    if (code == 0 && env->tasks && env->store)
        code = distribute_skies(&p, &here, &shared, err);
    for (size_t i = 0; i < job->n_skies && code == 0; i++) {
        if (!skies->kept || !skies->kept(skies->ctx, i))
            code = run_sky(&p, i, err);
        p.before += p.shares[i];
    }
    if (p.job.sensors != job->sensors)
        free(p.job.sensors);
    if (p.job.grids != job->grids)
        free(p.job.grids);
    free(p.shares);
    orl_scene_release(p.scene);
    return code;
}

/* Fills *ret_curve for the planned job by a pilot, or with the reason why there is no curve. */
static int make_curve(const struct orl_job *job, const struct orl_run_env *env,
                      const struct orl_result *planned, struct orl_accuracy_curve *ret_curve,
                      struct orl_error *err)
{
    const enum orl_technique technique = planned->plan.technique;
    if (!planned->no_curve)
        return orl_plan_accuracy_curve(job, env, technique, ret_curve, err);
    *ret_curve = (struct orl_accuracy_curve){.technique = technique,
                                             .threads = orl_thread_pool_size(env->pool)};
    snprintf(ret_curve->model, sizeof ret_curve->model, "%s", planned->no_curve);
    return 0;
}

int orl_plan_skies(const struct orl_job *job, const struct orl_run_env *env, size_t most,
                   int (*tell)(void *ctx, const char *sky, const struct orl_result *planned,
                               const struct orl_accuracy_curve *curve, struct orl_error *err),
                   void *ctx, struct orl_error *err)
{
    const size_t count = job->n_skies == 0 ? 1 : job->n_skies < most ? job->n_skies : most;
    int code = 0;
    for (size_t i = 0; i < count && code == 0; i++) {
        const struct orl_job one = job->n_skies > 0 ? single_sky_job(job, i) : *job;
        struct orl_result planned = {0};
        struct orl_accuracy_curve curve;
        code = orl_plan_job(&one, env, &planned, err);
        const bool draws = i == 0 && (planned.no_curve || planned.total_s < long_plan_s);
        if (code == 0 && draws)
            code = make_curve(&one, env, &planned, &curve, err);
        if (code == 0)
            code = tell(ctx, job->n_skies > 0 ? job->skies[i].name : NULL, &planned,
                        draws ? &curve : NULL, err);
        orl_result_done(&planned);
    }
    return code;
}
