#include "render/heat_map/canvas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/error.h>

int orl_canvas_init(struct orl_canvas *canvas, uint32_t width, uint32_t height, FILE *svg)
{
    *canvas = (struct orl_canvas){.raster = {NULL, width, height}, .svg = svg};
    if (svg) {
        fprintf(svg,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%u\" "
                "viewBox=\"0 0 %u %u\" font-family=\"sans-serif\">\n"
                "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
                width, height, width, height);
        return 0;
    }
    canvas->raster.rgb = malloc(3 * (size_t)width * height);
    if (!canvas->raster.rgb)
        return ORL_ERR_NOMEM;
    memset(canvas->raster.rgb, 0xff, 3 * (size_t)width * height);
    return 0;
}

void orl_canvas_end(struct orl_canvas *canvas)
{
    if (canvas->svg)
        fputs("</svg>\n", canvas->svg);
}

void orl_canvas_done(struct orl_canvas *canvas)
{
    free(canvas->raster.rgb);
    canvas->raster.rgb = NULL;
}

struct orl_quad orl_quad_of(double x0, double y0, double x1, double y1)
{
    return (struct orl_quad){{x0, x1, x1, x0}, {y0, y0, y1, y1}};
}

/* ---- Quads ----------------------------------------------------------------------------------- */

/* How far a point lies within the edge that starts at corner k, of a quad that turns that way. */
static double within(const struct orl_quad *q, int k, double turn, double x, double y)
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

/* Pixels whose middle it holds; of two quads that meet along an edge one has those on it. */
static void fill_pixels(const struct orl_raster *raster, const struct orl_quad *q,
                        const unsigned char rgb[3])
{
    const double turn = turn_of(q);
    double x0, x1, y0, y1;
    bounds_of(q->x, &x0, &x1);
    bounds_of(q->y, &y0, &y1);
    x1 = fmin(x1 + 1, raster->width);
    y1 = fmin(y1 + 1, raster->height);
    for (uint32_t y = (uint32_t)fmax(y0, 0); y < y1; y++)
        for (uint32_t x = (uint32_t)fmax(x0, 0); x < x1; x++) {
            bool in = true;
            for (int k = 0; k < 4 && in; k++)
                in = within(q, k, turn, x + 0.5, y + 0.5) >= 0;
            if (in)
                memcpy(raster->rgb + 3 * ((size_t)y * raster->width + x), rgb, 3);
        }
}

void orl_canvas_fill(struct orl_canvas *canvas, const struct orl_quad *q,
                     const unsigned char rgb[3])
{
    if (!canvas->svg) {
        fill_pixels(&canvas->raster, q, rgb);
        return;
    }
    fprintf(canvas->svg,
            "<path d=\"M%.2f %.2fL%.2f %.2fL%.2f %.2fL%.2f %.2fZ\" fill=\"#%02x%02x%02x\"/>\n",
            q->x[0], q->y[0], q->x[1], q->y[1], q->x[2], q->y[2], q->x[3], q->y[3], rgb[0], rgb[1],
            rgb[2]);
}

void orl_canvas_line(struct orl_canvas *canvas, double x0, double y0, double x1, double y1,
                     double weight, const unsigned char rgb[3])
{
    if (canvas->svg) {
        fprintf(canvas->svg,
                "<path d=\"M%.2f %.2fL%.2f %.2f\" stroke=\"#%02x%02x%02x\" stroke-width=\"%.2f\" "
                "stroke-linecap=\"round\"/>\n",
                x0, y0, x1, y1, rgb[0], rgb[1], rgb[2], weight);
        return;
    }
    struct orl_pen pen = {.weight = weight};
    memcpy(pen.rgb, rgb, 3);
    orl_raster_line(&canvas->raster, &pen, x0, y0, x1, y1);
}

void orl_canvas_hatch(struct orl_canvas *canvas, const struct orl_quad *q, double apart,
                      const unsigned char rgb[3])
{
    const double turn = turn_of(q);
    double x0, x1, y0, y1;
    bounds_of(q->x, &x0, &x1);
    bounds_of(q->y, &y0, &y1);
    /* Lines x + y = sum, from (x0, sum - x0) along (1, -1), as far as they are within all edges. */
    const long last = lrint(floor((x1 + y1) / apart));
    for (long line = lrint(ceil((x0 + y0) / apart)); line <= last; line++) {
        const double sum = apart * (double)line;
        double from = 0, to = x1 - x0;
        for (int k = 0; k < 4; k++) {
            const double a = within(q, k, turn, x0, sum - x0);
            const double slope = within(q, k, turn, x0 + 1, sum - x0 - 1) - a;
            if (slope > 0)
                from = fmax(from, -a / slope);
            else if (slope < 0)
                to = fmin(to, -a / slope);
            else if (a < 0)
                to = -1;
        }
        if (from < to)
            orl_canvas_line(canvas, x0 + from, sum - x0 - from, x0 + to, sum - x0 - to, 1, rgb);
    }
}

/* ---- Texts ----------------------------------------------------------------------------------- */

static void write_text(FILE *svg, const char *text)
{
    for (; *text; text++)
        switch (*text) {
        case '<':
            fputs("&lt;", svg);
            break;
        case '&':
            fputs("&amp;", svg);
            break;
        default:
            fputc(*text, svg);
            break;
        }
}

void orl_canvas_text(struct orl_canvas *canvas, double x, double y, double size,
                     enum orl_canvas_align align, const unsigned char rgb[3], const char *text)
{
    static const char *const anchors[] = {"start", "middle", "end"};
    static const double capitals = 0.72; /* of a usual font's size */
    if (canvas->svg) {
        fprintf(canvas->svg,
                "<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.2f\" text-anchor=\"%s\" "
                "fill=\"#%02x%02x%02x\">",
                x, y, size / capitals, anchors[align], rgb[0], rgb[1], rgb[2]);
        write_text(canvas->svg, text);
        fputs("</text>\n", canvas->svg);
        return;
    }
    struct orl_pen pen = {.size = size};
    memcpy(pen.rgb, rgb, 3);
    const double width = orl_letters_width(text, size);
    orl_letters_draw(&canvas->raster, &pen, x - width * 0.5 * (int)align, y, text);
}
