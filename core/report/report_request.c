/* Requests of reports: defaults, freeing, and checks for matrices. */
#include <oriel/annual/annual_report.h>

#include <stdlib.h>
#include <string.h>

#include "report/report_builder.h"

static const struct orl_annual_metric usual_metrics[] = {
    {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0},
    {ORL_METRIC_CDA, ORL_WHEN_OCCUPIED, 300, 0},
    {ORL_METRIC_UDI_LOWER, ORL_WHEN_OCCUPIED, 100, 0},
    {ORL_METRIC_UDI_PART, ORL_WHEN_OCCUPIED, 100, 300},
    {ORL_METRIC_UDI, ORL_WHEN_OCCUPIED, 300, 3000},
    {ORL_METRIC_UDI, ORL_WHEN_OCCUPIED, 100, 3000},
    {ORL_METRIC_UDI_UPPER, ORL_WHEN_OCCUPIED, 3000, 0},
    {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0},
    {ORL_METRIC_MEAN, ORL_WHEN_OCCUPIED, 0, 0},
    {ORL_METRIC_CUMULATIVE, ORL_WHEN_ALWAYS, 0, 0},
};
enum { USUAL = sizeof usual_metrics / sizeof *usual_metrics };

int orl_report_request_init(struct orl_report_request *report_request)
{
    *report_request = (struct orl_report_request){.n_metrics = 0};
    orl_occupancy_init(&report_request->occupancy);
    orl_view_out_request_init(&report_request->view_out);
    report_request->metrics = malloc(sizeof usual_metrics);
    if (!report_request->metrics)
        return ORL_ERR_NOMEM;
    memcpy(report_request->metrics, usual_metrics, sizeof usual_metrics);
    report_request->n_metrics = USUAL;
    return 0;
}

void orl_report_request_done(struct orl_report_request *report_request)
{
    if (!report_request)
        return;
    free(report_request->occupancy_file);
    free(report_request->metrics);
    free(report_request->targets);
    free(report_request->rules);
    free(report_request->grid_area);
    free(report_request->until);
    orl_exposure_request_done(&report_request->exposure);
    orl_view_out_request_done(&report_request->view_out);
    orl_viewpoint_request_done(&report_request->glare);
    *report_request = (struct orl_report_request){.n_metrics = 0};
}

/* ---- By matrices ----------------------------------------------------------------------------- */

static bool needs_factors(const struct orl_annual_rule *rule)
{
    for (size_t i = 0; i < ORL_RULE_TARGETS && rule->targets[i]; i++) {
        struct orl_annual_target target;
        if (orl_annual_target_parse(rule->targets[i], &target, NULL) == 0 &&
            target.figure.metric.kind == ORL_METRIC_DF)
            return true;
    }
    return false;
}

int orl_report_check_matrices(const struct orl_report_request *report_request,
                              struct orl_error *err)
{
    bool factors = false;
    for (size_t i = 0; i < report_request->n_metrics; i++)
        factors = factors || report_request->metrics[i].kind == ORL_METRIC_DF;
    for (size_t i = 0; i < report_request->n_targets; i++)
        factors = factors || report_request->targets[i].figure.metric.kind == ORL_METRIC_DF;
    for (size_t i = 0; i < report_request->n_rules; i++)
        factors = factors || needs_factors(&report_request->rules[i]);
    if (factors)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "daylight factors are found by paths: a year by matrices has none");
    if (report_request->until)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "matrices do not tell their errors: no accuracy can be asked of them");
    return 0;
}
