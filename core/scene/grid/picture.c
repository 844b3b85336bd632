#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "base/rgbe.h"
#include "scene/grid/grid.h"

int orl_grid_new_picture(const char *name, uint32_t width, uint32_t height, double aspect,
                         struct orl_grid **ret_grid, struct orl_error *err)
{
    const uint64_t values = (uint64_t)ORL_GRID_CHANNELS * width * height;
    struct orl_grid *grid;
    int code =
        width > ORL_LIMIT_IMAGE_SIDE || height > ORL_LIMIT_IMAGE_SIDE || values > ORL_GRID_VALUES
            ? ORL_ERR_LIMIT
            : 0;
    if (code < 0 || width < 2 || height < 2) {
        code = code < 0 ? code : ORL_ERR_SYNTAX;
        orl_error_set(err, code,
                      "the picture has %u x %u pixels: 2 x 2 at least, and %lu M at most", width,
                      height, (ORL_GRID_VALUES >> 20) / ORL_GRID_CHANNELS);
        orl_error_at(err, name, 0, NULL);
        return code;
    }
    grid = calloc(1, sizeof *grid);
    if (grid)
        grid->values = calloc(values, sizeof *grid->values);
    if (!grid || !grid->values) {
        orl_grid_free(grid);
        orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
        return ORL_ERR_NOMEM;
    }
    const double up = aspect * height / width; /* of a unit of width */
    grid->n_axes = 2;
    grid->channels = ORL_GRID_CHANNELS;
    grid->n_values = values;
    grid->axes[0] = (struct orl_grid_axis){.size = up >= 1 ? up : 1, .n = height};
    grid->axes[1] = (struct orl_grid_axis){.size = up >= 1 ? 1 : 1 / up, .n = width};
    *ret_grid = grid;
    return 0;
}

float *orl_grid_pixel(struct orl_grid *grid, uint32_t x, uint32_t y)
{
    const size_t width = grid->axes[1].n, row = grid->axes[0].n - 1 - y;
    return grid->values + (row * width + x) * grid->channels;
}

/* ---- Radiance's -------------------------------------------------------------------------------
 */

/* Of the header the format and the pixels' aspect matter. */
static int take_line(void *ctx, const struct orl_rgbe *rgbe, const char *line,
                     struct orl_error *err)
{
    static const char aspect[] = "PIXASPECT=", format[] = "FORMAT=";
    double *const all = ctx;
    if (strncmp(line, aspect, sizeof aspect - 1) == 0) {
        *all *= strtod(line + sizeof aspect - 1, NULL);
        if (!(*all > 1e-6 && *all < 1e6))
            return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err, "the pixels' aspect is out of range");
    }
    if (strncmp(line, format, sizeof format - 1) == 0 && !strstr(line, "32-bit_rle_rgbe")) {
        const int code = orl_rgbe_fail(rgbe, ORL_ERR_UNSUPPORTED, err,
                                       "the picture's FORMAT is not 32-bit_rle_rgbe");
        orl_error_hint(err, "ra_xyze -r makes one of XYZE");
        return code;
    }
    return 0;
}

static int read_hdr(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                    struct orl_error *err)
{
    struct orl_rgbe rgbe;
    struct orl_grid *grid = NULL;
    unsigned char(*pixels)[4] = NULL;
    double aspect = 1;
    int code = orl_rgbe_begin(&rgbe, name, data, size, take_line, &aspect, err);
    if (code == 0)
        code = orl_grid_new_picture(name, rgbe.width, rgbe.height, aspect, &grid, err);
    if (code < 0 || !grid)
        return code;
    const size_t n = (size_t)rgbe.width * rgbe.height;
    pixels = malloc(n * sizeof *pixels);
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
    if (size >= 2 && memcmp(data, "#?", 2) == 0)
        return read_hdr(name, data, size, ret_grid, err);
    if (size >= sizeof png && memcmp(data, png, sizeof png) == 0)
        return orl_grid_read_png(name, data, size, ret_grid, err);
    if (size >= sizeof exr && memcmp(data, exr, sizeof exr) == 0)
        return orl_grid_read_exr(name, data, size, ret_grid, err);
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "a picture is Radiance's, PNG or OpenEXR: this is none of them");
    orl_error_at(err, name, 0, NULL);
    return ORL_ERR_UNSUPPORTED;
}
