/*
 * A hemisphere as a disc in colours: theta from the middle outwards, phi from the right
 * counter-clockwise; of values on a logarithmic scale of four decades, or of what a second map has
 * more (red) or less (blue) than a first one. And the legend of either.
 */
#ifndef ORL_CHART_POLAR_MAP_H
#define ORL_CHART_POLAR_MAP_H

#include <oriel/bsdf_polar.h>
#include <oriel/canvas.h>

struct orl_polar_map {
    struct orl_canvas *canvas;
    double x, y, radius; /* of the disc, page units */
    double top;          /* of the scale */
    const double (*values)[ORL_POLAR_PHIS];
    const double (*second)[ORL_POLAR_PHIS]; /* NULL: values themselves are shown */
    double mark_theta_deg, mark_phi_deg;    /* a small circle stands there */
};
void orl_polar_map_draw(const struct orl_polar_map *map);

/* A bar from y down, numbers to its right. */
void orl_polar_legend_draw(struct orl_canvas *canvas, double x, double y, double height, double top,
                           bool differences);

#endif
