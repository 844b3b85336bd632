#include "checks/child_plan.h"

#include <stdatomic.h>

#include <oriel/crew.h>
#include <oriel/run.h>

#include "encode.h"
#include "process/times.h"
#include "result_json.h"
#include "runner/job_output.h"

static double now_s(void *ctx)
{
    (void)ctx;
    return orl_time_steady_s();
}

/* One more plan, of the job as it stands, under that name. */
static int add_plan(json_t *plans, const struct orl_job *job, const struct orl_run_env *env,
                    const char *sky, struct orl_error *err)
{
    struct orl_result result = {0};
    const int rc = orl_plan_job(job, env, &result, err);
    if (rc)
        return rc;
    json_t *plan = orl_planned_to_json(&result);
    orl_result_done(&result);
    if (!plan || json_object_set_new(plan, "sky", sky ? orl_json_from_text(sky) : json_null()) ||
        json_array_append_new(plans, plan))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

/* The plans of a job under each of its skies. */
static int plan_skies(json_t *plans, struct orl_job *job, const struct orl_run_env *env,
                      struct orl_error *err)
{
    struct orl_named_sky *skies = job->skies;
    const struct orl_sky_request none = job->sky;
    const size_t n_skies = job->n_skies;
    int rc = 0;
    job->skies = NULL;
    job->n_skies = 0;
    for (size_t i = 0; i < n_skies && i < ORL_PLAN_SKIES && rc == 0; i++) {
        job->sky = skies[i].request;
        rc = add_plan(plans, job, env, skies[i].name, err);
    }
    job->sky = none;
    job->skies = skies;
    job->n_skies = n_skies;
    return rc;
}

int orl_child_plan(struct orl_opened *opened, json_t **ret_result, struct orl_error *err)
{
    static atomic_bool cancel; /* the process ends instead */
    const struct orl_files files = orl_opened_provider(opened);
    struct orl_run_env env = {.files = &files, .cancel = &cancel, .now_s = now_s};
    struct orl_task task;
    int rc = orl_job_read(opened->single.data, opened->single.size, &task, NULL, err);
    if (rc)
        return rc;
    if (task.kind != ORL_TASK_RENDER)
        return orl_error_set(err, ORL_ERR_INVALID, "only a render job has a plan");
    rc = orl_job_set_scene(&task, &opened->bundle, err);
    env.crew = orl_crew_new(1);
    json_t *plans = json_array();
    struct orl_job *job = &task.of.render;
    if (rc == 0)
        rc = !env.crew || !plans ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory")
             : job->n_skies > 0  ? plan_skies(plans, job, &env, err)
                                 : add_plan(plans, job, &env, NULL, err);
    if (rc == 0)
        *ret_result =
            json_pack("{s:o, s:b}", "plans", plans, "more", job->n_skies > ORL_PLAN_SKIES);
    return rc;
}
