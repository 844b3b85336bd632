/* A job that makes a BSDF, of a panel or from measurements: it writes the BSDF's file and report,
 * and stores the BSDF for scenes to name. */
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_store.h>

#include "bsdf_json/bsdf_json.h"
#include "process/times.h"
#include "runner/worker/worker_run.h"
#include "json/encode.h"

/* ---- Progress ------------------------------------------------------------------------------- */

/* Context of the progress callbacks. */
struct progress {
    struct orl_worker *worker;
    bool in_rounds; /* true if the number of rounds is unknown */
    double began_s;
};

/* Returns the finished fraction of the job. If the number of rounds is unknown, each round counts
 * as half of the rest. */
static double job_fraction(const struct progress *progress, uint32_t round, double fraction)
{
    const double before = 1 - ldexp(1, 1 - (int)round);
    return progress->in_rounds ? before + (1 - before) * 0.5 * fraction : fraction;
}

static void on_progress(void *ctx, uint32_t round, double fraction)
{
    const struct progress *progress = ctx;
    struct orl_worker *worker = progress->worker;
    const double done = job_fraction(progress, round, fraction), least = 0.01;
    const double spent_s = orl_time_steady_s() - progress->began_s;
    atomic_store(&worker->stage, (int)ORL_STAGE_RENDER);
    atomic_store(&worker->stage_ppm, (int)(ORL_WORKER_WHOLE * fraction));
    atomic_store(&worker->job_ppm, (int)(ORL_WORKER_WHOLE * done));
    if (done >= least)
        orl_worker_set_eta(worker, spent_s * (1 - done) / done);
}

static void show_map(struct orl_worker *worker, const struct orl_map_info *info)
{
    pthread_mutex_lock(&worker->news_mutex);
    worker->progress.maps[0] = *info;
    worker->progress.n_maps = 1;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* ---- The BSDF -------------------------------------------------------------------------------- */

/* A finished BSDF of either kind of job. */
struct outcome {
    const char *name; /* name of its material, or NULL */
    const char *xml;
    size_t size;
    json_t *report, *warnings; /* owned */
};

/* Summarises the BSDF like POST /v1/bsdfs does. No child is needed, since the daemon wrote the
 * text. */
static int summarise_bsdf(const struct outcome *made, char **ret_summary, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_bsdf_check *check = calloc(1, sizeof *check);
    int rc = check ? orl_bsdf_load_xml(ORL_BSDF_MADE_FILE, made->xml, made->size, &bsdf, err)
                   : orl_error_no_memory(err);
    if (rc == 0) {
        orl_bsdf_examine(bsdf, check);
        json_t *json = orl_bsdf_check_to_json(check);
        *ret_summary = orl_json_text(json, JSON_COMPACT);
        json_decref(json);
        rc = *ret_summary ? 0 : orl_error_no_memory(err);
    }
    orl_bsdf_unref(bsdf);
    free(check);
    return rc;
}

/* Names the BSDF after its material, if that is a valid file name. */
static void name_bsdf(const char *material, struct orl_made_bsdf *made)
{
    char name[sizeof made->name];
    snprintf(made->name, sizeof made->name, "%s", ORL_BSDF_MADE_FILE);
    if (!material)
        return;
    snprintf(name, sizeof name, "%.200s.xml", material);
    if (orl_bundle_check_name(name, NULL) == 0)
        memcpy(made->name, name, sizeof name);
}

static int write_file(struct orl_worker *worker, const struct outcome *made, struct orl_error *err)
{
    struct orl_made_bsdf *bsdf = calloc(1, sizeof *bsdf);
    char path[ORL_PATH_MAX];
    if (!bsdf)
        return orl_error_no_memory(err);
    worker->outcome.bsdf = bsdf;
    orl_sha256_hex(made->xml, made->size, bsdf->id);
    bsdf->bytes = made->size;
    name_bsdf(made->name, bsdf);
    const int rc = summarise_bsdf(made, &bsdf->summary, err);
    orl_job_output_path(worker->output, ORL_BSDF_MADE_FILE, path);
    return rc ? rc : orl_write_file(path, made->xml, made->size, err);
}

/* Writes all files. Takes ownership of made->report and made->warnings. */
static int write_all(struct orl_worker *worker, const struct outcome *made, double total_s,
                     struct orl_error *err)
{
    worker->outcome.tally.stages_s[ORL_STAGE_RENDER] += total_s;
    const int rc = write_file(worker, made, err);
    if (rc) {
        json_decref(made->report);
        json_decref(made->warnings);
        return rc;
    }
    const struct orl_bsdf_output output = {.report = made->report,
                                           .warnings = made->warnings,
                                           .kept = &worker->progress.maps[0],
                                           .file = ORL_BSDF_MADE_FILE,
                                           .id = worker->outcome.bsdf->id,
                                           .bytes = made->size,
                                           .threads = worker->spec.threads,
                                           .total_s = total_s};
    return orl_bsdf_output_write(&output, worker->output, &worker->outcome.summary, err);
}

void orl_made_bsdf_free(struct orl_made_bsdf *bsdf)
{
    if (bsdf)
        free(bsdf->summary);
    free(bsdf);
}

/* ---- The jobs -------------------------------------------------------------------------------- */

static struct orl_bsdf_make_env env_of(struct progress *progress, const struct orl_files *files)
{
    struct orl_worker *worker = progress->worker;
    progress->began_s = orl_time_steady_s();
    return (struct orl_bsdf_make_env){.files = files,
                                      .pool = worker->pool,
                                      .cancel = &worker->cancel,
                                      .progress = on_progress,
                                      .ctx = progress};
}

static struct orl_bsdf_cache_key keep_of(const struct orl_worker *worker)
{
    return (struct orl_bsdf_cache_key){&worker->spec.maps, worker->spec.key, orl_time_steady_for};
}

int orl_worker_run_bsdf(struct orl_worker *worker, struct orl_job_request *job_request,
                        const struct orl_files *files, struct orl_error *err)
{
    const struct orl_bsdf_make_request *request = &job_request->of.bsdf_make;
    struct progress progress = {
        worker, request->accuracy > 0 && !orl_bsdf_basis_is_tree(request->basis), 0};
    struct orl_bsdf_make_env env = env_of(&progress, files);
    struct orl_bsdf_task_store tasks = {&worker->distributed.tasks, &worker->distributed.store};
    const struct orl_bsdf_distributor shared = orl_bsdf_distribute(&tasks);
    const struct orl_bsdf_cache_key cache_key = keep_of(worker);
    struct orl_bsdf_make_result made = {0};
    env.shared = worker->progress.in_parts ? &shared : NULL;
    struct orl_map_info info;
    int rc = orl_bsdf_make_cached(request, &env, &cache_key, &info, &made, err);
    if (rc)
        return rc;
    const double total_s = orl_time_steady_s() - progress.began_s;
    show_map(worker, &info);
    const struct outcome outcome = {request->name, made.xml, made.xml_size,
                                    orl_bsdf_made_to_json(&made),
                                    orl_bsdf_made_warnings(&made, request)};
    rc = write_all(worker, &outcome, total_s, err);
    orl_bsdf_make_result_done(&made);
    malloc_trim(0);
    return rc;
}

int orl_worker_run_fit(struct orl_worker *worker, struct orl_job_request *job_request,
                       const struct orl_files *files, struct orl_error *err)
{
    const struct orl_bsdf_fit_request *request = &job_request->of.bsdf_fit;
    struct progress progress = {worker, false, 0};
    const struct orl_bsdf_make_env env = env_of(&progress, files);
    const struct orl_bsdf_cache_key cache_key = keep_of(worker);
    struct orl_bsdf_fit_result fitted = {0};
    struct orl_map_info info;
    int rc = orl_bsdf_fit_cached(request, &env, &cache_key, &info, &fitted, err);
    if (rc)
        return rc;
    const double total_s = orl_time_steady_s() - progress.began_s;
    show_map(worker, &info);
    const struct outcome outcome = {request->name ? request->name : fitted.sample, fitted.xml,
                                    fitted.xml_size, orl_bsdf_fitted_to_json(request, &fitted),
                                    orl_bsdf_fitted_warnings(&fitted)};
    rc = write_all(worker, &outcome, total_s, err);
    orl_bsdf_fit_result_done(&fitted);
    malloc_trim(0);
    return rc;
}
