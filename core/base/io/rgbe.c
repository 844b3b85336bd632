#include "base/io/rgbe.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

enum { LINE = 4096, HEADER = 65536, SHORTEST_RLE = 8, LONGEST_RLE = 32767 };

int orl_rgbe_fail(const struct orl_rgbe *rgbe, int code, struct orl_error *err, const char *what)
{
    orl_error_set(err, code, "%s", what);
    orl_error_at(err, rgbe->name, rgbe->line, NULL);
    return code;
}

/* ---- The header ------------------------------------------------------------------------------ */

/* Reads one line without its end, truncated to the buffer. Returns false at the end of the data. */
static bool next_line(struct orl_rgbe *r, char ret_line[LINE])
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

/* Parses a sign, an axis and a count, such as -Y 400. Returns its end, or NULL if it is invalid. */
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

static int read_resolution(struct orl_rgbe *r, struct orl_error *err)
{
    char line[LINE];
    if (!next_line(r, line))
        return orl_rgbe_fail(r, ORL_ERR_SYNTAX, err, "the picture ends before its resolution");
    const char *rest = read_axis(line, r->order, &r->scanlines);
    rest = rest ? read_axis(rest, r->order + 2, &r->length) : NULL;
    if (!rest || r->order[1] == r->order[3])
        return orl_rgbe_fail(r, ORL_ERR_SYNTAX, err,
                             "a resolution such as -Y 400 +X 400 is expected here");
    if (r->scanlines < 1 || r->length < 1 || r->scanlines > ORL_LIMIT_IMAGE_SIDE ||
        r->length > ORL_LIMIT_IMAGE_SIDE ||
        (uint64_t)r->scanlines * r->length > ORL_LIMIT_IMAGE_PIXELS)
        return orl_rgbe_fail(r, ORL_ERR_LIMIT, err, "the picture has no pixels, or too many");
    r->line = 0;
    r->width = r->order[1] == 'Y' ? r->length : r->scanlines;
    r->height = r->order[1] == 'Y' ? r->scanlines : r->length;
    return 0;
}

/* Pictures from before 1992 begin with the commands that made them. */
bool orl_is_rgbe(const void *data, size_t size)
{
    static const char format[] = "FORMAT=32-bit_rle_";
    const char *const end = (const char *)data + (size < HEADER ? size : HEADER);
    if (size >= 2 && memcmp(data, "#?", 2) == 0)
        return true;
    for (const char *at = data; at < end && *at != '\n' && *at != '\r';) {
        if ((size_t)(end - at) >= sizeof format && memcmp(at, format, sizeof format - 1) == 0)
            return true;
        at = memchr(at, '\n', (size_t)(end - at));
        if (!at)
            return false;
        at++;
    }
    return false;
}

int orl_rgbe_begin(struct orl_rgbe *rgbe, const char *name, const void *data, size_t size,
                   orl_rgbe_line take, void *ctx, struct orl_error *err)
{
    const unsigned char *const bytes = data;
    char line[LINE];
    *rgbe = (struct orl_rgbe){.name = name, .at = bytes, .end = bytes + size};
    if (!orl_is_rgbe(data, size))
        return orl_rgbe_fail(
            rgbe, ORL_ERR_SYNTAX, err,
            "this is not a Radiance picture: it does not begin with #?, and has no FORMAT");
    if (*bytes == '#' && !next_line(rgbe, line))
        return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err, "the picture ends in its header");
    while (next_line(rgbe, line)) {
        if (line[0] == '\0' || strcmp(line, "\r") == 0)
            return read_resolution(rgbe, err);
        const int code = take(ctx, rgbe, line, err);
        if (code < 0)
            return code;
    }
    return orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err, "the picture ends in its header");
}

/* ---- Scanlines ------------------------------------------------------------------------------- */

static size_t bytes_left(const struct orl_rgbe *r)
{
    return (size_t)(r->end - r->at);
}

/* Reads one component of a scanline into every fourth byte. */
static bool read_component(struct orl_rgbe *r, unsigned char *out)
{
    for (uint32_t x = 0; x < r->length;) {
        if (bytes_left(r) < 2)
            return false;
        const uint32_t code = *r->at++;
        const bool is_run = code > 128;
        const uint32_t count = is_run ? code & 127 : code;
        if (count == 0 || count > r->length - x || bytes_left(r) < (is_run ? 1 : count))
            return false;
        for (uint32_t i = 0; i < count; i++, x++)
            out[(size_t)4 * x] = is_run ? *r->at : r->at[i];
        r->at += is_run ? 1 : count;
    }
    return true;
}

/* Reads a scanline of flat pixels. A pixel with mantissas of 1 repeats the last one; the count of
 * each further consecutive repeat is multiplied by 256 once more. */
static bool read_by_pixel(struct orl_rgbe *r, unsigned char *out)
{
    uint32_t x = 0, shift = 0;
    while (x < r->length) {
        if (bytes_left(r) < 4)
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

static bool read_scanline(struct orl_rgbe *r, unsigned char *out)
{
    const unsigned char *p = r->at;
    if (bytes_left(r) < 4 || r->length < SHORTEST_RLE || r->length > LONGEST_RLE || p[0] != 2 ||
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

/* Returns the index of a scanline's pixel in the output. */
static size_t place_of(const struct orl_rgbe *r, uint32_t scanline, uint32_t along)
{
    const bool by_rows = r->order[1] == 'Y';
    const uint32_t row = by_rows ? scanline : along, column = by_rows ? along : scanline;
    const char down = by_rows ? r->order[0] : r->order[2];
    const char right = by_rows ? r->order[2] : r->order[0];
    const uint32_t y = down == '-' ? row : r->height - 1 - row;
    const uint32_t x = right == '+' ? column : r->width - 1 - column;
    return (size_t)y * r->width + x;
}

int orl_rgbe_pixels(struct orl_rgbe *rgbe, unsigned char (*ret_pixels)[4], struct orl_error *err)
{
    unsigned char *const scanline = malloc((size_t)4 * rgbe->length);
    int code = 0;
    if (!scanline)
        return orl_rgbe_fail(rgbe, ORL_ERR_NOMEM, err, "out of memory reading a picture");
    for (uint32_t y = 0; y < rgbe->scanlines && code == 0; y++) {
        if (!read_scanline(rgbe, scanline))
            code = orl_rgbe_fail(rgbe, ORL_ERR_SYNTAX, err,
                                 "the picture's pixels end early or are damaged");
        for (uint32_t x = 0; x < rgbe->length && code == 0; x++)
            memcpy(ret_pixels[place_of(rgbe, y, x)], scanline + (size_t)4 * x, 4);
    }
    free(scanline);
    return code;
}
