/*
 * Compensated summation: the rounding error of each addition is collected and added at the end, so
 * that the error does not grow with the number of terms (Neumaier 1974).
 */
#ifndef ORL_BASE_STATISTICS_SUM_H
#define ORL_BASE_STATISTICS_SUM_H

#include <math.h>

struct orl_sum {
    double high, low; /* zero: empty sum */
};

static inline void orl_sum_add(struct orl_sum *sum, double value)
{
    const double high = sum->high + value;
    if (fabs(sum->high) >= fabs(value))
        sum->low += (sum->high - high) + value;
    else
        sum->low += (value - high) + sum->high;
    sum->high = high;
}

static inline double orl_sum_value(const struct orl_sum *sum)
{
    return sum->high + sum->low;
}

#endif
