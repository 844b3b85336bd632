/*
 * Checks that need a whole scene, in the child: a job's document with the scene's files, plans, and
 * previews.
 */
#include <math.h>
#include <stdatomic.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>
#include <oriel/job/run.h>
#include <oriel/job/skies.h>

#include "bsdf_json/bsdf_json.h"
#include "checks/child/child_checks.h"
#include "process/times.h"
#include "result/result_json.h"
#include "runner/estimate/job_estimate.h"
#include "runner/job_document.h"
#include "json/encode.h"

static int check_year(struct orl_annual_request *request, const struct orl_files *files,
                      struct orl_job_inputs_found *found, struct orl_error *err)
{
    struct orl_scene_size size = {0};
    int rc = orl_annual_schedules_read(request, files, err);
    if (rc == 0 && request->n_groups > 0)
        rc = orl_shades_measure(request, files, &size, err);
    if (rc == 0)
        rc = orl_matrix_terms_measure(request->terms, request->n_terms, files, &found->matrix_bytes,
                                      err);
    found->surfaces = size.surfaces;
    found->triangles = size.triangles;
    return rc;
}

int orl_child_document(struct orl_child_task *task, struct orl_job_inputs_found *found,
                       struct orl_error *err)
{
    const struct orl_files files = orl_mapped_inputs_provider(&task->files);
    const struct orl_file *document = &task->files.single;
    struct orl_job_request job_request;
    int rc = orl_job_document_read(document->data, document->size, &job_request, err);
    if (rc)
        return rc;
    rc = orl_job_document_set_scene(&job_request, &task->files.bundle, err);
    if (rc == 0 && job_request.kind == ORL_JOB_KIND_ANNUAL)
        rc = check_year(&job_request.of.annual.request, &files, found, err);
    else if (rc == 0 && orl_job_request_render_job(&job_request))
        rc = orl_views_check(orl_job_request_render_job(&job_request), &files, err);
    orl_job_request_done(&job_request);
    return rc;
}

/* ---- Plans ----------------------------------------------------------------------------------- */

static int add_plan(void *ctx, const char *sky, const struct orl_result *planned,
                    const struct orl_accuracy_curve *curve, struct orl_error *err)
{
    json_t *plan = orl_planned_to_json(planned, curve);
    if (plan && json_object_set_new(plan, "sky", orl_json_from_text(sky)) == 0 &&
        json_array_append_new(ctx, plan) == 0)
        return 0;
    return orl_error_no_memory(err);
}

int orl_child_plan(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    static atomic_bool cancel; /* never set: the process is killed instead */
    const struct orl_files files = orl_mapped_inputs_provider(&task->files);
    const struct orl_file *document = &task->files.single;
    struct orl_run_env env = {.files = &files, .cancel = &cancel, .now_s = orl_time_steady_for};
    struct orl_job_request job_request;
    int rc = orl_job_document_read(document->data, document->size, &job_request, err);
    if (rc)
        return rc;
    if (job_request.kind != ORL_JOB_KIND_RENDER)
        return orl_error_set(err, ORL_ERR_INVALID, "only a render job has a plan");
    rc = orl_job_document_set_scene(&job_request, &task->files.bundle, err);
    const struct orl_job_work work = orl_job_work(&job_request, &files);
    env.pool = orl_thread_pool_new(1);
    json_t *plans = json_array();
    const struct orl_job *job = &job_request.of.render;
    if (rc == 0)
        rc = env.pool && plans ? orl_plan_skies(job, &env, ORL_PLAN_SKIES, add_plan, plans, err)
                               : orl_error_no_memory(err);
    if (rc == 0)
        *ret_result =
            json_pack("{s:o, s:b, s:[i, f]}", "plans", plans, "more", job->n_skies > ORL_PLAN_SKIES,
                      "work", (int)work.work_class, work.s);
    return rc;
}

/* ---- Previews -------------------------------------------------------------------------------- */

int orl_child_outline(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    const json_t *height = json_object_get(task->request, "height");
    const struct orl_bundle *bundle = &task->files.bundle;
    const struct orl_files files = orl_mapped_inputs_provider(&task->files);
    const size_t count = orl_bundle_main_count(bundle);
    struct orl_floor_plan plan;
    for (size_t i = 0; i < count; i++)
        names[i] = bundle->files[i].name;
    const int rc = orl_scene_floor_plan(
        names, count, &files, json_is_number(height) ? json_number_value(height) : NAN, &plan, err);
    if (rc == 0) {
        *ret_result = orl_floor_plan_to_json(&plan);
        orl_floor_plan_done(&plan);
    }
    return rc;
}

int orl_child_polar(struct orl_child_task *task, json_t **ret_result, struct orl_error *err)
{
    static struct orl_bsdf_polar polar;
    struct orl_bsdf *bsdf = NULL;
    const bool front = json_is_true(json_object_get(task->request, "front"));
    const double theta = json_number_value(json_object_get(task->request, "theta_deg"));
    const double phi = json_number_value(json_object_get(task->request, "phi_deg"));
    const struct orl_bsdf_xml xml = {
        .name = "bsdf.xml", .data = task->files.single.data, .size = task->files.single.size};
    const int rc = orl_bsdf_load(&xml, &bsdf, err);
    if (rc)
        return rc;
    orl_bsdf_polar(bsdf, front, theta, phi, &polar);
    orl_bsdf_unref(bsdf);
    *ret_result = orl_bsdf_polar_to_json(&polar, front, theta, phi);
    return 0;
}
