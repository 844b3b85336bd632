/*
 * Size of a test: by default that of `make check`, with tolerances derived for it; with ORIEL_LONG
 * set in the environment (make long) the full number of seeds and cases.
 */
#ifndef ORL_TESTS_SUPPORT_EXTENT_H
#define ORL_TESTS_SUPPORT_EXTENT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

static inline bool extent_is_long(void)
{
    const char *text = getenv("ORIEL_LONG");
    return text && text[0] && !(text[0] == '0' && !text[1]);
}

static inline size_t extent(size_t quick, size_t full)
{
    return extent_is_long() ? full : quick;
}

#endif
