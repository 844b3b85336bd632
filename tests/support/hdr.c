/* cmocka needs these headers first. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/hdr.h"
#include "support/scene_text.h"

/* Reads one component of a scanline. Returns the position after it. */
static const unsigned char *read_component(const unsigned char *p, const unsigned char *end,
                                           int width, unsigned char *ret_bytes)
{
    for (int x = 0; x < width;) {
        assert_true(end - p > 1);
        const bool run = *p > 128;
        const int count = run ? *p - 128 : *p;
        p++;
        assert_true(count > 0 && count <= width - x && end - p >= (run ? 1 : count));
        if (run)
            memset(ret_bytes + x, *p, (size_t)count);
        else
            memcpy(ret_bytes + x, p, (size_t)count);
        p += run ? 1 : count;
        x += count;
    }
    return p;
}

static double decode(unsigned char mantissa, unsigned char exponent)
{
    return mantissa > 0 && exponent > 0 ? ldexp(mantissa + 0.5, exponent - 136) : 0;
}

/* Returns the position after the header's blank line and the resolution line; other programs pad
 * the latter with blanks. */
static const char *find_pixels(const char *text, const char *end, int width, int height)
{
    char line[64] = "";
    int found_width = 0, found_height = 0;
    const char *blank = memmem(text, (size_t)(end - text), "\n\n", 2);
    assert_non_null(blank);
    const char *start = blank + 2, *newline = memchr(start, '\n', (size_t)(end - start));
    assert_non_null(newline);
    assert_true((size_t)(newline - start) < sizeof line);
    memcpy(line, start, (size_t)(newline - start));
    assert_int_equal(sscanf(line, "-Y %d +X %d", &found_height, &found_width), 2);
    assert_int_equal(found_width, width);
    assert_int_equal(found_height, height);
    return newline + 1;
}

void hdr_read(const char *path, int width, int height, double (*ret_rgb)[3])
{
    size_t size;
    unsigned char *bytes = scene_read_bytes(path, &size), *rgbe = malloc(4 * (size_t)width);
    const unsigned char *end = bytes + size;
    const unsigned char *p =
        (const unsigned char *)find_pixels((const char *)bytes, (const char *)end, width, height);
    assert_non_null(rgbe);
    for (int y = 0; y < height; y++) {
        assert_true(end - p > 4 && p[0] == 2 && p[1] == 2 && (p[2] << 8 | p[3]) == width);
        p += 4;
        for (int c = 0; c < 4; c++)
            p = read_component(p, end, width, rgbe + c * width);
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                ret_rgb[y * width + x][c] = decode(rgbe[c * width + x], rgbe[3 * width + x]);
    }
    free(rgbe);
    free(bytes);
}
