/* A study's chart into a file, as SVG or PNG. */
#include "study/plot.h"

#include <cairo/cairo-svg.h>
#include <errno.h>
#include <stdlib.h>

#include "base/file.h"
#include "render/film/png.h"

static const double png_scale = 2;

/* Called by cairo with bytes of the file. */
static cairo_status_t take_bytes(void *stream, const unsigned char *bytes, unsigned int size)
{
    return fwrite(bytes, 1, size, stream) == size ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static int check(cairo_status_t status, const char *path, struct orl_error *err)
{
    if (status == CAIRO_STATUS_SUCCESS)
        return 0;
    return orl_error_set(err,
                         status == CAIRO_STATUS_NO_MEMORY ? ORL_ERR_NOMEM : orl_err_of_errno(errno),
                         "cannot draw '%s': %s", path, cairo_status_to_string(status));
}

/* Draws onto the surface at a scale, and finishes it. */
static int draw(cairo_surface_t *surface, double scale, const struct orl_chart *chart,
                const struct orl_study *study, const char *path, struct orl_error *err)
{
    cairo_t *cairo = cairo_create(surface);
    cairo_scale(cairo, scale, scale);
    int code = orl_chart_draw(chart, study, cairo, err);
    if (code == 0)
        code = check(cairo_status(cairo), path, err);
    cairo_destroy(cairo);
    return code;
}

int orl_study_write_svg(const struct orl_study *study, const char *title, const char *path,
                        struct orl_error *err)
{
    struct orl_chart chart;
    struct orl_out_file file = {.stream = NULL};
    int code = orl_chart_make(study, title, &chart, err);
    if (code < 0)
        return code;
    code = orl_out_open(&file, path, err);
    if (code == 0) {
        cairo_surface_t *surface =
            cairo_svg_surface_create_for_stream(take_bytes, file.stream, chart.width, chart.height);
        code = draw(surface, 1, &chart, study, path, err);
        cairo_surface_finish(surface);
        if (code == 0)
            code = check(cairo_surface_status(surface), path, err);
        cairo_surface_destroy(surface);
        code = orl_out_close(&file, code, err);
    }
    orl_chart_done(&chart);
    return code;
}

/* Cairo's 32-bit pixels as three bytes each; owned, NULL when out of memory. */
static unsigned char *rgb_of(cairo_surface_t *surface, uint32_t width, uint32_t height)
{
    cairo_surface_flush(surface);
    const unsigned char *bytes = cairo_image_surface_get_data(surface);
    const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    unsigned char *rgb = bytes ? malloc(3 * (size_t)width * height) : NULL;
    for (uint32_t y = 0; rgb && y < height; y++) {
        const uint32_t *row = (const uint32_t *)(const void *)(bytes + y * stride);
        unsigned char *out = rgb + 3 * (size_t)y * width;
        for (uint32_t x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                *out++ = (unsigned char)(row[x] >> (16 - 8 * c));
    }
    return rgb;
}

int orl_study_write_png(const struct orl_study *study, const char *title, const char *path,
                        struct orl_error *err)
{
    struct orl_chart chart;
    int code = orl_chart_make(study, title, &chart, err);
    if (code < 0)
        return code;
    const uint32_t width = (uint32_t)(png_scale * chart.width);
    const uint32_t height = (uint32_t)(png_scale * chart.height);
    cairo_surface_t *surface =
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
    code = check(cairo_surface_status(surface), path, err);
    if (code == 0)
        code = draw(surface, png_scale, &chart, study, path, err);
    unsigned char *rgb = code == 0 ? rgb_of(surface, width, height) : NULL;
    if (code == 0 && !rgb)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory drawing a chart");
    /* By libpng itself: cairo's own writing does not survive want of memory. */
    if (code == 0)
        code = orl_png_write(path, width, height, rgb, err);
    free(rgb);
    cairo_surface_destroy(surface);
    orl_chart_done(&chart);
    return code;
}
