#include "checks/child/child_plan.h"

#include <stdatomic.h>

#include <oriel/base/thread_pool.h>
#include <oriel/job/skies.h>

#include "process/times.h"
#include "result/result_json.h"
#include "runner/estimate/job_work.h"
#include "runner/job_output.h"
#include "json/encode.h"

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

static int add_plan(void *ctx, const char *sky, const struct orl_result *planned,
                    const struct orl_accuracy_curve *curve, struct orl_error *err)
{
    json_t *plan = orl_planned_to_json(planned, curve);
    if (plan &&
        json_object_set_new(plan, "sky", sky ? orl_json_from_text(sky) : json_null()) == 0 &&
        json_array_append_new(ctx, plan) == 0)
        return 0;
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

int orl_child_plan(struct orl_mapped_inputs *mapped, json_t **ret_result, struct orl_error *err)
{
    static atomic_bool cancel; /* never set: the process is killed instead */
    const struct orl_files files = orl_mapped_inputs_provider(mapped);
    struct orl_run_env env = {.files = &files, .cancel = &cancel, .now_s = now_s};
    struct orl_job_request job_request;
    int rc = orl_job_read(mapped->single.data, mapped->single.size, &job_request, NULL, err);
    if (rc)
        return rc;
    if (job_request.kind != ORL_JOB_KIND_RENDER)
        return orl_error_set(err, ORL_ERR_INVALID, "only a render job has a plan");
    rc = orl_job_set_scene(&job_request, &mapped->bundle, err);
    const struct orl_job_work work = orl_job_work(&job_request, &files);
    env.pool = orl_thread_pool_new(1);
    json_t *plans = json_array();
    const struct orl_job *job = &job_request.of.render;
    if (rc == 0)
        rc = env.pool && plans ? orl_plan_skies(job, &env, ORL_PLAN_SKIES, add_plan, plans, err)
                               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0)
        *ret_result =
            json_pack("{s:o, s:b, s:[i, f]}", "plans", plans, "more", job->n_skies > ORL_PLAN_SKIES,
                      "work", (int)work.work_class, work.s);
    return rc;
}
