/* Which state each window group of a year is in at every row of the weather file
 * (oriel/annual_shades.h has the rules). */
#ifndef ORL_ANNUAL_SCHEDULE_H
#define ORL_ANNUAL_SCHEDULE_H

#include <oriel/annual.h>

/* By series and spans; 0 by controls and without any. steps: of the result. ret_states:
 * [group * n_steps + step]. Returns 0 or ORL_ERR_RANGE (a series of another length). */
int orl_shades_schedule(const struct orl_annual_request *request,
                        const struct orl_annual_result *result, unsigned char *ret_states,
                        struct orl_error *err);

bool orl_shades_controlled(const struct orl_annual_request *request);

/*
 * What of the light decides, of sensors' rows: total, or direct of the group's own windows, all
 * groups being open. columns: n of each sensor. Sets ret_closed of every column.
 */
void orl_shades_control(const struct orl_annual_request *request,
                        const struct orl_shade_control *control, const float *lx, size_t columns,
                        bool *ret_closed);

#endif
