#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdlib.h>

#include "scene/grid/grid.h"

double orl_linear_of_srgb(double value)
{
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

void orl_linear_of_srgb_bytes(float ret_linear[256])
{
    for (int i = 0; i < 256; i++)
        ret_linear[i] = (float)orl_linear_of_srgb(i / 255.0);
}

/* libpng converts 16-bit channels to linear light. 8-bit ones are read as sRGB, because libpng
 * would round their linear values. */
static int read_pixels(const char *name, png_image *image, struct orl_grid *grid,
                       struct orl_error *err)
{
    static const png_color black = {0, 0, 0};
    const bool linear = image->format & PNG_FORMAT_FLAG_LINEAR;
    const size_t n = (size_t)image->width * image->height;
    float decoded[256];
    image->format = linear ? PNG_FORMAT_FLAG_LINEAR | PNG_FORMAT_FLAG_COLOR : PNG_FORMAT_RGB;
    void *const pixels = malloc(PNG_IMAGE_SIZE(*image));
    if (!pixels)
        return orl_grid_fail(name, ORL_ERR_NOMEM, err, "out of memory for a picture");
    if (!png_image_finish_read(image, &black, pixels, 0, NULL)) {
        free(pixels);
        return orl_grid_fail(name, ORL_ERR_SYNTAX, err, "the PNG is damaged");
    }
    orl_linear_of_srgb_bytes(decoded);
    for (size_t i = 0; i < n; i++) {
        float *const rgb =
            orl_grid_pixel(grid, (uint32_t)(i % image->width), (uint32_t)(i / image->width));
        for (size_t c = 0; c < ORL_GRID_CHANNELS; c++) {
            const size_t at = i * ORL_GRID_CHANNELS + c;
            rgb[c] = linear ? (float)(((const png_uint_16 *)pixels)[at] / 65535.0)
                            : decoded[((const unsigned char *)pixels)[at]];
        }
    }
    free(pixels);
    return 0;
}

int orl_grid_read_png(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                      struct orl_error *err)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    struct orl_grid *grid = NULL;
    if (!png_image_begin_read_from_memory(&image, data, size)) {
        png_image_free(&image);
        return orl_grid_fail(name, ORL_ERR_SYNTAX, err, "the PNG is damaged");
    }
    int code = orl_grid_new_picture(name, image.width, image.height, 1, &grid, err);
    if (code == 0)
        code = read_pixels(name, &image, grid, err);
    png_image_free(&image);
    if (code < 0)
        orl_grid_free(grid);
    else
        *ret_grid = grid;
    return code;
}
