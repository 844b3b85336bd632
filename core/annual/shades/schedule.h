/* State of each window group of a year at every row of the weather file
 * (oriel/annual/annual_shades.h has the rules). */
#ifndef ORL_ANNUAL_SHADES_SCHEDULE_H
#define ORL_ANNUAL_SHADES_SCHEDULE_H

#include <oriel/annual/annual.h>

/* Sets the states by series and spans; groups with a control, or without any of these, get 0.
 * result: only its steps are read. ret_states: [group * n_steps + step]. Returns 0 or ORL_ERR_RANGE
 * (a series of another length). */
int orl_shades_schedule(const struct orl_annual_request *request,
                        const struct orl_annual_result *result, unsigned char *ret_states,
                        struct orl_error *err);

bool orl_shades_controlled(const struct orl_annual_request *request);

/*
 * Control by light. Sensors are counted in order, one by one. After the last sensor of a grid its
 * decision is recorded, so memory does not grow with the grids. If there is no grid, all sensors
 * form one.
 */
struct orl_shade_count {
    size_t grid;   /* index of the current grid */
    uint32_t *lit; /* by column: sensors of the current grid at or above the threshold */
    bool *closed;  /* by column: true if some earlier grid closes the group */
    size_t columns;
};

/* Returns 0 or ORL_ERR_NOMEM; the caller calls orl_shade_count_done in either case. */
int orl_shade_count_init(struct orl_shade_count *count, size_t columns);
void orl_shade_count_done(struct orl_shade_count *count);
/* Counts a sensor. lx: its light by column with all groups open: total light, or direct light
 * through the group's own windows. Sensors without light may be skipped. */
void orl_shade_count_add(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control, size_t sensor, const float *lx);
/* Ends the count after the last sensor; closed then covers all grids. */
void orl_shade_count_end(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control);

#endif
