/* A report while it is made; inside of oriel/annual_report.h, whose errors these have. */
#ifndef ORL_REPORT_MAKING_H
#define ORL_REPORT_MAKING_H

#include <oriel/annual_report.h>

/* All borrowed. */
struct orl_report_making {
    const struct orl_annual_request *request;
    const struct orl_annual_result *result;
    const struct orl_annual_wishes *wishes;
    const struct orl_files *files;
    const atomic_bool *cancel;        /* polled at each sensor; NULL: never */
    struct orl_crew *crew;            /* NULL: none */
    struct orl_annual_report *report; /* its year, grids and periods are made first */
    struct orl_error *err;
};

/*
 * An hour of a sensor is uncertain if its standard error is above this share of the illuminance,
 * and the illuminance may be least_lx or more. That is the lower bound of useful daylight: less
 * light hardly matters to any metric, and hours at dusk would hide the others.
 */
#define ORL_UNCERTAIN_SHARE 0.25
#define ORL_UNCERTAIN_LEAST_LX 100.0
static inline bool orl_report_is_uncertain(double lx, double error)
{
    return error > ORL_UNCERTAIN_SHARE * lx && lx + 2 * error >= ORL_UNCERTAIN_LEAST_LX;
}

/* Of a grid, or of ORL_ALL_GRIDS. */
int orl_report_figure_of(const struct orl_report_making *making,
                         const struct orl_annual_figure *figure, size_t grid,
                         struct orl_annual_area *ret_area);

/* Does the weather file have at least ORL_HOURS_LEAST of that period? */
static inline bool orl_report_has_hours(const struct orl_annual_report *report,
                                        enum orl_annual_when when)
{
    return report->periods[when].hours >= ORL_HOURS_LEAST * report->hours_wanted[when];
}

/* Is nothing wished for that matrices cannot tell? ORL_ERR_INVALID. */
int orl_report_check_matrices(const struct orl_annual_wishes *wishes, struct orl_error *err);

/* Are there the grids that targets name? */
int orl_report_check_grids(const struct orl_report_making *making);
int orl_report_make_verdicts(const struct orl_report_making *making);

/* Sums up the hours of seats, n_seats of them, that report->seat_hours has. */
int orl_report_seats(const struct orl_annual_result *result, struct orl_annual_report *report,
                     struct orl_error *err);

#endif
