/*
 * A chart of glare over skies: daylight glare probability with its 95 % intervals, over the
 * hours of a day, or one sky after the other. The class bounds are lines, with their names
 * beside. Hollow marks are undecided: a bound lies in the interval.
 */
#ifndef ORL_CHART_GLARE_CHART_H
#define ORL_CHART_GLARE_CHART_H

#include <stddef.h>

#include <oriel/base/canvas.h>
#include <oriel/job/glare.h>

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

#endif
