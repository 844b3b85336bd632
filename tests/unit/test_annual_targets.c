/* Targets in words, verdicts on them, and rules. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/annual/annual_metrics.h>

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.10g is not %.10g within %g", value, wanted, tolerance);
}

/* ---- Targets --------------------------------------------------------------------------------- */

static struct orl_annual_target parse(const char *text)
{
    struct orl_annual_target target;
    struct orl_error err = {0};
    if (orl_annual_target_parse(text, &target, &err))
        fail_msg("%s: %s", text, err.message);
    return target;
}

static void assert_figure(const char *text, enum orl_annual_aggregate aggregate,
                          enum orl_metric_kind kind, enum orl_annual_when when, double low,
                          double high, double least)
{
    const struct orl_annual_target target = parse(text);
    const struct orl_annual_figure *f = &target.figure;
    if (f->aggregate != aggregate || f->metric.kind != kind || f->metric.when != when ||
        f->metric.low_lx != low || f->metric.high_lx != high || f->least != least)
        fail_msg("%s is read as over %d, kind %d, when %d, %g %g, %g", text, f->aggregate,
                 f->metric.kind, f->metric.when, f->metric.low_lx, f->metric.high_lx, f->least);
}

static void test_targets(void **state)
{
    const enum orl_annual_when used = ORL_WHEN_OCCUPIED;
    struct orl_annual_target target = parse("  SDA 300 , 50% of North office >55%");
    (void)state;
    assert_string_equal(target.grid, "North office");
    assert_true(target.relation == ORL_MORE_THAN && target.bound == 55);
    target = parse("ase1000,250 <= 10");
    assert_true(target.relation == ORL_AT_MOST && target.bound == 10 && !target.grid[0]);
    assert_figure("sDA >= 55 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DA, used, 300, 0, 50);
    assert_figure("sDA150/50>=30%", ORL_AGGREGATE_SHARE, ORL_METRIC_DA, used, 150, 0, 50);
    assert_figure("sDA500/50 in daylight hours >= 50 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DA,
                  ORL_WHEN_DAYLIGHT, 500, 0, 50);
    assert_figure("ASE < 10 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DIRECT_HOURS, used, 1000, 0, 250);
    assert_figure("ASE1000/250h < 10 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DIRECT_HOURS, used, 1000,
                  0, 250);
    assert_figure("DA500 >= 60 %", ORL_AGGREGATE_AVERAGE, ORL_METRIC_DA, used, 500, 0, 0);
    assert_figure("least da100 >= 50", ORL_AGGREGATE_LEAST, ORL_METRIC_DA, used, 100, 0, 0);
    assert_figure("cDA >= 60 %", ORL_AGGREGATE_AVERAGE, ORL_METRIC_CDA, used, 300, 0, 0);
    assert_figure("UDI100-3000 over the year >= 50 %", ORL_AGGREGATE_AVERAGE, ORL_METRIC_UDI,
                  ORL_WHEN_ALWAYS, 100, 3000, 0);
    assert_figure("UDI_lower100 <= 5 %", ORL_AGGREGATE_AVERAGE, ORL_METRIC_UDI_LOWER, used, 100, 0,
                  0);
    assert_figure("UDI_upper < 5 %", ORL_AGGREGATE_AVERAGE, ORL_METRIC_UDI_UPPER, used, 3000, 0, 0);
    assert_figure("illuminance >= 300 lx", ORL_AGGREGATE_AVERAGE, ORL_METRIC_MEAN, used, 0, 0, 0);
    assert_figure("hours300 of mean >= 2000 h", ORL_AGGREGATE_OF_MEAN, ORL_METRIC_HOURS,
                  ORL_WHEN_ALWAYS, 300, 0, 0);
    assert_figure("DF >= 2 %", ORL_AGGREGATE_AVERAGE, ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0, 0, 0);
    assert_figure("least df >= 0.6 %", ORL_AGGREGATE_LEAST, ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0, 0,
                  0);
    assert_figure("sDF >= 50 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0, 0, 2);
    assert_figure("sDF1.5% of hall >= 50 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0,
                  0, 1.5);
    assert_figure("sDF300lx >= 50 %", ORL_AGGREGATE_SHARE, ORL_METRIC_DF, ORL_WHEN_ALWAYS, 300, 0,
                  0);
    assert_figure("least hours90 >= 2000 h", ORL_AGGREGATE_LEAST, ORL_METRIC_HOURS, ORL_WHEN_ALWAYS,
                  90, 0, 0);
}

static void test_targets_refused(void **state)
{
    static const char *const texts[] = {"",
                                        "DGP < 0.35",
                                        "sDA300/50",
                                        "sDA300/50 = 55 %",
                                        "sDA300/50 >= ",
                                        "sDA300/50 >= lots",
                                        "sDA300/50 >= 55 lx",
                                        "sDA300/50 >= 55 % of office",
                                        "sDA300/50 >= 101 %",
                                        "sDA300/50 >= 0.55",
                                        "sDA300/ >= 55 %",
                                        "sDA300/101 >= 55 %",
                                        "sDA0/50 >= 55 %",
                                        "UDI3000-100 >= 5 %",
                                        "least sDA >= 5 %",
                                        "least DA of mean >= 5 %",
                                        "sDA of >= 5 %",
                                        "illuminance >= 300 %",
                                        "sDF0 >= 5 %",
                                        "DF >= 0.6",
                                        "DF2 >= 5 %",
                                        "DF in daylight hours >= 5 %",
                                        "sDAx300 >= 5 %"};
    struct orl_annual_target target = {.bound = -1};
    char long_text[200];
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct orl_error err = {0};
        if (orl_annual_target_parse(texts[i], &target, &err) == 0)
            fail_msg("'%s' is taken", texts[i]);
        assert_true(err.message[0] && (texts[i][0] == '\0' || strstr(err.message, texts[i])));
        assert_near(target.bound, -1, 0);
    }
    memset(long_text, ' ', sizeof long_text);
    memcpy(long_text + sizeof long_text - 12, "sDA >= 55 %", 12);
    assert_int_equal(orl_annual_target_parse(long_text, &target, NULL), ORL_ERR_LIMIT);
}

static enum orl_verdict judge(const char *text, double low, double high)
{
    const struct orl_annual_target target = parse(text);
    const struct orl_annual_value value = {(low + high) / 2, low, high};
    return orl_annual_judge(&target, &value);
}

static void test_verdicts(void **state)
{
    const double third = 100 * (11.0 / 20); /* 55 up to rounding */
    (void)state;
    assert_int_equal(judge("sDA >= 55 %", 55, 60), ORL_VERDICT_PASS);
    assert_int_equal(judge("sDA >= 55 %", third, third), ORL_VERDICT_PASS);
    assert_int_equal(judge("sDA > 55 %", third, third), ORL_VERDICT_FAIL);
    assert_int_equal(judge("sDA > 55 %", 55, 60), ORL_VERDICT_UNDECIDED);
    assert_int_equal(judge("sDA >= 55 %", 50, 55), ORL_VERDICT_UNDECIDED);
    assert_int_equal(judge("sDA >= 55 %", 50, 54.9), ORL_VERDICT_FAIL);
    assert_int_equal(judge("ASE <= 10 %", 5, 10), ORL_VERDICT_PASS);
    assert_int_equal(judge("ASE < 10 %", 5, 10), ORL_VERDICT_UNDECIDED);
    assert_int_equal(judge("ASE <= 10 %", 11, 12), ORL_VERDICT_FAIL);
    assert_int_equal(judge("ASE <= 10 %", NAN, NAN), ORL_VERDICT_UNKNOWN);
    const struct orl_annual_target target = parse("sDA >= 55 %");
    const struct orl_annual_value wide = {55, 54, 56}, narrow = {55, 54.6, 55.4},
                                  far = {70, 60, 80};
    assert_false(orl_annual_is_decided(&target, &wide, 0.5));
    assert_true(orl_annual_is_decided(&target, &narrow, 0.5));
    assert_true(orl_annual_is_decided(&target, &far, 0.5));
    assert_int_equal(orl_verdict_combine(ORL_VERDICT_PASS, ORL_VERDICT_PASS), ORL_VERDICT_PASS);
    assert_int_equal(orl_verdict_combine(ORL_VERDICT_PASS, ORL_VERDICT_UNDECIDED),
                     ORL_VERDICT_UNDECIDED);
    assert_int_equal(orl_verdict_combine(ORL_VERDICT_UNKNOWN, ORL_VERDICT_FAIL), ORL_VERDICT_FAIL);
}

/* All targets of all rules parse, and a name finds the rules that begin with it. */
static void test_rules(void **state)
{
    static const struct {
        const char *name;
        size_t count;
    } names[] = {{"en 17037", 3},
                 {"EN 17037 medium", 1},
                 {"LEED", 4},
                 {"WELL L01", 2},
                 {"WELL L06", 4},
                 {"BREEAM offices", 1},
                 {"BREEAM", 9},
                 {"roof lights", 3},
                 {"daylight factor by EN 17037", 3},
                 {"daylight factor", 6},
                 {"LEED v4.1, 2 points", 1},
                 {"WELL L06 tier 2", 2}};
    const struct orl_annual_rule *rules;
    size_t count, all = 0;
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        assert_int_equal(orl_annual_rules_find(names[i].name, &rules, &count, NULL), 0);
        assert_int_equal(count, names[i].count);
        for (size_t k = 0; k < count; k++)
            for (int t = 0; t < ORL_RULE_TARGETS && rules[k].targets[t]; t++, all++)
                parse(rules[k].targets[t]);
    }
    assert_true(all > 20);
    assert_int_equal(orl_annual_rules_find("DIN 5034", &rules, &count, NULL), ORL_ERR_NOT_FOUND);
    assert_int_equal(orl_annual_rules_find("", &rules, &count, NULL), ORL_ERR_NOT_FOUND);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_targets),
        cmocka_unit_test(test_targets_refused),
        cmocka_unit_test(test_verdicts),
        cmocka_unit_test(test_rules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
