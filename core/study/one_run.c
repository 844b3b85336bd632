/* One run of a study, with maps that no other run uses. */
#include "study/study_runs.h"

#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory/memory.h"

void orl_one_run_done(struct orl_one_run *run)
{
    free(run->values);
    free(run->errors);
    orl_texts_free(run->warnings, run->n_warnings);
    memset(run, 0, sizeof *run);
}

/* Context of a run, with an array for its values. */
struct value_collector {
    struct orl_runs_env *env;
    double *values; /* owned until taken */
    size_t count, capacity;
    bool out_of_memory;
};

static double now_s(void *ctx)
{
    const struct orl_study_env *env = ((const struct value_collector *)ctx)->env->env;
    return env->now_s(env->ctx);
}

/* Reports progress. Future runs are assumed to take as long as past ones, in proportion to their
 * cost; the first run of all is included. */
static void report_progress(void *ctx, enum orl_stage stage, double stage_fraction,
                            double job_fraction, double left_s)
{
    struct orl_runs_env *env = ((const struct value_collector *)ctx)->env;
    const double elapsed = now_s(ctx) - env->started_s, done = env->before + env->share;
    const double here = (env->before + env->share * job_fraction) / env->all;
    (void)stage, (void)stage_fraction;
    env->step.fraction = env->from + (1 - env->from) * here;
    env->step.left_s = left_s + (elapsed + left_s) * (env->all - done) / done;
    if (env->env->progress)
        env->env->progress(env->env->ctx, &env->step);
}

static void report_spent(void *ctx, const struct orl_result *result)
{
    const struct orl_runs_env *env = ((const struct value_collector *)ctx)->env;
    if (env->env->spent && !env->spent_deferred)
        env->env->spent(env->env->ctx, result);
}

static bool reserve_values(struct value_collector *value_collector, size_t count)
{
    const bool fine = orl_array_reserve_more(&value_collector->values, &value_collector->capacity,
                                             value_collector->count, count, sizeof(double));
    value_collector->out_of_memory = value_collector->out_of_memory || !fine;
    return fine;
}

static void append_view(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                        size_t count)
{
    struct value_collector *value_collector = ctx;
    (void)index, (void)errors;
    if (!reserve_values(value_collector, count))
        return;
    for (size_t i = 0; i < count; i++) {
        const struct orl_rgb color = {pixels[i][0], pixels[i][1], pixels[i][2]};
        value_collector->values[value_collector->count++] = ORL_EFFICACY_LM_PER_W * orl_luma(color);
    }
}

static void append_sensors(struct value_collector *value_collector, const struct orl_result *result)
{
    if (result->n_sensors == 0 || !reserve_values(value_collector, result->n_sensors))
        return;
    memcpy(value_collector->values + value_collector->count, result->illuminance_lx,
           result->n_sensors * sizeof(double));
    value_collector->count += result->n_sensors;
}

/* Deletes all files that a run has left: images and maps. */
static void clear_folder(const char *folder)
{
    DIR *dir = opendir(folder);
    const struct dirent *entry;
    while (dir && (entry = readdir(dir)))
        unlinkat(dirfd(dir), entry->d_name, 0); /* fails for "." and ".." */
    if (dir)
        closedir(dir);
}

/* Returns the template's job with the setting's numbers. It borrows from the template, so
 * orl_job_done must not be called. */
static struct orl_job make_job(const struct orl_study_request *request,
                               const struct orl_study_setting *setting, uint64_t seed)
{
    struct orl_job job = request->job;
    job.technique = setting->technique;
    job.seed = seed;
    job.photons_global = setting->photons ? setting->photons : ORL_PHOTONS_BY_PLAN;
    job.photons_caustic = job.photons_global;
    job.photons_exact = true;
    job.sensor_files = false;
    job.gather_samples = 0;
    job.pixel_samples = 0;
    if (orl_study_of_views(request))
        job.pixel_samples = setting->samples;
    else
        job.gather_samples = setting->samples;
    return job;
}

static int compute_run(struct value_collector *value_collector, const struct orl_job *job,
                       struct orl_result *ret_result, struct orl_error *err)
{
    const struct orl_runs_env *env = value_collector->env;
    const struct orl_study_env *study = env->env;
    struct orl_folder_store folder;
    memcpy(folder.folder, env->folder, sizeof folder.folder);
    struct orl_map_store store = orl_map_store_in_folder(&folder);
    store.release = store.abandon;
    const struct orl_run_env run_env = {.pool = study->pool,
                                        .files = study->files,
                                        .store = &store,
                                        .output_folder = env->folder,
                                        .cancel = study->cancel,
                                        .now_s = now_s,
                                        .progress = report_progress,
                                        .view_ready = append_view,
                                        .spent = report_spent,
                                        .ctx = value_collector};
    int code = orl_run(job, &run_env, ret_result, err);
    if (code == 0) {
        append_sensors(value_collector, ret_result);
        if (value_collector->out_of_memory)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a run's values");
    }
    clear_folder(env->folder);
    return code;
}

/* Moves the data that the study needs out of the run's result. */
static void move_result(struct value_collector *value_collector, struct orl_result *result,
                        struct orl_one_run *run)
{
    *run = (struct orl_one_run){
        .values = value_collector->values,
        .count = value_collector->count,
        .errors = result->standard_error_lx,
        .cost = {.threads = result->threads, .total_s = result->total_s, .health = result->health},
        .warnings = result->warnings,
        .n_warnings = result->n_warnings};
    memcpy(run->cost.stages_s, result->timings_s, sizeof run->cost.stages_s);
    for (size_t k = 0; k < result->n_maps; k++)
        run->cost.map_bytes += result->maps[k].bytes;
    value_collector->values = NULL;
    result->standard_error_lx = NULL;
    result->warnings = NULL;
    result->n_warnings = 0;
}

int orl_one_run_make(struct orl_runs_env *env, const struct orl_study_setting *setting,
                     uint64_t seed, struct orl_one_run *ret_run, struct orl_error *err)
{
    const struct orl_job job = make_job(env->request, setting, seed);
    struct value_collector value_collector = {.env = env};
    struct orl_result result = {0};
    const int code = compute_run(&value_collector, &job, &result, err);
    if (code == 0)
        move_result(&value_collector, &result, ret_run);
    free(value_collector.values);
    orl_result_done(&result);
    return code;
}
