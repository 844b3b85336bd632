/*
 * What is made of a year of illuminances: metrics of sensors, figures of areas, and verdicts.
 *
 * Time. A year is steps of equal length from 1 January 0:00, local standard time (no daylight
 * saving): 8760 hours, or 8784 with 29 February, or so many times a whole number of steps an hour.
 * Step i lasts from i to i + 1; it is asked for at its middle, as EPW's hour 1 (0:00 to 1:00) is at
 * 0:30. Arrays have columns for some steps only, those with the sun up; at all others it is dark,
 * and they count as 0 lx: no tool that leaves them out of UDI's lower part adds up to 100 %.
 *
 * Errors. An hour's value has a standard error, by 16 batches: intervals are Student's of 15
 * degrees, t = 2.13. Errors of one sensor are correlated over hours, as its paths are the same
 * ones: a sensor's metric has the interval of the metric at E exp(-t k se / E) to E exp(t k se / E)
 * of all hours together. k is 1 in hours without sun, whose errors have one common factor. In hours
 * with sun it is the sensor's coherence (oriel/annual.h), since the sun's places share less; where
 * that is not known it is 1, and intervals are too wide. (By factors, since values that come out
 * low have errors that are too small; se is never above E, both being of means that are not
 * negative. What is 0 stays so. UDI's useful part gains at one bound what it loses at the other:
 * what the two would move it by is added in squares.) Sensors have paths of their own: their errors
 * are independent. Each sensor has a t at which it would
 * change sides, which gives its probability to pass; the number of sensors that pass follows the
 * convolution of these probabilities (the Poisson-binomial distribution). That takes a sensor's
 * truth to lie anywhere around its value alike. Where many lie on one side of the bound, close to
 * it, that is not so: the lower end is found as if all sensors were 0.35 standard errors behind,
 * the upper end as if they were as far ahead. Where a large part of an area lies within a standard
 * error of the bound, all on one side, an interval can still be too narrow. Without standard errors
 * intervals are NaN, and verdicts are unknown.
 *
 * Definitions, with what other tools do otherwise:
 *
 * DA      daylight autonomy: share of the hours with E >= low (Reinhart, Mardaljevic, Rogers 2006,
 *         Leukos 3, 7). Some papers say >; E met exactly counts here, as in LM-83 and Honeybee.
 * cDA     continuous: an hour with E < low counts E / low (Rogers 2006).
 * UDI     useful daylight illuminance (Nabil and Mardaljevic 2005, Lighting Res. Technol. 37, 41;
 *         bounds of 100 and 3000 lx: Mardaljevic et al. 2012): lower E < low, useful low <= E <=
 *         high, upper E > high; useful is split at 300 lx: supplementary low <= E < split,
 *         autonomous split <= E <= high. The paper of 2005 has 100 and 2000. Lower, useful and
 *         upper add up to 100 %, dark hours being lower, as Honeybee has it too.
 * sDA     spatial DA: share of the area with DA(low) >= a share of the hours; sDA300/50 (IES
 *         LM-83-12: 8 to 18, every day, 3650 h; blinds move there, by 2.2.6, and do here where
 *         the year's shades are controlled so: oriel/annual_shades.h).
 * ASE     annual sunlight exposure: share of the area with direct sunlight (oriel/annual.h defines
 *         it) of more than 1000 lx in 250 h or more of the same hours, blinds open: ASE1000,250
 *         (IES LM-83-12). Strictly more than 1000, at least 250. ClimateStudio and Honeybee have
 *         the same; some tools take suns from sky patches and are off by as much as
 *         60 points.
 * EN      EN 17037:2018, 5.1 and A.2 by climate data: daylight provision. The 4380 hours of
 *         the year with the most daylight (global horizontal; half the steps of a leap year); in
 *         half of them 300, 500 or 750 lx on 50 % of the area and 100, 300 or 500 lx on 95 %:
 *         minimum, medium, high. Roof lights: the target on 95 %. As Honeybee has it.
 * DF      daylight factor: illuminance over that of an unobstructed level plane under the CIE's
 *         overcast sky of 10 000 lx (CIE S 011/E:2003, type 16), shades open, ground included; its
 *         mean over an area, its least (EN 12464), or the share with so much. By EN 17037, annex
 *         A.2, method 1: the DF that gives 300 lx (500, 750; at the least 100, 300, 500) of the
 *         median diffuse illuminance outside, on 50 % of the area (95 %). That median is the
 *         weather's over EN's 4380 hours here; the standard's table A.3 has capitals' of its own,
 *         which can be given.
 * LEED    v4.1, EQ Daylight, option 1: sDA300/50 of 40, 55 or 75 % for 1, 2 or 3 points. A room
 * with ASE above 10 % has to tell how glare is met; in v4 such a room did not count. WELL    v2:
 * L01 sDA150/50 >= 30 %, or 200 lx in half of the daylight hours on 30 %; L06 sDA300/50
 *         >= 55 (tier 1) or 75 % (tier 2), or EN 17037's minimum (tier 1: the target alone).
 * BREEAM  Hea 01, illuminance averages: the mean over a room, and its darkest point, reach so many
 * lux in so many hours of the year, of all 8760. mean illuminance, cumulative illuminance (lx h),
 * hours at or above, hours of direct sunlight above a threshold (0 lx: any of it arrives; EN
 * 17037's exposure to sunlight and its view out are other matters: oriel/sun_exposure.h,
 * view_out.h).
 *
 * Units: lux, hours, percent. Threads: any; arguments are borrowed and read. Errors: those of
 * error.h. What is not finite in the arrays is the caller's fault.
 */
#ifndef ORIEL_ANNUAL_METRICS_H
#define ORIEL_ANNUAL_METRICS_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_ANNUAL_DEGREES = 15 }; /* of freedom, that standard errors have; odd */

/* ---- Which steps count ----------------------------------------------------------------------- */

struct orl_annual_steps {
    uint32_t count;    /* of the year */
    uint32_t per_hour; /* 1, or more */
};
/* 8760 or 8784 hours of them? ORL_ERR_RANGE. */
int orl_annual_steps_check(const struct orl_annual_steps *steps, struct orl_error *err);

/* When a room is in use. */
struct orl_occupancy {
    double from_h, to_h; /* of a day, from <= middle of the step < to; over midnight if to < from */
    unsigned days;       /* bit 0 Monday ... bit 6 Sunday */
    unsigned first_day;  /* what day 1 January is: 0 Monday ... 6 Sunday, or the next */
    uint32_t begins_day; /* days from there on are of the year before; 0: none are */
};
/* The weather file says what day 1 January is (EPW: DATA PERIODS); where it does not, a Monday. */
enum { ORL_FIRST_DAY_OF_WEATHER = 7 };
void orl_occupancy_init(struct orl_occupancy *occupancy); /* 8 to 18, every day; by the weather */
/* Marks of all steps: 1 in use, 0 not. first_day of the weather counts as Monday. */
void orl_occupancy_mark(const struct orl_occupancy *occupancy, const struct orl_annual_steps *steps,
                        unsigned char *ret_marks);
/*
 * The same of a file: a line a step with one number, above 0 where the room is in use; or, as
 * DAYSIM writes them, "month,day,hour,value", where the hour is the middle of the step. Lines that
 * begin with '#' and empty ones are passed over, as is a first line of words, and UTF-8's mark.
 * ORL_ERR_SYNTAX (also: lines of both kinds), ORL_ERR_RANGE (too few or many lines, times out of
 * order) with the line.
 */
int orl_occupancy_read(const char *name, const char *text, size_t size,
                       const struct orl_annual_steps *steps, unsigned char *ret_marks,
                       struct orl_error *err);

/* EN 17037's daylight hours: the half of the steps that were measured (NULL: all were) with the
 * most global horizontal daylight, of equal ones the earlier. ORL_ERR_NOMEM. */
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
    double hours; /* of all steps that count, those without a column included */
};
/* marks: of all steps; NULL: all count. step_of[n]: the step of each column, ascending.
 * ORL_ERR_NOMEM.
 */
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
    ORL_METRIC_DF,           /* %, of no hour; shares: low > 0 is what the DF is to give */
    ORL_METRIC_KINDS
};

struct orl_annual_metric {
    enum orl_metric_kind kind;
    enum orl_annual_when when;
    double low_lx, high_lx; /* as far as the kind has them */
};

/* "%", "lx", "lx h" or "h". */
const char *orl_annual_unit(enum orl_metric_kind kind);
/* "DA300", "UDI100-3000", "hours of direct light above 1000 lx", ... */
void orl_annual_metric_name(const struct orl_annual_metric *metric, char *ret_text, size_t size);

/* One sensor's columns, or a mean of several. */
struct orl_annual_light {
    const float *total_lx, *direct_lx;             /* direct: of kinds that ask for it */
    const float *total_error_lx, *direct_error_lx; /* standard errors; NULL: not known */
    const float *overcast_lx, *overcast_error_lx;  /* one number each, of kinds that ask for it */
    const float *coherence;     /* one number: of errors of total_lx in hours with sun; NULL: 1 */
    const unsigned char *sunny; /* of each column: it is an hour with sun; NULL: none is */
    const float *total_factor;  /* as orl_annual_factors leaves them, to save time; or NULL */
};
/* Fills the factors by which the upper ends of the intervals of E exceed E. All metrics of a row
 * use the same factors. row holds values and errors of the total. */
void orl_annual_factors(const struct orl_annual_light *row, size_t n, float *ret_factors);

struct orl_annual_value {
    double value, low, high; /* 95 %; NaN where errors are not known */
};

void orl_annual_evaluate(const struct orl_annual_metric *metric,
                         const struct orl_annual_period *period, const struct orl_annual_light *row,
                         struct orl_annual_value *ret_value);

/* The metric alone, all of the row's values being z standard errors higher, as above; none is below
 * 0. */
double orl_annual_at(const struct orl_annual_metric *metric, const struct orl_annual_period *period,
                     const struct orl_annual_light *row, double z);

/*
 * The least z at which the metric, which must be one that grows with E, is at least bound:
 * -INFINITY where it always is, INFINITY where it never is. Without errors one of these two.
 * scratch: room for n_columns numbers.
 */
double orl_annual_crossing(const struct orl_annual_metric *metric, double bound,
                           const struct orl_annual_period *period,
                           const struct orl_annual_light *row, double *scratch);
bool orl_annual_grows(enum orl_metric_kind kind); /* with E: all but UDI's lower and middle parts */

/* ---- Figures of areas ------------------------------------------------------------------------ */

/* Series of sensors as arrays, sensor by sensor. */
struct orl_annual_rows {
    const float *total_lx, *direct_lx, *total_error_lx, *direct_error_lx; /* as of one row */
    const float *overcast_lx, *overcast_error_lx, *coherence;             /* of each sensor */
    const unsigned char *sunny;                                           /* of each column */
    size_t n_sensors, n_columns;
    const double *area;        /* what each sensor stands for, in any unit; NULL: all the same */
    const atomic_bool *cancel; /* polled at each sensor; NULL: never */
    struct orl_crew *crew;     /* of threads for shares of the area; NULL: none */
};

enum orl_annual_over {
    ORL_OVER_SHARE,   /* %, of the area with at least `least` of the metric */
    ORL_OVER_AVERAGE, /* of the metric over the area */
    ORL_OVER_LEAST,   /* of the metric: the worst sensor */
    ORL_OVER_OF_MEAN  /* the metric of the mean illuminance over the area */
};

struct orl_annual_figure {
    enum orl_annual_over over;
    struct orl_annual_metric metric;
    double least; /* of shares, in the metric's unit */
};

struct orl_annual_area {
    struct orl_annual_value value;
    size_t open; /* of shares: sensors whose side is open, at 95 % */
};

/* periods: by enum orl_annual_when. ORL_ERR_INVALID (a share of what does not grow, no sensors, no
 * direct light in the rows), ORL_ERR_NOMEM, ORL_ERR_CANCELLED. */
int orl_annual_figure_of(const struct orl_annual_figure *figure,
                         const struct orl_annual_period *periods,
                         const struct orl_annual_rows *rows, struct orl_annual_area *ret_result,
                         struct orl_error *err);

/* Of values of sensors, the average over their areas (NULL: all the same). */
struct orl_annual_value orl_annual_average(const struct orl_annual_value *values,
                                           const double *area, size_t n);

/* The share of area that passes, in percent, by each part's z of crossing (as above) and area
 * (NULL: all the same). known: whether errors are. Polls cancel, or NULL. ORL_ERR_NOMEM,
 * ORL_ERR_CANCELLED. */
int orl_annual_share(const double *crossing, const double *area, size_t n, bool known,
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
    char text[ORL_TARGET_TEXT]; /* as it was said */
};

/*
 * A target in words: FIGURE [in daylight hours | over the year] [of GRID] RELATION NUMBER [UNIT].
 *
 * FIGURE: "sDA300/50" ("sDA" is that one; in daylight hours it is EN 17037's), "ASE1000,250"
 * ("ASE"), "sDF2" (of the daylight factor: 2 % or more; "sDF300lx": what gives 300 lx of the median
 * diffuse daylight), or an average over the area: "DA300", "cDA300", "UDI100-3000", "UDI_lower100",
 * "UDI_upper3000", "UDI_part100-300", "illuminance", "cumulative", "direct_hours1000", "DF"; with
 * "least" in front that of the darkest sensor; "hours300" the hours with 300 lx or more, with "of
 * mean" in front those of the mean over the area. RELATION: >= > <= <. UNIT: % lx h; a figure in
 * percent needs no sign unless the number is below
 * 1. Letters may be of either case. ORL_ERR_SYNTAX with what was wanted, and where.
 */
int orl_annual_target_parse(const char *text, struct orl_annual_target *ret_target,
                            struct orl_error *err);

/* A metric by itself: "DA300", "UDI100-3000 over the year", "direct_hours1000". The same errors. */
int orl_annual_metric_parse(const char *text, struct orl_annual_metric *ret_metric,
                            struct orl_error *err);

/* Figures that meet a bound but for rounding (1e-9 of it) meet it. */
enum orl_verdict orl_annual_judge(const struct orl_annual_target *target,
                                  const struct orl_annual_value *value);
/* Is more accuracy of no use: decided, or the whole interval within `near` of the bound? */
bool orl_annual_settled(const struct orl_annual_target *target,
                        const struct orl_annual_value *value, double near);

/* All of them must pass. */
enum { ORL_RULE_TARGETS = 2 };
struct orl_annual_rule {
    const char *name;   /* "LEED v4.1, 2 points" */
    const char *clause; /* where it is written, and what is assumed */
    const char *targets[ORL_RULE_TARGETS];
    bool needs_blinds; /* LM-83's sDA: blinds close against direct sunlight */
};

/* Rules of EN 17037, LEED v4.1, WELL v2 and BREEAM by name ("EN 17037", "LEED", "WELL L01", "WELL
 * L06", "BREEAM offices", ...), in either case; a name is also that of all rules it begins. Sets
 * the first and how many follow each other. ORL_ERR_NOT_FOUND, with the names there are. */
int orl_annual_rules_find(const char *name, const struct orl_annual_rule **ret_first,
                          size_t *ret_count, struct orl_error *err);

enum orl_verdict orl_verdict_both(enum orl_verdict a, enum orl_verdict b);

#endif
