#include "render/film/png.h"

#include <errno.h>
#include <png.h>
#include <zlib.h>

#include "base/io/out_file.h"

struct picture {
    uint32_t width, height;
    const unsigned char *rgb;
    int bits; /* per channel */
};

/* Encodes a picture. libpng reports failure by a jump back to here. */
static int encode_png(const struct picture *picture, FILE *stream)
{
    errno = 0;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return orl_err_of_errno(errno);
    }
    png_init_io(png, stream);
    png_set_IHDR(png, info, picture->width, picture->height, picture->bits, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_PAETH);
    png_set_compression_strategy(png, Z_RLE);
    png_write_info(png, info);
    for (uint32_t y = 0; y < picture->height; y++)
        png_write_row(png, picture->rgb + (size_t)picture->bits / 8 * 3 * y * picture->width);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return 0;
}

static int write_picture(const struct picture *picture, const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    code = encode_png(picture, file.stream);
    if (code < 0)
        orl_error_set(err, code, "libpng failed writing '%s'%s", path,
                      code == ORL_ERR_NOMEM ? ": out of memory" : "");
    return orl_out_close(&file, code, err);
}

int orl_png_write(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                  struct orl_error *err)
{
    const struct picture picture = {width, height, rgb, 8};
    return write_picture(&picture, path, err);
}

int orl_png_write_16(const char *path, uint32_t width, uint32_t height, const unsigned char *rgb,
                     struct orl_error *err)
{
    const struct picture picture = {width, height, rgb, 16};
    return write_picture(&picture, path, err);
}
