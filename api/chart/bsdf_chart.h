/*
 * Where BSDFs send the light that comes from one direction, as a page: polar maps of what is
 * reflected and transmitted, in one scale (1/sr, logarithmic), tables of peaks, and what the check
 * finds. Of two files both, one above the other, and what the second has more or less than the
 * first.
 *
 * Maps have theta from the middle outwards, x to the right and y up, in the frame of
 * oriel/bsdf_polar.h; a small circle is where light would go straight on, or mirrored.
 */
#ifndef ORL_CHART_BSDF_CHART_H
#define ORL_CHART_BSDF_CHART_H

#include <oriel/bsdf.h>
#include <oriel/canvas.h>

struct orl_bsdf_chart_file {
    const char *name;
    const struct orl_bsdf *bsdf;
    const struct orl_bsdf_check *check;
};

struct orl_bsdf_chart {
    struct orl_bsdf_chart_file files[2];
    size_t n_files; /* 1 or 2 */
    bool front;     /* light comes from there, the inside */
    double theta_deg, phi_deg;
    double top; /* of the scale, 1/sr; 0: found. */
};

/* The largest value that the scale of a chart from there needs. */
double orl_bsdf_chart_top(const struct orl_bsdf_chart *chart);

/* Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_bsdf_chart_write(const struct orl_bsdf_chart *chart, enum orl_canvas_kind kind,
                         const char *path, struct orl_error *err);

#endif
