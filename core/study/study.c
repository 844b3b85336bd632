/*
 * Runs a study from its request to its results: the reference first, then each setting, finally the
 * fits and the Pareto front. Also writes the points as a table.
 */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/job/study.h>

#include "base/io/out_file.h"
#include "base/memory/memory.h"
#include "run/request/job_inputs.h"
#include "study/speed.h"
#include "study/study_errors.h"
#include "study/study_runs.h"

void orl_study_done(struct orl_study *study)
{
    if (!study)
        return;
    free(study->points);
    free(study->fits);
    orl_study_free_external(study->external, study->n_external);
    orl_texts_free(study->warnings, study->n_warnings);
    memset(study, 0, sizeof *study);
}

const char *orl_study_step_name(const struct orl_study_step *step)
{
    return step->in_parts    ? "parts"
           : step->reference ? "reference"
                             : orl_technique_name(step->setting.technique);
}

/* State shared by the steps of a study. */
struct study_run {
    const struct orl_study_request *request;
    const struct orl_study_env *env;
    struct orl_study *study;
    struct orl_runs_env runs_env;
    struct orl_study_setting *settings; /* owned */
    size_t n_settings;
    struct orl_reference reference; /* owned */
};

static double total_s_of(const struct orl_series *series)
{
    double sum = 0;
    for (size_t i = 0; i < series->n_runs; i++)
        sum += series->costs[i].total_s;
    return sum;
}

/* Runs the reference, with seeds that no measured run has. */
static int run_reference(struct study_run *study_run, struct orl_error *err)
{
    const struct orl_study_setting setting = orl_study_reference_setting(study_run->request);
    const uint32_t runs = study_run->request->reference_runs;
    struct orl_study_reference *about = &study_run->study->reference;
    struct orl_series series = {0};
    study_run->runs_env.step.reference = true;
    int code = orl_series_run(&study_run->runs_env, &setting,
                              orl_study_reference_seed(study_run->request), runs, &series, err);
    if (code == 0)
        code = orl_reference_make(&study_run->reference, series.values, runs,
                                  runs == 1 ? series.errors : NULL, series.count,
                                  study_run->study->of_views, err);
    if (code == 0) {
        about->samples = setting.samples * runs;
        about->runs = runs;
        about->seconds = total_s_of(&series);
        study_run->study->threads = (uint32_t)series.costs[0].threads;
        orl_reference_describe(&study_run->reference, about);
    }
    orl_series_done(&series);
    return code;
}

static void average_times(struct orl_study_point *point, const struct orl_series *series)
{
    const double n = (double)series->n_runs;
    double squares = 0;
    point->total_s = total_s_of(series) / n;
    for (size_t i = 0; i < series->n_runs; i++) {
        const double d = series->costs[i].total_s - point->total_s;
        squares += d * d;
        for (int stage = 0; stage < ORL_STAGE_COUNT; stage++)
            point->stages_s[stage] += series->costs[i].stages_s[stage] / n;
    }
    point->total_error_s = series->n_runs > 1 ? sqrt(squares / (n * (n - 1))) : NAN;
    point->map_bytes = series->costs[0].map_bytes;
}

static int run_setting(struct study_run *study_run, const struct orl_study_setting *setting,
                       struct orl_error *err)
{
    struct orl_study_point point = {.setting = *setting, .seeds = study_run->request->repeats};
    struct orl_series series = {0};
    study_run->runs_env.step.reference = false;
    int code = orl_series_run(&study_run->runs_env, setting, study_run->request->job.seed,
                              study_run->request->repeats, &series, err);
    if (code == 0 && series.count != study_run->reference.count)
        code = orl_error_set(err, ORL_ERR_INTERNAL,
                             "a run and its reference have different numbers of values");
    if (code == 0)
        code = orl_study_compute_errors(&study_run->reference, series.values, series.n_runs,
                                        study_run->study->of_views, &point, err);
    if (code == 0) {
        average_times(&point, &series);
        study_run->study->points[study_run->study->n_points++] = point;
        if (study_run->env->point_ready)
            study_run->env->point_ready(study_run->env->ctx, &point);
    }
    orl_series_done(&series);
    return code;
}

static int copy_given(struct study_run *study_run, struct orl_error *err)
{
    const struct orl_study_request *request = study_run->request;
    struct orl_study *study = study_run->study;
    study->external = calloc(request->n_external + 1, sizeof *study->external);
    for (size_t i = 0; study->external && i < request->n_external; i++) {
        study->external[i] = request->external[i];
        study->external[i].name = strdup(request->external[i].name);
        study->n_external = i + 1;
        if (!study->external[i].name)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    return study->external ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* Counts the sensors for cost estimates, also those in a file. */
static int count_sensors(struct study_run *study_run, struct orl_error *err)
{
    const struct orl_job *job = &study_run->request->job;
    struct orl_sensor *sensors = NULL;
    size_t n = job->n_sensors;
    const int code = job->sensors_file ? orl_sensors_load(study_run->env->files, job->sensors_file,
                                                          study_run->env->cancel, &sensors, &n, err)
                                       : 0;
    free(sensors);
    study_run->runs_env.sensors = (double)n;
    return code;
}

static int make_folder(struct study_run *study_run, struct orl_error *err)
{
    struct orl_runs_env *runs = &study_run->runs_env;
    const int length =
        snprintf(runs->folder, sizeof runs->folder, "%s/study-XXXXXX", study_run->env->work_folder);
    if (length < 0 || (size_t)length >= sizeof runs->folder)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the work folder is too long");
    if (mkdtemp(runs->folder))
        return 0;
    runs->folder[0] = '\0';
    return orl_error_set(err, orl_err_of_errno(errno), "cannot create a folder in '%s': %s",
                         study_run->env->work_folder, strerror(errno));
}

static int prepare_study(struct study_run *study_run, struct orl_error *err)
{
    struct orl_study *study = study_run->study;
    int code = copy_given(study_run, err);
    if (code == 0)
        code = orl_study_list_settings(study_run->request, &study_run->settings,
                                       &study_run->n_settings, err);
    if (code == 0)
        code = count_sensors(study_run, err);
    if (code < 0)
        return code;
    study->points = calloc(study_run->n_settings + 1, sizeof *study->points);
    study->fits = calloc(ORL_TECHNIQUE_COUNT, sizeof *study->fits);
    if (!study->points || !study->fits)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    study_run->runs_env.all = orl_study_core_s(study_run->request, study_run->runs_env.sensors);
    return make_folder(study_run, err);
}

/* Measures the machine's speed. In a distributed study this also makes all runs. */
static int measure_speed(struct study_run *study_run, struct orl_error *err)
{
    double *rays_per_s = &study_run->study->rays_per_s;
    return orl_study_is_shared(study_run->env)
               ? orl_share_runs(&study_run->runs_env, study_run->settings, study_run->n_settings,
                                rays_per_s, err)
               : orl_study_measure_speed(study_run->request, study_run->env, rays_per_s, err);
}

/* Measures the speed, and scales times that were measured on other machines. */
static int find_speed(struct study_run *study_run, struct orl_error *err)
{
    struct orl_study *study = study_run->study;
    const int code = measure_speed(study_run, err);
    for (size_t i = 0; i < study->n_external && code == 0; i++) {
        struct orl_study_external *external = &study->external[i];
        const bool known = external->rays_per_s > 0 && isfinite(study->rays_per_s);
        const double here_s =
            external->seconds * (known ? external->rays_per_s / study->rays_per_s : 1);
        external->here_s = fmin(fmax(here_s, ORL_STUDY_LEAST), ORL_STUDY_MOST);
    }
    return code;
}

static int fit_all(struct study_run *study_run, struct orl_error *err)
{
    struct orl_study *study = study_run->study;
    int code = 0;
    for (size_t i = 0; i < study_run->request->n_techniques && code >= 0; i++) {
        code = orl_study_fit_make(study->points, study->n_points, study_run->request->techniques[i],
                                  &study->fits[study->n_fits], err);
        study->n_fits += code == 1;
    }
    return code < 0 ? code : 0;
}

int orl_study_run(const struct orl_study_request *request, const struct orl_study_env *env,
                  struct orl_study *ret_study, struct orl_error *err)
{
    struct orl_study study = {.of_views = orl_study_of_views(request)};
    struct study_run study_run = {.request = request,
                                  .env = env,
                                  .study = &study,
                                  .runs_env = {.request = request,
                                               .env = env,
                                               .warnings = &study.warnings,
                                               .n_warnings = &study.n_warnings}};
    int code = orl_study_request_validate(request, err);
    if (code == 0)
        code = prepare_study(&study_run, err);
    if (code == 0)
        code = find_speed(&study_run, err);
    if (code == 0)
        code = run_reference(&study_run, err);
    for (size_t i = 0; i < study_run.n_settings && code == 0; i++)
        code = run_setting(&study_run, &study_run.settings[i], err);
    if (code == 0)
        code = fit_all(&study_run, err);
    if (code == 0)
        orl_study_mark_front(study.points, study.n_points);
    if (study_run.runs_env.folder[0])
        rmdir(study_run.runs_env.folder);
    free(study_run.settings);
    orl_reference_done(&study_run.reference);
    if (code < 0)
        orl_study_done(&study);
    else
        *ret_study = study;
    return code;
}

/* ---- Points as comma-separated values -------------------------------------------------------- */

static void write_names(FILE *stream)
{
    fputs("technique,photons,samples,seeds", stream);
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        fprintf(stream, ",%s_s", orl_stage_name((enum orl_stage)i));
    fputs(",total_s,total_error_s,rms,rms_error,bias,bias_error,noise,p95,peak,map_bytes,"
          "reference_shows,on_front\n",
          stream);
}

static void write_point(FILE *stream, const struct orl_study_point *p)
{
    const double measures[] = {p->total_s,    p->total_error_s, p->rms, p->rms_error, p->bias,
                               p->bias_error, p->noise,         p->p95, p->peak};
    fprintf(stream, "%s,%llu,%u,%u", orl_technique_name(p->setting.technique),
            (unsigned long long)p->setting.photons, p->setting.samples, p->seeds);
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        orl_out_number(stream, p->stages_s[i]);
    for (size_t i = 0; i < sizeof measures / sizeof *measures; i++)
        orl_out_number(stream, measures[i]);
    fprintf(stream, ",%llu,%d,%d\n", (unsigned long long)p->map_bytes, p->reference_shows,
            p->on_front);
}

int orl_study_write_csv(const struct orl_study *study, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    write_names(file.stream);
    for (size_t i = 0; i < study->n_points; i++)
        write_point(file.stream, &study->points[i]);
    return orl_out_close(&file, 0, err);
}
