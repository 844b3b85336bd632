/* A panel's BSDF being made: its file and what is told of it, and a BSDF for scenes to name. */
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf.h>
#include <oriel/bsdf_kept.h>

#include "bsdf_json.h"
#include "encode.h"
#include "process/times.h"
#include "runner/worker_run.h"

/* ---- What is told ---------------------------------------------------------------------------- */

/* What it is told by. */
struct told {
    struct orl_worker *worker;
    const struct orl_bsdf_make_request *request;
    double began_s;
};

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

/* How many rounds there will be is not known: each is taken to do half of what is left. */
static double of_whole(const struct orl_bsdf_make_request *request, uint32_t round, double fraction)
{
    const double before = 1 - ldexp(1, 1 - (int)round);
    return request->accuracy > 0 && !orl_bsdf_basis_is_tree(request->basis)
               ? before + (1 - before) * 0.5 * fraction
               : fraction;
}

static void on_progress(void *ctx, uint32_t round, double fraction)
{
    const struct told *told = ctx;
    struct orl_worker *worker = told->worker;
    const double done = of_whole(told->request, round, fraction), least = 0.01;
    const double spent_s = orl_time_steady_s() - told->began_s;
    atomic_store(&worker->stage, (int)ORL_STAGE_RENDER);
    atomic_store(&worker->stage_ppm, (int)(ORL_WORKER_WHOLE * fraction));
    atomic_store(&worker->job_ppm, (int)(ORL_WORKER_WHOLE * done));
    if (done >= least)
        orl_worker_take_left(worker, spent_s * (1 - done) / done);
}

static void show_map(struct orl_worker *worker, const struct orl_map_info *info)
{
    pthread_mutex_lock(&worker->news_mutex);
    worker->maps[0] = *info;
    worker->n_maps = 1;
    pthread_mutex_unlock(&worker->news_mutex);
}

/* ---- The BSDF -------------------------------------------------------------------------------- */

/* As POST /v1/bsdfs looks at one; its text is the daemon's own. */
static int examine(const struct orl_bsdf_made *made, char **ret_summary, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_bsdf_check *check = calloc(1, sizeof *check);
    int rc = check ? orl_bsdf_load_xml(ORL_BSDF_MADE_FILE, made->xml, made->xml_size, &bsdf, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0) {
        orl_bsdf_examine(bsdf, check);
        json_t *json = orl_bsdf_check_to_json(check);
        *ret_summary = json ? orl_json_text(json, JSON_COMPACT) : NULL;
        json_decref(json);
        rc = *ret_summary ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    orl_bsdf_unref(bsdf);
    free(check);
    return rc;
}

/* Files call it by its material's name, where that is fit for one. */
static void name_bsdf(const struct orl_bsdf_make_request *request, struct orl_made_bsdf *made)
{
    char name[sizeof made->name];
    snprintf(made->name, sizeof made->name, "%s", ORL_BSDF_MADE_FILE);
    if (!request->name)
        return;
    snprintf(name, sizeof name, "%.200s.xml", request->name);
    if (orl_bundle_check_name(name, NULL) == 0)
        memcpy(made->name, name, sizeof name);
}

static int write_all(struct orl_worker *worker, const struct orl_bsdf_make_request *request,
                     const struct orl_bsdf_made *made, double total_s, struct orl_error *err)
{
    struct orl_made_bsdf *bsdf = calloc(1, sizeof *bsdf);
    char path[ORL_PATH_MAX];
    if (!bsdf)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    worker->outcome.bsdf = bsdf;
    orl_sha256_hex(made->xml, made->xml_size, bsdf->id);
    bsdf->bytes = made->xml_size;
    name_bsdf(request, bsdf);
    int rc = examine(made, &bsdf->summary, err);
    orl_job_output_path(worker->output, ORL_BSDF_MADE_FILE, path);
    if (rc == 0)
        rc = orl_write_file(path, made->xml, made->xml_size, err);
    if (rc == 0)
        rc = orl_bsdf_output_write(&(struct orl_bsdf_output){made, request, &worker->maps[0],
                                                             ORL_BSDF_MADE_FILE, bsdf->id,
                                                             worker->spec.threads, total_s},
                                   worker->output, &worker->outcome.summary, err);
    return rc;
}

void orl_made_bsdf_free(struct orl_made_bsdf *bsdf)
{
    if (bsdf)
        free(bsdf->summary);
    free(bsdf);
}

/* ---- The job --------------------------------------------------------------------------------- */

int orl_worker_run_bsdf(struct orl_worker *worker, struct orl_task *task,
                        const struct orl_files *files, struct orl_error *err)
{
    const struct orl_bsdf_make_request *request = &task->of.bsdf_make;
    struct told told = {worker, request, orl_time_steady_s()};
    const struct orl_bsdf_make_env env = {.files = files,
                                          .crew = worker->crew,
                                          .cancel = &worker->cancel,
                                          .progress = on_progress,
                                          .ctx = &told};
    struct orl_bsdf_made made = {0};
    struct orl_map_info info;
    int rc = orl_bsdf_make_kept(request, &env, &worker->spec.maps, worker->spec.key, now_s, &info,
                                &made, err);
    if (rc)
        return rc;
    const double total_s = orl_time_steady_s() - told.began_s;
    show_map(worker, &info);
    worker->outcome.tally.stages_s[ORL_STAGE_RENDER] += total_s;
    rc = write_all(worker, request, &made, total_s, err);
    orl_bsdf_made_done(&made);
    malloc_trim(0);
    return rc;
}
