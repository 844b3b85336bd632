#include "parts/sharing.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "parts/wave.h"
#include "parts/wave_files.h"
#include "parts/whole_files.h"

/* Makes the pieces that are not made yet, in their order. */
static int run_rest(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                    const bool *made, struct orl_error *err)
{
    struct orl_piece *rest = malloc((n + 1) * sizeof *rest);
    size_t kept = 0;
    int rc;

    if (!rest)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < n; i++)
        if (!made[i])
            rest[kept++] = pieces[i];
    rc = kept > 0 ? orl_wave_run(sharing, rest, kept, err) : 0;
    free(rest);
    return rc;
}

/* Callback of a run that hands out all its pieces. */
static int distribute_pieces(void *ctx, const struct orl_piece *pieces, size_t n, bool *ret_here,
                             const struct orl_pieces_watch *watch, struct orl_error *err)
{
    struct orl_sharing *sharing = ctx;
    bool *made = calloc(n + 1, sizeof *made);
    int rc;

    (void)ret_here;
    if (!made)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    sharing->watch = watch;
    rc = orl_wave_adopt(sharing, pieces, n, made, err);
    if (rc == 0)
        rc = run_rest(sharing, pieces, n, made, err);
    free(made);
    return rc;
}

static int start_runner(struct orl_sharing *sharing, struct orl_error *err)
{
    const struct orl_sharing_spec *spec = &sharing->spec;
    const struct orl_runner_spec wanted = {.folder = sharing->folder,
                                           .job = sharing->job,
                                           .program = spec->program,
                                           .threads = spec->threads,
                                           .most = spec->slurm ? spec->most : spec->abreast,
                                           .words = spec->words,
                                           .n_words = spec->n_words,
                                           .cancel = spec->cancel,
                                           .now_s = spec->now_s};

    return spec->slurm ? orl_runner_slurm(&wanted, &sharing->runner, err)
                       : orl_runner_local(&wanted, &sharing->runner, err);
}

int orl_sharing_open(struct orl_sharing *sharing, const struct orl_sharing_spec *spec,
                     struct orl_error *err)
{
    int rc;

    *sharing =
        (struct orl_sharing){.spec = *spec, .began = time(NULL), .opened_s = spec->now_s(NULL)};
    rc = orl_shared_folder_make(spec->folder, spec->doc, spec->files, spec->n_files, sharing->job,
                                &sharing->earlier, err);
    if (rc)
        return rc;
    if (!realpath(spec->folder, sharing->folder))
        return orl_error_set(err, orl_err_of_errno(errno), "cannot find '%s': %s", spec->folder,
                             strerror(errno));
    snprintf(sharing->in_folder.folder, sizeof sharing->in_folder.folder, "%.4000s/store",
             sharing->folder);
    orl_shared_store_init(&sharing->in_folder, &sharing->store);
    sharing->pieces = (struct orl_pieces){sharing, sharing->job, distribute_pieces, NULL};
    return start_runner(sharing, err);
}

void orl_sharing_done(struct orl_sharing *sharing, bool remove)
{
    if (sharing->runner.done)
        sharing->runner.done(sharing->runner.ctx);
    orl_shared_store_done(&sharing->in_folder);
    if (remove && sharing->folder[0])
        orl_remove_folder(sharing->folder);
}

int orl_sharing_abandon(const char *folder, double (*now_s)(void *ctx), struct orl_error *err)
{
    char job[ORL_PIECE_KEY], wave[ORL_WAVE_NAME];
    const struct orl_runner_spec spec = {.job = job, .now_s = now_s};
    json_t *doc = NULL;
    int rc = 0;

    /* If verification fails, there is nothing to cancel: tasks cannot succeed without the job's
     * files. */
    if (orl_shared_folder_verify(folder, job, &doc, NULL) == 0)
        while (rc == 0 && orl_wave_find(folder, wave)) {
            rc = orl_slurm_cancel(&spec, wave, err);
            if (!orl_wave_forget(folder, wave))
                break;
        }
    json_decref(doc);
    orl_remove_folder(folder);
    return rc;
}
