#include "render/film/error_map.h"

#include <cairo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/png.h"

/* The scale: what its ends show. */
static const double least = 1e-3, most = 1;

static double luma_of(const struct orl_film *film, size_t pixel)
{
    const float *rgb = film->pixels[pixel];
    return orl_luma((struct orl_rgb){rgb[0], rgb[1], rgb[2]});
}

double orl_film_mean(const struct orl_film *film)
{
    const size_t n = (size_t)film->width * film->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        sum += luma_of(film, i);
    return sum / (double)n;
}

double orl_film_relative_error(const struct orl_film *film, size_t pixel, double mean)
{
    const double error = film->errors[pixel];
    return error > 0 ? error / fmax(luma_of(film, pixel), 0.1 * mean) : 0;
}

/* ---- Smoothing ------------------------------------------------------------------------------- */

/* Whether two pixels differ by no more than chance would have it. */
static bool alike(const struct orl_film *film, size_t a, size_t b)
{
    const double off = luma_of(film, a) - luma_of(film, b);
    return fabs(off) <= 2 * hypot((double)film->errors[a], (double)film->errors[b]);
}

static float error_about(const struct orl_film *film, uint32_t x, uint32_t y)
{
    const uint32_t x0 = x > 0 ? x - 1 : 0, x1 = x + 1 < film->width ? x + 1 : x;
    const uint32_t y0 = y > 0 ? y - 1 : 0, y1 = y + 1 < film->height ? y + 1 : y;
    const size_t at = (size_t)y * film->width + x;
    double squares = 0, count = 0;
    for (uint32_t v = y0; v <= y1; v++)
        for (uint32_t u = x0; u <= x1; u++) {
            const size_t other = (size_t)v * film->width + u;
            if (!alike(film, at, other))
                continue;
            squares += (double)film->errors[other] * film->errors[other];
            count++;
        }
    return (float)sqrt(squares / count);
}

int orl_film_smooth_errors(struct orl_film *film)
{
    float *smooth = calloc((size_t)film->width * film->height, sizeof *smooth);
    if (!smooth)
        return ORL_ERR_NOMEM;
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            smooth[(size_t)y * film->width + x] = error_about(film, x, y);
    free(film->errors);
    film->errors = smooth;
    return 0;
}

/* ---- HDR ------------------------------------------------------------------------------------- */

int orl_film_write_error_hdr(const struct orl_film *film, const struct orl_view *view,
                             const char *path, struct orl_error *err)
{
    struct orl_film gray;
    int code = orl_film_init(&gray, film->width, film->height, err);
    if (code == 0) {
        for (size_t i = 0; i < (size_t)film->width * film->height; i++)
            for (int c = 0; c < 3; c++)
                gray.pixels[i][c] = film->errors[i];
        code = orl_film_write_hdr(&gray, view, path, err);
    }
    orl_film_done(&gray);
    return code;
}

/* ---- PNG ------------------------------------------------------------------------------------- */

/*
 * CIELAB: lightness from 14 to 91 in even steps, hue from violet by way of teal to yellow so that
 * steps differ alike, chroma as far as sRGB goes but 60 at most.
 */
void orl_error_color(double relative, unsigned char ret_srgb[3])
{
    static const unsigned char points[][3] = {
        {28, 18, 107},  {10, 44, 115},   {12, 65, 114},  {14, 84, 115}, {17, 103, 119},
        {20, 122, 121}, {23, 141, 117},  {28, 161, 106}, {69, 179, 96}, {119, 194, 94},
        {162, 208, 95}, {204, 220, 101}, {245, 232, 112}};
    enum { LAST = sizeof points / sizeof *points - 1 };
    const double share = relative > least ? log(relative / least) / log(most / least) : 0;
    const double at = LAST * fmin(share, 1);
    const int low = at < LAST ? (int)at : LAST - 1;
    for (int c = 0; c < 3; c++)
        ret_srgb[c] = (unsigned char)lrint(points[low][c] +
                                           (at - low) * (points[low + 1][c] - points[low][c]));
}

/* The picture with its legend, in pixels. */
struct layout {
    uint32_t width, height; /* of all */
    double unit;            /* of the legend: a small letter's size grows with the picture */
};
enum { LEGEND_UNITS = 62, LEAST_UNITS = 270, UNITS_ACROSS = 640 };

static struct layout layout_of(const struct orl_film *film)
{
    const uint32_t side = film->width > film->height ? film->width : film->height;
    const double unit = fmax(1, (double)side / UNITS_ACROSS);
    const uint32_t across = (uint32_t)ceil(LEAST_UNITS * unit);
    return (struct layout){film->width > across ? film->width : across,
                           film->height + (uint32_t)ceil(LEGEND_UNITS * unit), unit};
}

/* On white. */
static void draw_pixels(const struct orl_film *film, cairo_surface_t *surface)
{
    const double mean = orl_film_mean(film);
    const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    cairo_surface_flush(surface);
    unsigned char *bytes = cairo_image_surface_get_data(surface);
    memset(bytes, 0xff, stride * (size_t)cairo_image_surface_get_height(surface));
    for (uint32_t y = 0; y < film->height; y++) {
        uint32_t *row = (uint32_t *)(void *)(bytes + y * stride);
        for (uint32_t x = 0; x < film->width; x++) {
            unsigned char c[3];
            orl_error_color(orl_film_relative_error(film, (size_t)y * film->width + x, mean), c);
            row[x] = (uint32_t)c[0] << 16 | (uint32_t)c[1] << 8 | c[2];
        }
    }
    cairo_surface_mark_dirty(surface);
}

/* The legend's scale, in its units: from the left of the picture, and from its own top. */
enum { SCALE_LEFT = 12, SCALE_TOP = 32, SCALE_UNITS = 12 };

static double scale_right(const struct layout *layout)
{
    return fmin(layout->width / layout->unit, 400) - 16;
}

static void draw_colours(const struct orl_film *film, const struct layout *layout,
                         cairo_surface_t *surface)
{
    const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    const size_t first = (size_t)lrint(SCALE_LEFT * layout->unit);
    const size_t last = (size_t)lrint(scale_right(layout) * layout->unit);
    const size_t top = film->height + (size_t)lrint(SCALE_TOP * layout->unit);
    const size_t bottom = film->height + (size_t)lrint((SCALE_TOP + SCALE_UNITS) * layout->unit);
    cairo_surface_flush(surface);
    unsigned char *bytes = cairo_image_surface_get_data(surface);
    for (size_t y = top; y < bottom; y++) {
        uint32_t *row = (uint32_t *)(void *)(bytes + y * stride);
        for (size_t x = first; x < last; x++) {
            unsigned char c[3];
            const double share = ((double)(x - first) + 0.5) / (double)(last - first);
            orl_error_color(least * pow(most / least, share), c);
            row[x] = (uint32_t)c[0] << 16 | (uint32_t)c[1] << 8 | c[2];
        }
    }
    cairo_surface_mark_dirty(surface);
}

/* The k-th of n values from below; they are put in another order (Hoare 1961). */
static double find_kth(double *values, size_t n, size_t k)
{
    size_t first = 0, last = n - 1;
    while (first < last) {
        const double pivot = values[first + (last - first) / 2];
        size_t low = first, high = last;
        for (;; low++, high--) {
            while (values[low] < pivot)
                low++;
            while (values[high] > pivot)
                high--;
            if (low >= high)
                break;
            const double swap = values[low];
            values[low] = values[high];
            values[high] = swap;
        }
        if (k <= high)
            last = high;
        else
            first = high + 1;
    }
    return values[k];
}

/* "median 1.4 %, 95 % of pixels below 6.1 %". Returns 0 or ORL_ERR_NOMEM. */
static int say_how_large(const struct orl_film *film, char *ret_text, size_t size)
{
    const size_t n = (size_t)film->width * film->height;
    const double mean = orl_film_mean(film);
    double *errors = calloc(n + 1, sizeof *errors);
    if (!errors)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++)
        errors[i] = 100 * orl_film_relative_error(film, i, mean);
    const double median = find_kth(errors, n, n / 2), high = find_kth(errors, n, (n - 1) * 19 / 20);
    snprintf(ret_text, size, "median %.2g %%, 95 %% of pixels below %.2g %%", median, high);
    free(errors);
    return 0;
}

static void draw_centered(cairo_t *cairo, const char *text, double x, double y)
{
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text, &extents);
    cairo_move_to(cairo, x - extents.x_advance / 2, y);
    cairo_show_text(cairo, text);
}

/* The ticks below it. */
static void draw_ticks(cairo_t *cairo, double x0, double x1, double y)
{
    static const double ticks[] = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1};
    cairo_set_source_rgb(cairo, 0.1, 0.1, 0.1);
    cairo_set_line_width(cairo, 1);
    for (size_t i = 0; i < sizeof ticks / sizeof *ticks; i++) {
        const double x = x0 + (x1 - x0) * log(ticks[i] / least) / log(most / least);
        char text[16];
        snprintf(text, sizeof text, "%g", 100 * ticks[i]);
        cairo_move_to(cairo, x, y);
        cairo_line_to(cairo, x, y + 3);
        cairo_stroke(cairo);
        draw_centered(cairo, text, x, y + 13);
    }
}

static int draw_legend(const struct orl_film *film, const struct layout *layout, cairo_t *cairo)
{
    char text[96];
    const int code = say_how_large(film, text, sizeof text);
    cairo_save(cairo);
    cairo_translate(cairo, 0, film->height);
    cairo_scale(cairo, layout->unit, layout->unit);
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, 10);
    cairo_set_source_rgb(cairo, 0.1, 0.1, 0.1);
    cairo_move_to(cairo, 12, 13);
    cairo_show_text(cairo, "Standard error, % of the pixel's luminance:");
    cairo_move_to(cairo, 12, 26);
    cairo_show_text(cairo, text);
    draw_ticks(cairo, SCALE_LEFT, scale_right(layout), SCALE_TOP + SCALE_UNITS);
    cairo_restore(cairo);
    return code;
}

/* All of it, once. Returns 0 or ORL_ERR_NOMEM. */
static int draw_once(const struct orl_film *film, const struct layout *layout,
                     cairo_surface_t **ret_surface)
{
    cairo_surface_t *surface =
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)layout->width, (int)layout->height);
    cairo_t *cairo = cairo_create(surface);
    int code = cairo_status(cairo) == CAIRO_STATUS_SUCCESS ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        draw_pixels(film, surface);
        draw_colours(film, layout, surface);
        code = draw_legend(film, layout, cairo);
    }
    if (code == 0 && cairo_status(cairo) != CAIRO_STATUS_SUCCESS)
        code = ORL_ERR_NOMEM;
    cairo_destroy(cairo);
    if (code < 0)
        cairo_surface_destroy(surface);
    else
        *ret_surface = surface;
    return code;
}

/* The two of a picture, byte by byte. */
static bool are_same(cairo_surface_t *a, cairo_surface_t *b)
{
    const size_t stride = (size_t)cairo_image_surface_get_stride(a);
    const size_t height = (size_t)cairo_image_surface_get_height(a);
    cairo_surface_flush(a);
    cairo_surface_flush(b);
    return memcmp(cairo_image_surface_get_data(a), cairo_image_surface_get_data(b),
                  stride * height) == 0;
}

/*
 * What pixman has no memory for (letters above all) is left out of the picture, and nobody is told:
 * so it is drawn twice, and is whole when the two are the same.
 */
static int draw(const struct orl_film *film, cairo_surface_t **ret_surface, struct orl_error *err)
{
    const struct layout layout = layout_of(film);
    cairo_surface_t *surface = NULL, *again = NULL;
    int code = draw_once(film, &layout, &surface);
    if (code == 0)
        code = draw_once(film, &layout, &again);
    if (code == 0 && !are_same(surface, again))
        code = ORL_ERR_NOMEM;
    cairo_surface_destroy(again);
    if (code < 0) {
        cairo_surface_destroy(surface);
        return orl_error_set(err, code, "out of memory drawing an error map");
    }
    *ret_surface = surface;
    return 0;
}

/* Cairo's 32-bit pixels as three bytes each; owned, NULL when out of memory. */
static unsigned char *rgb_of(cairo_surface_t *surface, uint32_t width, uint32_t height)
{
    unsigned char *rgb = malloc(3 * (size_t)width * height);
    cairo_surface_flush(surface);
    const unsigned char *bytes = cairo_image_surface_get_data(surface);
    const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    for (uint32_t y = 0; rgb && y < height; y++) {
        const uint32_t *row = (const uint32_t *)(const void *)(bytes + y * stride);
        unsigned char *out = rgb + 3 * (size_t)y * width;
        for (uint32_t x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                *out++ = (unsigned char)(row[x] >> (16 - 8 * c));
    }
    return rgb;
}

int orl_film_write_error_png(const struct orl_film *film, const char *path, struct orl_error *err)
{
    cairo_surface_t *surface = NULL;
    int code = draw(film, &surface, err);
    if (code < 0)
        return code;
    const uint32_t width = (uint32_t)cairo_image_surface_get_width(surface);
    const uint32_t height = (uint32_t)cairo_image_surface_get_height(surface);
    unsigned char *rgb = rgb_of(surface, width, height);
    cairo_surface_destroy(surface);
    code = rgb ? orl_png_write(path, width, height, rgb, err)
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing an error map");
    free(rgb);
    return code;
}
