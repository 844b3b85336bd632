#include "render/film/image_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/rgbe.h"

struct reading {
    struct orl_rgbe rgbe;
    double exposure[3];
    struct orl_hdr_picture picture;
};

/* ---- The header ------------------------------------------------------------------------------ */

static bool starts_with(const char *line, const char *word, const char **ret_rest)
{
    const size_t length = strlen(word);
    *ret_rest = line + length;
    return strncmp(line, word, length) == 0;
}

static int take_exposure(struct reading *r, const struct orl_rgbe *rgbe, const char *text,
                         int channels, struct orl_error *err)
{
    double e[3] = {1, 1, 1};
    for (int i = 0; i < channels; i++) {
        char *end;
        e[i] = strtod(text, &end);
        if (end == text || !(e[i] > 0) || !isfinite(e[i]))
            return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err,
                                 "the header's exposure must be a number above 0");
        text = end;
    }
    for (int i = 0; i < 3; i++)
        r->exposure[i] *= e[channels == 1 ? 0 : i];
    if (!isnormal(r->exposure[0]) || !isnormal(r->exposure[1]) || !isnormal(r->exposure[2]))
        return orl_rgbe_fail(rgbe, ORL_ERR_RANGE, err,
                             "the product of the header's exposures is out of range");
    return 0;
}

static int take_line(void *ctx, const struct orl_rgbe *rgbe, const char *line,
                     struct orl_error *err)
{
    struct reading *const r = ctx;
    const char *rest;
    int code = 0;
    if (starts_with(line, "EXPOSURE=", &rest))
        return take_exposure(r, rgbe, rest, 1, err);
    if (starts_with(line, "COLORCORR=", &rest))
        return take_exposure(r, rgbe, rest, 3, err);
    if (starts_with(line, "FORMAT=", &rest)) {
        rest += strspn(rest, " \t");
        if (!starts_with(rest, "32-bit_rle_rgbe", &rest)) {
            code = orl_rgbe_fail(rgbe, ORL_ERR_UNSUPPORTED, err,
                                 "the picture's FORMAT is not 32-bit_rle_rgbe");
            orl_error_hint(err, "convert an XYZE picture with ra_xyze -r");
        }
    }
    if (starts_with(line, "VIEW=", &rest)) {
        code = orl_view_parse(rest, &r->picture.view, err);
        orl_error_at(code < 0 ? err : NULL, rgbe->name, rgbe->line, NULL);
        r->picture.has_view = code == 0;
    }
    return code;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

static int decode_pixels(struct reading *r, const unsigned char (*pixels)[4], struct orl_error *err)
{
    struct orl_film *const film = &r->picture.film;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        float *const rgb = film->pixels[i];
        for (int c = 0; c < 3; c++)
            rgb[c] = (float)(orl_rgbe_value(pixels[i], c) / r->exposure[c]);
        film->errors[i] = NAN;
        if (!isfinite(rgb[0]) || !isfinite(rgb[1]) || !isfinite(rgb[2]))
            return orl_rgbe_fail(&r->rgbe, ORL_ERR_RANGE, err,
                                 "a pixel divided by the exposure is too large");
    }
    return 0;
}

static int read_pixels(struct reading *r, struct orl_error *err)
{
    const uint32_t width = r->rgbe.width, height = r->rgbe.height;
    int code = orl_film_init(&r->picture.film, width, height, err);
    unsigned char(*const pixels)[4] = malloc((size_t)width * height * sizeof *pixels);
    if (!pixels)
        return orl_rgbe_fail(&r->rgbe, ORL_ERR_NOMEM, err, "out of memory reading a picture");
    if (code == 0)
        code = orl_rgbe_pixels(&r->rgbe, pixels, err);
    if (code == 0)
        code = decode_pixels(r, (const unsigned char(*)[4])pixels, err);
    free(pixels);
    return code;
}

int orl_hdr_read(const char *name, const void *data, size_t size,
                 struct orl_hdr_picture *ret_picture, struct orl_error *err)
{
    struct reading r = {.exposure = {1, 1, 1}};
    int code = orl_rgbe_begin(&r.rgbe, name, data, size, take_line, &r, err);
    if (code == 0)
        code = read_pixels(&r, err);
    if (code < 0)
        orl_hdr_done(&r.picture);
    else
        *ret_picture = r.picture;
    return code;
}

void orl_hdr_done(struct orl_hdr_picture *picture)
{
    orl_film_done(&picture->film);
}
