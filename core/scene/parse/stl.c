#include "scene/parse/stl.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_BYTES = 80, TRIANGLE_BYTES = 50, WORD_BYTES = 64 };

struct reading {
    const char *at, *end, *file;
    int line;
};

static int fail(const struct reading *r, const char *what, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_SYNTAX, "%s", what);
    orl_error_at(err, r->file, r->line, NULL);
    return ORL_ERR_SYNTAX;
}

/* ---- Binary ---------------------------------------------------------------------------------- */

static uint32_t read_u32(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static double read_float(const char *at)
{
    const uint32_t bits = read_u32(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Its length says so; a text may begin with any of its bytes. */
static bool is_binary(const char *data, size_t size)
{
    return size >= HEADER_BYTES + 4 &&
           (size - HEADER_BYTES - 4) / TRIANGLE_BYTES == read_u32(data + HEADER_BYTES) &&
           (size - HEADER_BYTES - 4) % TRIANGLE_BYTES == 0;
}

static int read_binary(struct reading *r, const struct orl_stl_sink *sink, struct orl_error *err)
{
    const uint32_t count = read_u32(r->at + HEADER_BYTES);
    const char *at = r->at + HEADER_BYTES + 4;
    int code = 0;
    for (uint32_t i = 0; i < count && code == 0; i++, at += TRIANGLE_BYTES) {
        struct orl_vec3 corners[3];
        r->line = i < INT_MAX ? (int)i + 1 : INT_MAX;
        for (int k = 0; k < 3; k++) {
            const char *corner = at + 12 + 12 * (size_t)k; /* behind the normal */
            corners[k] = orl_v3(read_float(corner), read_float(corner + 4), read_float(corner + 8));
            if (!isfinite(corners[k].x + corners[k].y + corners[k].z))
                return fail(r, "a corner is not finite", err);
        }
        code = sink->add(sink->ctx, corners, r->line, err);
    }
    return code;
}

/* ---- Text ------------------------------------------------------------------------------------ */

static bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool next_word(struct reading *r, char ret_word[WORD_BYTES])
{
    size_t length = 0;
    for (; r->at < r->end && is_space(*r->at); r->at++)
        r->line += *r->at == '\n';
    for (; r->at < r->end && !is_space(*r->at); r->at++)
        if (length + 1 < WORD_BYTES)
            ret_word[length++] = *r->at;
    ret_word[length] = '\0';
    return length > 0;
}

static bool next_number(struct reading *r, double *ret_number)
{
    char word[WORD_BYTES], *end;
    if (!next_word(r, word))
        return false;
    *ret_number = strtod(word, &end);
    return *end == '\0' && isfinite(*ret_number);
}

static int read_corner(struct reading *r, struct orl_vec3 *ret_corner, struct orl_error *err)
{
    double place[3];
    for (int k = 0; k < 3; k++)
        if (!next_number(r, &place[k]))
            return fail(r, "a vertex is three numbers", err);
    *ret_corner = orl_v3(place[0], place[1], place[2]);
    return 0;
}

/* Behind "loop": "vertex x y z", three times, then "endloop". */
static int read_loop(struct reading *r, const struct orl_stl_sink *sink, struct orl_error *err)
{
    struct orl_vec3 corners[3];
    char word[WORD_BYTES];
    const int line = r->line;
    int code = 0;
    for (int k = 0; k < 3 && code == 0; k++) {
        if (!next_word(r, word) || strcmp(word, "vertex") != 0)
            return fail(r, "a facet has three lines 'vertex x y z'", err);
        code = read_corner(r, &corners[k], err);
    }
    if (code == 0 && (!next_word(r, word) || strcmp(word, "endloop") != 0))
        return fail(r, "a facet has three lines 'vertex x y z', then 'endloop'", err);
    return code ? code : sink->add(sink->ctx, corners, line, err);
}

static void skip_line(struct reading *r)
{
    const char *end = memchr(r->at, '\n', (size_t)(r->end - r->at));
    r->at = end ? end : r->end;
}

static int read_text(struct reading *r, const struct orl_stl_sink *sink, struct orl_error *err)
{
    char word[WORD_BYTES];
    int code = 0;
    while (code == 0 && next_word(r, word)) {
        if (strcmp(word, "loop") == 0)
            code = read_loop(r, sink, err);
        else if (strcmp(word, "solid") == 0 || strcmp(word, "endsolid") == 0 ||
                 strcmp(word, "facet") == 0)
            skip_line(r); /* a name, or a normal */
        else if (strcmp(word, "outer") != 0 && strcmp(word, "endfacet") != 0)
            code = fail(r, "'facet', 'outer loop' or 'endsolid' is wanted here", err);
    }
    return code;
}

bool orl_stl_is(const char *data, size_t size)
{
    return is_binary(data, size) ||
           (size > 5 && memcmp(data, "solid", 5) == 0 && is_space(data[5]));
}

int orl_stl_read(const char *file, const char *data, size_t size, const struct orl_stl_sink *sink,
                 struct orl_error *err)
{
    struct reading r = {.at = data, .end = data + size, .file = file, .line = 1};
    return is_binary(data, size) ? read_binary(&r, sink, err) : read_text(&r, sink, err);
}
