/*
 * Web origins as browsers write them in the Origin header (RFC 6454, 6.2): "https://tool.example",
 * "http://localhost:3000". Scheme and host are in lower case, the port is given only if it is not
 * the scheme's default, and nothing follows. Origins that differ in a byte are different; a dot at
 * the end of the name makes another. Threads: any.
 */
#ifndef ORL_SERVER_PROCESS_ORIGIN_H
#define ORL_SERVER_PROCESS_ORIGIN_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>

enum { ORL_ORIGIN_MAX = 300 }; /* bytes: the longest name that DNS has, and a port */

/* Checks an origin. ORL_ERR_INVALID, with a sentence, for text that no browser sends: "*", "null",
 * a path, ... */
int orl_origin_check(const char *text, struct orl_error *err);

/* Returns true if the origin equals one of the list, byte for byte. */
bool orl_origin_is_listed(const char *origin, const char *const *list, size_t count);

#endif
