#include "support/hand_year.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

void hand_year_make(struct orl_annual_result *result, bool leap)
{
    static const int lengths[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    *result =
        (struct orl_annual_result){.n_steps = leap ? 8784 : 8760, .n_sensors = HAND_YEAR_SENSORS};
    result->steps = calloc(result->n_steps, sizeof *result->steps);
    result->step_of_column = calloc(result->n_steps, sizeof *result->step_of_column);
    assert_true(result->steps && result->step_of_column);
    size_t at = 0;
    for (int month = 1; month <= 12; month++)
        for (int day = 1; day <= lengths[month - 1] + (leap && month == 2); day++)
            for (int hour = 0; hour < 24; hour++, at++) {
                const bool lit =
                    hour >= HAND_YEAR_FIRST_LIT && hour < HAND_YEAR_FIRST_LIT + HAND_YEAR_LIT;
                struct orl_annual_step *s = &result->steps[at];
                *s = (struct orl_annual_step){.month = month,
                                              .day = day,
                                              .hour = hour + 0.5,
                                              .column = ORL_ANNUAL_DARK,
                                              .global_lx = lit ? 1e4 + hour : 0};
                if (lit) {
                    result->step_of_column[result->n_columns] = (uint32_t)at;
                    s->column = (uint32_t)result->n_columns++;
                }
            }
    const size_t n = HAND_YEAR_SENSORS * result->n_columns;
    result->total = calloc(n, sizeof *result->total);
    result->direct = calloc(n, sizeof *result->direct);
    result->se = calloc(n, sizeof *result->se);
    assert_true(result->total && result->direct && result->se);
    for (size_t i = 0; i < n; i++) {
        const size_t sensor = i / result->n_columns;
        const bool noon =
            fabs(result->steps[result->step_of_column[i % result->n_columns]].hour - 12.5) < 0.1;
        result->direct[i] = noon && sensor >= 4 ? 5000 : 0;
        result->total[i] = 100 * (float)(sensor + 1) + result->direct[i];
        result->se[i] = 0.02F * result->total[i];
    }
}

void hand_year_free(struct orl_annual_result *result)
{
    free(result->steps);
    free(result->step_of_column);
    free(result->total);
    free(result->direct);
    free(result->se);
}

struct orl_annual_request hand_year_request(struct orl_annual_grid grids[2])
{
    static char north[] = "North / \"old\"", south[] = "south";
    grids[0] = (struct orl_annual_grid){north, 0, 2};
    grids[1] = (struct orl_annual_grid){south, 2, 4};
    return (struct orl_annual_request){
        .grids = grids, .n_grids = 2, .n_sensors = HAND_YEAR_SENSORS};
}

void hand_year_ask(struct orl_report_request *report_request, const char *target, const char *rules)
{
    const struct orl_annual_rule *first;
    assert_int_equal(orl_report_request_init(report_request), 0);
    report_request->targets = calloc(1, sizeof *report_request->targets);
    assert_non_null(report_request->targets);
    assert_int_equal(orl_annual_target_parse(target, report_request->targets, NULL), 0);
    report_request->n_targets = 1;
    assert_int_equal(orl_annual_rules_find(rules, &first, &report_request->n_rules, NULL), 0);
    report_request->rules = calloc(report_request->n_rules, sizeof *report_request->rules);
    assert_non_null(report_request->rules);
    for (size_t i = 0; i < report_request->n_rules; i++)
        report_request->rules[i] = first[i];
}

struct orl_annual_report hand_year_report(const struct orl_annual_request *request,
                                          const struct orl_annual_result *result,
                                          const struct orl_report_request *report_request)
{
    struct orl_annual_report report;
    struct orl_error err = {0};
    if (orl_annual_report_make(request, result, report_request, NULL, NULL, NULL, &report, &err) <
        0)
        fail_msg("%s", err.message);
    return report;
}
