#include <oriel/base/canvas.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "base/io/out_file.h"
#include "base/text/stroke_font.h"
#include "render/film/image_files.h"

/* Widths of strokes, as a share of the letters' size. */
static const double usual_weight = 0.13, bold_weight = 0.17;
/* Width of the rim about letters, page units. */
static const double rim = 1.5;

struct orl_canvas {
    double scale;
    struct orl_raster raster; /* its pixels are owned; NULL if the page is no raster */
    char *path;               /* path of a PNG or PDF, owned */
    struct orl_out_file svg;  /* its stream is NULL if the page is no SVG */
    struct orl_pdf *pdf;      /* NULL if the page is no PDF */
};

/* ---- The page -------------------------------------------------------------------------------- */

static int open_svg(struct orl_canvas *canvas, const char *path, double width, double height,
                    struct orl_error *err)
{
    const int code = orl_out_open(&canvas->svg, path, err);
    if (code < 0)
        return code;
    fprintf(canvas->svg.stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" "
            "viewBox=\"0 0 %g %g\" font-family=\"sans-serif\">\n"
            "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            width, height, width, height);
    return 0;
}

static int open_png(struct orl_canvas *canvas, const char *path, double width, double height,
                    struct orl_error *err)
{
    struct orl_raster *raster = &canvas->raster;
    raster->width = (uint32_t)lrint(width * canvas->scale);
    raster->height = (uint32_t)lrint(height * canvas->scale);
    const size_t size = 3 * (size_t)raster->width * raster->height;
    raster->rgb = malloc(size);
    canvas->path = strdup(path);
    if (!raster->rgb || !canvas->path)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing '%s'", path);
    memset(raster->rgb, 0xff, size);
    return 0;
}

static int open_pdf(struct orl_canvas *canvas, const char *path, double width, double height,
                    struct orl_error *err)
{
    canvas->path = strdup(path);
    if (!canvas->path || orl_pdf_new(width, height, canvas->scale, &canvas->pdf) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing '%s'", path);
    return 0;
}

static void free_page(struct orl_canvas *canvas)
{
    orl_pdf_free(canvas->pdf);
    free(canvas->raster.rgb);
    free(canvas->path);
    free(canvas);
}

int orl_canvas_open(enum orl_canvas_kind kind, const char *path, double width, double height,
                    double scale, struct orl_canvas **ret_canvas, struct orl_error *err)
{
    struct orl_canvas *canvas = calloc(1, sizeof *canvas);
    if (!canvas)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing '%s'", path);
    canvas->scale = kind == ORL_CANVAS_SVG ? 1 : scale;
    const int code = kind == ORL_CANVAS_PNG   ? open_png(canvas, path, width, height, err)
                     : kind == ORL_CANVAS_PDF ? open_pdf(canvas, path, width, height, err)
                                              : open_svg(canvas, path, width, height, err);
    if (code < 0)
        free_page(canvas);
    else
        *ret_canvas = canvas;
    return code;
}

int orl_canvas_close(struct orl_canvas *canvas, int code, struct orl_error *err)
{
    if (canvas->svg.stream) {
        if (code == 0)
            fputs("</svg>\n", canvas->svg.stream);
        code = orl_out_close(&canvas->svg, code, err);
    } else if (code == 0 && canvas->pdf) {
        code = orl_pdf_write(canvas->pdf, canvas->path, err);
    } else if (code == 0) {
        code = orl_png_write(canvas->path, canvas->raster.width, canvas->raster.height,
                             canvas->raster.rgb, err);
    }
    free_page(canvas);
    return code;
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

static void print_color(FILE *svg, const char *attribute, const unsigned char rgb[3])
{
    fprintf(svg, " %s=\"#%02x%02x%02x\"", attribute, rgb[0], rgb[1], rgb[2]);
}

static void print_corners(FILE *svg, size_t n, const double x[], const double y[])
{
    fputs("<path d=\"", svg);
    for (size_t i = 0; i < n; i++)
        fprintf(svg, "%c%.2f %.2f", i == 0 ? 'M' : 'L', x[i], y[i]);
}

/* A polygon in pixels. */
struct shape {
    size_t n;
    const double *x, *y;
    double scale, turn; /* turn: sign of the orientation */
};

static double area_of(const struct shape *s)
{
    double twice = 0;
    for (size_t i = 0, k = s->n - 1; i < s->n; k = i++)
        twice += s->x[k] * s->y[i] - s->x[i] * s->y[k];
    return twice;
}

static void bounds_of(const double v[], size_t n, double scale, double *ret_low, double *ret_high)
{
    *ret_low = INFINITY;
    *ret_high = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        *ret_low = fmin(*ret_low, scale * v[i]);
        *ret_high = fmax(*ret_high, scale * v[i]);
    }
}

/* Shortens the range of pixels of a row to those whose centres lie on the inner side of the edge
 * that starts at corner k. A row crosses an edge once at most. */
static void clip_row(const struct shape *s, size_t k, uint32_t row, uint32_t *first, uint32_t *end)
{
    const size_t n = (k + 1) % s->n;
    const double x0 = s->scale * s->x[k], y0 = s->scale * s->y[k];
    const double across = (s->scale * s->x[n] - x0) * (row + 0.5 - y0);
    const double along = s->scale * s->y[n] - y0;
    while (*first < *end && !(s->turn * (across - along * (*first + 0.5 - x0)) >= 0))
        (*first)++;
    while (*first < *end && !(s->turn * (across - along * (*end - 0.5 - x0)) >= 0))
        (*end)--;
}

/* Fills the pixels whose centres the shape contains. */
static void fill_pixels(const struct orl_raster *raster, struct shape *s,
                        const unsigned char rgb[3])
{
    double x0, x1, y0, y1;
    s->turn = area_of(s) < 0 ? -1 : 1;
    bounds_of(s->x, s->n, s->scale, &x0, &x1);
    bounds_of(s->y, s->n, s->scale, &y0, &y1);
    x1 = fmin(x1 + 1, raster->width);
    y1 = fmin(y1 + 1, raster->height);
    for (uint32_t y = (uint32_t)fmax(y0, 0); y < y1; y++) {
        uint32_t first = (uint32_t)fmax(x0, 0), end = (uint32_t)ceil(fmax(x1, 0));
        for (size_t k = 0; k < s->n && first < end; k++)
            clip_row(s, k, y, &first, &end);
        for (uint32_t x = first; x < end; x++)
            memcpy(raster->rgb + 3 * ((size_t)y * raster->width + x), rgb, 3);
    }
}

void orl_canvas_fill(struct orl_canvas *canvas, size_t n, const double x[], const double y[],
                     const unsigned char rgb[3])
{
    FILE *svg = canvas->svg.stream;
    if (canvas->pdf) {
        orl_pdf_fill(canvas->pdf, n, x, y, rgb);
        return;
    }
    if (!svg) {
        struct shape shape = {.n = n, .x = x, .y = y, .scale = canvas->scale};
        fill_pixels(&canvas->raster, &shape, rgb);
        return;
    }
    print_corners(svg, n, x, y);
    fputs("Z\"", svg);
    print_color(svg, "fill", rgb);
    fputs("/>\n", svg);
}

void orl_canvas_disc(struct orl_canvas *canvas, double x, double y, double radius,
                     const unsigned char rgb[3])
{
    orl_canvas_line(canvas, x, y, x, y, 2 * radius, rgb);
}

void orl_canvas_path(struct orl_canvas *canvas, size_t n, const double x[], const double y[],
                     double weight, const unsigned char rgb[3])
{
    FILE *svg = canvas->svg.stream;
    if (svg) {
        print_corners(svg, n, x, y);
        fputs("\" fill=\"none\"", svg);
        print_color(svg, "stroke", rgb);
        fprintf(svg,
                " stroke-width=\"%.2f\" stroke-linecap=\"round\" stroke-linejoin=\"round\"/>\n",
                weight);
        return;
    }
    if (canvas->pdf) {
        orl_pdf_path(canvas->pdf, n, x, y, weight, rgb);
        return;
    }
    const double s = canvas->scale;
    struct orl_pen pen = {.weight = s * weight};
    memcpy(pen.rgb, rgb, 3);
    for (size_t i = 1; i < n; i++)
        orl_raster_line(&canvas->raster, &pen, s * x[i - 1], s * y[i - 1], s * x[i], s * y[i]);
}

void orl_canvas_line(struct orl_canvas *canvas, double x0, double y0, double x1, double y1,
                     double weight, const unsigned char rgb[3])
{
    const double x[2] = {x0, x1}, y[2] = {y0, y1};
    orl_canvas_path(canvas, 2, x, y, weight, rgb);
}

/* ---- Texts ----------------------------------------------------------------------------------- */

/* Prints text for XML. Control characters and the two non-characters of UTF-8's third plane, which
 * XML forbids, become spaces. */
static void print_text(FILE *svg, const char *text)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '<' || c == '>' || c == '&')
            fputs(c == '<' ? "&lt;" : c == '>' ? "&gt;" : "&amp;", svg);
        else if (strncmp(text, "\xef\xbf\xbe", 3) == 0 || strncmp(text, "\xef\xbf\xbf", 3) == 0)
            fputc(' ', svg), text += 2;
        else
            fputc(c < 0x20 || c == 0x7f ? ' ' : c, svg);
    }
}

/* Writes a text stretched to the width of the stroke font's letters, for any font of the reader. */
static void write_text(FILE *svg, double x, double y, double width,
                       const struct orl_canvas_text_style *text_style, const char *text)
{
    static const double capitals = 0.72; /* height of capitals, as a share of a usual font's size */
    fprintf(svg, "<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.2f\" textLength=\"%.2f\"", x, y,
            text_style->size / capitals, width);
    fputs(" lengthAdjust=\"spacingAndGlyphs\"", svg);
    if (text_style->upright)
        fprintf(svg, " transform=\"rotate(-90 %.2f %.2f)\"", x, y);
    if (text_style->bold)
        fputs(" font-weight=\"bold\"", svg);
    if (text_style->rimmed)
        fprintf(svg, " stroke=\"#fff\" stroke-width=\"%.2f\" paint-order=\"stroke\"", 2 * rim);
    print_color(svg, "fill", text_style->rgb);
    fputc('>', svg);
    print_text(svg, text);
    fputs("</text>\n", svg);
}

static void draw_text(const struct orl_canvas *canvas, double x, double y,
                      const struct orl_canvas_text_style *text_style, const char *text)
{
    const double s = canvas->scale, weight = text_style->bold ? bold_weight : usual_weight;
    struct orl_pen pen = {.size = s * text_style->size,
                          .weight = s * (text_style->size * weight + 2 * rim),
                          .turn = text_style->upright ? ORL_PI / 2 : 0,
                          .rgb = {255, 255, 255}};
    if (text_style->rimmed)
        orl_stroke_text_draw(&canvas->raster, &pen, s * x, s * y, text);
    pen.weight = s * text_style->size * weight;
    memcpy(pen.rgb, text_style->rgb, 3);
    orl_stroke_text_draw(&canvas->raster, &pen, s * x, s * y, text);
}

void orl_canvas_text(struct orl_canvas *canvas, double x, double y,
                     const struct orl_canvas_text_style *text_style, const char *text)
{
    const double width = orl_canvas_text_width(text, text_style->size);
    const double left = x - width * 0.5 * (int)text_style->align;
    if (canvas->pdf)
        orl_pdf_text(canvas->pdf, x, y, width, rim, text_style, text);
    else if (canvas->svg.stream)
        write_text(canvas->svg.stream, left, y, width, text_style, text);
    else
        draw_text(canvas, left, y, text_style, text);
}

double orl_canvas_text_width(const char *text, double size)
{
    return orl_stroke_text_width(text, size);
}
