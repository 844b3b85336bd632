#include "render/film/read_hdr.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

enum { LINE = 4096, SHORTEST_RLE = 8, LONGEST_RLE = 32767 };

struct reading {
    const char *name;
    const unsigned char *at, *end;
    int line; /* of the header; 0 behind it */
    double exposure[3];
    uint32_t scanlines, length; /* as they are stored */
    char order[4];              /* "-Y+X": signs and axes, the slower first */
    struct orl_hdr_picture picture;
};

static int fail(const struct reading *r, int code, struct orl_error *err, const char *what)
{
    orl_error_set(err, code, "%s", what);
    orl_error_at(err, r->name, r->line, NULL);
    return code;
}

/* ---- The header ------------------------------------------------------------------------------ */

/* One line without its end; cut to what there is room for. False at the end of the bytes. */
static bool next_line(struct reading *r, char ret_line[LINE])
{
    const size_t left = (size_t)(r->end - r->at);
    const unsigned char *stop = left > 0 ? memchr(r->at, '\n', left) : NULL;
    if (!stop)
        return false;
    const size_t length = (size_t)(stop - r->at), kept = length < LINE ? length : LINE - 1;
    memcpy(ret_line, r->at, kept);
    ret_line[kept] = '\0';
    r->at = stop + 1;
    r->line++;
    return true;
}

static bool starts_with(const char *line, const char *word, const char **ret_rest)
{
    const size_t length = strlen(word);
    *ret_rest = line + length;
    return strncmp(line, word, length) == 0;
}

static int take_exposure(struct reading *r, const char *text, int channels, struct orl_error *err)
{
    double e[3] = {1, 1, 1};
    for (int i = 0; i < channels; i++) {
        char *end;
        e[i] = strtod(text, &end);
        if (end == text || !(e[i] > 0) || !isfinite(e[i]))
            return fail(r, ORL_ERR_SYNTAX, err, "the header's exposure is no number above 0");
        text = end;
    }
    for (int i = 0; i < 3; i++)
        r->exposure[i] *= e[channels == 1 ? 0 : i];
    if (!isnormal(r->exposure[0]) || !isnormal(r->exposure[1]) || !isnormal(r->exposure[2]))
        return fail(r, ORL_ERR_RANGE, err, "the header's exposures together are out of range");
    return 0;
}

static int take_line(struct reading *r, const char *line, struct orl_error *err)
{
    const char *rest;
    int code = 0;
    if (starts_with(line, "EXPOSURE=", &rest))
        return take_exposure(r, rest, 1, err);
    if (starts_with(line, "COLORCORR=", &rest))
        return take_exposure(r, rest, 3, err);
    if (starts_with(line, "FORMAT=", &rest)) {
        rest += strspn(rest, " \t");
        if (!starts_with(rest, "32-bit_rle_rgbe", &rest)) {
            code = fail(r, ORL_ERR_UNSUPPORTED, err, "the picture's FORMAT is not 32-bit_rle_rgbe");
            orl_error_hint(err, "ra_xyze -r makes one of XYZE");
        }
    }
    if (starts_with(line, "VIEW=", &rest)) {
        code = orl_view_parse(rest, &r->picture.view, err);
        orl_error_at(code < 0 ? err : NULL, r->name, r->line, NULL);
        r->picture.has_view = code == 0;
    }
    return code;
}

/* A sign, an axis and a count, such as -Y 400; where it ends, NULL when it is none. */
static const char *read_axis(const char *text, char ret_order[2], uint32_t *ret_count)
{
    char *end;
    text += strspn(text, " ");
    if ((text[0] != '+' && text[0] != '-') || (text[1] != 'X' && text[1] != 'Y') || text[2] != ' ')
        return NULL;
    memcpy(ret_order, text, 2);
    text += 2 + strspn(text + 2, " ");
    const unsigned long count = strtoul(text, &end, 10);
    *ret_count = count > ORL_LIMIT_IMAGE_SIDE ? ORL_LIMIT_IMAGE_SIDE + 1 : (uint32_t)count;
    return end == text || *text == '-' || *text == '+' ? NULL : end;
}

static int read_resolution(struct reading *r, struct orl_error *err)
{
    char line[LINE];
    if (!next_line(r, line))
        return fail(r, ORL_ERR_SYNTAX, err, "the picture ends before its resolution");
    const char *rest = read_axis(line, r->order, &r->scanlines);
    rest = rest ? read_axis(rest, r->order + 2, &r->length) : NULL;
    if (!rest || r->order[1] == r->order[3])
        return fail(r, ORL_ERR_SYNTAX, err, "no resolution such as -Y 400 +X 400 is here");
    if (r->scanlines < 1 || r->length < 1 || r->scanlines > ORL_LIMIT_IMAGE_SIDE ||
        r->length > ORL_LIMIT_IMAGE_SIDE ||
        (uint64_t)r->scanlines * r->length > ORL_LIMIT_IMAGE_PIXELS)
        return fail(r, ORL_ERR_LIMIT, err, "the picture has no pixels, or too many");
    r->line = 0;
    return 0;
}

static int read_header(struct reading *r, struct orl_error *err)
{
    char line[LINE];
    if (!next_line(r, line) || strncmp(line, "#?", 2) != 0)
        return fail(r, ORL_ERR_SYNTAX, err, "this is no Radiance picture: it begins with no #?");
    while (next_line(r, line)) {
        if (line[0] == '\0' || strcmp(line, "\r") == 0)
            return read_resolution(r, err);
        const int code = take_line(r, line, err);
        if (code < 0)
            return code;
    }
    return fail(r, ORL_ERR_SYNTAX, err, "the picture ends in its header");
}

/* ---- Scanlines ------------------------------------------------------------------------------- */

static size_t left(const struct reading *r)
{
    return (size_t)(r->end - r->at);
}

/* One component of a scanline, every fourth byte. */
static bool read_component(struct reading *r, unsigned char *out)
{
    for (uint32_t x = 0; x < r->length;) {
        if (left(r) < 2)
            return false;
        const uint32_t code = *r->at++;
        const bool is_run = code > 128;
        const uint32_t count = is_run ? code & 127 : code;
        if (count == 0 || count > r->length - x || left(r) < (is_run ? 1 : count))
            return false;
        for (uint32_t i = 0; i < count; i++, x++)
            out[(size_t)4 * x] = is_run ? *r->at : r->at[i];
        r->at += is_run ? 1 : count;
    }
    return true;
}

/* Pixels as they are, or, where the mantissas are all 1, repeats of the last one; repeats that
 * follow one another count 256 times as much each. */
static bool read_by_pixel(struct reading *r, unsigned char *out)
{
    uint32_t x = 0, shift = 0;
    while (x < r->length) {
        if (left(r) < 4)
            return false;
        const unsigned char *p = r->at;
        r->at += 4;
        if (p[0] != 1 || p[1] != 1 || p[2] != 1) {
            memcpy(out + (size_t)4 * x++, p, 4);
            shift = 0;
            continue;
        }
        const uint64_t count = shift < 32 ? (uint64_t)p[3] << shift : UINT64_MAX;
        if (x == 0 || count > r->length - x)
            return false;
        for (uint64_t i = 0; i < count; i++, x++)
            memcpy(out + (size_t)4 * x, out + (size_t)4 * (x - 1), 4);
        shift += 8;
    }
    return true;
}

static bool read_scanline(struct reading *r, unsigned char *out)
{
    const unsigned char *p = r->at;
    if (left(r) < 4 || r->length < SHORTEST_RLE || r->length > LONGEST_RLE || p[0] != 2 ||
        p[1] != 2 || (p[2] & 128) != 0)
        return read_by_pixel(r, out);
    if (((uint32_t)p[2] << 8 | p[3]) != r->length)
        return false;
    r->at += 4;
    for (int c = 0; c < 4; c++)
        if (!read_component(r, out + c))
            return false;
    return true;
}

/* Where the pixel of a scanline lies in the film. */
static size_t place_of(const struct reading *r, uint32_t scanline, uint32_t along)
{
    const bool by_rows = r->order[1] == 'Y';
    const uint32_t slow = scanline, fast = along;
    const uint32_t row = by_rows ? slow : fast, column = by_rows ? fast : slow;
    const char down = by_rows ? r->order[0] : r->order[2];
    const char right = by_rows ? r->order[2] : r->order[0];
    const uint32_t width = r->picture.film.width, height = r->picture.film.height;
    const uint32_t y = down == '-' ? row : height - 1 - row;
    const uint32_t x = right == '+' ? column : width - 1 - column;
    return (size_t)y * width + x;
}

/* The middle of what the bytes stand for, as Radiance's tools take them. */
static void decode(const struct reading *r, const unsigned char rgbe[4], float ret_rgb[3])
{
    const double scale = rgbe[3] > 0 ? ldexp(1, (int)rgbe[3] - 136) : 0;
    for (int i = 0; i < 3; i++)
        ret_rgb[i] = rgbe[3] > 0 ? (float)((rgbe[i] + 0.5) * scale / r->exposure[i]) : 0;
}

static int read_pixels(struct reading *r, struct orl_error *err)
{
    const bool by_rows = r->order[1] == 'Y';
    struct orl_film *film = &r->picture.film;
    int code = orl_film_init(film, by_rows ? r->length : r->scanlines,
                             by_rows ? r->scanlines : r->length, err);
    unsigned char *scanline = malloc((size_t)4 * r->length);
    if (code == 0 && !scanline)
        code = fail(r, ORL_ERR_NOMEM, err, "out of memory reading a picture");
    for (uint32_t y = 0; y < r->scanlines && code == 0; y++) {
        if (!read_scanline(r, scanline))
            code = fail(r, ORL_ERR_SYNTAX, err, "the picture's pixels end early or are damaged");
        for (uint32_t x = 0; x < r->length && code == 0; x++) {
            const size_t at = place_of(r, y, x);
            float *rgb = film->pixels[at];
            decode(r, scanline + (size_t)4 * x, rgb);
            film->errors[at] = NAN;
            if (!isfinite(rgb[0]) || !isfinite(rgb[1]) || !isfinite(rgb[2]))
                code = fail(r, ORL_ERR_RANGE, err, "by its exposure a pixel is beyond measure");
        }
    }
    free(scanline);
    return code;
}

int orl_hdr_read(const char *name, const void *data, size_t size,
                 struct orl_hdr_picture *ret_picture, struct orl_error *err)
{
    struct reading r = {.name = name, .at = data, .exposure = {1, 1, 1}};
    r.end = r.at + size;
    int code = read_header(&r, err);
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
