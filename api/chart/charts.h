/*
 * Charts of results, drawn on a canvas (oriel/base/canvas.h): a year's page and temporal maps,
 * scattering of BSDFs, glare over skies, and a study. Each has a source file of its own.
 */
#ifndef ORL_CHART_CHARTS_H
#define ORL_CHART_CHARTS_H

#include <stddef.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/canvas.h>
#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_polar.h>
#include <oriel/job/glare.h>
#include <oriel/job/study.h>

/*
 * A one-page summary of a year: figures and verdicts with intervals, a grid over its plan, the
 * year as a temporal map, and the assumptions. The page has A4 proportions, upright.
 */
struct orl_annual_page {
    const char *title; /* NULL: only the grid's name */
    const struct orl_annual_request *request;
    const struct orl_report_request *report_request;
    const struct orl_annual_result *result;
    const struct orl_annual_report *report;
    const struct orl_annual_plans *plans;
    size_t grid;
    const atomic_bool *cancel; /* NULL: not cancellable */
};

/* Writes the page to a file. Returns 0, ORL_ERR_NOMEM, ORL_ERR_IO or ORL_ERR_CANCELLED. */
int orl_annual_page_write(const struct orl_annual_page *page, enum orl_canvas_kind kind,
                          const char *path, struct orl_error *err);

/*
 * Draws a year as a temporal map: days from left to right, hours of the day upwards, a colour for
 * each step. Steps without light from the sky are gray, unmeasured ones white.
 *
 * Values are those of all steps of a year (oriel/annual/annual_metrics.h), hours in local standard
 * time.
 */

struct orl_temporal_map {
    const char *title, *unit;
    struct orl_annual_steps steps;
    const float *values; /* NaN: not measured; below 0: no light from the sky */
    double top;          /* top of the scale; 0: a round number above 99 % of the lit steps */
    bool logarithmic;    /* true: three decades; false: linear from 0 */
    const unsigned char *marks; /* per step; lines show where they usually begin and end; or NULL */
};

/* Draws onto an open page; x and y are the upper left corner. Returns 0 or ORL_ERR_NOMEM. */
int orl_temporal_map_draw(const struct orl_temporal_map *map, struct orl_canvas *canvas, double x,
                          double y, double width, double height);

/* Writes a page of its own. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_temporal_map_write(const struct orl_temporal_map *map, enum orl_canvas_kind kind,
                           const char *path, struct orl_error *err);

/*
 * A page about the scattering of one or two BSDFs for one incident direction. It has polar maps of
 * reflection and transmission on one logarithmic scale (1/sr), tables of peaks, and the check's
 * findings. Two files are drawn one above the other, followed by a map of second minus first.
 *
 * Maps have theta from the middle outwards, x to the right and y up, in the frame of
 * oriel/bsdf/bsdf_polar.h; a small circle marks the direction of straight transmission or mirror
 * reflection.
 */

struct orl_bsdf_chart_file {
    const char *name;
    const struct orl_bsdf *bsdf;
    const struct orl_bsdf_check *check;
};

struct orl_bsdf_chart {
    struct orl_bsdf_chart_file files[2];
    size_t n_files; /* 1 or 2 */
    bool front;     /* true if light comes from the front, the inside */
    double theta_deg, phi_deg;
    double top; /* top of the scale, 1/sr; 0: automatic */
};

/* Returns the top of the scale that this chart needs (1/sr), for charts with a common scale. */
double orl_bsdf_chart_top(const struct orl_bsdf_chart *chart);

/* Writes the chart to a file. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_bsdf_chart_write(const struct orl_bsdf_chart *chart, enum orl_canvas_kind kind,
                         const char *path, struct orl_error *err);

/*
 * Draws a hemisphere as a coloured disc: theta from the middle outwards, phi from the right
 * counter-clockwise. It shows values on a logarithmic scale of four decades, or a second map
 * minus the first: red is more, blue is less. Also draws the legend of either.
 */

struct orl_polar_map {
    struct orl_canvas *canvas;
    double x, y, radius; /* centre and radius of the disc, in page units */
    double top;          /* top of the scale */
    const double (*values)[ORL_POLAR_PHIS];
    const double (*second)[ORL_POLAR_PHIS]; /* map to compare with; NULL: values are shown */
    double mark_theta_deg, mark_phi_deg;    /* direction of a small circle */
};
void orl_polar_map_draw(const struct orl_polar_map *map);

/* Draws a colour bar from y down, with numbers to its right. */
void orl_polar_legend_draw(struct orl_canvas *canvas, double x, double y, double height, double top,
                           bool differences);

/*
 * A chart of glare over skies: daylight glare probability with its 95 % intervals, over the
 * hours of a day, or one sky after the other. The class bounds are lines, with their names
 * beside. Hollow marks are undecided: a bound lies in the interval.
 */

struct orl_glare_hour {
    char label[32];
    double hour;      /* hour of the day; NaN: unknown */
    double dgp;       /* NaN: unknown, and not drawn */
    double low, high; /* 95 % interval; NaN: unknown */
    enum orl_glare_class class_of;
    bool dark; /* true if the sky gives no light */
};

/* Writes the chart to a file, whole or absent. The x axis is the hour if all hours are known
 * and rise; else skies stand side by side. title: cut short if it does not fit. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_glare_chart_write(const struct orl_glare_hour *hours, size_t count, const char *title,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err);

/* Draws a study's chart: error against time, both logarithmic, with the given points. */

/* Writes the chart to a file, whole or absent. title: NULL for none. Returns 0, ORL_ERR_NOMEM
 * or ORL_ERR_IO. */
int orl_study_chart_write(const struct orl_study *study, const char *title,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err);

#endif
