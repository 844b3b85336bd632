/* Titles of metrics on pages, and their names in file names. */
#include <oriel/annual/annual_report.h>

#include <stdio.h>

static const char *when_of(enum orl_annual_when when)
{
    static const char *const texts[ORL_WHEN_COUNT] = {"", ", daylight hours", ", all hours"};
    return texts[when];
}

void orl_annual_metric_title(const struct orl_annual_metric *metric, char *ret_text, size_t size)
{
    const double low = metric->low_lx, high = metric->high_lx;
    const char *when = when_of(metric->when);
    switch (metric->kind) {
    case ORL_METRIC_DA:
        snprintf(ret_text, size, "Daylight autonomy at %g lx%s", low, when);
        break;
    case ORL_METRIC_CDA:
        snprintf(ret_text, size, "Continuous daylight autonomy at %g lx%s", low, when);
        break;
    case ORL_METRIC_UDI:
        snprintf(ret_text, size, "Useful daylight, %g to %g lx%s", low, high, when);
        break;
    case ORL_METRIC_UDI_LOWER:
        snprintf(ret_text, size, "Below useful daylight, under %g lx%s", low, when);
        break;
    case ORL_METRIC_UDI_PART:
        snprintf(ret_text, size, "Supplementary daylight, %g to %g lx%s", low, high, when);
        break;
    case ORL_METRIC_UDI_UPPER:
        snprintf(ret_text, size, "Above useful daylight, over %g lx%s", low, when);
        break;
    case ORL_METRIC_MEAN:
        snprintf(ret_text, size, "Mean illuminance%s", when);
        break;
    case ORL_METRIC_CUMULATIVE:
        snprintf(ret_text, size, "Cumulative illuminance%s", when);
        break;
    case ORL_METRIC_HOURS:
        snprintf(ret_text, size, "Hours with %g lx or more%s", low, when);
        break;
    case ORL_METRIC_DF:
        snprintf(ret_text, size, "Daylight factor");
        break;
    default:
        snprintf(ret_text, size, "Direct sunlight above %g lx%s", low, when);
        break;
    }
}

void orl_annual_metric_file(const struct orl_annual_metric *metric, char *ret_text, size_t size)
{
    static const char *const names[ORL_METRIC_KINDS] = {
        "da",   "cda",        "udi",   "udi_lower",    "udi_part", "udi_upper",
        "mean", "cumulative", "hours", "direct_hours", "df"};
    const double low = metric->low_lx, high = metric->high_lx;
    const char *when = metric->when == ORL_WHEN_DAYLIGHT ? "_daylight"
                       : metric->when == ORL_WHEN_ALWAYS ? "_year"
                                                         : "";
    if (metric->kind == ORL_METRIC_UDI || metric->kind == ORL_METRIC_UDI_PART)
        snprintf(ret_text, size, "%s%g-%g%s", names[metric->kind], low, high, when);
    else if (metric->kind == ORL_METRIC_MEAN || metric->kind == ORL_METRIC_CUMULATIVE)
        snprintf(ret_text, size, "%s%s", names[metric->kind], when);
    else
        snprintf(ret_text, size, "%s%g%s", names[metric->kind], low, when);
}
