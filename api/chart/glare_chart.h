/*
 * How glare goes from sky to sky: daylight glare probability with its 95 % intervals, over the
 * hours of a day, or one sky after the other. The classes' bounds are lines, their names stand
 * beside; hollow marks are undecided: their interval holds a bound.
 */
#ifndef ORL_CHART_GLARE_CHART_H
#define ORL_CHART_GLARE_CHART_H

#include <stddef.h>

#include <oriel/canvas.h>
#include <oriel/glare.h>

struct orl_glare_hour {
    char label[32];
    double hour;      /* of the day; NaN: none is known */
    double dgp;       /* NaN: not known, and nothing is shown */
    double low, high; /* its interval; NaN: not known */
    enum orl_glare_class class_of;
    bool dark; /* the sky gives no light */
};

/* Into a file, whole or absent. Over hours where all are known and rise; else side by side. title:
 * cut short where it does not fit. Returns 0, ORL_ERR_NOMEM or ORL_ERR_IO. */
int orl_glare_chart_write(const struct orl_glare_hour *hours, size_t count, const char *title,
                          enum orl_canvas_kind kind, const char *path, struct orl_error *err);

#endif
