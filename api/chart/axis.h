/*
 * A logarithmic axis: maps values above zero to a range on the page. Ticks are at 1, 2 and 5
 * times powers of ten, or only at powers of ten if those are too dense.
 */
#ifndef ORL_API_CHART_AXIS_H
#define ORL_API_CHART_AXIS_H

#include <stddef.h>

enum { ORL_AXIS_TICKS = 64 };

struct orl_axis {
    double low, high; /* values at the ends */
    double from, to;  /* page coordinates of the ends; may run either way */
    double ticks[ORL_AXIS_TICKS];
    size_t n_ticks; /* at least 2 */
};

/*
 * Makes an axis that shows values from low to high, both > 0, with a margin, over at least a
 * factor of 8. spacing: least distance between ticks, in page units.
 */
void orl_axis_init(struct orl_axis *axis, double low, double high, double from, double to,
                   double spacing);

/* Returns the page coordinate of a value; it may lie beyond the ends. */
double orl_axis_at(const struct orl_axis *axis, double value);

/* Writes a tick's label, such as "0.05", "20", "10000" or "1e+05". */
void orl_axis_format(double tick, char *ret_text, size_t size);

#endif
