/* Radiance pictures, and glare in them. */
#include <math.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/job/glare.h>

#include "fuzz/fuzz.h"
#include "render/film/image_files.h"

static void check_glare(const uint8_t *data, size_t size)
{
    const struct orl_picture_bytes picture = {"a.hdr", data, size};
    const struct orl_glare_settings settings = {.smooth = true};
    struct orl_glare glare = {.n_sources = 0};
    struct orl_error err = {0};
    const int code =
        orl_glare_of_picture(&picture, "-vta -vh 180 -vv 180", &picture, &settings, &glare, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return;
    }
    FUZZ_PROMISE(glare.values[ORL_GLARE_DGP].value >= 0 && glare.values[ORL_GLARE_DGP].value <= 1);
    for (size_t i = 0; i < glare.n_sources; i++)
        FUZZ_PROMISE(glare.sources[i].pixels > 0 && glare.sources[i].solid_angle_sr > 0);
    orl_glare_done(&glare);
}

bool fuzz_hdr(const uint8_t *data, size_t size)
{
    struct orl_hdr_picture picture = {.has_view = false};
    struct orl_error err = {0};
    const int code = orl_hdr_read("a.hdr", data, size, &picture, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return false;
    }
    const size_t count = (size_t)picture.film.width * picture.film.height;
    FUZZ_PROMISE(count > 0 && count <= ORL_LIMIT_IMAGE_PIXELS);
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            FUZZ_PROMISE(picture.film.pixels[i][c] >= 0);
    orl_hdr_done(&picture);
    check_glare(data, size);
    return true;
}
