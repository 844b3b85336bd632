/*
 * Report of a year: metrics of every sensor, figures of every grid, verdicts on targets, each with
 * its interval (oriel/annual/annual_metrics.h has the definitions), and the output files.
 *
 * The year is that of the weather file: 8760 hours, or 8784 if it has 29 February. Hours that are
 * missing in the file, or that were not measured, count neither as lit nor as dark; their number is
 * reported. Errors of direct sunlight alone are not known. The error of all light is used in its
 * place where there is any; it is no smaller unless errors cancel.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_REPORT_H
#define ORIEL_ANNUAL_ANNUAL_REPORT_H

#include <oriel/annual/annual.h>
#include <oriel/annual/annual_glare.h>
#include <oriel/annual/annual_metrics.h>
#include <oriel/annual/sun_exposure.h>
#include <oriel/annual/view_out.h>
#include <oriel/base/canvas.h>

/* ---- The year -------------------------------------------------------------------------------- */

struct orl_annual_timeline {
    struct orl_annual_steps steps;
    bool times_begin_steps; /* true: times of rows are beginnings of steps (0, 1/4 h ...); false:
                               middles or ends */
    /* For each step: 1 if the file has a row for it. Also 1 for a step at night without a row, if
     * its day has other rows or no sunrise: it is dark. Owned, as the arrays below. */
    unsigned char *measured;
    uint32_t *step_of_column;    /* for each column of the result's arrays, ascending */
    unsigned char *sunny;        /* for each column: 1 if the sun's disc gives light */
    double *global_lx;           /* for each step; 0 if it is dark or not known */
    double *diffuse_lx;          /* for each step, likewise */
    size_t n_columns, n_missing; /* number of columns, and of steps that are not measured */
    size_t n_doubtful; /* steps with the sun at 3 degrees or more, but no light in the file */
};
/* Builds the year. Returns 0, ORL_ERR_RANGE (rows that share a step, or are out of order) or
 * ORL_ERR_NOMEM. */
int orl_annual_timeline_make(const struct orl_annual_result *result,
                             struct orl_annual_timeline *ret_year, struct orl_error *err);
void orl_annual_timeline_done(struct orl_annual_timeline *year); /* NULL and zeros are fine */
/* Returns the year's step of a row of the weather file. */
uint32_t orl_annual_step_of(const struct orl_annual_timeline *year,
                            const struct orl_annual_step *row);

/* ---- Input ----------------------------------------------------------------------------------- */

/* Reads the sensors of the request's grids. A grid with a file (names[i], else NULL) gets the
 * file's sensors; the others keep theirs. Polls cancel, which may be NULL. Errors: those of reading
 * sensors, with file and line; ORL_ERR_LIMIT, ORL_ERR_CANCELLED. */
int orl_annual_grids_read(struct orl_annual_request *request, char *const *names,
                          const struct orl_files *files, const atomic_bool *cancel,
                          struct orl_error *err);

/*
 * Reads the series of window groups with a schedule file. The file has a line for each row of the
 * weather file, with comma-separated fields: the state's name or its number from 0. With one
 * column, the first line may be a heading. With several, the group's column is headed by its name
 * or by "shades of" and its name, as in hours.csv. Empty lines and lines that begin with '#' are
 * skipped. Errors: those of opening; ORL_ERR_SYNTAX, _RANGE (no such state), _LIMIT, with the line;
 * _NOMEM.
 */
int orl_annual_schedules_read(struct orl_annual_request *request, const struct orl_files *files,
                              struct orl_error *err);

/*
 * Check that a year accepts these bytes as a weather file, or as an occupancy file. The first also
 * returns the steps and the number of rows. Errors are those of the year, with file and line, as
 * far as the bytes alone determine them.
 */
int orl_annual_weather_check(const char *name, const char *text, size_t size, int year_chosen,
                             struct orl_annual_steps *ret_steps, size_t *ret_rows,
                             struct orl_error *err);
int orl_occupancy_check(const char *name, const char *text, size_t size,
                        const struct orl_annual_steps *steps, struct orl_error *err);

/* File that was opened, with a digest of its content. */
struct orl_annual_input {
    char *name;
    uint64_t bytes;
    char digest[ORL_DIGEST_HEX + 1]; /* SHA-256 */
};
struct orl_annual_inputs {
    const struct orl_files *files;  /* borrowed provider of the files */
    struct orl_annual_input *items; /* each file once, by name */
    size_t count, room;
};
/* Opens a file unless it is already listed; for files that an earlier job has read. */
int orl_annual_inputs_ensure(struct orl_annual_inputs *inputs, const char *name,
                             struct orl_error *err);
/* Returns a provider that forwards to `files` and records the files opened. `inputs` must outlive
 * it. Free it with orl_annual_inputs_done. */
struct orl_files orl_annual_inputs_provider(struct orl_annual_inputs *inputs,
                                            const struct orl_files *files);
void orl_annual_inputs_done(struct orl_annual_inputs *inputs);

/* ---- Request --------------------------------------------------------------------------------- */

/* Requested evaluations. It owns its arrays and strings; orl_report_request_done frees them. */
struct orl_report_request {
    struct orl_occupancy occupancy;
    char *occupancy_file; /* alternative to occupancy, for the provider; NULL: none */
    struct orl_annual_metric *metrics;
    size_t n_metrics;
    struct orl_annual_target *targets;
    size_t n_targets;
    struct orl_annual_rule *rules; /* owned array; its strings are static */
    size_t n_rules;
    double median_diffuse_lx; /* outdoors, for daylight factors; 0: from the weather */
    double *grid_area;        /* area of each grid, any unit; NULL: sensors represent equal areas */
    /* Target that determines the accuracy (orl_annual_run_until); NULL: none. */
    struct orl_annual_target *until;
    struct orl_exposure_request exposure;
    struct orl_view_out_request view_out;
    struct orl_viewpoint_request glare;
};
/* Sets defaults: LM-83's hours; DA300, cDA300, the parts of UDI, hours of direct light above 1000
 * lx, and mean illuminance; no targets. Returns 0 or ORL_ERR_NOMEM. */
int orl_report_request_init(struct orl_report_request *report_request);
void orl_report_request_done(
    struct orl_report_request *report_request); /* NULL and zeros are fine */
/* Checks what is known before the weather is read: the grids that targets name must exist. Returns
 * 0, ORL_ERR_INVALID or ORL_ERR_NOMEM. */
int orl_report_request_validate(const struct orl_annual_request *request,
                                const struct orl_report_request *report_request,
                                struct orl_error *err);

/* ---- Results --------------------------------------------------------------------------------- */

#define ORL_ALL_GRIDS SIZE_MAX

enum { ORL_VERDICT_NOTE = 128 };

/*
 * Verdict on a target. Besides the case of too wide an interval, a verdict is undecided in three
 * cases, and its note gives the reason:
 * - The weather file has less than ORL_HOURS_LEAST of the hours that the rule requires.
 * - A rule by LM-83 would pass, but LM-83 closes blinds in some hour of use, and no window group of
 *   the job closes by that rule. LM-83 closes them if more than 2 % of the points of a grid have
 *   1000 lx or more of direct sunlight (IES LM-83-12, 2.2.6). Blinds reduce light, so a rule that
 *   fails without them fails.
 * - More than 10 % of the hours have standard errors above 25 %, where the light may be 100 lx or
 *   more, and the bound is no further from the value than three times the interval's longer side.
 */
struct orl_annual_verdict {
    const struct orl_annual_rule *rule; /* rule of the report request; NULL: a target of the job */
    struct orl_annual_target target;
    size_t grid; /* or ORL_ALL_GRIDS */
    struct orl_annual_area area;
    enum orl_verdict verdict;
    bool uncertain;              /* true: undecided because too many hours have large errors */
    char note[ORL_VERDICT_NOTE]; /* the reason; "" if there is none */
};
#define ORL_HOURS_LEAST 0.95

/* Shares of a grid's area with a view out of at least minimum, medium and high level. */
struct orl_view_shares {
    double percent[3];
    enum orl_view_level level; /* level that 75 % of the area reach */
};

struct orl_annual_report {
    struct orl_annual_timeline year;
    unsigned char *marks;                             /* for each step: 1 if in use and measured */
    struct orl_annual_period periods[ORL_WHEN_COUNT]; /* by enum orl_annual_when */
    double hours_wanted[ORL_WHEN_COUNT];              /* hours of each period, measured or not */
    double median_diffuse_lx;      /* requested value, or median over EN 17037's daylight hours */
    struct orl_annual_grid *grids; /* grids of the request, or one grid of all sensors */
    size_t n_grids, n_sensors;
    double *area; /* for each sensor */
    struct orl_annual_metric *metrics;
    size_t n_metrics;
    struct orl_annual_value *values; /* [metric * n_sensors + sensor] */
    /* sDA300/50 and ASE1000,250 first, then the average of every metric. */
    struct orl_annual_figure *figures;
    size_t n_figures;
    /* [figure * (n_grids + 1) + grid]; the last grid stands for all. */
    struct orl_annual_area *areas;
    struct orl_annual_verdict *verdicts;
    size_t n_verdicts;
    size_t n_unlit; /* sensors that receive no light in any hour; they may be inside an object */
    struct orl_exposure *exposures; /* for each point; NULL: not requested, or not computed yet */
    size_t n_exposures;
    struct orl_view_out *views; /* points, then sensors; NULL: not requested, or not computed yet */
    size_t n_views;
    struct orl_view_shares *view_shares;         /* for each grid; NULL: no views from sensors */
    struct orl_viewpoint_hours *viewpoint_hours; /* for each viewpoint; NULL: not requested */
    struct orl_viewpoint_glare *viewpoints;
    size_t n_viewpoints;
    /* Spatial: % of viewpoints with at least medium protection. */
    struct orl_annual_value glare_autonomy;
};

/* Evaluates a result that holds its arrays. files: for the occupancy file only. Returns 0,
 * ORL_ERR_INVALID (a target names an unknown grid), the error of reading the occupancy,
 * ORL_ERR_RANGE, _NOMEM or _CANCELLED. cancel is polled at each sensor of each figure; may be NULL.
 * pool: NULL for the calling thread alone. */
int orl_annual_report_make(const struct orl_annual_request *request,
                           const struct orl_annual_result *result,
                           const struct orl_report_request *report_request,
                           const struct orl_files *files, const atomic_bool *cancel,
                           struct orl_thread_pool *pool, struct orl_annual_report *ret_report,
                           struct orl_error *err);
/* Returns those errors of orl_annual_report_make that are known once the steps are, before any hour
 * is computed (orl_annual_env's begins). */
int orl_report_request_check(const struct orl_annual_request *request,
                             const struct orl_annual_result *result,
                             const struct orl_report_request *report_request,
                             const struct orl_files *files, struct orl_error *err);
/* Adds the requested exposure to sunlight (oriel/annual/sun_exposure.h). */
int orl_annual_report_add_exposure(const struct orl_annual_request *request,
                                   const struct orl_annual_result *result,
                                   const struct orl_report_request *report_request,
                                   const struct orl_run_env *env, struct orl_annual_report *report,
                                   struct orl_error *err);
/* Adds views out (oriel/annual/view_out.h), which it takes over, and their shares by grid. Returns
 * 0 or ORL_ERR_NOMEM. */
int orl_annual_report_add_views(const struct orl_report_request *report_request,
                                struct orl_view_out *views, size_t n_views,
                                struct orl_annual_report *report, struct orl_error *err);
/* Adds the glare of viewpoints (oriel/annual/annual_glare.h) in the hours of use, and its
 * statistics. */
int orl_annual_report_add_glare(const struct orl_annual_request *request,
                                const struct orl_annual_result *result,
                                const struct orl_report_request *report_request,
                                const struct orl_run_env *env, struct orl_annual_report *report,
                                struct orl_error *err);
void orl_annual_report_done(struct orl_annual_report *report); /* NULL and zeros are fine */

/*
 * Adds warnings to the result: missing or doubtful hours, sensors without light, and hours with
 * large standard errors. The last are hours in which the error of a sensor is above 25 % of its
 * illuminance, and illuminance plus twice the error is 100 lx or more. warned, if not NULL, is
 * called with each warning. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_annual_report_warn(const struct orl_annual_request *request,
                           const struct orl_annual_report *report, struct orl_annual_result *result,
                           void (*warned)(void *ctx, const char *warning), void *ctx,
                           struct orl_error *err);

/* ---- Refinement until a verdict is decided --------------------------------------------------- */

/* Progress of the refinement for report_request->until. */
struct orl_annual_refinement {
    bool asked, decided; /* decided: decided, or shown to lie within 0.5 % of the bound */
    struct orl_annual_target target;
    struct orl_annual_area area;
    enum orl_verdict verdict;
    uint32_t rounds;       /* number of runs, including the first */
    size_t refined;        /* sensors with more paths than in the first run */
    uint64_t most_samples; /* for one sensor */
    uint32_t sun_halvings; /* for the last run: halvings of the distance between the sun's nodes */
};

/*
 * Runs the request. While the target of report_request->until is undecided, it runs again with four
 * times the paths, only for sensors that affect the decision. For a share of an area these are the
 * sensors less than three standard errors from changing sides; else all sensors of the target.
 * Paths of all runs have equal weight. If errors fall less than the number of paths implies,
 * interpolation between the sun's nodes limits them: the next run has nodes half as far apart. Ends
 * when the target is decided, or a sensor would have more than ORL_ANNUAL_MOST_SAMPLES. Without a
 * target it equals orl_annual_run. round_done: called after each run; may be NULL.
 */
int orl_annual_run_until(const struct orl_annual_request *request,
                         const struct orl_report_request *report_request,
                         const struct orl_annual_env *env,
                         void (*round_done)(void *ctx, const struct orl_annual_refinement *so_far),
                         void *ctx, struct orl_annual_result *ret_result,
                         struct orl_annual_refinement *ret_refinement, struct orl_error *err);

/* Returns rows of the result's arrays, as input of area figures: those of a grid, or of
 * ORL_ALL_GRIDS. */
struct orl_annual_rows orl_annual_rows_of(const struct orl_annual_report *report,
                                          const struct orl_annual_result *result, size_t grid);

/* ---- Series ---------------------------------------------------------------------------------- */

enum orl_annual_series { ORL_SERIES_MEAN, ORL_SERIES_SHARE };
#define ORL_SUN_DOWN (-1.0F)

/* Fills a value for every step of the year: the mean over a grid, lx, or the share of its area with
 * at least threshold_lx, percent. NaN if the step was not measured, ORL_SUN_DOWN if it is dark.
 * Polls cancel, which may be NULL, at each sensor. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_annual_series_of(const struct orl_annual_report *report,
                         const struct orl_annual_result *result, size_t grid,
                         enum orl_annual_series series, double threshold_lx,
                         const atomic_bool *cancel, float *ret_values);

/* ---- Maps ------------------------------------------------------------------------------------ */

/* Grids over the plan of the scene; each is shown in the plane that holds most of its sensors. */
struct orl_annual_plans;

/* Reads the scene, or finds it in the memory cache. Returns 0 or the error of loading. */
int orl_annual_plans_new(const struct orl_annual_request *request,
                         const struct orl_annual_report *report, const struct orl_run_env *env,
                         struct orl_annual_plans **ret_plans, struct orl_error *err);
void orl_annual_plans_free(struct orl_annual_plans *plans); /* NULL is fine */

/* Returns the size of a grid's map, page units. side: length of the plan's longer side. Returns
 * false if too few sensors of the grid lie in one plane for a map. */
bool orl_annual_plan_size(const struct orl_annual_plans *plans, size_t grid, double side,
                          double *ret_width, double *ret_height);
/* Draw the report's metric with that index as a map of the grid. Sensors are hatched if the side of
 * the bound that they are on is undecided (50 % for DA and cDA, 250 h for direct sun). Returns 0 or
 * ORL_ERR_NOMEM. */
int orl_annual_plan_draw(const struct orl_annual_plans *plans,
                         const struct orl_annual_report *report, size_t grid, size_t metric,
                         struct orl_canvas *canvas, double x, double y, double side);
int orl_annual_plan_write(const struct orl_annual_plans *plans,
                          const struct orl_annual_report *report, size_t grid, size_t metric,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err);

/* Returns the long name of a metric: "Daylight autonomy at 300 lx". Occupied hours are not
 * mentioned. */
void orl_annual_metric_title(const struct orl_annual_metric *metric, char *ret_text, size_t size);
/* Returns the file-name stem of a metric: "da300", "udi100-3000", "direct_hours1000". */
void orl_annual_metric_file(const struct orl_annual_metric *metric, char *ret_text, size_t size);

/* ---- Files ----------------------------------------------------------------------------------- */

/*
 * Functions that write files. Files are whole or absent; folders are created. They return 0,
 * ORL_ERR_IO, ORL_ERR_FULL, ORL_ERR_LIMIT, and ORL_ERR_CANCELLED once *cancel is set (NULL: never).
 *
 * orl_matrix_write writes Radiance's matrix of one component: "#?RADIANCE", NROWS, NCOLS, NCOMP,
 * FORMAT=ascii or float (in this machine's byte order, which the BigEndian line gives), a blank
 * line, and row after row.
 */
int orl_matrix_write(const char *path, const float *values, size_t rows, size_t columns, bool ascii,
                     const atomic_bool *cancel, struct orl_error *err);
/* Writes a matrix with three equal components, FORMAT=float, as dctimestep reads it. */
int orl_coefficients_write(const char *path, const float *values, size_t rows, size_t columns,
                           const atomic_bool *cancel, struct orl_error *err);

/*
 * Writes Honeybee's results folder (honeybee-radiance-postprocess 0.4 reads it): grids_info.json,
 * sun-up-hours.txt, grid_states.json, study_info.json,
 * __static_apertures__/default/{total,direct}/GRID.npy, and metrics/{da,cda,udi,udi_lower,
 * udi_upper,ase,hours_above}/GRID.* with a summary. Columns are those of the result. Grids keep
 * their names; characters that file names cannot have become '_'. named: called before each file is
 * written, with its name below the folder; a negative result ends the writing. May be NULL.
 */
int orl_honeybee_write(const char *folder, const struct orl_annual_report *report,
                       const struct orl_annual_result *result,
                       int (*named)(void *ctx, const char *name, struct orl_error *err), void *ctx,
                       const atomic_bool *cancel, struct orl_error *err);

/* Writes the folder without metrics: its description and the series. */
int orl_honeybee_write_hours(const char *folder, const struct orl_annual_report *report,
                             const struct orl_annual_result *result,
                             int (*named)(void *ctx, const char *name, struct orl_error *err),
                             void *ctx, const atomic_bool *cancel, struct orl_error *err);

/* Writes a line per sensor: grid, position, direction, every metric with its interval. */
int orl_annual_sensors_csv(const char *path, const struct orl_annual_report *report,
                           const struct orl_sensor *sensors, const atomic_bool *cancel,
                           struct orl_error *err);
/* Writes a line per row of the weather file: month, day, hour, 1 if it counts, global and direct
 * light outdoors, mean illuminance of every grid. With shades also the state of every group
 * ("shades of NAME"). */
int orl_annual_hours_csv(const char *path, const struct orl_annual_request *request,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, const atomic_bool *cancel,
                         struct orl_error *err);

/* Writes a line per column of the result's arrays and matrices: its number from 0, month, day,
 * hour, and the hour of the year, all in the middle of the step. */
int orl_annual_columns_csv(const char *path, const struct orl_annual_report *report,
                           const struct orl_annual_result *result, struct orl_error *err);

/* Writes a line per point, then a line per sensor, for those with views out. */
int orl_annual_view_out_csv(const char *path, const struct orl_report_request *report_request,
                            const struct orl_annual_report *report,
                            const struct orl_sensor *sensors, struct orl_error *err);

/* Writes a line for each lit hour of use: for every viewpoint DGP with its interval, and the
 * illuminance at the eye. */
int orl_annual_glare_csv(const char *path, const struct orl_report_request *report_request,
                         const struct orl_annual_report *report,
                         const struct orl_annual_result *result, struct orl_error *err);

/* Converts a grid's name to a file name. */
void orl_annual_file_name(const char *grid, char *ret_name, size_t size);

#endif
