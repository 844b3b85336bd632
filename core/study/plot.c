/* A study's chart into a file, as SVG or PNG. */
#include "study/plot.h"

#include <cairo/cairo-svg.h>
#include <errno.h>

#include "base/file.h"

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

int orl_study_write_png(const struct orl_study *study, const char *title, const char *path,
                        struct orl_error *err)
{
    struct orl_chart chart;
    struct orl_out_file file = {.stream = NULL};
    int code = orl_chart_make(study, title, &chart, err);
    if (code < 0)
        return code;
    cairo_surface_t *surface = cairo_image_surface_create(
        CAIRO_FORMAT_RGB24, (int)(png_scale * chart.width), (int)(png_scale * chart.height));
    code = draw(surface, png_scale, &chart, study, path, err);
    if (code == 0)
        code = orl_out_open(&file, path, err);
    if (code == 0) {
        errno = 0;
        code =
            check(cairo_surface_write_to_png_stream(surface, take_bytes, file.stream), path, err);
        code = orl_out_close(&file, code, err);
    }
    cairo_surface_destroy(surface);
    orl_chart_done(&chart);
    return code;
}
