/*
 * Draws a year as a carpet: days from left to right, hours of the day upwards, a colour for each
 * step. Steps without light from the sky are gray, unmeasured ones white.
 *
 * Values are those of all steps of a year (oriel/annual/annual_metrics.h), hours in local standard
 * time.
 */
#ifndef ORL_CHART_TEMPORAL_MAP_H
#define ORL_CHART_TEMPORAL_MAP_H

#include <oriel/annual/annual_report.h>
#include <oriel/base/canvas.h>

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

#endif
