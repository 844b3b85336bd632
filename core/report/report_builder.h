/* Internals of oriel/annual/annual_report.h: the builder of a report. Functions return the
 * errors given there. */
#ifndef ORL_REPORT_REPORT_BUILDER_H
#define ORL_REPORT_REPORT_BUILDER_H

#include <oriel/annual/annual_report.h>

/* All pointers are borrowed. */
struct orl_report_builder {
    const struct orl_annual_request *request;
    const struct orl_annual_result *result;
    const struct orl_report_request *report_request;
    const struct orl_files *files;
    const atomic_bool *cancel;        /* polled at each sensor; may be NULL */
    struct orl_thread_pool *pool;     /* may be NULL */
    struct orl_annual_report *report; /* year, grids and periods are filled first */
    struct orl_error *err;
};

/*
 * Limits of uncertain hours. An hour of a sensor is uncertain if its standard error exceeds this
 * share of the illuminance. The illuminance must also be able to reach the least value below, the
 * lower bound of useful daylight. Less light hardly matters to any metric, and hours at dusk would
 * outnumber the others.
 */
#define ORL_UNCERTAIN_SHARE 0.25
#define ORL_UNCERTAIN_LEAST_LX 100.0
static inline bool orl_report_is_uncertain(double lx, double error)
{
    return error > ORL_UNCERTAIN_SHARE * lx && lx + 2 * error >= ORL_UNCERTAIN_LEAST_LX;
}

/* Computes a figure of a grid, or of ORL_ALL_GRIDS. */
int orl_report_figure_of(const struct orl_report_builder *builder,
                         const struct orl_annual_figure *figure, size_t grid,
                         struct orl_annual_area *ret_area);

/* Returns true if the weather file has at least the share ORL_HOURS_LEAST of that period's
 * hours. */
static inline bool orl_report_has_hours(const struct orl_annual_report *report,
                                        enum orl_annual_when when)
{
    return report->periods[when].hours >= ORL_HOURS_LEAST * report->hours_wanted[when];
}

/* Returns ORL_ERR_INVALID if something requested cannot be computed from matrices; else 0. */
int orl_report_check_matrices(const struct orl_report_request *report_request,
                              struct orl_error *err);

/* Checks that the grids named by targets exist. */
int orl_report_check_grids(const struct orl_report_builder *builder);
int orl_report_make_verdicts(const struct orl_report_builder *builder);

/* Rates the viewpoints of report->seat_hours, n_seats of them. */
int orl_report_viewpoints(const struct orl_annual_result *result, struct orl_annual_report *report,
                          struct orl_error *err);

#endif
