#include "study/series.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void orl_series_done(struct orl_series *series)
{
    for (size_t i = 0; series->values && i < series->n_runs; i++)
        free(series->values[i]);
    free(series->values);
    free(series->errors);
    free(series->stages_s);
    free(series->total_s);
    memset(series, 0, sizeof *series);
}

/* A run, and where its values go. */
struct run {
    struct orl_series_env *env;
    double *values; /* owned until it is taken */
    size_t count, capacity;
    bool out_of_memory;
};

static double now_s(void *ctx)
{
    const struct orl_study_env *env = ((const struct run *)ctx)->env->env;
    return env->now_s(env->ctx);
}

/* Runs to come take as long as those before, by their costs; the first of all is one of them. */
static void progress(void *ctx, enum orl_stage stage, double stage_fraction, double job_fraction,
                     double left_s)
{
    struct orl_series_env *env = ((const struct run *)ctx)->env;
    const double elapsed = now_s(ctx) - env->started_s, done = env->before + env->share;
    (void)stage, (void)stage_fraction;
    env->step.fraction = (env->before + env->share * job_fraction) / env->all;
    env->step.left_s = left_s + (elapsed + left_s) * (env->all - done) / done;
    if (env->env->progress)
        env->env->progress(env->env->ctx, &env->step);
}

static void spent(void *ctx, const struct orl_result *result)
{
    const struct orl_study_env *env = ((const struct run *)ctx)->env->env;
    if (env->spent)
        env->spent(env->ctx, result);
}

static bool reserve(struct run *run, size_t count)
{
    if (run->count + count <= run->capacity)
        return true;
    double *grown = realloc(run->values, (run->count + count) * sizeof *grown);
    if (!grown) {
        run->out_of_memory = true;
        return false;
    }
    run->values = grown;
    run->capacity = run->count + count;
    return true;
}

static void take_view(void *ctx, size_t index, float (*const pixels)[3], const float *errors,
                      size_t count)
{
    struct run *run = ctx;
    (void)index, (void)errors;
    if (!reserve(run, count))
        return;
    for (size_t i = 0; i < count; i++) {
        const struct orl_rgb color = {pixels[i][0], pixels[i][1], pixels[i][2]};
        run->values[run->count++] = ORL_EFFICACY_LM_PER_W * orl_luma(color);
    }
}

static void take_sensors(struct run *run, const struct orl_result *result)
{
    if (result->n_sensors == 0 || !reserve(run, result->n_sensors))
        return;
    memcpy(run->values + run->count, result->illuminance_lx, result->n_sensors * sizeof(double));
    run->count += result->n_sensors;
}

/* Images, maps: whatever a run has left. */
static void clear_folder(const char *folder)
{
    DIR *dir = opendir(folder);
    const struct dirent *entry;
    while (dir && (entry = readdir(dir)))
        unlinkat(dirfd(dir), entry->d_name, 0); /* refuses "." and ".." */
    if (dir)
        closedir(dir);
}

/* Each warning once, however many runs had it. */
static void take_warnings(struct orl_series_env *env, const struct orl_result *result)
{
    for (size_t i = 0; i < result->n_warnings; i++) {
        bool known = false;
        for (size_t k = 0; k < *env->n_warnings; k++)
            known = known || strcmp((*env->warnings)[k], result->warnings[i]) == 0;
        char **grown =
            known ? NULL : realloc(*env->warnings, (*env->n_warnings + 1) * sizeof *grown);
        if (!grown)
            continue;
        *env->warnings = grown;
        grown[*env->n_warnings] = strdup(result->warnings[i]);
        *env->n_warnings += grown[*env->n_warnings] != NULL;
    }
}

/* The template's job with the setting's numbers. Borrows from the template: not for
 * orl_job_done. */
static struct orl_job make_job(const struct orl_study_request *request,
                               const struct orl_study_setting *setting, uint64_t seed)
{
    struct orl_job job = request->job;
    job.technique = setting->technique;
    job.seed = seed;
    job.photons_global = setting->photons ? setting->photons : ORL_PHOTONS_BY_PLAN;
    job.photons_caustic = job.photons_global;
    job.photons_exact = true;
    job.gather_samples = 0;
    job.pixel_samples = 0;
    if (orl_study_of_views(request))
        job.pixel_samples = setting->samples;
    else
        job.gather_samples = setting->samples;
    return job;
}

static int run_once(struct orl_series_env *env, const struct orl_job *job, struct run *run,
                    struct orl_result *ret_result, struct orl_error *err)
{
    const struct orl_study_env *study = env->env;
    struct orl_folder_store folder;
    memcpy(folder.folder, env->folder, sizeof folder.folder);
    struct orl_map_store store = orl_map_store_in_folder(&folder);
    store.release = store.abandon;
    const struct orl_run_env run_env = {.crew = study->crew,
                                        .files = study->files,
                                        .store = &store,
                                        .output_folder = env->folder,
                                        .cancel = study->cancel,
                                        .now_s = now_s,
                                        .progress = progress,
                                        .view_ready = take_view,
                                        .spent = spent,
                                        .ctx = run};
    int code = orl_run(job, &run_env, ret_result, err);
    if (code == 0) {
        take_sensors(run, ret_result);
        take_warnings(env, ret_result);
        if (run->out_of_memory) {
            orl_result_done(ret_result);
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a run's values");
        }
    }
    clear_folder(env->folder);
    return code;
}

static int keep_run(struct orl_series *series, size_t index, struct run *run,
                    struct orl_result *result, struct orl_error *err)
{
    if (index > 0 && run->count != series->count)
        return orl_error_set(err, ORL_ERR_INTERNAL, "runs of one study differ in their values");
    series->count = run->count;
    series->values[index] = run->values;
    run->values = NULL;
    memcpy(series->stages_s[index], result->timings_s, sizeof result->timings_s);
    series->total_s[index] = result->total_s;
    for (size_t k = 0; index == 0 && k < result->n_maps; k++)
        series->map_bytes += result->maps[k].bytes;
    free(series->errors);
    series->errors = result->standard_error_lx;
    result->standard_error_lx = NULL;
    return 0;
}

double orl_series_cost(const struct orl_study_request *request,
                       const struct orl_study_setting *setting)
{
    /* Microseconds: a photon of either kind traced and indexed, a sample of a sensor, a path of a
     * pixel; and what every run begins with. */
    const double photon_us = 2, sample_us = 3, path_us = 10, start_us = 5e5;
    const struct orl_job *job = &request->job;
    const double sensors = job->n_sensors ? (double)job->n_sensors : 100;
    double values = 0;
    for (size_t i = 0; i < job->n_views; i++)
        values += (double)job->views[i].width * job->views[i].height;
    return start_us + photon_us * (double)setting->photons +
           (values > 0 ? values * path_us : sensors * sample_us) * (setting->samples + 1.0);
}

int orl_series_run(struct orl_series_env *env, const struct orl_study_setting *setting,
                   uint64_t first_seed, uint32_t n_runs, struct orl_series *ret_series,
                   struct orl_error *err)
{
    struct orl_series series = {.n_runs = n_runs,
                                .values = calloc(n_runs, sizeof *series.values),
                                .stages_s = calloc(n_runs, sizeof *series.stages_s),
                                .total_s = calloc(n_runs, sizeof *series.total_s)};
    int code = 0;
    if (!series.values || !series.stages_s || !series.total_s)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (!(env->before > 0))
        env->started_s = env->env->now_s(env->env->ctx);
    env->share = orl_series_cost(env->request, setting);
    env->step.setting = *setting;
    env->step.runs = n_runs;
    for (uint32_t i = 0; i < n_runs && code == 0; i++) {
        const struct orl_job job = make_job(env->request, setting, first_seed + i);
        struct run run = {.env = env};
        struct orl_result result = {0};
        env->step.run = i + 1;
        code = run_once(env, &job, &run, &result, err);
        if (code == 0)
            code = keep_run(&series, i, &run, &result, err);
        free(run.values);
        orl_result_done(&result);
        env->before += env->share;
    }
    if (code < 0)
        orl_series_done(&series);
    else
        *ret_series = series;
    return code;
}
