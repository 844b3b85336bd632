#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/bsdf/bsdf_store.h>

#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "input/input_folders.h"
#include "output/terminal.h"

int orl_bsdf_file_load(const char *path, struct orl_bsdf **ret_bsdf, struct orl_error *err)
{
    struct orl_files files = orl_files_from_folder(".");
    struct orl_file file;
    int rc = files.open(files.ctx, path, &file, err);
    if (rc < 0)
        return rc;
    const struct orl_bsdf_xml xml = {
        .name = path, .data = file.data, .size = file.size, .cancel = orl_local_interrupted()};
    rc = orl_bsdf_load(&xml, ret_bsdf, err);
    files.close(files.ctx, &file);
    return rc;
}

int orl_bsdf_file_source(const char *path, char ret_source[512], struct orl_error *err)
{
    const char *slash = strrchr(path, '/');
    char sha[ORL_DIGEST_TEXT];
    const int rc = orl_digest_file(path, sha, err);
    if (rc == 0)
        snprintf(ret_source, 512, "%.300s, SHA-256 %s", slash ? slash + 1 : path, sha);
    return rc;
}

/* ---- Computing, fitting, converting, comparing ----------------------------------------------- */

/* State of a BSDF computation. */
struct bsdf_run {
    struct orl_files files;
    struct orl_progress_line progress;
    struct orl_bsdf_make_env env;
};

static void on_progress(void *ctx, uint32_t round, double fraction)
{
    char name[32];
    snprintf(name, sizeof name, "round %u", round);
    orl_progress_show(ctx, name, fraction, NAN);
}

static int start_crew(uint32_t threads, struct orl_thread_pool **ret_pool, struct orl_error *err)
{
    *ret_pool = orl_thread_pool_start(threads);
    return *ret_pool ? 0
                     : orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
}

/* folder: NULL if no files are read. */
static int bsdf_run_start(struct bsdf_run *m, const char *folder, uint32_t threads,
                          struct orl_error *err)
{
    *m = (struct bsdf_run){.env = {.cancel = orl_local_interrupted(), .progress = on_progress}};
    if (folder) {
        m->files = orl_raypath_files(folder);
        m->env.files = &m->files;
    }
    m->env.ctx = &m->progress;
    int rc = start_crew(threads, &m->env.pool, err);
    if (rc == 0)
        orl_progress_start(&m->progress);
    return rc;
}

static void bsdf_run_stop(struct bsdf_run *m)
{
    orl_progress_end(&m->progress);
    orl_thread_pool_stop(m->env.pool);
}

int orl_local_make_bsdf(const struct orl_bsdf_make_request *request, const char *folder,
                        uint32_t threads, const struct orl_local_distribution *distribution,
                        struct orl_bsdf_make_result *ret_made, struct orl_error *err)
{
    struct orl_bsdf_task_store tasks = {.store = NULL};
    const struct orl_bsdf_distributor shared = orl_bsdf_distribute(&tasks);
    struct bsdf_run m;
    int rc = bsdf_run_start(&m, folder, threads, err);
    if (rc)
        return rc;
    if (distribution) {
        tasks.tasks = distribution->tasks;
        tasks.store = distribution->store;
        m.env.shared = &shared;
    }
    rc = orl_bsdf_make(request, &m.env, ret_made, err);
    bsdf_run_stop(&m);
    return rc;
}

int orl_local_convert_bsdf(const struct orl_bsdf *bsdf, const char *source,
                           const struct orl_bsdf_make_request *to, uint32_t threads,
                           struct orl_bsdf_make_result *ret_made, struct orl_error *err)
{
    struct bsdf_run m;
    int rc = bsdf_run_start(&m, NULL, threads, err);
    if (rc)
        return rc;
    rc = orl_bsdf_convert(bsdf, source, to, &m.env, ret_made, err);
    bsdf_run_stop(&m);
    return rc;
}

int orl_local_cull_bsdf(const struct orl_bsdf *bsdf, const char *source,
                        const struct orl_bsdf_make_request *to, double within, uint32_t threads,
                        double *ret_unseen, struct orl_bsdf_make_result *ret_made,
                        struct orl_bsdf_comparison *ret_lost, struct orl_error *err)
{
    struct bsdf_run m;
    int rc = bsdf_run_start(&m, NULL, threads, err);
    if (rc)
        return rc;
    rc = orl_bsdf_convert_within(bsdf, source, to, within, &m.env, ret_unseen, ret_made, ret_lost,
                                 err);
    bsdf_run_stop(&m);
    return rc;
}

int orl_local_fit_bsdf(const struct orl_bsdf_fit_request *request, const char *folder,
                       uint32_t threads, struct orl_bsdf_fit_result *ret_fitted,
                       struct orl_error *err)
{
    struct bsdf_run m;
    int rc = bsdf_run_start(&m, folder, threads, err);
    if (rc)
        return rc;
    rc = orl_bsdf_fit(request, &m.env, ret_fitted, err);
    bsdf_run_stop(&m);
    return rc;
}

int orl_local_compare_bsdfs(const struct orl_bsdf *a, const struct orl_bsdf *b, uint32_t threads,
                            struct orl_bsdf_comparison *ret_comparison, struct orl_error *err)
{
    struct orl_thread_pool *pool;
    int rc = start_crew(threads, &pool, err);
    if (rc)
        return rc;
    rc = orl_bsdf_compare(a, b, pool, orl_local_interrupted(), ret_comparison, err);
    orl_thread_pool_stop(pool);
    return rc;
}
