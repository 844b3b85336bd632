/* Functions on single sensors for figures of areas, beside those of oriel/annual/annual_metrics.h.
 */
#ifndef ORL_METRICS_ANNUAL_SENSOR_YEAR_H
#define ORL_METRICS_ANNUAL_SENSOR_YEAR_H

#include <oriel/annual/annual_metrics.h>

/* 97.5 % quantile of Student's t with ORL_ANNUAL_DEGREES degrees of freedom. */
#define ORL_ANNUAL_Z 2.131449545559323

bool orl_annual_errors_known(const struct orl_annual_metric *metric,
                             const struct orl_annual_light *row);

/* Returns the metric, and its lower and upper bound if all values are within z standard errors. */
struct orl_annual_value orl_annual_within(const struct orl_annual_metric *metric,
                                          const struct orl_annual_period *period,
                                          const struct orl_annual_light *row, double z);

#endif
