#include <stdlib.h>
#include <string.h>

#include "base/io/rgbe.h"
#include "scene/grid/grid.h"

/* ---- Radiance pictures ----------------------------------------------------------------------- */

/* Reads the format and the pixels' aspect from the header. */
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
    orl_error_set(err, ORL_ERR_UNSUPPORTED,
                  "a picture is Radiance's, PNG, TIFF or OpenEXR: this is none of them");
    orl_error_hint(err, "image editors make one of these, Radiance's ra_* one of its own");
    orl_error_at(err, name, 0, NULL);
    return ORL_ERR_UNSUPPORTED;
}
