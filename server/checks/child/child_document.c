#include "checks/child/child_document.h"

#include <oriel/annual/annual_report.h>
#include <oriel/job/run.h>

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

int orl_child_document(struct orl_mapped_inputs *mapped, struct orl_job_inputs_found *found,
                       struct orl_error *err)
{
    const struct orl_files files = orl_mapped_inputs_provider(mapped);
    struct orl_job_request job_request;
    int rc = orl_job_read(mapped->single.data, mapped->single.size, &job_request, NULL, err);
    if (rc)
        return rc;
    rc = orl_job_set_scene(&job_request, &mapped->bundle, err);
    if (rc == 0 && job_request.kind == ORL_JOB_KIND_ANNUAL)
        rc = check_year(&job_request.of.annual.request, &files, found, err);
    else if (rc == 0 && orl_job_request_render_job(&job_request))
        rc = orl_views_check(orl_job_request_render_job(&job_request), &files, err);
    orl_job_request_done(&job_request);
    return rc;
}
