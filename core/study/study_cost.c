#include "study/study_cost.h"

#include <stdlib.h>

#include "study/study_request.h"

double orl_study_run_core_s(const struct orl_job *job, const struct orl_study_setting *setting,
                            double sensors)
{
    /* Microseconds: a photon of either kind, traced and indexed; a sample of a sensor; a path of a
     * pixel; the start of a run. */
    const double photon_us = 2, sample_us = 3, path_us = 10, start_us = 5e5;
    double values = 0;
    for (size_t i = 0; i < job->n_views; i++)
        values += (double)job->views[i].width * job->views[i].height;
    return 1e-6 *
           (start_us + photon_us * (double)setting->photons +
            (values > 0 ? values * path_us : sensors * sample_us) * (setting->samples + 1.0));
}

double orl_study_core_s(const struct orl_study_request *request, double sensors)
{
    const struct orl_study_setting reference = orl_study_reference_setting(request);
    struct orl_study_setting *settings = NULL;
    size_t n = 0;
    double sum = request->reference_runs * orl_study_run_core_s(&request->job, &reference, sensors);
    if (orl_study_list_settings(request, &settings, &n, NULL) < 0)
        return sum;
    for (size_t i = 0; i < n; i++)
        sum += request->repeats * orl_study_run_core_s(&request->job, &settings[i], sensors);
    free(settings);
    return sum;
}
