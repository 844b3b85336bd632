/* Computes, fits, converts and compares BSDFs in this process, with progress on stderr. */
#include "local.h"

#include <math.h>
#include <stdio.h>

#include <oriel/bsdf_shared.h>

#include "library.h"
#include "progress.h"

/* State of a BSDF computation. */
struct making {
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

static int start_crew(uint32_t threads, struct orl_crew **ret_crew, struct orl_error *err)
{
    *ret_crew = orl_crew_start(threads);
    return *ret_crew ? 0
                     : orl_error_set(err, ORL_ERR_NOMEM, "%u threads cannot be started", threads);
}

/* folder: NULL if no files are read. */
static int making_start(struct making *m, const char *folder, uint32_t threads,
                        struct orl_error *err)
{
    int rc;

    *m = (struct making){.env = {.cancel = orl_local_interrupted(), .progress = on_progress}};
    if (folder) {
        m->files = orl_library_files(folder);
        m->env.files = &m->files;
    }
    m->env.ctx = &m->progress;
    rc = start_crew(threads, &m->env.crew, err);
    if (rc == 0)
        orl_progress_start(&m->progress);
    return rc;
}

static void making_stop(struct making *m)
{
    orl_progress_end(&m->progress);
    orl_crew_stop(m->env.crew);
}

int orl_local_make_bsdf(const struct orl_bsdf_make_request *request, const char *folder,
                        uint32_t threads, const struct orl_local_share *share,
                        struct orl_bsdf_made *ret_made, struct orl_error *err)
{
    struct orl_bsdf_pieces pieces = {.store = NULL};
    const struct orl_bsdf_sharing shared = orl_bsdf_share(&pieces);
    struct making m;
    int rc = making_start(&m, folder, threads, err);

    if (rc)
        return rc;
    if (share) {
        pieces.pieces = share->pieces;
        pieces.store = share->store;
        m.env.shared = &shared;
    }
    rc = orl_bsdf_make(request, &m.env, ret_made, err);
    making_stop(&m);
    return rc;
}

int orl_local_convert_bsdf(const struct orl_bsdf *bsdf, const char *source,
                           const struct orl_bsdf_make_request *to, uint32_t threads,
                           struct orl_bsdf_made *ret_made, struct orl_error *err)
{
    struct making m;
    int rc = making_start(&m, NULL, threads, err);

    if (rc)
        return rc;
    rc = orl_bsdf_convert(bsdf, source, to, &m.env, ret_made, err);
    making_stop(&m);
    return rc;
}

int orl_local_cull_bsdf(const struct orl_bsdf *bsdf, const char *source,
                        const struct orl_bsdf_make_request *to, double within, uint32_t threads,
                        double *ret_unseen, struct orl_bsdf_made *ret_made,
                        struct orl_bsdf_comparison *ret_lost, struct orl_error *err)
{
    struct making m;
    int rc = making_start(&m, NULL, threads, err);

    if (rc)
        return rc;
    rc = orl_bsdf_convert_within(bsdf, source, to, within, &m.env, ret_unseen, ret_made, ret_lost,
                                 err);
    making_stop(&m);
    return rc;
}

int orl_local_fit_bsdf(const struct orl_bsdf_fit_request *request, const char *folder,
                       uint32_t threads, struct orl_bsdf_fitted *ret_fitted, struct orl_error *err)
{
    struct making m;
    int rc = making_start(&m, folder, threads, err);

    if (rc)
        return rc;
    rc = orl_bsdf_fit(request, &m.env, ret_fitted, err);
    making_stop(&m);
    return rc;
}

int orl_local_compare_bsdfs(const struct orl_bsdf *a, const struct orl_bsdf *b, uint32_t threads,
                            struct orl_bsdf_comparison *ret_comparison, struct orl_error *err)
{
    struct orl_crew *crew;
    int rc = start_crew(threads, &crew, err);

    if (rc)
        return rc;
    rc = orl_bsdf_compare(a, b, crew, orl_local_interrupted(), ret_comparison, err);
    orl_crew_stop(crew);
    return rc;
}
