#include "scene/parse/mesh/mesh_formats.h"

#include <limits.h>
#include <math.h>
#include <string.h>

#include <oriel/base/scanner.h>

enum { HEADER_BYTES = 80, TRIANGLE_BYTES = 50 };

/* ---- Binary ---------------------------------------------------------------------------------- */

static double read_float(const char *at)
{
    const uint32_t bits = orl_u32_at(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Decides by the length; text may begin with any of the same bytes. */
static bool is_binary(const char *data, size_t size)
{
    return size >= HEADER_BYTES + 4 &&
           (size - HEADER_BYTES - 4) / TRIANGLE_BYTES == orl_u32_at(data + HEADER_BYTES) &&
           (size - HEADER_BYTES - 4) % TRIANGLE_BYTES == 0;
}

static int read_binary(const char *file, const char *data, const struct orl_stl_sink *sink,
                       struct orl_error *err)
{
    const uint32_t count = orl_u32_at(data + HEADER_BYTES);
    const char *at = data + HEADER_BYTES + 4;
    int code = 0;
    for (uint32_t i = 0; i < count && code == 0; i++, at += TRIANGLE_BYTES) {
        struct orl_vec3 corners[3];
        const int number = i < INT_MAX ? (int)i + 1 : INT_MAX;
        for (int k = 0; k < 3; k++) {
            const char *corner = at + 12 + 12 * (size_t)k; /* skips the normal */
            corners[k] = orl_v3(read_float(corner), read_float(corner + 4), read_float(corner + 8));
            if (!isfinite(corners[k].x + corners[k].y + corners[k].z)) {
                orl_error_set(err, ORL_ERR_SYNTAX, "a corner is not finite");
                orl_error_at(err, file, number, NULL);
                return ORL_ERR_SYNTAX;
            }
        }
        code = sink->add(sink->ctx, corners, number, err);
    }
    return code;
}

/* ---- Text ------------------------------------------------------------------------------------ */

static int fail(const struct orl_scanner *scanner, const char *what, struct orl_error *err)
{
    return orl_scanner_fail(scanner, ORL_ERR_SYNTAX, err, "%s", what);
}

static int read_corner(struct orl_scanner *scanner, struct orl_vec3 *ret_corner,
                       struct orl_error *err)
{
    static const char what[] = "a vertex needs three numbers";
    double place[3];
    struct orl_slice word;
    for (int k = 0; k < 3; k++) {
        if (!orl_scanner_word(scanner, &word))
            return fail(scanner, what, err);
        const int code = orl_scanner_number(scanner, word, what, &place[k], err);
        if (code < 0)
            return code;
    }
    *ret_corner = orl_v3(place[0], place[1], place[2]);
    return 0;
}

static bool is_next(struct orl_scanner *scanner, const char *text)
{
    struct orl_slice word;
    return orl_scanner_word(scanner, &word) && orl_slice_is(word, text);
}

/* Reads, behind "loop", "vertex x y z" three times, then "endloop". */
static int read_loop(struct orl_scanner *scanner, const struct orl_stl_sink *sink,
                     struct orl_error *err)
{
    struct orl_vec3 corners[3];
    const int line = scanner->line;
    int code = 0;
    for (int k = 0; k < 3 && code == 0; k++) {
        if (!is_next(scanner, "vertex"))
            return fail(scanner, "a facet needs three lines 'vertex x y z'", err);
        code = read_corner(scanner, &corners[k], err);
    }
    if (code == 0 && !is_next(scanner, "endloop"))
        return fail(scanner, "a facet needs three lines 'vertex x y z', then 'endloop'", err);
    return code ? code : sink->add(sink->ctx, corners, line, err);
}

static int read_text(struct orl_scanner *scanner, const struct orl_stl_sink *sink,
                     struct orl_error *err)
{
    struct orl_slice word;
    int code = 0;
    while (code == 0 && orl_scanner_word(scanner, &word)) {
        if (orl_slice_is(word, "loop"))
            code = read_loop(scanner, sink, err);
        else if (orl_slice_is(word, "solid") || orl_slice_is(word, "endsolid") ||
                 orl_slice_is(word, "facet"))
            orl_scanner_next_line(scanner); /* skips a name or a normal */
        else if (!orl_slice_is(word, "outer") && !orl_slice_is(word, "endfacet"))
            code = fail(scanner, "'facet', 'outer loop' or 'endsolid' is expected here", err);
    }
    return code;
}

bool orl_stl_detect(const char *data, size_t size)
{
    struct orl_scanner scanner;
    if (is_binary(data, size))
        return true;
    return orl_scanner_init(&scanner, NULL, data, size, 0, NULL) == 0 && is_next(&scanner, "solid");
}

int orl_stl_read(const char *file, const char *data, size_t size, const struct orl_stl_sink *sink,
                 struct orl_error *err)
{
    struct orl_scanner scanner;
    if (is_binary(data, size))
        return read_binary(file, data, sink, err);
    const int code = orl_scanner_init(&scanner, file, data, size, 0, err);
    return code < 0 ? code : read_text(&scanner, sink, err);
}
