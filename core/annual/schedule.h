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
 * Control by light: sensors are counted in their order, one by one, and what a grid decides is
 * noted when its last one has been, so that memory does not grow with the grids. All sensors are
 * one grid if there is none.
 */
struct orl_shade_count {
    size_t grid;   /* that is counted now */
    uint32_t *lit; /* by column: its sensors above the bound */
    bool *closed;  /* by column: some grid before it closes the group */
    size_t columns;
};

/* Returns 0 or ORL_ERR_NOMEM; orl_shade_count_done in either case. */
int orl_shade_count_init(struct orl_shade_count *count, size_t columns);
void orl_shade_count_done(struct orl_shade_count *count);
/* lx: the sensor's, by column: total light, or direct light of the group's own windows, all groups
 * being open. A sensor that is left out has none. */
void orl_shade_count_add(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control, size_t sensor, const float *lx);
/* After the last sensor: then closed is that of all grids. */
void orl_shade_count_end(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control);

#endif
