/* Names and units of metrics; metrics of one sensor's year, and the error at which each would
 * change sides of a bound. */
#include "metrics/annual/annual_figures.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include <oriel/annual/annual_metrics.h>
#include <oriel/base/vec.h>

#include "base/statistics/numeric.h"

/* Names of metrics: a text, the metric's illuminances, and a text. */
static const struct kind_text {
    const char *before;
    int numbers; /* 0, 1: the lower illuminance, 2: both */
    const char *after, *unit;
} kind_texts[] = {
    [ORL_METRIC_DA] = {"DA", 1, "", "%"},
    [ORL_METRIC_CDA] = {"cDA", 1, "", "%"},
    [ORL_METRIC_UDI] = {"UDI", 2, "", "%"},
    [ORL_METRIC_UDI_LOWER] = {"UDI below ", 1, " lx", "%"},
    [ORL_METRIC_UDI_PART] = {"UDI supplementary ", 2, "", "%"},
    [ORL_METRIC_UDI_UPPER] = {"UDI above ", 1, " lx", "%"},
    [ORL_METRIC_MEAN] = {"mean illuminance", 0, "", "lx"},
    [ORL_METRIC_CUMULATIVE] = {"cumulative illuminance", 0, "", "lx h"},
    [ORL_METRIC_HOURS] = {"hours of ", 1, " lx or more", "h"},
    [ORL_METRIC_DIRECT_HOURS] = {"hours of direct light above ", 1, " lx", "h"},
    [ORL_METRIC_DF] = {"daylight factor", 0, "", "%"},
};

const char *orl_annual_unit(enum orl_metric_kind kind)
{
    return kind_texts[kind].unit;
}

void orl_annual_metric_name(const struct orl_annual_metric *metric, char *ret_text, size_t size)
{
    const struct kind_text *of = &kind_texts[metric->kind];
    char numbers[64] = "";
    if (of->numbers == 1)
        snprintf(numbers, sizeof numbers, "%g", metric->low_lx);
    else if (of->numbers == 2)
        snprintf(numbers, sizeof numbers, "%g-%g", metric->low_lx, metric->high_lx);
    snprintf(ret_text, size, "%s%s%s", of->before, numbers, of->after);
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* Part of a row that a metric uses. */
struct light {
    const float *value, *error, *factor;
    const unsigned char *sunny; /* columns whose errors are partly coherent; NULL: none */
    double coherence;           /* coherence of the errors in sunny columns */
};

static struct light light_of_total(const struct orl_annual_light *row)
{
    return (struct light){.value = row->total_lx,
                          .error = row->total_error_lx,
                          .factor = row->total_factor,
                          .sunny = row->coherence ? row->sunny : NULL,
                          .coherence = row->coherence ? (double)*row->coherence : 1};
}

static struct light light_of(const struct orl_annual_metric *metric,
                             const struct orl_annual_light *row)
{
    if (metric->kind == ORL_METRIC_DF)
        return (struct light){.value = row->overcast_lx, .error = row->overcast_error_lx};
    if (metric->kind == ORL_METRIC_DIRECT_HOURS)
        return (struct light){.value = row->direct_lx, .error = row->direct_error_lx};
    return light_of_total(row);
}

bool orl_annual_errors_known(const struct orl_annual_metric *metric,
                             const struct orl_annual_light *row)
{
    return light_of(metric, row).error != NULL;
}

/*
 * Returns the part of a column's relative standard error that all columns share.
 *
 * Light is a sum over few bright paths and many dim ones. An estimate that comes out low has too
 * small a standard error, since the error shrinks with the value. Relative errors are more even, so
 * values are moved by factors. For means that are never negative the error is at most the value
 * itself.
 */
static double shared_relative_error(const struct light *light, size_t column)
{
    const double error = fmin((double)light->error[column] / (double)light->value[column], 1);
    return light->sunny && light->sunny[column] ? light->coherence * error : error;
}

static double shifted_value(const struct light *light, uint32_t column, double z)
{
    const double value = light->value[column];
    if (z == 0 || !light->error || !(value > 0) || !(light->error[column] > 0))
        return fmax(0, value);
    if (light->factor && fabs(z) == ORL_ANNUAL_Z)
        return z > 0 ? value * light->factor[column] : value / light->factor[column];
    return value * exp(z * shared_relative_error(light, column));
}

void orl_annual_error_factors(const struct orl_annual_light *row, size_t n, float *ret_factors)
{
    const struct light light = light_of_total(row);
    for (size_t i = 0; i < n; i++)
        ret_factors[i] = light.value[i] > 0 && light.error[i] > 0
                             ? (float)exp(ORL_ANNUAL_Z * shared_relative_error(&light, i))
                             : 1;
}

/* Returns the weight of a step with that illuminance in the metric. */
static double step_weight(const struct orl_annual_metric *metric, double lx)
{
    switch (metric->kind) {
    case ORL_METRIC_CDA:
        return lx >= metric->low_lx ? 1 : lx / metric->low_lx;
    case ORL_METRIC_UDI:
        return lx >= metric->low_lx && lx <= metric->high_lx;
    case ORL_METRIC_UDI_LOWER:
        return lx < metric->low_lx;
    case ORL_METRIC_UDI_PART:
        return lx >= metric->low_lx && lx < metric->high_lx;
    case ORL_METRIC_UDI_UPPER:
    case ORL_METRIC_DIRECT_HOURS:
        return lx > metric->low_lx;
    case ORL_METRIC_MEAN:
    case ORL_METRIC_CUMULATIVE:
        return lx;
    default:
        return lx >= metric->low_lx;
    }
}

double orl_annual_evaluate_at(const struct orl_annual_metric *metric,
                              const struct orl_annual_period *period,
                              const struct orl_annual_light *row, double z)
{
    const struct light light = light_of(metric, row);
    if (metric->kind == ORL_METRIC_DF)
        return 100 * shifted_value(&light, 0, z) / ORL_OVERCAST_LX;
    const double dark_h = period->hours - (double)period->n_columns * period->step_h;
    double sum = 0;
    for (size_t i = 0; i < period->n_columns; i++)
        sum += step_weight(metric, shifted_value(&light, period->columns[i], z));
    const double hours = sum * period->step_h + dark_h * step_weight(metric, 0);
    switch (metric->kind) {
    case ORL_METRIC_MEAN:
        return period->hours > 0 ? hours / period->hours : 0;
    case ORL_METRIC_CUMULATIVE:
    case ORL_METRIC_HOURS:
    case ORL_METRIC_DIRECT_HOURS:
        return hours;
    default:
        return orl_percent(hours, period->hours);
    }
}

bool orl_annual_is_monotonic(enum orl_metric_kind kind)
{
    return kind != ORL_METRIC_UDI && kind != ORL_METRIC_UDI_LOWER && kind != ORL_METRIC_UDI_PART;
}

/* ---- Intervals ------------------------------------------------------------------------------- */

/* Returns the interval of a metric that is monotonic in the light. */
static struct orl_annual_value steady_within(const struct orl_annual_metric *metric,
                                             const struct orl_annual_period *period,
                                             const struct orl_annual_light *row, double z)
{
    const double below = orl_annual_evaluate_at(metric, period, row, -z);
    const double above = orl_annual_evaluate_at(metric, period, row, z);
    return (struct orl_annual_value){orl_annual_evaluate_at(metric, period, row, 0),
                                     fmin(below, above), fmax(below, above)};
}

/*
 * UDI is the share that has reached the lower bound less the share above the upper bound. With a
 * common factor the two move together, and their difference varies less; with less coherence it
 * varies more. Adding their squares is wide enough for either case.
 */
static struct orl_annual_value range_within(const struct orl_annual_metric *metric,
                                            const struct orl_annual_period *period,
                                            const struct orl_annual_light *row, double z)
{
    const bool part = metric->kind == ORL_METRIC_UDI_PART;
    const struct orl_annual_metric in = {ORL_METRIC_DA, metric->when, metric->low_lx, 0};
    const struct orl_annual_metric out = {part ? ORL_METRIC_DA : ORL_METRIC_UDI_UPPER, metric->when,
                                          metric->high_lx, 0};
    const struct orl_annual_value come = steady_within(&in, period, row, z);
    const struct orl_annual_value gone = steady_within(&out, period, row, z);
    const double value = orl_annual_evaluate_at(metric, period, row, 0);
    return (struct orl_annual_value){
        value, fmax(0, value - hypot(come.value - come.low, gone.high - gone.value)),
        fmin(100, value + hypot(come.high - come.value, gone.value - gone.low))};
}

struct orl_annual_value orl_annual_within(const struct orl_annual_metric *metric,
                                          const struct orl_annual_period *period,
                                          const struct orl_annual_light *row, double z)
{
    if (!orl_annual_errors_known(metric, row))
        return (struct orl_annual_value){orl_annual_evaluate_at(metric, period, row, 0), NAN, NAN};
    if (metric->kind == ORL_METRIC_UDI || metric->kind == ORL_METRIC_UDI_PART)
        return range_within(metric, period, row, z);
    return steady_within(metric, period, row, z);
}

void orl_annual_evaluate(const struct orl_annual_metric *metric,
                         const struct orl_annual_period *period, const struct orl_annual_light *row,
                         struct orl_annual_value *ret_value)
{
    *ret_value = orl_annual_within(metric, period, row, ORL_ANNUAL_Z);
}

/* ---- Crossings ------------------------------------------------------------------------------- */

/* Returns the z at which one step begins to count. */
static double step_crossing(const struct orl_annual_metric *metric, const struct light *light,
                            uint32_t column)
{
    const double lx = light->value[column];
    const bool strict =
        metric->kind == ORL_METRIC_UDI_UPPER || metric->kind == ORL_METRIC_DIRECT_HOURS;
    const bool unsure = light->error && light->error[column] > 0 && lx > 0;
    const double share = unsure ? shared_relative_error(light, column) : 0;
    if (!(share > 0))
        return (strict ? lx > metric->low_lx : lx >= metric->low_lx) ? -INFINITY : INFINITY;
    const double z = log(metric->low_lx / lx) / share;
    /* An exactly equal value is not more. */
    return strict && lx <= metric->low_lx ? fmax(z, DBL_MIN) : z;
}

/* Returns the crossing of a metric that counts hours: that of the last step it needs. */
static double counting_crossing(const struct orl_annual_metric *metric, double needed_h,
                                const struct orl_annual_period *period,
                                const struct orl_annual_light *row, double *scratch)
{
    const struct light light = light_of(metric, row);
    const double steps = needed_h / period->step_h;
    const double needed = ceil(steps - 1e-9 * fmax(1, steps));
    if (needed <= 0)
        return -INFINITY;
    if (needed > (double)period->n_columns)
        return INFINITY;
    for (size_t i = 0; i < period->n_columns; i++)
        scratch[i] = step_crossing(metric, &light, period->columns[i]);
    return orl_nth_element(scratch, period->n_columns, (size_t)needed - 1);
}

/* Returns the crossing of other metrics, which grow monotonically, by bisection. */
static double sought_crossing(const struct orl_annual_metric *metric, double bound,
                              const struct orl_annual_period *period,
                              const struct orl_annual_light *row)
{
    const double reach = 38; /* beyond it a double holds no probability of a normal law */
    const double hair = 1e-12 * fabs(bound);
    double low = -reach, high = reach;
    if (orl_annual_evaluate_at(metric, period, row, low) >= bound - hair)
        return -INFINITY;
    if (orl_annual_evaluate_at(metric, period, row, high) < bound - hair)
        return INFINITY;
    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        if (orl_annual_evaluate_at(metric, period, row, middle) >= bound - hair)
            high = middle;
        else
            low = middle;
    }
    return orl_annual_evaluate_at(metric, period, row, 0) >= bound - hair ? fmin(high, 0) : high;
}

double orl_annual_crossing(const struct orl_annual_metric *metric, double bound,
                           const struct orl_annual_period *period,
                           const struct orl_annual_light *row, double *scratch)
{
    switch (metric->kind) {
    case ORL_METRIC_DA:
    case ORL_METRIC_UDI_UPPER:
        return counting_crossing(metric, bound / 100 * period->hours, period, row, scratch);
    case ORL_METRIC_HOURS:
    case ORL_METRIC_DIRECT_HOURS:
        return counting_crossing(metric, bound, period, row, scratch);
    default:
        return sought_crossing(metric, bound, period, row);
    }
}
