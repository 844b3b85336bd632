/* Runs as tasks of a distributed study: stored runs, and their distribution. */
#include "study/study_runs.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/distributed/task_work.h"
#include "run/estimate/progress.h"
#include "study/speed.h"

/* Version of a task's contents and file layout; raise it when either changes. */
static const char recipe[] = "oriel study runs 1";
/* Share of a distributed study's work that makes its runs; the rest assembles the results. */
static const double distributed_share = 0.98;
/* Time to load the scene and trace its rays, in seconds of one core. */
static const double speed_s = 1;

bool orl_study_is_shared(const struct orl_study_env *env)
{
    return env->tasks && env->store;
}

/* ---- Stored runs ----------------------------------------------------------------------------- */

/* Header of a stored run. Then follow its values, their errors if known, and its warnings, each
 * with a terminating zero. */
struct run_header {
    uint64_t count, has_errors, warning_bytes;
    struct orl_run_cost cost;
};

static size_t bytes_of(const struct run_header *run_header)
{
    return sizeof *run_header +
           run_header->count * sizeof(double) * (run_header->has_errors ? 2 : 1) +
           (run_header->warning_bytes + 3) / 4 * 4;
}

static void fill_header(const struct orl_one_run *run, struct run_header *ret_head)
{
    *ret_head = (struct run_header){run->count, run->errors != NULL, 0, run->cost};
    for (size_t i = 0; i < run->n_warnings; i++)
        ret_head->warning_bytes += strlen(run->warnings[i]) + 1;
}

static int pack_run(const struct orl_one_run *run, void **ret_data, size_t *ret_size,
                    struct orl_error *err)
{
    struct run_header run_header;
    fill_header(run, &run_header);
    char *to = calloc(1, bytes_of(&run_header));
    *ret_data = to;
    *ret_size = bytes_of(&run_header);
    if (!to)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a run's values");
    memcpy(to, &run_header, sizeof run_header);
    to += sizeof run_header;
    memcpy(to, run->values, run->count * sizeof *run->values);
    to += run->count * sizeof *run->values;
    if (run->errors) {
        memcpy(to, run->errors, run->count * sizeof *run->errors);
        to += run->count * sizeof *run->errors;
    }
    for (size_t i = 0; i < run->n_warnings; i++)
        to = stpcpy(to, run->warnings[i]) + 1;
    return 0;
}

/* Returns a copy of count values; NULL: out of memory. */
static double *copy_doubles(const char *from, size_t count)
{
    double *to = malloc((count + 1) * sizeof *to);
    if (to)
        memcpy(to, from, count * sizeof *to);
    return to;
}

static bool unpack_warnings(const char *from, size_t bytes, struct orl_one_run *run)
{
    size_t n = 0;
    for (size_t i = 0; i < bytes; i++)
        n += from[i] == '\0';
    run->warnings = calloc(n + 1, sizeof *run->warnings);
    for (; run->warnings && run->n_warnings < n; from += strlen(from) + 1)
        if (!(run->warnings[run->n_warnings++] = strdup(from)))
            return false;
    return run->warnings != NULL;
}

/* Unpacks data of the correct size. The caller frees the run, also after an error. */
static int unpack_run(const struct run_header *run_header, const char *from,
                      struct orl_one_run *run, struct orl_error *err)
{
    *run = (struct orl_one_run){.count = run_header->count, .cost = run_header->cost};
    from += sizeof *run_header;
    run->values = copy_doubles(from, run->count);
    from += run->count * sizeof *run->values;
    if (run_header->has_errors) {
        run->errors = copy_doubles(from, run->count);
        from += run->count * sizeof *run->errors;
    }
    if (run->values && (run->errors || !run_header->has_errors) &&
        unpack_warnings(from, run_header->warning_bytes, run))
        return 0;
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a run's values");
}

/* ---- Tasks ----------------------------------------------------------------------------------- */

/* A run to be made: a setting and a seed. */
struct planned_run {
    struct orl_study_setting setting;
    uint64_t seed;
};

/* Context of runs in progress. */
struct run_tasks {
    struct orl_runs_env *env;
    const struct planned_run *runs; /* by task; one more task, the last, is the speed */
    size_t n_runs;
    double *rays_per_s;
    struct orl_one_run *into; /* NULL: runs are stored, and not returned yet */
};

static int make_speed(const struct run_tasks *run_tasks, void **ret_data, size_t *ret_size,
                      struct orl_error *err)
{
    const struct orl_runs_env *env = run_tasks->env;
    const int code = orl_study_measure_speed(env->request, env->env, run_tasks->rays_per_s, err);
    *ret_size = sizeof *run_tasks->rays_per_s;
    *ret_data = malloc(*ret_size);
    if (!*ret_data)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    memcpy(*ret_data, run_tasks->rays_per_s, *ret_size);
    return code;
}

static int make_task(void *ctx, size_t index, void **ret_data, size_t *ret_size,
                     struct orl_error *err)
{
    struct run_tasks *run_tasks = ctx;
    struct orl_runs_env *env = run_tasks->env;
    struct orl_one_run run = {0};
    if (index == run_tasks->n_runs)
        return make_speed(run_tasks, ret_data, ret_size, err);
    const struct planned_run *planned_run = &run_tasks->runs[index];
    env->share = orl_study_run_core_s(&env->request->job, &planned_run->setting, env->sensors);
    int code = orl_one_run_make(env, &planned_run->setting, planned_run->seed, &run, err);
    if (code == 0)
        code = pack_run(&run, ret_data, ret_size, err);
    if (code == 0 && run_tasks->into)
        *run_tasks->into = run;
    else
        orl_one_run_done(&run);
    return code;
}

/* Reports the cost of a run that another process made. */
static void report_spent(const struct orl_study_env *env, const struct orl_run_cost *cost)
{
    struct orl_result spent = {
        .threads = (uint32_t)cost->threads, .total_s = cost->total_s, .health = cost->health};
    memcpy(spent.timings_s, cost->stages_s, sizeof spent.timings_s);
    if (env->spent)
        env->spent(env->ctx, &spent);
}

static int load_task(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                     struct orl_error *err)
{
    const struct run_tasks *run_tasks = ctx;
    struct run_header run_header;
    if (index == run_tasks->n_runs) {
        *ret_taken = size == sizeof *run_tasks->rays_per_s;
        if (*ret_taken)
            memcpy(run_tasks->rays_per_s, data, size);
        return 0;
    }
    if (size >= sizeof run_header)
        memcpy(&run_header, data, sizeof run_header);
    *ret_taken = size >= sizeof run_header && run_header.count <= size &&
                 run_header.warning_bytes <= size && size == bytes_of(&run_header);
    if (!*ret_taken || !run_tasks->into)
        return 0;
    const int code = unpack_run(&run_header, data, run_tasks->into, err);
    if (code < 0)
        orl_one_run_done(run_tasks->into);
    else
        report_spent(run_tasks->env->env, &run_header.cost);
    return code;
}

static void name_task(const char *job, const char *kind, const uint64_t numbers[4],
                      struct orl_job_task *ret_piece)
{
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, recipe, sizeof recipe);
    orl_sha256_add(&hash, job, strlen(job) + 1);
    orl_sha256_add(&hash, kind, strlen(kind) + 1);
    orl_sha256_add(&hash, numbers, 4 * sizeof *numbers);
    orl_task_key_end(&hash, ret_piece->key);
    snprintf(ret_piece->kind, sizeof ret_piece->kind, "%s", kind);
}

static void name_run(const struct orl_runs_env *env, const struct planned_run *run,
                     struct orl_job_task *ret_piece)
{
    const struct orl_study_setting *setting = &run->setting;
    const uint64_t numbers[4] = {(uint64_t)setting->technique, setting->photons, setting->samples,
                                 run->seed};
    struct orl_job job = env->request->job;
    job.photons_global = job.photons_caustic =
        setting->photons ? setting->photons : ORL_PHOTONS_BY_PLAN;
    *ret_piece = (struct orl_job_task){
        .work = orl_study_run_core_s(&env->request->job, setting, env->sensors),
        .bytes = orl_run_estimate_bytes(&job)};
    ret_piece->core_s = ret_piece->work;
    name_task(env->env->tasks->job, "run", numbers, ret_piece);
}

/* ---- All of them ----------------------------------------------------------------------------- */

/* Reports progress; the remaining time is estimated from the time so far. */
static void report_share(void *ctx, double share)
{
    struct orl_runs_env *env = ((const struct run_tasks *)ctx)->env;
    const struct orl_study_env *study = env->env;
    const double done = distributed_share * share;
    const double elapsed = study->now_s(study->ctx) - env->started_s;
    env->step.run = 1 + (uint32_t)(share * (env->step.runs - 1));
    env->step.fraction = done;
    env->step.left_s = done > 0 ? elapsed * (1 - done) / done : (double)NAN;
    if (study->progress)
        study->progress(study->ctx, &env->step);
}

/* Lists the reference's runs, then those of the settings, in order. */
static size_t list_runs(const struct orl_study_request *request,
                        const struct orl_study_setting *settings, size_t n_settings,
                        struct planned_run *ret_runs)
{
    const struct orl_study_setting reference = orl_study_reference_setting(request);
    size_t n = 0;
    for (uint32_t i = 0; i < request->reference_runs; i++)
        ret_runs[n++] = (struct planned_run){reference, orl_study_reference_seed(request) + i};
    for (size_t s = 0; s < n_settings; s++)
        for (uint32_t i = 0; i < request->repeats; i++)
            ret_runs[n++] = (struct planned_run){settings[s], request->job.seed + i};
    return n;
}

static int compute_tasks(struct run_tasks *run_tasks, struct orl_job_task *tasks, size_t n,
                         const struct orl_job_tasks *shared, struct orl_error *err)
{
    const struct orl_study_env *env = run_tasks->env->env;
    const struct orl_run_env run = {.store = env->store, .tasks = shared, .cancel = env->cancel};
    const struct orl_task_work work = {.tasks = tasks,
                                       .n = n,
                                       .ctx = run_tasks,
                                       .make = make_task,
                                       .take = load_task,
                                       .told = run_tasks->into ? NULL : report_share};
    return orl_run_tasks(&run, &work, err);
}

static int distribute_all(struct run_tasks *run_tasks, struct orl_job_task *tasks,
                          struct orl_error *err)
{
    static const uint64_t none[4] = {0};
    struct orl_runs_env *env = run_tasks->env;
    const size_t n = run_tasks->n_runs;
    for (size_t i = 0; i < n; i++)
        name_run(env, &run_tasks->runs[i], &tasks[i]);
    tasks[n] = (struct orl_job_task){.work = speed_s, .core_s = speed_s};
    name_task(env->env->tasks->job, "speed", none, &tasks[n]);
    env->spent_deferred = true;
    env->started_s = env->env->now_s(env->env->ctx);
    env->step = (struct orl_study_step){.in_parts = true,
                                        .setting = orl_study_reference_setting(env->request),
                                        .run = 1,
                                        .runs = (uint32_t)n};
    const int code = compute_tasks(run_tasks, tasks, n + 1, env->env->tasks, err);
    env->step = (struct orl_study_step){.in_parts = false};
    env->spent_deferred = false;
    env->from = distributed_share;
    return code;
}

int orl_share_runs(struct orl_runs_env *env, const struct orl_study_setting *settings,
                   size_t n_settings, double *ret_rays_per_s, struct orl_error *err)
{
    const struct orl_study_request *request = env->request;
    const size_t n = request->reference_runs + n_settings * request->repeats;
    struct planned_run *runs = calloc(n + 1, sizeof *runs);
    struct orl_job_task *tasks = calloc(n + 2, sizeof *tasks);
    struct run_tasks run_tasks = {.env = env, .runs = runs, .rays_per_s = ret_rays_per_s};
    if (runs)
        run_tasks.n_runs = list_runs(request, settings, n_settings, runs);
    const int code = runs && tasks
                         ? distribute_all(&run_tasks, tasks, err)
                         : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for tasks of a study");
    free(runs);
    free(tasks);
    return code;
}

/* ---- One of them ----------------------------------------------------------------------------- */

int orl_shared_run_find(struct orl_runs_env *env, const struct orl_study_setting *setting,
                        uint64_t seed, struct orl_one_run *ret_run, struct orl_error *err)
{
    const struct planned_run planned_run = {*setting, seed};
    struct run_tasks run_tasks = {.env = env, .runs = &planned_run, .n_runs = 1, .into = ret_run};
    struct orl_job_task job_task;
    if (!orl_study_is_shared(env->env))
        return orl_one_run_make(env, setting, seed, ret_run, err);
    const struct orl_job_tasks here = {.job = env->env->tasks->job};
    name_run(env, &planned_run, &job_task);
    return compute_tasks(&run_tasks, &job_task, 1, &here, err);
}
