/*
 * libmicrohttpd configured as in the daemon, without a network: bytes go in as if a client had sent
 * them, and a callback sees each request. One thread, no waiting.
 */
#ifndef ORL_TESTS_SUPPORT_WIRE_H
#define ORL_TESTS_SUPPORT_WIRE_H

#include <microhttpd.h>
#include <stdbool.h>
#include <stddef.h>

struct wire_request {
    struct MHD_Connection *connection;
    const char *method, *url, *version; /* as MHD returns them: escapes of the target are decoded */
    bool too_long; /* true: the target is too long, and its query has been cut off */
    bool ended;
};

/* Called when a request's headers have arrived, and again at its end. */
typedef void (*wire_see)(void *ctx, const struct wire_request *request);

/* Sends the bytes and the end of the stream. Returns the number of bytes received, 0 for none. */
size_t wire_send(const void *bytes, size_t size, wire_see see, void *ctx);

#endif
