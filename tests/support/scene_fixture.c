#include "support/scene_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

/* Texts that have been returned, so that no leak is reported. */
struct kept {
    struct kept *next;
    char *text;
};
static struct kept *all;

static const char *keep_text(char *text)
{
    struct kept *one = malloc(sizeof *one);
    assert_non_null(text);
    assert_non_null(one);
    *one = (struct kept){all, text};
    all = one;
    return text;
}

const char *scene_fixture(const char *name)
{
    char path[256];
    size_t size;
    snprintf(path, sizeof path, "tests/fixtures/scenes/%s.rad", name);
    return keep_text((char *)scene_read_bytes(path, &size));
}

const char *scene_join(const char *first, ...)
{
    size_t size = 1, used = 0;
    va_list parts;
    va_start(parts, first);
    for (const char *part = first; part; part = va_arg(parts, const char *))
        size += strlen(part);
    va_end(parts);
    char *text = calloc(size, 1);
    assert_non_null(text);
    va_start(parts, first);
    for (const char *part = first; part; part = va_arg(parts, const char *)) {
        const size_t length = strlen(part);
        memcpy(text + used, part, length);
        used += length;
    }
    va_end(parts);
    return keep_text(text);
}
