/* Viewpoints of a request and their results: validation and freeing. */
#include <oriel/annual/annual_glare.h>

#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/coordinates.h>

void orl_viewpoint_request_done(struct orl_viewpoint_request *viewpoint_request)
{
    for (size_t i = 0; viewpoint_request->viewpoints && i < viewpoint_request->n_viewpoints; i++)
        free(viewpoint_request->viewpoints[i].name);
    free(viewpoint_request->viewpoints);
    *viewpoint_request = (struct orl_viewpoint_request){.viewpoints = NULL};
}

void orl_viewpoint_hours_free(struct orl_viewpoint_hours *hours, size_t n)
{
    for (size_t i = 0; hours && i < n; i++) {
        free(hours[i].dgp);
        free(hours[i].low);
        free(hours[i].high);
        free(hours[i].eye_lx);
    }
    free(hours);
}

/* ---- Validation ------------------------------------------------------------------------------ */

int orl_viewpoints_validate(const struct orl_viewpoint_request *viewpoint_request,
                            const struct orl_annual_request *request, struct orl_error *err)
{
    static const double steepest = 0.999; /* sine of the altitude: 87.4 degrees */
    if (viewpoint_request->n_viewpoints == 0)
        return 0;
    if (request->n_terms > 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "glare needs a scene to look at: a year by matrices has none of it");
    for (size_t i = 0; i < viewpoint_request->n_viewpoints; i++) {
        const struct orl_viewpoint *viewpoint = &viewpoint_request->viewpoints[i];
        char what[96];
        snprintf(what, sizeof what, "the seat '%.64s'", viewpoint->name);
        int code = orl_check_point(viewpoint->at, what, err);
        if (code == 0)
            code = orl_check_direction(viewpoint->towards, what, err);
        if (code < 0)
            return code;
        if (!(fabs(viewpoint->towards.z) <= steepest * orl_length(viewpoint->towards)))
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "'%s' looks straight up or down: which way is up in its view is "
                                 "not known",
                                 viewpoint->name);
    }
    return 0;
}
