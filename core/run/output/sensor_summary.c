/* Figures of a grid's sensors. */
#include <math.h>

#include <oriel/job/run.h>

#include "base/statistics/numeric.h"

static const double threshold_lx = 300;

struct orl_sensor_summary orl_sensor_summary_of(const struct orl_result *result, size_t first,
                                                size_t count)
{
    struct orl_sensor_summary s = {0, NAN, INFINITY, -INFINITY, {NAN, NAN}, NAN, NAN};
    struct orl_sum sum = {0}, low = {0}, high = {0};
    size_t above = 0;
    for (size_t i = first; i < first + count && i < result->n_sensors; i++) {
        const double lx = result->illuminance_lx[i];
        if (!isfinite(lx))
            continue;
        s.sensors++;
        s.minimum_lx = fmin(s.minimum_lx, lx);
        s.maximum_lx = fmax(s.maximum_lx, lx);
        above += lx >= threshold_lx;
        orl_sum_add(&sum, lx);
        orl_sum_add(&low, result->interval_95_lx ? result->interval_95_lx[i][0] : NAN);
        orl_sum_add(&high, result->interval_95_lx ? result->interval_95_lx[i][1] : NAN);
    }
    if (s.sensors == 0) {
        s.minimum_lx = s.maximum_lx = NAN;
        return s;
    }
    const double n = (double)s.sensors;
    s.mean_lx = orl_sum_value(&sum) / n;
    s.interval_95_lx[0] = orl_sum_value(&low) / n;
    s.interval_95_lx[1] = orl_sum_value(&high) / n;
    s.uniformity = s.mean_lx > 0 ? s.minimum_lx / s.mean_lx : NAN;
    s.share_300 = (double)above / n;
    return s;
}
