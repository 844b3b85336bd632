/* Internals of oriel/annual/annual_report.h: the builder of a report, the scene with open shades,
 * and the openings for view out. Functions return the errors given there. */
#ifndef ORL_REPORT_REPORT_INTERNAL_H
#define ORL_REPORT_REPORT_INTERNAL_H

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_report.h>
#include <oriel/annual/view_out.h>

#include "scene/built/scene.h"

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

/* Loads a year's scene as for a job without a sky, with its shades in their first state. Reads the
 * scene, or takes it from the memory cache. The caller releases *ret_scene. Returns 0 or the error
 * of loading. */
int orl_unshaded_scene_load(const struct orl_annual_request *request, const struct orl_run_env *env,
                            struct orl_scene **ret_scene, struct orl_error *err);

/*
 * Openings for view out (oriel/annual/view_out.h): the clear panes, the ports that form one
 * opening, and the surfaces that are ground.
 */

struct orl_openings {
    const struct orl_scene *scene;                       /* borrowed */
    const struct orl_view_out_request *view_out_request; /* borrowed */
    bool *clear, *ground; /* by facet that is not instanced; owned, like of_port */
    uint32_t *of_port;    /* opening to which each port belongs */
    size_t count;         /* number of openings */
};

/* Finds the openings and the ground. Returns 0, ORL_ERR_NOT_FOUND (a name that nothing has),
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_openings_find(const struct orl_view_out_request *view_out_request,
                      const struct orl_scene *scene, const atomic_bool *cancel,
                      struct orl_openings *ret_openings, struct orl_error *err);
/* Returns true if the facet is ground; instanced facets are allowed. */
bool orl_openings_is_ground(const struct orl_openings *openings, uint32_t facet);
void orl_openings_done(struct orl_openings *openings); /* zeros are allowed */

#endif
