/* Names and units of metrics. */
#include <oriel/annual/annual_metrics.h>

#include <stdio.h>

const char *orl_annual_unit(enum orl_metric_kind kind)
{
    switch (kind) {
    case ORL_METRIC_MEAN:
        return "lx";
    case ORL_METRIC_CUMULATIVE:
        return "lx h";
    case ORL_METRIC_HOURS:
    case ORL_METRIC_DIRECT_HOURS:
        return "h";
    default:
        return "%";
    }
}

void orl_annual_metric_name(const struct orl_annual_metric *metric, char *ret_text, size_t size)
{
    const double low = metric->low_lx, high = metric->high_lx;
    switch (metric->kind) {
    case ORL_METRIC_DA:
        snprintf(ret_text, size, "DA%g", low);
        break;
    case ORL_METRIC_CDA:
        snprintf(ret_text, size, "cDA%g", low);
        break;
    case ORL_METRIC_UDI:
        snprintf(ret_text, size, "UDI%g-%g", low, high);
        break;
    case ORL_METRIC_UDI_LOWER:
        snprintf(ret_text, size, "UDI below %g lx", low);
        break;
    case ORL_METRIC_UDI_PART:
        snprintf(ret_text, size, "UDI supplementary %g-%g", low, high);
        break;
    case ORL_METRIC_UDI_UPPER:
        snprintf(ret_text, size, "UDI above %g lx", low);
        break;
    case ORL_METRIC_MEAN:
        snprintf(ret_text, size, "mean illuminance");
        break;
    case ORL_METRIC_CUMULATIVE:
        snprintf(ret_text, size, "cumulative illuminance");
        break;
    case ORL_METRIC_HOURS:
        snprintf(ret_text, size, "hours of %g lx or more", low);
        break;
    case ORL_METRIC_DF:
        snprintf(ret_text, size, "daylight factor");
        break;
    default:
        snprintf(ret_text, size, "hours of direct light above %g lx", low);
        break;
    }
}
