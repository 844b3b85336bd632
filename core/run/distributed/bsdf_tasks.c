#include <oriel/bsdf/bsdf_distributed.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/distributed/task_work.h"

/* Version of a lot's content and file layout; change it with either. */
static const char recipe[] = "oriel bsdf lots 2";

static void name_task(const char *job, const struct orl_bsdf_tasks *bsdf_tasks, size_t index,
                      struct orl_job_task *ret_task)
{
    struct orl_sha256 hash;
    const uint64_t number = index;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, recipe, sizeof recipe);
    orl_sha256_add(&hash, job, strlen(job) + 1);
    orl_sha256_add(&hash, bsdf_tasks->name, strlen(bsdf_tasks->name) + 1);
    orl_sha256_add(&hash, &number, sizeof number);
    *ret_task =
        (struct orl_job_task){.kind = "lot", .core_s = bsdf_tasks->core_s(bsdf_tasks->ctx, index)};
    ret_task->work = ret_task->core_s;
    orl_task_key_end(&hash, ret_task->key);
}

static int run_bsdf_tasks(void *ctx, const struct orl_bsdf_tasks *bsdf_tasks, struct orl_error *err)
{
    const struct orl_bsdf_task_store *state = ctx;
    const struct orl_run_env run = {.store = state->store, .tasks = state->tasks};
    struct orl_task_work work = {.n = bsdf_tasks->n,
                                 .ctx = bsdf_tasks->ctx,
                                 .make = bsdf_tasks->make,
                                 .take = bsdf_tasks->take,
                                 .told = bsdf_tasks->told};
    work.tasks = calloc(bsdf_tasks->n + 1, sizeof *work.tasks);
    if (!work.tasks)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for pieces of a job");
    for (size_t i = 0; i < bsdf_tasks->n; i++)
        name_task(state->tasks->job, bsdf_tasks, i, &work.tasks[i]);
    const int code = orl_run_tasks(&run, &work, err);
    free(work.tasks);
    return code;
}

struct orl_bsdf_distributor orl_bsdf_distribute(struct orl_bsdf_task_store *state)
{
    return (struct orl_bsdf_distributor){state, run_bsdf_tasks};
}
