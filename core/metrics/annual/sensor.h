/* What figures of areas need of sensors beside oriel/annual_metrics.h. */
#ifndef ORL_METRICS_ANNUAL_SENSOR_H
#define ORL_METRICS_ANNUAL_SENSOR_H

#include <oriel/annual_metrics.h>

#define ORL_ANNUAL_Z 2.131449545559323 /* of Student's t with ORL_ANNUAL_DEGREES, 95 % */

bool orl_annual_errors_known(const struct orl_annual_metric *metric,
                             const struct orl_annual_light *row);

/* The metric, and the least and most it is while all values are within z standard errors. */
struct orl_annual_value orl_annual_within(const struct orl_annual_metric *metric,
                                          const struct orl_annual_period *period,
                                          const struct orl_annual_light *row, double z);

#endif
