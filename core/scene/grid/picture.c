/* Pictures: detection of the format; Radiance's own formats, RGBE and spectra. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/rgbe.h"
#include "scene/grid/grid.h"

/* ---- Radiance pictures ----------------------------------------------------------------------- */

/* Fails if the line of a header gives another format. */
static int check_format(const struct orl_rgbe *rgbe, const char *line, const char *format,
                        const char *hint, struct orl_error *err)
{
    char what[80];
    if (strncmp(line, "FORMAT=", 7) != 0 || strstr(line, format))
        return 0;
    snprintf(what, sizeof what, "the picture's FORMAT is not %s", format);
    orl_rgbe_fail(rgbe, ORL_ERR_UNSUPPORTED, err, what);
    orl_error_hint(err, "%s", hint);
    return ORL_ERR_UNSUPPORTED;
}

/* Reads the format and the pixels' aspect from the header. */
static int take_rgbe_line(void *ctx, const struct orl_rgbe *rgbe, const char *line,
                          struct orl_error *err)
{
    static const char aspect[] = "PIXASPECT=";
    double *const all = ctx;
    if (strncmp(line, aspect, sizeof aspect - 1) == 0) {
        *all *= strtod(line + sizeof aspect - 1, NULL);
        if (!(*all > 1e-6 && *all < 1e6))
            return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err,
                                 "the pixel aspect ratio is out of range");
    }
    return check_format(rgbe, line, "32-bit_rle_rgbe", "convert a picture of XYZE with ra_xyze -r",
                        err);
}

static int read_hdr(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                    struct orl_error *err)
{
    struct orl_rgbe rgbe;
    struct orl_grid *grid = NULL;
    double aspect = 1;
    int code = orl_rgbe_begin(&rgbe, name, data, size, take_rgbe_line, &aspect, err);
    if (code == 0)
        code = orl_grid_new_picture(name, rgbe.width, rgbe.height, aspect, &grid, err);
    if (code < 0 || !grid)
        return code;
    const size_t n = (size_t)rgbe.width * rgbe.height;
    unsigned char(*const pixels)[4] = malloc(n * sizeof *pixels);
    if (!pixels) {
        orl_grid_free(grid);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    }
    code = orl_rgbe_pixels(&rgbe, pixels, err);
    for (size_t i = 0; code == 0 && i < n; i++)
        for (int c = 0; c < ORL_GRID_CHANNELS; c++)
            orl_grid_pixel(grid, (uint32_t)(i % rgbe.width), (uint32_t)(i / rgbe.width))[c] =
                (float)orl_rgbe_value(pixels[i], c);
    free(pixels);
    if (code < 0)
        orl_grid_free(grid);
    else
        *ret_grid = grid;
    return code;
}

int orl_grid_read_picture(const char *name, const void *data, size_t size,
                          struct orl_grid **ret_grid, struct orl_error *err)
{
    static const unsigned char png[] = {0x89, 'P', 'N', 'G'}, exr[] = {0x76, 0x2f, 0x31, 0x01};
    static const char *const tiff[] = {"II*\0", "MM\0*", "II+\0", "MM\0+"}; /* and BigTIFF */
    if (orl_is_rgbe(data, size))
        return read_hdr(name, data, size, ret_grid, err);
    if (size >= sizeof png && memcmp(data, png, sizeof png) == 0)
        return orl_grid_read_png(name, data, size, ret_grid, err);
    if (size >= sizeof exr && memcmp(data, exr, sizeof exr) == 0)
        return orl_grid_read_exr(name, data, size, ret_grid, err);
    for (int i = 0; i < 4; i++)
        if (size >= 4 && memcmp(data, tiff[i], 4) == 0)
            return orl_grid_read_tiff(name, data, size, ret_grid, err);
    orl_grid_fail(name, ORL_ERR_UNSUPPORTED, err,
                  "the picture is not a Radiance, PNG, TIFF or OpenEXR file");
    orl_error_hint(err, "convert it with an image editor, or with Radiance's ra_* programs");
    return ORL_ERR_UNSUPPORTED;
}

/*
 * Radiance's pictures of spectra: a pixel has NCOMP components with a common exponent, evenly
 * spaced over the wavelengths of WAVELENGTH_SPLITS, from the first number to the last.
 * Reference: "Radiance File Formats", picture files.
 */

enum { LEAST_COMPONENTS = 4, MOST_COMPONENTS = 496 };

struct header {
    double components;
    double first_nm, last_nm, aspect;
};

static int take_spectra_line(void *ctx, const struct orl_rgbe *rgbe, const char *line,
                             struct orl_error *err)
{
    static const char components[] = "NCOMP=", splits[] = "WAVELENGTH_SPLITS=",
                      aspect[] = "PIXASPECT=";
    struct header *const h = ctx;
    if (strncmp(line, components, sizeof components - 1) == 0)
        h->components = floor(strtod(line + sizeof components - 1, NULL));
    if (strncmp(line, aspect, sizeof aspect - 1) == 0)
        h->aspect *= strtod(line + sizeof aspect - 1, NULL);
    if (strncmp(line, splits, sizeof splits - 1) == 0) {
        char *at = (char *)(uintptr_t)line + sizeof splits - 1;
        double nm[4];
        for (int i = 0; i < 4; i++)
            nm[i] = strtod(at, &at);
        h->first_nm = nm[0];
        h->last_nm = nm[3];
    }
    return check_format(rgbe, line, "Radiance_spectra",
                        "use colorpict for pictures of three colours", err);
}

static int check_header(const struct orl_rgbe *rgbe, const struct header *h, struct orl_error *err)
{
    if (!(h->components >= LEAST_COMPONENTS && h->components <= MOST_COMPONENTS))
        return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err,
                             "a spectral picture needs NCOMP= 4 to 496 in its header");
    if (!(h->last_nm >= 1 && h->first_nm >= 1 && h->first_nm != h->last_nm && h->first_nm < 1e5 &&
          h->last_nm < 1e5))
        return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err,
                             "WAVELENGTH_SPLITS= takes four wavelengths, in nm");
    if (!(h->aspect > 1e-6 && h->aspect < 1e6))
        return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err, "the pixel aspect ratio is out of range");
    if (memcmp(rgbe->order, "-Y+X", 4) != 0 || rgbe->width < 2 || rgbe->height < 2)
        return orl_rgbe_fail(rgbe, ORL_ERR_UNSUPPORTED, err,
                             "its scan lines must run down and to the right (-Y and +X), with at "
                             "least 2 pixels each way");
    if ((size_t)rgbe->width * rgbe->height > ORL_GRID_VALUES / (size_t)h->components)
        return orl_rgbe_fail(rgbe, ORL_ERR_LIMIT, err, "it has too many values");
    if ((size_t)(rgbe->end - rgbe->at) / ((size_t)h->components + 1) <
        (size_t)rgbe->width * rgbe->height)
        return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err, "it ends before its last pixel");
    return 0;
}

static struct orl_grid *new_grid(const struct orl_rgbe *rgbe, const struct header *h)
{
    const double wide = rgbe->width, high = rgbe->height * h->aspect;
    const double short_side = fmin(wide, high), step = (h->last_nm - h->first_nm) / h->components;
    struct orl_grid *const grid =
        orl_grid_new((size_t)rgbe->width * rgbe->height * (size_t)h->components, 1);
    if (!grid)
        return NULL;
    grid->n_axes = 3;
    grid->axes[0] = (struct orl_grid_axis){.size = wide / short_side, .n = rgbe->width};
    grid->axes[1] = (struct orl_grid_axis){.size = high / short_side, .n = rgbe->height};
    grid->axes[2] = (struct orl_grid_axis){.origin = h->first_nm + step / 2,
                                           .size = step * (h->components - 1),
                                           .n = (uint32_t)h->components};
    return grid;
}

int orl_grid_read_spectra(const char *name, const void *data, size_t size,
                          struct orl_grid **ret_grid, struct orl_error *err)
{
    struct header h = {.first_nm = 780, .last_nm = 380, .aspect = 1};
    struct orl_rgbe rgbe;
    int code = orl_rgbe_begin(&rgbe, name, data, size, take_spectra_line, &h, err);
    if (code == 0)
        code = check_header(&rgbe, &h, err);
    if (code < 0)
        return code;
    struct orl_grid *const grid = new_grid(&rgbe, &h);
    if (!grid)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    const size_t n = (size_t)h.components;
    const unsigned char *pixel = rgbe.at;
    for (uint32_t y = rgbe.height; y-- > 0;)
        for (uint32_t x = 0; x < rgbe.width; x++, pixel += n + 1) {
            float *const values = grid->values + ((size_t)x * rgbe.height + y) * n;
            const double unit = ldexp(1, (int)pixel[n] - 136);
            for (size_t i = 0; i < n; i++)
                values[i] = pixel[n] > 0 ? (float)((pixel[i] + 0.5) * unit) : 0;
        }
    *ret_grid = grid;
    return 0;
}
