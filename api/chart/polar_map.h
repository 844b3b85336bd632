/*
 * Draws a hemisphere as a coloured disc: theta from the middle outwards, phi from the right
 * counter-clockwise. It shows values on a logarithmic scale of four decades, or a second map
 * minus the first: red is more, blue is less. Also draws the legend of either.
 */
#ifndef ORL_CHART_POLAR_MAP_H
#define ORL_CHART_POLAR_MAP_H

#include <oriel/base/canvas.h>
#include <oriel/bsdf/bsdf_polar.h>

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

#endif
