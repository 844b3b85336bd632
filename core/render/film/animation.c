#include <oriel/job/animation.h>

#include <png.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/apng.h"

struct picture {
    uint32_t width, height;
    unsigned char *rgb; /* owned */
};

static int read_picture(const char *path, struct picture *ret_picture, struct orl_error *err)
{
    png_image image = {.version = PNG_IMAGE_VERSION};
    if (!png_image_begin_read_from_file(&image, path))
        return orl_error_set(err, ORL_ERR_SYNTAX, "'%s': %s", path, image.message);
    image.format = PNG_FORMAT_RGB;
    unsigned char *rgb = malloc(PNG_IMAGE_SIZE(image));
    if (!rgb) {
        png_image_free(&image);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for '%s'", path);
    }
    if (!png_image_finish_read(&image, NULL, rgb, 0, NULL)) {
        free(rgb);
        return orl_error_set(err, ORL_ERR_SYNTAX, "'%s': %s", path, image.message);
    }
    *ret_picture = (struct picture){image.width, image.height, rgb};
    return 0;
}

static int add_frame(struct orl_apng *apng, const char *path, const struct picture *first,
                     struct orl_error *err)
{
    struct picture picture = {0};
    int code = read_picture(path, &picture, err);
    if (code < 0)
        return code;
    code = picture.width == first->width && picture.height == first->height
               ? orl_apng_add(apng, picture.rgb, err)
               : orl_error_set(err, ORL_ERR_RANGE, "'%s' is of another size", path);
    free(picture.rgb);
    return code;
}

int orl_animation_write(const char *const *pictures, size_t count, double frame_s, const char *path,
                        struct orl_error *err)
{
    struct picture first = {0};
    struct orl_apng *apng = NULL;
    int code = read_picture(pictures[0], &first, err);
    if (code < 0)
        return code;
    code = orl_apng_open(path, first.width, first.height, (uint32_t)count, frame_s, &apng, err);
    free(first.rgb);
    if (code < 0)
        return code;
    for (size_t i = 0; i < count && code == 0; i++)
        code = add_frame(apng, pictures[i], &first, err);
    return orl_apng_close(apng, code, err);
}
