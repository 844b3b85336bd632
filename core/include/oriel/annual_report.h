/*
 * What is told of a year: metrics of every sensor, figures of every grid, verdicts on targets, each
 * with its interval (oriel/annual_metrics.h has the definitions), and the files it goes into.
 *
 * The year is that of the weather file: 8760 hours, or 8784 where it has 29 February. Hours that it
 * does not have, or that were not measured, count nowhere, neither as lit nor as dark; how many
 * they are is told. Errors of direct sunlight alone are not known by themselves: that of all light
 * stands for them where there is any, which is no smaller unless errors cancel.
 */
#ifndef ORIEL_ANNUAL_REPORT_H
#define ORIEL_ANNUAL_REPORT_H

#include <oriel/annual.h>
#include <oriel/annual_glare.h>
#include <oriel/annual_metrics.h>
#include <oriel/canvas.h>
#include <oriel/sun_exposure.h>
#include <oriel/view_out.h>

/* ---- The year -------------------------------------------------------------------------------- */

struct orl_annual_year {
    struct orl_annual_steps steps;
    bool times_begin_steps; /* rows' times: 0, 1/4 h ...; else middles or ends of steps */
    /* For each step: 1 if the file has a row for it. Also 1 for a step at night without a row, if
     * its day has other rows or no sunrise: it is dark. Owned, as the arrays below. */
    unsigned char *measured;
    uint32_t *step_of_column;    /* of the result's arrays, ascending */
    unsigned char *sunny;        /* of each column: 1 if the sun's disc gives light */
    double *global_lx;           /* of each step; 0 where it is dark or not known */
    double *diffuse_lx;          /* likewise */
    size_t n_columns, n_missing; /* columns; steps that are not measured */
    size_t
        n_doubtful; /* steps with the sun 3 degrees up or more, and no light in the file at all */
};
/* ORL_ERR_RANGE (rows that share a step, or out of order), ORL_ERR_NOMEM. */
int orl_annual_year_make(const struct orl_annual_result *result, struct orl_annual_year *ret_year,
                         struct orl_error *err);
void orl_annual_year_done(struct orl_annual_year *year); /* NULL and zeros are fine */
/* The year's step of a row of the weather file. */
uint32_t orl_annual_step_of(const struct orl_annual_year *year, const struct orl_annual_step *row);

/* ---- What goes in ---------------------------------------------------------------------------- */

/* Sensors of the request's grids: of each that has a file (names[i], else NULL) the file's; the
 * others keep theirs. Polls cancel, or NULL. Errors: what reading sensors says, with file and line;
 * ORL_ERR_LIMIT, ORL_ERR_CANCELLED. */
int orl_annual_grids_read(struct orl_annual_request *request, char *const *names,
                          const struct orl_files *files, const atomic_bool *cancel,
                          struct orl_error *err);

/*
 * Series of those window groups that have a file of them: a line for each row of the weather file,
 * of fields with commas between them, with the state's name or its number from 0. With one column,
 * the first line may be a heading; of several the group's is the one headed by its name, or by
 * "shades of" that, as hours.csv has it. Lines that are empty or begin with '#' are passed over.
 * Errors: what opening says; ORL_ERR_SYNTAX, _RANGE (no such state), _LIMIT, with the line; _NOMEM.
 */
int orl_annual_schedules_read(struct orl_annual_request *request, const struct orl_files *files,
                              struct orl_error *err);

/*
 * Whether a year would take these bytes for its weather, and of how many steps and rows it is; or
 * for when its rooms are in use. Errors are those of the year, with file and line, as far as the
 * bytes alone tell.
 */
int orl_annual_weather_check(const char *name, const char *text, size_t size, int year_chosen,
                             struct orl_annual_steps *ret_steps, size_t *ret_rows,
                             struct orl_error *err);
int orl_occupancy_check(const char *name, const char *text, size_t size,
                        const struct orl_annual_steps *steps, struct orl_error *err);

/* Which files were opened, and what they held. */
struct orl_annual_input {
    char *name;
    uint64_t bytes;
    char digest[ORL_DIGEST_HEX + 1]; /* SHA-256 */
};
struct orl_annual_inputs {
    const struct orl_files *files;  /* borrowed: where they come from */
    struct orl_annual_input *items; /* each once, by name */
    size_t count, room;
};
/* Opens one, where that was not done yet: of what was read by an earlier job. */
int orl_annual_inputs_need(struct orl_annual_inputs *inputs, const char *name,
                           struct orl_error *err);
/* A provider that passes all on, and notes it. inputs outlives it; orl_annual_inputs_done. */
struct orl_files orl_annual_inputs_of(struct orl_annual_inputs *inputs,
                                      const struct orl_files *files);
void orl_annual_inputs_done(struct orl_annual_inputs *inputs);

/* ---- What is asked --------------------------------------------------------------------------- */

/* Arrays and strings are owned; orl_annual_wishes_done frees them. */
struct orl_annual_wishes {
    struct orl_occupancy occupancy;
    char *occupancy_file; /* instead, for the provider; NULL: none */
    struct orl_annual_metric *metrics;
    size_t n_metrics;
    struct orl_annual_target *targets;
    size_t n_targets;
    struct orl_annual_rule *rules; /* their texts are nobody's */
    size_t n_rules;
    double median_diffuse_lx; /* outside, for daylight factors; 0: by the weather */
    double *grid_area;        /* of each grid, any unit; NULL: sensors stand for equal areas */
    struct orl_annual_target *until; /* what accuracy is wanted for (below); NULL: none */
    struct orl_exposure_wish exposure;
    struct orl_view_out_wish view_out;
    struct orl_seats_wish glare;
};
/* LM-83's hours; DA300, cDA300, UDI in its parts, hours of direct light above 1000 lx, and mean
 * illuminance; no targets. ORL_ERR_NOMEM. */
int orl_annual_wishes_init(struct orl_annual_wishes *wishes);
void orl_annual_wishes_done(struct orl_annual_wishes *wishes); /* NULL and zeros are fine */
/* What can be told before the weather is read: whether the grids that targets name are there.
 * ORL_ERR_INVALID, ORL_ERR_NOMEM. */
int orl_annual_wishes_validate(const struct orl_annual_request *request,
                               const struct orl_annual_wishes *wishes, struct orl_error *err);

/* ---- What is told ---------------------------------------------------------------------------- */

#define ORL_ALL_GRIDS SIZE_MAX

enum { ORL_VERDICT_NOTE = 128 };

/*
 * A verdict is undecided, and its note gives the reason, in three more cases. The weather file has
 * less than ORL_HOURS_LEAST of the hours that the rule asks for. Or a rule by LM-83 would pass, but
 * LM-83 closes blinds in some hour of use (more than 2 % of the points of a grid have 1000 lx or
 * more of direct sunlight; IES LM-83-12, 2.2.6), and no window group of the job closes by that
 * rule. Blinds reduce light, so a rule that fails without them fails. Or more than 10 % of the
 * hours have standard errors above 25 %, where the light may be 100 lx or more, and the bound is no
 * further from the value than three times the interval's longer side.
 */
struct orl_annual_verdict {
    const struct orl_annual_rule *rule; /* of the wishes; or NULL: a target of the job's own */
    struct orl_annual_target target;
    size_t grid; /* or ORL_ALL_GRIDS */
    struct orl_annual_area area;
    enum orl_verdict verdict;
    bool uncertain;              /* it is undecided since too many hours have large errors */
    char note[ORL_VERDICT_NOTE]; /* the reason; "" if there is none */
};
#define ORL_HOURS_LEAST 0.95

/* Of a grid's area, what has a view out of minimum, medium and high level, or better. */
struct orl_view_shares {
    double percent[3];
    enum orl_view_level level; /* that 75 % reach */
};

struct orl_annual_report {
    struct orl_annual_year year;
    unsigned char *marks;                             /* of each step: in use and measured */
    struct orl_annual_period periods[ORL_WHEN_COUNT]; /* by enum orl_annual_when */
    double hours_wanted[ORL_WHEN_COUNT]; /* of each period, with hours that are not measured */
    double median_diffuse_lx;            /* as wished, or over EN 17037's daylight hours */
    struct orl_annual_grid *grids;       /* as in the request, or one of all sensors */
    size_t n_grids, n_sensors;
    double *area; /* of each sensor */
    struct orl_annual_metric *metrics;
    size_t n_metrics;
    struct orl_annual_value *values; /* [metric * n_sensors + sensor] */
    /* sDA300/50 and ASE1000,250 first, then the average of every metric. */
    struct orl_annual_figure *figures;
    size_t n_figures;
    struct orl_annual_area *areas; /* [figure * (n_grids + 1) + grid]; the last one is of all */
    struct orl_annual_verdict *verdicts;
    size_t n_verdicts;
    size_t n_unlit;                 /* sensors that no light ever reaches: inside of something? */
    struct orl_exposure *exposures; /* of each point; NULL: not asked for, or not found yet */
    size_t n_exposures;
    struct orl_view_out *views; /* of points, then of sensors; NULL: not asked for, or not yet */
    size_t n_views;
    struct orl_view_shares *view_shares; /* of each grid; NULL: not of sensors */
    struct orl_seat_hours *seat_hours;   /* of each seat, as what follows; NULL: not asked for */
    struct orl_seat_glare *seats;
    size_t n_seats;
    struct orl_annual_value glare_autonomy; /* spatial: % of seats of at least medium protection */
};

/* files: of the occupancy file, else not asked. Of a result that holds its arrays. ORL_ERR_INVALID
 * (a target names no grid there is), what reading the occupancy says, ORL_ERR_RANGE, _NOMEM,
 * _CANCELLED: cancel, or NULL, is polled at each sensor of each figure. crew: NULL for the calling
 * thread alone. */
int orl_annual_report_make(const struct orl_annual_request *request,
                           const struct orl_annual_result *result,
                           const struct orl_annual_wishes *wishes, const struct orl_files *files,
                           const atomic_bool *cancel, struct orl_crew *crew,
                           struct orl_annual_report *ret_report, struct orl_error *err);
/* The same errors as far as they are known once the steps are, before anything is computed
 * (orl_annual_env's begins). */
int orl_annual_wishes_check(const struct orl_annual_request *request,
                            const struct orl_annual_result *result,
                            const struct orl_annual_wishes *wishes, const struct orl_files *files,
                            struct orl_error *err);
/* Adds the exposure to sunlight that is wished for (oriel/sun_exposure.h). */
int orl_annual_report_expose(const struct orl_annual_request *request,
                             const struct orl_annual_result *result,
                             const struct orl_annual_wishes *wishes, const struct orl_run_env *env,
                             struct orl_annual_report *report, struct orl_error *err);
/* Adds views out, as they were found (oriel/view_out.h), which it takes over, and their shares of
 * grids. ORL_ERR_NOMEM. */
int orl_annual_report_view(const struct orl_annual_wishes *wishes, struct orl_view_out *views,
                           size_t n_views, struct orl_annual_report *report, struct orl_error *err);
/* Adds the glare of seats (oriel/annual_glare.h) in the hours of use, and what is told of it. */
int orl_annual_report_dazzle(const struct orl_annual_request *request,
                             const struct orl_annual_result *result,
                             const struct orl_annual_wishes *wishes, const struct orl_run_env *env,
                             struct orl_annual_report *report, struct orl_error *err);
void orl_annual_report_done(struct orl_annual_report *report); /* NULL and zeros are fine */

/*
 * Adds to the result's warnings what the report shows: hours that are not there, or doubtful,
 * sensors without light, and hours whose standard error is large. These are hours in which the
 * error of a sensor is above 25 % of its illuminance, and illuminance and twice the error together
 * are 100 lx or more. warned, if not NULL, is called with each. ORL_ERR_NOMEM.
 */
int orl_annual_report_warn(const struct orl_annual_request *request,
                           const struct orl_annual_report *report, struct orl_annual_result *result,
                           void (*warned)(void *ctx, const char *warning), void *ctx,
                           struct orl_error *err);

/* ---- Until a verdict is sure ----------------------------------------------------------------- */

/* How the accuracy for wishes->until was come by. */
struct orl_annual_refinement {
    bool asked, settled; /* decided, or shown to lie within 0.5 % of the bound */
    struct orl_annual_target target;
    struct orl_annual_area area;
    enum orl_verdict verdict;
    uint32_t rounds;       /* runs, the first included */
    size_t refined;        /* sensors that had more paths than the first run's */
    uint64_t most_samples; /* of a sensor */
    uint32_t sun_halvings; /* of the last run, of the distance between the sun's nodes */
};

/*
 * Runs the request, and then, while the target of wishes->until is open, again with four times the
 * paths for those sensors alone that leave it open: of shares of an area those less than three
 * standard errors from changing sides, else all of the target's. Paths of all runs count alike.
 * Where errors fall less than by the paths, what lies between the sun's nodes is why: the next run
 * has nodes half as far apart.
 * Ends when the target is settled, or a sensor would have more than ORL_ANNUAL_MOST_SAMPLES.
 * Without a target it is orl_annual_run. told: called after each run; may be NULL.
 */
int orl_annual_run_until(const struct orl_annual_request *request,
                         const struct orl_annual_wishes *wishes, const struct orl_annual_env *env,
                         void (*told)(void *ctx, const struct orl_annual_refinement *so_far),
                         void *ctx, struct orl_annual_result *ret_result,
                         struct orl_annual_refinement *ret_refinement, struct orl_error *err);

/* Rows of the result's arrays as area figures take them: of a grid, or of ORL_ALL_GRIDS. */
struct orl_annual_rows orl_annual_rows_of(const struct orl_annual_report *report,
                                          const struct orl_annual_result *result, size_t grid);

/* ---- Series ---------------------------------------------------------------------------------- */

enum orl_annual_series { ORL_SERIES_MEAN, ORL_SERIES_SHARE };
#define ORL_SUN_DOWN (-1.0F)

/* Of every step of the year: the mean over a grid, lx, or the share of its area with at least so
 * many lux, percent. NaN where nothing was measured, ORL_SUN_DOWN where it is dark.
 * Polls cancel, or NULL, at each sensor. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_annual_series_of(const struct orl_annual_report *report,
                         const struct orl_annual_result *result, size_t grid,
                         enum orl_annual_series series, double threshold_lx,
                         const atomic_bool *cancel, float *ret_values);

/* ---- Maps ------------------------------------------------------------------------------------ */

/* Grids over the plan of the scene: the plane of each that holds most of its sensors. */
struct orl_annual_plans;

/* Reads the scene, or finds it on the shelf. Returns 0 or what loading says. */
int orl_annual_plans_new(const struct orl_annual_request *request,
                         const struct orl_annual_report *report, const struct orl_run_env *env,
                         struct orl_annual_plans **ret_plans, struct orl_error *err);
void orl_annual_plans_free(struct orl_annual_plans *plans); /* NULL is fine */

/* False: too few sensors of the grid lie in one plane for a map. side: of the plan's longer side,
 * page units. */
bool orl_annual_plan_size(const struct orl_annual_plans *plans, size_t grid, double side,
                          double *ret_width, double *ret_height);
/* A metric of the report, by its index, as a map of the grid; hatched where it is open on which
 * side of a bound a sensor is (50 % of DA and cDA, 250 h of direct sun). Returns 0 or
 * ORL_ERR_NOMEM.
 */
int orl_annual_plan_draw(const struct orl_annual_plans *plans,
                         const struct orl_annual_report *report, size_t grid, size_t metric,
                         struct orl_canvas *canvas, double x, double y, double side);
int orl_annual_plan_write(const struct orl_annual_plans *plans,
                          const struct orl_annual_report *report, size_t grid, size_t metric,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err);

/* What a metric is called at length: "Daylight autonomy at 300 lx"; occupied hours go without
 * saying. */
void orl_annual_metric_title(const struct orl_annual_metric *metric, char *ret_text, size_t size);
/* And for files: "da300", "udi100-3000", "direct_hours1000". */
void orl_annual_metric_file(const struct orl_annual_metric *metric, char *ret_text, size_t size);

/* ---- Files ----------------------------------------------------------------------------------- */

/*
 * All are whole or absent; folders are made. Returns 0, ORL_ERR_IO, ORL_ERR_FULL, ORL_ERR_LIMIT;
 * and, where cancel (NULL: never) is set meanwhile, ORL_ERR_CANCELLED.
 *
 * Radiance's matrix of one component: "#?RADIANCE", NROWS, NCOLS, NCOMP, FORMAT=ascii or float (of
 * this machine's order of bytes, which BigEndian tells), a blank line, and row after row. */
int orl_matrix_write(const char *path, const float *values, size_t rows, size_t columns, bool ascii,
                     const atomic_bool *cancel, struct orl_error *err);
/* The same of three equal components, FORMAT=float: what dctimestep takes. */
int orl_coefficients_write(const char *path, const float *values, size_t rows, size_t columns,
                           const atomic_bool *cancel, struct orl_error *err);

/*
 * Honeybee's results folder (honeybee-radiance-postprocess 0.4 reads it): grids_info.json,
 * sun-up-hours.txt, grid_states.json, study_info.json,
 * __static_apertures__/default/{total,direct}/GRID.npy, and metrics/{da,cda,udi,udi_lower,
 * udi_upper,ase,hours_above}/GRID.* with a summary. Columns are those of the result. Grids are
 * named as there; what no file may be called becomes '_'. named: told of each file before it is
 * written, by its name below the folder; NULL, or what it returns below 0 ends the writing.
 */
int orl_honeybee_write(const char *folder, const struct orl_annual_report *report,
                       const struct orl_annual_result *result,
                       int (*named)(void *ctx, const char *name, struct orl_error *err), void *ctx,
                       const atomic_bool *cancel, struct orl_error *err);

/* A line a sensor: grid, position, direction, every metric with its interval. */
int orl_annual_sensors_csv(const char *path, const struct orl_annual_report *report,
                           const struct orl_sensor *sensors, const atomic_bool *cancel,
                           struct orl_error *err);
/* A line a row of the weather file: month, day, hour, whether it counts, global and direct light
 * outside, mean illuminance of every grid; where there are shades, the state of every group
 * ("shades of NAME").
 */
int orl_annual_hours_csv(const char *path, const struct orl_annual_request *request,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, const atomic_bool *cancel,
                         struct orl_error *err);

/* A line a column of the result's arrays and matrices: its number from 0, month, day, hour, and the
 * hour of the year, all in the middle of the step. */
int orl_annual_columns_csv(const char *path, const struct orl_annual_report *report,
                           const struct orl_annual_result *result, struct orl_error *err);

/* A line a point, then a line a sensor, of those that views out are told of. */
int orl_annual_view_out_csv(const char *path, const struct orl_annual_wishes *wishes,
                            const struct orl_annual_report *report,
                            const struct orl_sensor *sensors, struct orl_error *err);

/* A line for each lit hour of use: of every seat DGP with its interval, and the light at the eye.
 */
int orl_annual_glare_csv(const char *path, const struct orl_annual_wishes *wishes,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, struct orl_error *err);

/* A grid's name as a file's. */
void orl_annual_file_name(const char *grid, char *ret_name, size_t size);

#endif
