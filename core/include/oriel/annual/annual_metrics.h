/*
 * Evaluation of a year of illuminances: metrics of sensors, figures of areas, and verdicts.
 *
 * Time. A year consists of steps of equal length from 1 January 0:00, local standard time (no
 * daylight saving): 8760 hours, or 8784 with 29 February, each divided into a whole number of
 * steps. Step i lasts from i to i + 1 and is evaluated at its middle, as EPW's hour 1 (0:00 to
 * 1:00) is at 0:30. Arrays have columns only for the steps with the sun up. All other steps are
 * dark and count as 0 lx. If a tool leaves dark steps out of UDI's lower part, its parts do not add
 * up to 100 %.
 *
 * Errors. An hour's value has a standard error from 16 batches; intervals are Student's with 15
 * degrees of freedom, t = 2.13. Errors of one sensor are correlated over hours, since all hours use
 * the same paths. The interval of a sensor's metric is therefore its value at E exp(-t k se / E)
 * and at E exp(t k se / E), in all hours together. Here k is 1 in hours without sun, whose errors
 * have one common factor. In hours with sun k is the sensor's coherence (oriel/annual/annual.h),
 * since the sun's positions share less. If the coherence is not known, k is 1, and intervals are
 * too wide. The interval uses factors because values that come out low have errors that are too
 * small. se never exceeds E, since both come from means that are not negative. Values of 0 stay 0.
 * UDI's useful part gains at one bound what it loses at the other: the changes by the two bounds
 * are added in squares.
 *
 * Sensors have separate paths, and their errors are independent. Each sensor has a t at which it
 * would change sides, which gives its probability to pass. The number of sensors that pass follows
 * the convolution of these probabilities (the Poisson-binomial distribution). This assumes that a
 * sensor's true value lies on either side of its estimate alike. That is wrong if many sensors lie
 * on one side of the bound, close to it. Therefore the lower end is computed as if all sensors were
 * 0.35 standard errors lower, and the upper end as if they were 0.35 higher. If a large part of an
 * area lies within a standard error of the bound, all on one side, an interval can still be too
 * narrow. Without standard errors intervals are NaN, and verdicts are unknown.
 *
 * Definitions, and differences from other tools:
 * - DA: daylight autonomy, the share of the hours with E >= low (Reinhart, Mardaljevic, Rogers
 *   2006, Leukos 3, 7). Some papers say >; here E equal to low counts, as in LM-83 and Honeybee.
 * - cDA: continuous DA; an hour with E < low counts E / low (Rogers 2006).
 * - UDI: useful daylight illuminance (Nabil and Mardaljevic 2005, Lighting Res. Technol. 37, 41;
 *   bounds of 100 and 3000 lx: Mardaljevic et al. 2012). Lower: E < low; useful: low <= E <= high;
 *   upper: E > high. Useful is split at 300 lx: supplementary low <= E < split, autonomous split <=
 *   E <= high. The paper of 2005 has 100 and 2000. Lower, useful and upper add up to 100 %; dark
 *   hours are lower, as in Honeybee.
 * - sDA: spatial DA, the share of the area with DA(low) >= a share of the hours; sDA300/50 (IES
 *   LM-83-12: 8 to 18, every day, 3650 h). In LM-83, 2.2.6, blinds move; here they move if the
 *   year's shades are controlled so (oriel/annual/annual_shades.h).
 * - ASE: annual sunlight exposure, the share of the area with direct sunlight
 * (oriel/annual/annual.h defines it) of more than 1000 lx in 250 h or more of the same hours, with
 * blinds open: ASE1000,250 (IES LM-83-12). Strictly more than 1000, at least 250, as in
 * ClimateStudio and Honeybee. Some tools take suns from sky patches and are off by as much as 60
 * points.
 * - EN: EN 17037:2018, 5.1 and A.2 by climate data: daylight provision. It uses the 4380 hours of
 *   the year with the most daylight (global horizontal; half the steps of a leap year). In half of
 *   them 300, 500 or 750 lx on 50 % of the area, and 100, 300 or 500 lx on 95 %: minimum, medium,
 *   high. For roof lights: the target on 95 %. As in Honeybee.
 * - DF: daylight factor, the illuminance over that of an unobstructed level plane outdoors. The sky
 *   is the CIE overcast sky of 10 000 lx (CIE S 011/E:2003, type 16); shades are open, and the
 *   ground is included. Figures are its mean over an area, its minimum (EN 12464), or the share of
 *   the area with so much. EN 17037, annex A.2, method 1, requires the DF that gives 300 lx (500,
 *   750) at the median outdoor diffuse illuminance, on 50 % of the area. The minimum target is 100
 *   lx (300, 500) on 95 %. Here that median is the weather's over EN's 4380 hours; a value of the
 *   standard's table A.3 of capitals can be given instead.
 * - LEED v4.1, EQ Daylight, option 1: sDA300/50 of 40, 55 or 75 % for 1, 2 or 3 points. For a room
 *   with ASE above 10 % the design must state how it limits glare; in v4 such a room did not count.
 * - WELL v2: L01 sDA150/50 >= 30 %, or 200 lx in half of the daylight hours on 30 %; L06 sDA300/50
 *   >= 55 (tier 1) or 75 % (tier 2), or EN 17037's minimum (tier 1: the target alone).
 * - BREEAM Hea 01, illuminance averages: the mean over a room, and its darkest point, reach so many
 *   lux in so many hours of the year, of all 8760.
 * - Others: mean illuminance; cumulative illuminance (lx h); hours at or above a bound; hours of
 *   direct sunlight above a threshold (0 lx: any of it arrives). EN 17037's exposure to sunlight
 *   and view out are in oriel/annual/sun_exposure.h and view_out.h.
 *
 * Units: lux, hours, percent. Threads: any; arguments are borrowed and read. Errors: those of
 * error.h. Array values must be finite.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_METRICS_H
#define ORIEL_ANNUAL_ANNUAL_METRICS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_ANNUAL_DEGREES = 15 }; /* degrees of freedom of the standard errors; odd */

/* ---- Steps that count ------------------------------------------------------------------------ */

struct orl_annual_steps {
    uint32_t count;    /* steps of the year */
    uint32_t per_hour; /* 1, or more */
};
/* Checks that the steps make 8760 or 8784 hours. Returns 0 or ORL_ERR_RANGE. */
int orl_annual_steps_check(const struct orl_annual_steps *steps, struct orl_error *err);

/* Hours of use of a room. */
struct orl_occupancy {
    /* Hours of use, from <= middle of the step < to; over midnight if to < from. */
    double from_h, to_h;
    unsigned days; /* bit 0 Monday ... bit 6 Sunday */
    /* Weekday of 1 January: 0 Monday ... 6 Sunday, or ORL_FIRST_DAY_OF_WEATHER. */
    unsigned first_day;
    uint32_t begins_day; /* days from this one on belong to the year before; 0: no days do */
};
/* Value for the weekday of 1 January in the weather file (EPW: DATA PERIODS), or Monday if the file
 * does not give it. */
enum { ORL_FIRST_DAY_OF_WEATHER = 7 };
/* 8 to 18, every day; weekday from the weather file. */
void orl_occupancy_init(struct orl_occupancy *occupancy);
/* Fills the marks of all steps: 1 in use, 0 not. ORL_FIRST_DAY_OF_WEATHER counts as Monday. */
void orl_occupancy_mark(const struct orl_occupancy *occupancy, const struct orl_annual_steps *steps,
                        unsigned char *ret_marks);
/*
 * Reads the marks from a file. Each line has one number per step, above 0 if the room is in use.
 * DAYSIM's lines "month,day,hour,value" are also accepted, where the hour is the middle of the
 * step. Empty lines, lines that begin with '#', a first line of words, and a UTF-8 byte order mark
 * are skipped. Errors, with the line: ORL_ERR_SYNTAX (also for lines of both kinds), ORL_ERR_RANGE
 * (too few or many lines, times out of order).
 */
int orl_occupancy_read(const char *name, const char *text, size_t size,
                       const struct orl_annual_steps *steps, unsigned char *ret_marks,
                       struct orl_error *err);

/* Marks EN 17037's daylight hours: the half of the steps with the most global horizontal daylight,
 * among those measured (NULL: all); of equal ones the earlier. Returns 0 or ORL_ERR_NOMEM. */
int orl_annual_daylight_mark(const double *global, const unsigned char *measured,
                             const struct orl_annual_steps *steps, unsigned char *ret_marks,
                             struct orl_error *err);

enum orl_annual_when { ORL_WHEN_OCCUPIED, ORL_WHEN_DAYLIGHT, ORL_WHEN_ALWAYS, ORL_WHEN_COUNT };
const char *orl_annual_when_name(enum orl_annual_when when); /* "occupied", "daylight", "year" */

/* Steps that count, as columns of arrays. */
struct orl_annual_period {
    uint32_t *columns; /* owned; ascending */
    size_t n_columns;
    double step_h;
    double hours; /* all steps that count, also without a column */
};
/* Builds a period. marks: of all steps; NULL: all count. step_of[n]: the step of each column,
 * ascending. Returns 0 or ORL_ERR_NOMEM. */
int orl_annual_period_make(const unsigned char *marks, const struct orl_annual_steps *steps,
                           const uint32_t *step_of, size_t n, struct orl_annual_period *ret_period,
                           struct orl_error *err);
void orl_annual_period_done(struct orl_annual_period *period); /* NULL and zeros are fine */

/* ---- Metrics of a sensor --------------------------------------------------------------------- */

enum orl_metric_kind {
    ORL_METRIC_DA,           /* %, low */
    ORL_METRIC_CDA,          /* %, low */
    ORL_METRIC_UDI,          /* %, low <= E <= high */
    ORL_METRIC_UDI_LOWER,    /* %, E < low */
    ORL_METRIC_UDI_PART,     /* %, low <= E < high: supplementary */
    ORL_METRIC_UDI_UPPER,    /* %, E > low */
    ORL_METRIC_MEAN,         /* lx */
    ORL_METRIC_CUMULATIVE,   /* lx h */
    ORL_METRIC_HOURS,        /* h, E >= low */
    ORL_METRIC_DIRECT_HOURS, /* h, direct > low */
    ORL_METRIC_DF, /* %, does not use hours; low > 0 in a share: the illuminance that the DF must
                      give */
    ORL_METRIC_KINDS
};

struct orl_annual_metric {
    enum orl_metric_kind kind;
    enum orl_annual_when when;
    double low_lx, high_lx; /* used if the kind has them */
};

/* Returns "%", "lx", "lx h" or "h". */
const char *orl_annual_unit(enum orl_metric_kind kind);
/* Returns "DA300", "UDI100-3000", "hours of direct light above 1000 lx", ... */
void orl_annual_metric_name(const struct orl_annual_metric *metric, char *ret_text, size_t size);

/* Columns of one sensor, or means over several. */
struct orl_annual_light {
    const float *total_lx, *direct_lx;             /* direct: only for kinds that use it */
    const float *total_error_lx, *direct_error_lx; /* standard errors; NULL: not known */
    const float *overcast_lx, *overcast_error_lx;  /* one number each, only for kinds that use it */
    /* One number: coherence of the errors of total_lx in hours with sun; NULL: 1. */
    const float *coherence;
    const unsigned char *sunny; /* for each column: 1 in hours with sun; NULL: none */
    const float *total_factor;  /* result of orl_annual_error_factors, to save time; or NULL */
};
/* Fills the factors by which the upper ends of the intervals of E exceed E. All metrics of a row
 * use the same factors. `row` holds values and errors of the total. */
void orl_annual_error_factors(const struct orl_annual_light *row, size_t n, float *ret_factors);

struct orl_annual_value {
    double value, low, high; /* 95 %; NaN where errors are not known */
};

void orl_annual_evaluate(const struct orl_annual_metric *metric,
                         const struct orl_annual_period *period, const struct orl_annual_light *row,
                         struct orl_annual_value *ret_value);

/* Returns the metric with all values of the row moved up by z standard errors, as described above.
 * Values are clamped at 0. */
double orl_annual_evaluate_at(const struct orl_annual_metric *metric,
                              const struct orl_annual_period *period,
                              const struct orl_annual_light *row, double z);

/*
 * Returns the smallest z at which the metric is at least `bound`: -INFINITY if it always is,
 * INFINITY if it never is. Without errors the result is one of these two. The metric must grow with
 * E (orl_annual_is_monotonic). scratch: room for n_columns numbers.
 */
double orl_annual_crossing(const struct orl_annual_metric *metric, double bound,
                           const struct orl_annual_period *period,
                           const struct orl_annual_light *row, double *scratch);
bool orl_annual_is_monotonic(
    enum orl_metric_kind kind); /* with E: all but UDI's lower and middle parts */

/* ---- Figures of areas ------------------------------------------------------------------------ */

/* Rows of several sensors as arrays, sensor by sensor. */
struct orl_annual_rows {
    const float *total_lx, *direct_lx, *total_error_lx, *direct_error_lx;
    const float *overcast_lx, *overcast_error_lx, *coherence; /* one per sensor */
    const unsigned char *sunny;                               /* one per column */
    size_t n_sensors, n_columns;
    const double *area; /* area that each sensor represents, in any unit; NULL: equal areas */
    const atomic_bool *cancel;    /* polled at each sensor; NULL: never */
    struct orl_thread_pool *pool; /* threads for shares of the area; NULL: none */
};

enum orl_annual_aggregate {
    ORL_AGGREGATE_SHARE,   /* %: share of the area with at least `least` of the metric */
    ORL_AGGREGATE_AVERAGE, /* mean of the metric over the area */
    ORL_AGGREGATE_LEAST,   /* minimum of the metric: the worst sensor */
    ORL_AGGREGATE_OF_MEAN  /* the metric of the mean illuminance over the area */
};

struct orl_annual_figure {
    enum orl_annual_aggregate aggregate;
    struct orl_annual_metric metric;
    double least; /* for ORL_AGGREGATE_SHARE, in the metric's unit */
};

struct orl_annual_area {
    struct orl_annual_value value;
    size_t open; /* for shares: sensors whose side is not decided at 95 % */
};

/* Evaluates a figure. periods: by enum orl_annual_when. Returns 0, ORL_ERR_INVALID (a share of a
 * metric that does not grow, no sensors, no direct light in the rows), ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_annual_figure_of(const struct orl_annual_figure *figure,
                         const struct orl_annual_period *periods,
                         const struct orl_annual_rows *rows, struct orl_annual_area *ret_result,
                         struct orl_error *err);

/* Returns the average of sensors' values over their areas (NULL: equal areas). */
struct orl_annual_value orl_annual_average(const struct orl_annual_value *values,
                                           const double *area, size_t n);

/* Computes the share of area that passes, in percent, from each part's z of crossing (as above) and
 * area (NULL: equal areas). known: true if errors are known. Polls cancel, which may be NULL.
 * Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_annual_area_share(const double *crossing, const double *area, size_t n, bool known,
                          const atomic_bool *cancel, struct orl_annual_area *ret_result,
                          struct orl_error *err);

/* ---- Verdicts -------------------------------------------------------------------------------- */

enum orl_verdict { ORL_VERDICT_FAIL, ORL_VERDICT_UNDECIDED, ORL_VERDICT_PASS, ORL_VERDICT_UNKNOWN };
const char *orl_verdict_name(enum orl_verdict verdict); /* "fail", "undecided", "pass", "unknown" */

enum orl_relation { ORL_AT_LEAST, ORL_MORE_THAN, ORL_AT_MOST, ORL_LESS_THAN };

enum { ORL_TARGET_TEXT = 96, ORL_TARGET_GRID = 64 };

struct orl_annual_target {
    struct orl_annual_figure figure;
    enum orl_relation relation;
    double bound;
    char grid[ORL_TARGET_GRID]; /* "": all grids together */
    char text[ORL_TARGET_TEXT]; /* the target as the user wrote it */
};

/*
 * Parses a target: FIGURE [in daylight hours | over the year] [of GRID] RELATION NUMBER [UNIT].
 *
 * FIGURE is one of:
 * - "sDA300/50" (short "sDA"; in daylight hours it is EN 17037's), "ASE1000,250" (short "ASE").
 * - "sDF2": share of the area with a daylight factor of 2 % or more. "sDF300lx": with a daylight
 *   factor that gives 300 lx of the median diffuse daylight.
 * - An average over the area: "DA300", "cDA300", "UDI100-3000", "UDI_lower100", "UDI_upper3000",
 *   "UDI_part100-300", "illuminance", "cumulative", "direct_hours1000", "DF". With "least" in
 *   front: the value of the darkest sensor.
 * - "hours300": the hours with 300 lx or more; with "of mean" in front, those of the mean over the
 *   area.
 *
 * RELATION: >= > <= <. UNIT: % lx h; a figure in percent needs no sign unless the number is below
 * 1. Letters may be upper or lower case. Returns 0, or ORL_ERR_SYNTAX with the expected word and
 * its place.
 */
int orl_annual_target_parse(const char *text, struct orl_annual_target *ret_target,
                            struct orl_error *err);

/* Parses a metric alone: "DA300", "UDI100-3000 over the year", "direct_hours1000". Errors are those
 * of orl_annual_target_parse. */
int orl_annual_metric_parse(const char *text, struct orl_annual_metric *ret_metric,
                            struct orl_error *err);

/* Compares a value with a target. A value within rounding of the bound (1e-9 of it) meets it. */
enum orl_verdict orl_annual_judge(const struct orl_annual_target *target,
                                  const struct orl_annual_value *value);
/* Returns true if more accuracy does not help: the target is decided, or the whole interval lies
 * within `tolerance` of the bound. */
bool orl_annual_is_decided(const struct orl_annual_target *target,
                           const struct orl_annual_value *value, double tolerance);

/* Rule of a standard; all of its targets must pass. */
enum { ORL_RULE_TARGETS = 2 };
struct orl_annual_rule {
    const char *name;   /* "LEED v4.1, 2 points" */
    const char *clause; /* clause of the standard, and assumptions */
    const char *targets[ORL_RULE_TARGETS];
    bool needs_blinds; /* LM-83's sDA: blinds close against direct sunlight */
};

/* Finds rules of EN 17037, LEED v4.1, WELL v2 and BREEAM by name ("EN 17037", "LEED", "WELL L01",
 * "WELL L06", "BREEAM offices", ...), in either case. A name selects all rules that begin with it.
 * Sets the first rule and the number of consecutive rules. Returns 0, or ORL_ERR_NOT_FOUND with the
 * known names. */
int orl_annual_rules_find(const char *name, const struct orl_annual_rule **ret_first,
                          size_t *ret_count, struct orl_error *err);

enum orl_verdict orl_verdict_combine(enum orl_verdict a, enum orl_verdict b);

#endif
