#include "chart/charts.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/base/vec.h>
#include <oriel/job/picture.h>

enum { DECADES = 4, LEVELS = 64, CIRCLE = 72 };
static const unsigned char ink[3] = {26, 26, 26}, paper[3] = {255, 255, 255},
                           line[3] = {160, 160, 160};
static const double bar = 14, letters = 8;

/* ---- Colours --------------------------------------------------------------------------------- */

/* Returns the colour level of a value: 0 below the scale, else 1 to LEVELS. */
static int level_of(double value, double top)
{
    if (!(value > 0))
        return 0;
    const double share = 1 + log10(value / top) / DECADES;
    return share <= 0 ? 0 : share >= 1 ? LEVELS : (int)ceil(share * LEVELS);
}

/* Returns a level's colour. Differences may be negative: from white to red or to blue. */
static void color_of(int level, bool differences, unsigned char ret_rgb[3])
{
    static const double more[3] = {165, 0, 38}, less[3] = {18, 60, 155};
    const double share = fabs((double)level) / LEVELS;
    if (!differences) {
        orl_palette_color(ORL_PALETTE_EVEN, share, ret_rgb);
        return;
    }
    for (int i = 0; i < 3; i++)
        ret_rgb[i] = (unsigned char)lrint(255 + share * ((level < 0 ? less[i] : more[i]) - 255));
}

static int level_at(const struct orl_polar_map *m, int theta, int phi)
{
    const double value = m->values[theta][phi];
    if (!m->second)
        return level_of(value, m->top);
    const double off = m->second[theta][phi] - value;
    return off < 0 ? -level_of(-off, m->top) : level_of(off, m->top);
}

/* ---- The disc -------------------------------------------------------------------------------- */

static void locate_direction(const struct orl_polar_map *m, double theta_deg, double phi_deg,
                             double *ret_x, double *ret_y)
{
    const double r = m->radius * theta_deg / 90, phi = phi_deg * ORL_DEG_TO_RAD;
    *ret_x = m->x + r * cos(phi);
    *ret_y = m->y - r * sin(phi);
}

static void draw_ring(const struct orl_polar_map *m, double theta_deg, double weight,
                      const unsigned char rgb[3])
{
    double x[CIRCLE + 1], y[CIRCLE + 1];
    for (int i = 0; i <= CIRCLE; i++)
        locate_direction(m, theta_deg, 360.0 * i / CIRCLE, &x[i], &y[i]);
    orl_canvas_path(m->canvas, CIRCLE + 1, x, y, weight, rgb);
}

/* Draws a cell, slightly enlarged so that viewers show no gaps between cells. */
static void draw_cell(const struct orl_polar_map *m, int theta, int phi, int level)
{
    const double dtheta = 90.0 / ORL_POLAR_THETAS, dphi = 360.0 / ORL_POLAR_PHIS;
    const double inner = theta * dtheta, outer = (theta + 1) * dtheta + 0.1;
    const double from = phi * dphi - 0.05, to = (phi + 1) * dphi + 0.05;
    unsigned char rgb[3];
    double x[4], y[4];
    locate_direction(m, inner, from, &x[0], &y[0]);
    locate_direction(m, fmin(90, outer), from, &x[1], &y[1]);
    locate_direction(m, fmin(90, outer), to, &x[2], &y[2]);
    locate_direction(m, inner, to, &x[3], &y[3]);
    color_of(level, m->second != NULL, rgb);
    orl_canvas_fill(m->canvas, 4, x, y, rgb);
}

static void write_at(struct orl_canvas *canvas, double x, double y, enum orl_canvas_align align,
                     const char *text)
{
    struct orl_canvas_text_style as = {.size = letters, .align = align};
    memcpy(as.rgb, ink, 3);
    orl_canvas_text(canvas, x, y, &as, text);
}

void orl_polar_map_draw(const struct orl_polar_map *m)
{
    unsigned char ground[3];
    double x, y;
    color_of(0, m->second != NULL, ground);
    orl_canvas_disc(m->canvas, m->x, m->y, m->radius, ground);
    for (int theta = 0; theta < ORL_POLAR_THETAS; theta++)
        for (int phi = 0; phi < ORL_POLAR_PHIS; phi++) {
            const int level = level_at(m, theta, phi);
            if (level != 0)
                draw_cell(m, theta, phi, level);
        }
    for (int theta = 30; theta <= 90; theta += 30)
        draw_ring(m, theta, theta == 90 ? 1.2 : 0.6, theta == 90 ? ink : line);
    locate_direction(m, m->mark_theta_deg, m->mark_phi_deg, &x, &y);
    struct orl_polar_map mark = *m;
    mark.x = x;
    mark.y = y;
    mark.radius = 5;
    draw_ring(&mark, 90, 2.4, paper);
    draw_ring(&mark, 90, 1, ink);
    write_at(m->canvas, m->x, m->y - m->radius - 3, ORL_CANVAS_MIDDLE, "y");
    write_at(m->canvas, m->x + m->radius + 4, m->y + 3, ORL_CANVAS_LEFT, "x");
}

/* ---- The legend ------------------------------------------------------------------------------ */

void orl_polar_legend_draw(struct orl_canvas *canvas, double x, double y, double height, double top,
                           bool differences)
{
    const int low = differences ? -LEVELS : 0, steps = LEVELS - low;
    for (int i = 0; i < steps; i++) {
        const double y0 = y + height * i / steps, y1 = y + height * (i + 1) / steps + 0.3;
        const double xs[4] = {x, x + bar, x + bar, x}, ys[4] = {y0, y0, y1, y1};
        unsigned char rgb[3];
        color_of(LEVELS - i, differences, rgb);
        orl_canvas_fill(canvas, 4, xs, ys, rgb);
    }
    for (int d = 0; d <= (differences ? 2 : 1) * DECADES; d++) {
        const double at = y + height * d / ((differences ? 2 : 1) * DECADES);
        const int down = d <= DECADES ? d : 2 * DECADES - d;
        char text[32];
        if (differences && d == DECADES)
            snprintf(text, sizeof text, "none");
        else if (differences && d % 2 == 1)
            continue;
        else
            snprintf(text, sizeof text, "%s%.6g",
                     d > DECADES   ? "-"
                     : differences ? "+"
                                   : "",
                     top * pow(10, -down));
        write_at(canvas, x + bar + 4, at + 3, ORL_CANVAS_LEFT, text);
    }
    write_at(canvas, x, y - 8, ORL_CANVAS_LEFT, "1/sr");
}
