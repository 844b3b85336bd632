/*
 * A page about the scattering of one or two BSDFs for one incident direction. It has polar maps of
 * reflection and transmission on one logarithmic scale (1/sr), tables of peaks, and the check's
 * findings. Two files are drawn one above the other, followed by a map of second minus first.
 *
 * Maps have theta from the middle outwards, x to the right and y up, in the frame of
 * oriel/bsdf/bsdf_polar.h; a small circle marks the direction of straight transmission or mirror
 * reflection.
 */
#ifndef ORL_CHART_BSDF_CHART_H
#define ORL_CHART_BSDF_CHART_H

#include <oriel/base/canvas.h>
#include <oriel/bsdf/bsdf.h>

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

#endif
