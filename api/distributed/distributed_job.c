#include "distributed/distributed_job.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "distributed/atomic_files.h"
#include "distributed/task_round.h"

/* Makes the tasks that are not made yet, in their order. */
static int run_missing(struct orl_distributed_job *distributed, const struct orl_job_task *tasks,
                       size_t n, const bool *made, struct orl_error *err)
{
    struct orl_job_task *missing = malloc((n + 1) * sizeof *missing);
    size_t kept = 0;
    if (!missing)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < n; i++)
        if (!made[i])
            missing[kept++] = tasks[i];
    int rc = kept > 0 ? orl_task_round_run(distributed, missing, kept, err) : 0;
    free(missing);
    return rc;
}

/* Callback of a run that hands out all its tasks. */
static int distribute_pieces(void *ctx, const struct orl_job_task *tasks, size_t n, bool *ret_here,
                             const struct orl_job_tasks_watch *watch, struct orl_error *err)
{
    struct orl_distributed_job *distributed = ctx;
    bool *made = calloc(n + 1, sizeof *made);
    (void)ret_here;
    if (!made)
        return orl_error_no_memory(err);
    distributed->watch = watch;
    int rc = orl_task_round_adopt(distributed, tasks, n, made, err);
    if (rc == 0)
        rc = run_missing(distributed, tasks, n, made, err);
    free(made);
    return rc;
}

static int start_runner(struct orl_distributed_job *distributed, struct orl_error *err)
{
    const struct orl_distributed_job_spec *spec = &distributed->spec;
    const struct orl_runner_spec wanted = {.folder = distributed->folder,
                                           .job = distributed->job,
                                           .program = spec->program,
                                           .threads = spec->threads,
                                           .most = spec->slurm ? spec->most : spec->most_processes,
                                           .words = spec->words,
                                           .n_words = spec->n_words,
                                           .cancel = spec->cancel,
                                           .now_s = spec->now_s};
    return spec->slurm ? orl_runner_slurm(&wanted, &distributed->runner, err)
                       : orl_runner_local(&wanted, &distributed->runner, err);
}

int orl_distributed_job_open(struct orl_distributed_job *distributed,
                             const struct orl_distributed_job_spec *spec, struct orl_error *err)
{
    *distributed = (struct orl_distributed_job){
        .spec = *spec, .began = time(NULL), .opened_s = spec->now_s(NULL)};
    int rc = orl_shared_folder_make(spec->folder, spec->doc, spec->files, spec->n_files,
                                    distributed->job, &distributed->n_reused, err);
    if (rc)
        return rc;
    if (!realpath(spec->folder, distributed->folder))
        return orl_error_set(err, orl_err_of_errno(errno), "cannot find '%s': %s", spec->folder,
                             strerror(errno));
    snprintf(distributed->shared_store.folder, sizeof distributed->shared_store.folder,
             "%.4000s/store", distributed->folder);
    orl_shared_store_init(&distributed->shared_store, &distributed->store);
    distributed->tasks =
        (struct orl_job_tasks){distributed, distributed->job, distribute_pieces, NULL};
    return start_runner(distributed, err);
}

void orl_distributed_job_done(struct orl_distributed_job *distributed, bool remove)
{
    if (distributed->runner.done)
        distributed->runner.done(distributed->runner.ctx);
    orl_shared_store_done(&distributed->shared_store);
    if (remove && distributed->folder[0])
        orl_remove_folder(distributed->folder);
}

int orl_distributed_job_abandon(const char *folder, double (*now_s)(void *ctx),
                                struct orl_error *err)
{
    char job[ORL_JOB_TASK_KEY], round[ORL_TASK_ROUND_NAME];
    const struct orl_runner_spec spec = {.job = job, .now_s = now_s};
    json_t *doc = NULL;
    int rc = 0;
    /* If verification fails, there is nothing to cancel: tasks cannot succeed without the job's
     * files. */
    if (orl_shared_folder_verify(folder, job, &doc, NULL) == 0)
        while (rc == 0 && orl_task_round_find(folder, round)) {
            rc = orl_slurm_cancel(&spec, round, err);
            if (!orl_task_round_remove_marker(folder, round))
                break;
        }
    json_decref(doc);
    orl_remove_folder(folder);
    return rc;
}
