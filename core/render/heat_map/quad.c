#include "render/heat_map/quad.h"

#include <math.h>

struct orl_quad orl_quad_of(double x0, double y0, double x1, double y1)
{
    return (struct orl_quad){{x0, x1, x1, x0}, {y0, y0, y1, y1}};
}

/* Returns the distance of a point inside the edge that starts at corner k, times the edge's length;
 * turn: sign of the quad's orientation. */
static double distance_within(const struct orl_quad *q, int k, double turn, double x, double y)
{
    const int n = (k + 1) % 4;
    return turn * ((q->x[n] - q->x[k]) * (y - q->y[k]) - (q->y[n] - q->y[k]) * (x - q->x[k]));
}

static double turn_of(const struct orl_quad *q)
{
    const double cross =
        (q->x[1] - q->x[0]) * (q->y[2] - q->y[0]) - (q->y[1] - q->y[0]) * (q->x[2] - q->x[0]);
    return cross < 0 ? -1 : 1;
}

static void bounds_of(const double v[4], double *ret_low, double *ret_high)
{
    *ret_low = fmin(fmin(v[0], v[1]), fmin(v[2], v[3]));
    *ret_high = fmax(fmax(v[0], v[1]), fmax(v[2], v[3]));
}

/* Clips the line x + y = sum, from (x0, sum - x0) along (1, -1), to the quad. */
static void clip_line(const struct orl_quad *q, double x0, double sum, double *from, double *to)
{
    const double turn = turn_of(q);
    for (int k = 0; k < 4; k++) {
        const double a = distance_within(q, k, turn, x0, sum - x0);
        const double slope = distance_within(q, k, turn, x0 + 1, sum - x0 - 1) - a;
        if (slope > 0)
            *from = fmax(*from, -a / slope);
        else if (slope < 0)
            *to = fmin(*to, -a / slope);
        else if (a < 0)
            *to = -1;
    }
}

void orl_quad_hatch(struct orl_canvas *canvas, const struct orl_quad *q, double apart,
                    const unsigned char rgb[3])
{
    double x0, x1, y0, y1;
    bounds_of(q->x, &x0, &x1);
    bounds_of(q->y, &y0, &y1);
    const long last = lrint(floor((x1 + y1) / apart));
    for (long line = lrint(ceil((x0 + y0) / apart)); line <= last; line++) {
        const double sum = apart * (double)line;
        double from = 0, to = x1 - x0;
        clip_line(q, x0, sum, &from, &to);
        if (from < to)
            orl_canvas_line(canvas, x0 + from, sum - x0 - from, x0 + to, sum - x0 - to, 1, rgb);
    }
}
