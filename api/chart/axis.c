#include "chart/axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double least_ratio = 8;

/* Sets ticks at `per` values of every step-th decade. Returns false if they are too close. */
static int place_ticks(struct orl_axis *axis, int per, int step, double spacing)
{
    static const double digits[] = {1, 2, 5};
    const int first = (int)floor(log10(axis->low)), last = (int)ceil(log10(axis->high));
    axis->n_ticks = 0;
    for (int decade = first; decade <= last; decade++) {
        for (int i = 0; i < per; i++) {
            /* Dividing gives the double nearest to 1/10; pow(10, -1) need not. */
            const double power = pow(10, abs(decade));
            const double value = decade < 0 ? digits[i] / power : digits[i] * power;
            if (decade % step != 0 || value < axis->low || value > axis->high)
                continue;
            if (axis->n_ticks == ORL_AXIS_TICKS)
                return 0;
            axis->ticks[axis->n_ticks++] = value;
        }
    }
    for (size_t i = 1; i < axis->n_ticks; i++)
        if (fabs(orl_axis_at(axis, axis->ticks[i]) - orl_axis_at(axis, axis->ticks[i - 1])) <
            spacing)
            return 0;
    return 1;
}

void orl_axis_init(struct orl_axis *axis, double low, double high, double from, double to,
                   double spacing)
{
    const double margin = fmax(pow(high / low, 0.06), sqrt(fmax(1, least_ratio * low / high)));
    *axis = (struct orl_axis){.low = low / margin, .high = high * margin, .from = from, .to = to};
    if (place_ticks(axis, 3, 1, spacing))
        return;
    for (int step = 1; step < ORL_AXIS_TICKS && !place_ticks(axis, 1, step, spacing); step++)
        continue;
}

double orl_axis_at(const struct orl_axis *axis, double value)
{
    const double t = log(value / axis->low) / log(axis->high / axis->low);
    return axis->from + t * (axis->to - axis->from);
}

void orl_axis_format(double tick, char *ret_text, size_t size)
{
    snprintf(ret_text, size, tick >= 1e5 || tick < 1e-4 ? "%.0e" : "%.10g", tick);
}
