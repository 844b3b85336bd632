#include "checks/child_plan.h"

#include <stdatomic.h>

#include <oriel/crew.h>
#include <oriel/skies.h>

#include "encode.h"
#include "process/times.h"
#include "result_json.h"
#include "runner/job_output.h"
#include "runner/job_work.h"

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

static int add_plan(void *ctx, const char *sky, const struct orl_result *planned,
                    const struct orl_curve *curve, struct orl_error *err)
{
    json_t *plan = orl_planned_to_json(planned, curve);
    if (plan &&
        json_object_set_new(plan, "sky", sky ? orl_json_from_text(sky) : json_null()) == 0 &&
        json_array_append_new(ctx, plan) == 0)
        return 0;
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

int orl_child_plan(struct orl_opened *opened, json_t **ret_result, struct orl_error *err)
{
    static atomic_bool cancel; /* never set: the process is killed instead */
    const struct orl_files files = orl_opened_provider(opened);
    struct orl_run_env env = {.files = &files, .cancel = &cancel, .now_s = now_s};
    struct orl_task task;
    int rc = orl_job_read(opened->single.data, opened->single.size, &task, NULL, err);
    if (rc)
        return rc;
    if (task.kind != ORL_TASK_RENDER)
        return orl_error_set(err, ORL_ERR_INVALID, "only a render job has a plan");
    rc = orl_job_set_scene(&task, &opened->bundle, err);
    const struct orl_job_work work = orl_job_work(&task, &files);
    env.crew = orl_crew_new(1);
    json_t *plans = json_array();
    const struct orl_job *job = &task.of.render;
    if (rc == 0)
        rc = env.crew && plans ? orl_plan_skies(job, &env, ORL_PLAN_SKIES, add_plan, plans, err)
                               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0)
        *ret_result = json_pack("{s:o, s:b, s:[i, f]}", "plans", plans, "more",
                                job->n_skies > ORL_PLAN_SKIES, "work", (int)work.way, work.s);
    return rc;
}
