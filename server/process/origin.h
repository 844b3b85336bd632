/*
 * Web origins as browsers write them in the Origin header (RFC 6454, 6.2): "https://tool.example",
 * "http://localhost:3000". Scheme and host in lower case, the port only where it is not the
 * scheme's own, nothing behind it. Two that differ in a byte are two origins; a dot at the end of
 * the name makes another. Threads: any.
 */
#ifndef ORL_SERVER_PROCESS_ORIGIN_H
#define ORL_SERVER_PROCESS_ORIGIN_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>

enum { ORL_ORIGIN_MAX = 300 }; /* bytes: the longest name that DNS has, and a port */

/* ORL_ERR_INVALID, with a sentence, for what no browser would ever send: "*", "null", a path, ...
 */
int orl_origin_check(const char *text, struct orl_error *err);

/* Is it, byte for byte, one of them? */
bool orl_origin_is_listed(const char *origin, const char *const *list, size_t count);

#endif
