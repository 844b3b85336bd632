#include "checks/child_document.h"

#include <oriel/annual_report.h>
#include <oriel/run.h>

#include "runner/job_output.h"

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

int orl_child_document(struct orl_opened *opened, struct orl_job_inputs_found *found,
                       struct orl_error *err)
{
    const struct orl_files files = orl_opened_provider(opened);
    struct orl_task task;
    int rc = orl_job_read(opened->single.data, opened->single.size, &task, NULL, err);
    if (rc)
        return rc;
    rc = orl_job_set_scene(&task, &opened->bundle, err);
    if (rc == 0 && task.kind == ORL_TASK_ANNUAL)
        rc = check_year(&task.of.annual.request, &files, found, err);
    else if (rc == 0 && orl_task_job(&task))
        rc = orl_views_check(orl_task_job(&task), &files, err);
    orl_task_done(&task);
    return rc;
}
