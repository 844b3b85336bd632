/* Requests of reports: defaults, freeing, and checks for matrices. */
#include <oriel/annual_report.h>

#include <stdlib.h>
#include <string.h>

#include "report/making.h"

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

int orl_annual_wishes_init(struct orl_annual_wishes *wishes)
{
    *wishes = (struct orl_annual_wishes){.n_metrics = 0};
    orl_occupancy_init(&wishes->occupancy);
    orl_view_out_wish_init(&wishes->view_out);
    wishes->metrics = malloc(sizeof usual_metrics);
    if (!wishes->metrics)
        return ORL_ERR_NOMEM;
    memcpy(wishes->metrics, usual_metrics, sizeof usual_metrics);
    wishes->n_metrics = USUAL;
    return 0;
}

void orl_annual_wishes_done(struct orl_annual_wishes *wishes)
{
    if (!wishes)
        return;
    free(wishes->occupancy_file);
    free(wishes->metrics);
    free(wishes->targets);
    free(wishes->rules);
    free(wishes->grid_area);
    free(wishes->until);
    orl_exposure_wish_done(&wishes->exposure);
    orl_view_out_wish_done(&wishes->view_out);
    orl_seats_wish_done(&wishes->glare);
    *wishes = (struct orl_annual_wishes){.n_metrics = 0};
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

int orl_report_check_matrices(const struct orl_annual_wishes *wishes, struct orl_error *err)
{
    bool factors = false;
    for (size_t i = 0; i < wishes->n_metrics; i++)
        factors = factors || wishes->metrics[i].kind == ORL_METRIC_DF;
    for (size_t i = 0; i < wishes->n_targets; i++)
        factors = factors || wishes->targets[i].figure.metric.kind == ORL_METRIC_DF;
    for (size_t i = 0; i < wishes->n_rules; i++)
        factors = factors || needs_factors(&wishes->rules[i]);
    if (factors)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "daylight factors are found by paths: a year by matrices has none");
    if (wishes->until)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "matrices do not tell their errors: no accuracy can be asked of them");
    return 0;
}
