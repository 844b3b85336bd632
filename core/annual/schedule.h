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
 * Control by light: sensors are counted one by one, then the counts decide.
 * counts: [grid][column], 0 at first; orl_shades_grids of them, all sensors being one grid if there
 * is none. lx: the sensor's, by column: total light, or direct light of the group's own windows,
 * all groups being open.
 */
size_t orl_shades_grids(const struct orl_annual_request *request);
void orl_shades_count(const struct orl_annual_request *request,
                      const struct orl_shade_control *control, size_t sensor, const float *lx,
                      size_t columns, uint32_t *counts);
/* Sets closed of every column. */
void orl_shades_decide(const struct orl_annual_request *request,
                       const struct orl_shade_control *control, const uint32_t *counts,
                       size_t columns, bool *ret_closed);

#endif
