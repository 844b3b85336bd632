/* Verdicts that stay undecided with a note, and the worst days of viewpoints. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "report/report_internal.h"
#include "support/hand_year.h"

static struct orl_window_group blinds = {
    .control = {.kind = ORL_SHADES_BY_SUN, .above_lx = 1000, .share_percent = 2}};

/* Checks the verdict on sDA300/50 >= 40 % by LEED, for the south and for both grids, and its note.
 */
static void check_blinds(const struct orl_annual_result *result, struct orl_window_group *groups,
                         enum orl_verdict south, const char *note)
{
    struct orl_annual_grid grids[2];
    struct orl_annual_request request = hand_year_request(grids);
    struct orl_report_request report_request;
    struct orl_annual_report report;
    hand_year_ask(&report_request, "sDA300/50 of south >= 40 %", "LEED v4.1, 1 point");
    request.groups = groups;
    request.n_groups = groups ? 1 : 0;
    report = hand_year_report(&request, result, &report_request);
    assert_int_equal(report.n_verdicts, 1 + 3);
    assert_int_equal(report.verdicts[0].verdict, ORL_VERDICT_PASS); /* names no rule */
    assert_string_equal(report.verdicts[0].note, "");
    assert_int_equal(report.verdicts[2].verdict, ORL_VERDICT_FAIL); /* the north: no blinds help */
    assert_string_equal(report.verdicts[2].note, "");
    assert_int_equal(report.verdicts[3].verdict, south);
    assert_string_equal(report.verdicts[3].note, note);
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
}

static void test_blinds_of_rules(void **state)
{
    struct orl_window_group by_hand = {.control = {.kind = ORL_SHADES_NO_CONTROL}}, late = blinds,
                            wide = blinds;
    struct orl_annual_result result;
    (void)state;
    hand_year_make(&result, false);
    check_blinds(&result, &blinds, ORL_VERDICT_PASS, "");
    check_blinds(&result, NULL, ORL_VERDICT_UNDECIDED,
                 "not according to LM-83: no blinds modelled");
    check_blinds(&result, &by_hand, ORL_VERDICT_UNDECIDED,
                 "not according to LM-83: no blinds close by its rule");
    late.control.above_lx = 5000;
    check_blinds(&result, &late, ORL_VERDICT_UNDECIDED,
                 "not according to LM-83: no blinds close by its rule");
    wide.control.share_percent = 10;
    check_blinds(&result, &wide, ORL_VERDICT_UNDECIDED,
                 "not according to LM-83: no blinds close by its rule");
    /* Without direct sunlight no blinds close. */
    for (size_t i = 0; i < HAND_YEAR_SENSORS * result.n_columns; i++)
        result.direct[i] = fminf(result.direct[i], 999);
    check_blinds(&result, NULL, ORL_VERDICT_PASS, "");
    hand_year_free(&result);
}

/* LM-83 closes blinds for each grid separately. One of 120 points, in a grid of two, is below 2 %
 * of all and far above 2 % of its grid. */
static void test_blinds_of_a_small_grid(void **state)
{
    enum { POINTS = 120, SMALL = 2 };
    struct orl_annual_grid grids[2];
    struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    (void)state;
    hand_year_make(&result, false);
    const size_t n = POINTS * result.n_columns;
    float **arrays[] = {&result.total, &result.direct, &result.se};
    for (int k = 0; k < 3; k++) {
        free(*arrays[k]);
        assert_non_null(*arrays[k] = calloc(n, sizeof **arrays[k]));
    }
    for (size_t i = 0; i < n; i++) {
        result.total[i] = 400;
        result.direct[i] = i < result.n_columns ? 300 : 0;
    }
    result.direct[100] = 5000;
    result.n_sensors = request.n_sensors = POINTS;
    grids[0].count = SMALL;
    grids[1].first = SMALL;
    grids[1].count = POINTS - SMALL;
    hand_year_ask(&report_request, "sDA300/50 >= 40 %", "LEED v4.1, 1 point");
    struct orl_annual_report report = hand_year_report(&request, &result, &report_request);
    const struct orl_annual_verdict *of_rule = report.verdicts + 3; /* all grids, and each grid */
    assert_int_equal(report.n_verdicts, 3 + 3);
    assert_int_equal(of_rule[0].grid, ORL_ALL_GRIDS);
    assert_int_equal(of_rule[0].verdict, ORL_VERDICT_UNDECIDED);
    assert_int_equal(of_rule[1].verdict, ORL_VERDICT_UNDECIDED);
    assert_int_equal(of_rule[2].verdict, ORL_VERDICT_PASS);
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

/* A file without January leaves all verdicts undecided; a file without two weeks does not. For
 * half a year, the daylight hours are the lighter half of its own hours, without its nights. */
static void test_few_hours(void **state)
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    (void)state;
    hand_year_make(&result, false);
    hand_year_ask(&report_request, "sDA300/50 of south >= 55 %", "EN 17037 minimum");
    for (size_t i = 0; i < 14 * 24; i++)
        result.steps[i].missing = true;
    report = hand_year_report(&request, &result, &report_request);
    assert_int_equal(report.verdicts[0].verdict, ORL_VERDICT_PASS);
    assert_true(report.periods[ORL_WHEN_OCCUPIED].hours == 3510);
    assert_true(report.hours_wanted[ORL_WHEN_OCCUPIED] == 3650);
    orl_annual_report_done(&report);
    for (size_t i = 0; i < 31 * 24; i++)
        result.steps[i].missing = true;
    report = hand_year_report(&request, &result, &report_request);
    assert_int_equal(report.verdicts[0].verdict, ORL_VERDICT_UNDECIDED);
    assert_string_equal(report.verdicts[0].note,
                        "the weather file has 3340 of 3650 occupied hours");
    for (size_t i = 1; i < report.n_verdicts; i++) {
        assert_int_equal(report.verdicts[i].verdict, ORL_VERDICT_UNDECIDED);
        assert_non_null(strstr(report.verdicts[i].note, "of 4380 daylight hours"));
    }
    orl_annual_report_done(&report);
    for (size_t i = 0; i < result.n_steps; i++)
        result.steps[i].missing = i >= 181 * 24;
    report = hand_year_report(&request, &result, &report_request);
    assert_int_equal(report.verdicts[1].verdict, ORL_VERDICT_UNDECIDED);
    assert_string_equal(report.verdicts[1].note,
                        "the weather file has 2172 of 4380 daylight hours");
    assert_int_equal(report.periods[ORL_WHEN_DAYLIGHT].n_columns, 2172);
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

/* Returns the verdict on the mean illuminance, and its note. The target's upper bound is the value
 * plus `sides` times the interval's longer side. */
static enum orl_verdict judge_mean(const struct orl_annual_result *result, double sides,
                                   char note[sizeof((struct orl_annual_verdict *)0)->note])
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    struct orl_report_request report_request;
    double bound = 0;
    enum orl_verdict verdict = ORL_VERDICT_UNDECIDED;
    for (int round = 0; round < 2; round++) {
        char target[64];
        snprintf(target, sizeof target, "illuminance of south <= %.9g lx", bound);
        hand_year_ask(&report_request, target, "EN 17037 minimum");
        struct orl_annual_report report = hand_year_report(&request, result, &report_request);
        const struct orl_annual_value *v = &report.verdicts[0].area.value;
        bound = v->value + sides * fmax(v->value - v->low, v->high - v->value);
        verdict = report.verdicts[0].verdict;
        memcpy(note, report.verdicts[0].note, sizeof report.verdicts[0].note);
        orl_annual_report_done(&report);
        orl_report_request_done(&report_request);
    }
    return verdict;
}

/* One hour in five with an error of 30 % is too many for a bound near the interval; one in twenty
 * is not. */
static void test_uncertain_hours(void **state)
{
    struct orl_annual_result result;
    char note[sizeof((struct orl_annual_verdict *)0)->note];
    (void)state;
    hand_year_make(&result, false);
    assert_int_equal(judge_mean(&result, 2, note), ORL_VERDICT_PASS);
    for (size_t i = 0; i < HAND_YEAR_SENSORS * result.n_columns; i += 20)
        result.se[i] = 0.3F * result.total[i];
    assert_int_equal(judge_mean(&result, 2, note), ORL_VERDICT_PASS);
    assert_string_equal(note, "");
    for (size_t i = 0; i < HAND_YEAR_SENSORS * result.n_columns; i += 5)
        result.se[i] = 0.3F * result.total[i];
    assert_int_equal(judge_mean(&result, 2, note), ORL_VERDICT_UNDECIDED);
    assert_string_equal(note, "20 % of the hours have standard errors above 25 %: use more "
                              "\"samples\"");
    assert_int_equal(judge_mean(&result, 4, note), ORL_VERDICT_PASS);
    assert_string_equal(note, "");
    hand_year_free(&result);
}

/* A viewpoint faces the sun at noon of every day: DGP is 1 each time, so the illuminance at the eye
 * ranks the days. The level of protection is undecided if the weather lacks hours of use. */
static void test_worst_days_of_a_viewpoint(void **state)
{
    struct orl_annual_grid grids[2];
    const struct orl_annual_request request = hand_year_request(grids);
    struct orl_annual_result result;
    struct orl_report_request report_request;
    struct orl_annual_report report;
    struct orl_viewpoint_hours *viewpoint = calloc(1, sizeof *viewpoint);
    struct orl_error err = {0};
    (void)state;
    hand_year_make(&result, false);
    hand_year_ask(&report_request, "sDA300/50 of south >= 55 %", "LEED");
    assert_non_null(viewpoint);
    float **arrays[] = {&viewpoint->dgp, &viewpoint->low, &viewpoint->high, &viewpoint->eye_lx};
    for (int i = 0; i < 4; i++)
        assert_non_null(*arrays[i] = calloc(result.n_columns, sizeof **arrays[i]));
    for (size_t c = 0; c < result.n_columns; c++) {
        const struct orl_annual_step *step = &result.steps[result.step_of_column[c]];
        const bool noon = fabs(step->hour - 12.5) < 0.1;
        viewpoint->dgp[c] = viewpoint->low[c] = viewpoint->high[c] = noon ? 1 : 0.3F;
        viewpoint->eye_lx[c] = noon ? 20000 + 100 * (float)step->day - (float)step->month : 3000;
    }
    report = hand_year_report(&request, &result, &report_request);
    report.viewpoint_hours = viewpoint;
    report.n_viewpoints = 1;
    assert_int_equal(orl_report_viewpoints(&result, &report, &err), 0);
    assert_int_equal(report.viewpoints[0].n_worst, ORL_GLARE_WORST);
    static const int months[ORL_GLARE_WORST] = {1, 3, 5, 7, 8}; /* the 31st days of these months */
    for (int i = 0; i < ORL_GLARE_WORST; i++) {
        const struct orl_annual_step *step = &result.steps[report.viewpoints[0].worst[i].step];
        assert_int_equal(step->day, 31);
        assert_int_equal(step->month, months[i]);
    }
    assert_int_equal(report.viewpoints[0].lowest, report.viewpoints[0].highest);
    free(report.viewpoints);
    report.periods[ORL_WHEN_OCCUPIED].hours /= 2;
    assert_int_equal(orl_report_viewpoints(&result, &report, &err), 0);
    assert_int_equal(report.viewpoints[0].lowest, ORL_PROTECTED_NONE);
    assert_int_equal(report.viewpoints[0].highest, ORL_PROTECTED_HIGH);
    orl_annual_report_done(&report);
    orl_report_request_done(&report_request);
    hand_year_free(&result);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_blinds_of_rules), cmocka_unit_test(test_blinds_of_a_small_grid),
        cmocka_unit_test(test_few_hours), cmocka_unit_test(test_uncertain_hours),
        cmocka_unit_test(test_worst_days_of_a_viewpoint)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
