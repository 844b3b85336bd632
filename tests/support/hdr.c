/* cmocka wants these before it. */
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

/* One component of a scanline. Returns what follows it. */
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

/* Behind the header's blank line and the line of the resolution. */
static const char *find_pixels(const char *text, const char *end, int width, int height)
{
    char wanted[64];
    const char *blank = memmem(text, (size_t)(end - text), "\n\n", 2);
    assert_non_null(blank);
    snprintf(wanted, sizeof wanted, "-Y %d +X %d\n", height, width);
    assert_true((size_t)(end - blank) > 2 + strlen(wanted));
    assert_memory_equal(blank + 2, wanted, strlen(wanted));
    return blank + 2 + strlen(wanted);
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
