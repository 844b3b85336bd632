/*
 * Runs a study from its request to its results: the reference first, then each setting, finally the
 * fits and the Pareto front.
 */
#include <oriel/study.h>

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "run/stages.h"
#include "study/error_model.h"
#include "study/judge.h"
#include "study/series.h"
#include "study/shared_runs.h"
#include "study/speed.h"
#include "study/study_cost.h"
#include "study/study_request.h"

void orl_study_done(struct orl_study *study)
{
    if (!study)
        return;
    free(study->points);
    free(study->fits);
    orl_study_free_given(study->given, study->n_given);
    for (size_t i = 0; i < study->n_warnings; i++)
        free(study->warnings[i]);
    free(study->warnings);
    memset(study, 0, sizeof *study);
}

const char *orl_study_step_name(const struct orl_study_step *step)
{
    return step->in_parts    ? "parts"
           : step->reference ? "reference"
                             : orl_technique_name(step->setting.technique);
}

/* State shared by the steps of a study. */
struct work {
    const struct orl_study_request *request;
    const struct orl_study_env *env;
    struct orl_study *study;
    struct orl_runs_env runs_env;
    struct orl_study_setting *settings; /* owned */
    size_t n_settings;
    struct orl_reference reference; /* owned */
};

static double sum_of(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    return sum;
}

/* Runs the reference, with seeds that no judged run has. */
static int run_reference(struct work *work, struct orl_error *err)
{
    const struct orl_study_setting setting = orl_study_reference_setting(work->request);
    const uint32_t runs = work->request->reference_runs;
    struct orl_study_reference *about = &work->study->reference;
    struct orl_series series = {0};
    work->runs_env.step.reference = true;
    int code = orl_series_run(&work->runs_env, &setting, orl_study_reference_seed(work->request),
                              runs, &series, err);
    if (code == 0)
        code = orl_reference_make(&work->reference, series.values, runs,
                                  runs == 1 ? series.errors : NULL, series.count,
                                  work->study->of_views, err);
    if (code == 0) {
        about->samples = setting.samples * runs;
        about->runs = runs;
        about->seconds = sum_of(series.total_s, runs);
        work->study->threads = series.threads;
        orl_reference_describe(&work->reference, about);
    }
    orl_series_done(&series);
    return code;
}

static void take_times(struct orl_study_point *point, const struct orl_series *series)
{
    const double n = (double)series->n_runs;
    double squares = 0;
    point->total_s = sum_of(series->total_s, series->n_runs) / n;
    for (size_t i = 0; i < series->n_runs; i++) {
        const double d = series->total_s[i] - point->total_s;
        squares += d * d;
        for (int stage = 0; stage < ORL_STAGE_COUNT; stage++)
            point->stages_s[stage] += series->stages_s[i][stage] / n;
    }
    point->total_error_s = series->n_runs > 1 ? sqrt(squares / (n * (n - 1))) : NAN;
    point->map_bytes = series->map_bytes;
}

static int run_setting(struct work *work, const struct orl_study_setting *setting,
                       struct orl_error *err)
{
    struct orl_study_point point = {.setting = *setting, .seeds = work->request->repeats};
    struct orl_series series = {0};
    work->runs_env.step.reference = false;
    int code = orl_series_run(&work->runs_env, setting, work->request->job.seed,
                              work->request->repeats, &series, err);
    if (code == 0 && series.count != work->reference.count)
        code = orl_error_set(err, ORL_ERR_INTERNAL, "a run and its reference differ in size");
    if (code == 0)
        code = orl_study_judge(&work->reference, series.values, series.n_runs,
                               work->study->of_views, &point, err);
    if (code == 0) {
        take_times(&point, &series);
        work->study->points[work->study->n_points++] = point;
        if (work->env->point_ready)
            work->env->point_ready(work->env->ctx, &point);
    }
    orl_series_done(&series);
    return code;
}

static int copy_given(struct work *work, struct orl_error *err)
{
    const struct orl_study_request *request = work->request;
    struct orl_study *study = work->study;
    study->given = calloc(request->n_given + 1, sizeof *study->given);
    for (size_t i = 0; study->given && i < request->n_given; i++) {
        study->given[i] = request->given[i];
        study->given[i].name = strdup(request->given[i].name);
        study->n_given = i + 1;
        if (!study->given[i].name)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    return study->given ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* Counts the sensors for cost estimates, also those in a file. */
static int count_sensors(struct work *work, struct orl_error *err)
{
    const struct orl_job *job = &work->request->job;
    struct orl_sensor *sensors = NULL;
    size_t n = job->n_sensors;
    const int code = job->sensors_file ? orl_sensors_load(work->env->files, job->sensors_file,
                                                          work->env->cancel, &sensors, &n, err)
                                       : 0;
    free(sensors);
    work->runs_env.sensors = (double)n;
    return code;
}

static int make_folder(struct work *work, struct orl_error *err)
{
    struct orl_runs_env *runs = &work->runs_env;
    const int length =
        snprintf(runs->folder, sizeof runs->folder, "%s/study-XXXXXX", work->env->work_folder);
    if (length < 0 || (size_t)length >= sizeof runs->folder)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the work folder is too long");
    if (mkdtemp(runs->folder))
        return 0;
    runs->folder[0] = '\0';
    return orl_error_set(err, orl_err_of_errno(errno), "cannot make a folder in '%s': %s",
                         work->env->work_folder, strerror(errno));
}

static int prepare_study(struct work *work, struct orl_error *err)
{
    struct orl_study *study = work->study;
    int code = copy_given(work, err);
    if (code == 0)
        code = orl_study_list_settings(work->request, &work->settings, &work->n_settings, err);
    if (code == 0)
        code = count_sensors(work, err);
    if (code < 0)
        return code;
    study->points = calloc(work->n_settings + 1, sizeof *study->points);
    study->fits = calloc(ORL_TECHNIQUE_COUNT, sizeof *study->fits);
    if (!study->points || !study->fits)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    work->runs_env.all = orl_study_core_s(work->request, work->runs_env.sensors);
    return make_folder(work, err);
}

/* Measures the machine's speed. In a distributed study this also makes all runs. */
static int measure_speed(struct work *work, struct orl_error *err)
{
    double *rays_per_s = &work->study->rays_per_s;
    return orl_study_is_shared(work->env)
               ? orl_share_runs(&work->runs_env, work->settings, work->n_settings, rays_per_s, err)
               : orl_study_measure_speed(work->request, work->env, rays_per_s, err);
}

/* Measures the speed, and scales times that were measured on other machines. */
static int find_speed(struct work *work, struct orl_error *err)
{
    struct orl_study *study = work->study;
    const int code = measure_speed(work, err);
    for (size_t i = 0; i < study->n_given && code == 0; i++) {
        struct orl_study_given *given = &study->given[i];
        const bool known = given->rays_per_s > 0 && isfinite(study->rays_per_s);
        const double here_s = given->seconds * (known ? given->rays_per_s / study->rays_per_s : 1);
        given->here_s = fmin(fmax(here_s, ORL_STUDY_LEAST), ORL_STUDY_MOST);
    }
    return code;
}

static int fit_all(struct work *work, struct orl_error *err)
{
    struct orl_study *study = work->study;
    int code = 0;
    for (size_t i = 0; i < work->request->n_techniques && code >= 0; i++) {
        code = orl_study_fit_make(study->points, study->n_points, work->request->techniques[i],
                                  &study->fits[study->n_fits], err);
        study->n_fits += code == 1;
    }
    return code < 0 ? code : 0;
}

int orl_study_run(const struct orl_study_request *request, const struct orl_study_env *env,
                  struct orl_study *ret_study, struct orl_error *err)
{
    struct orl_study study = {.of_views = orl_study_of_views(request)};
    struct work work = {.request = request,
                        .env = env,
                        .study = &study,
                        .runs_env = {.request = request,
                                     .env = env,
                                     .warnings = &study.warnings,
                                     .n_warnings = &study.n_warnings}};
    int code = orl_study_request_validate(request, err);
    if (code == 0)
        code = prepare_study(&work, err);
    if (code == 0)
        code = find_speed(&work, err);
    if (code == 0)
        code = run_reference(&work, err);
    for (size_t i = 0; i < work.n_settings && code == 0; i++)
        code = run_setting(&work, &work.settings[i], err);
    if (code == 0)
        code = fit_all(&work, err);
    if (code == 0)
        orl_study_mark_front(study.points, study.n_points);
    if (work.runs_env.folder[0])
        rmdir(work.runs_env.folder);
    free(work.settings);
    orl_reference_done(&work.reference);
    if (code < 0)
        orl_study_done(&study);
    else
        *ret_study = study;
    return code;
}
