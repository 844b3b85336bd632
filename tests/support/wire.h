/*
 * libmicrohttpd as the daemon has it, without a network: bytes go in as if a client had sent them,
 * and a function sees each request that comes of them. One thread, no waiting.
 */
#ifndef ORL_TESTS_SUPPORT_WIRE_H
#define ORL_TESTS_SUPPORT_WIRE_H

#include <microhttpd.h>
#include <stdbool.h>
#include <stddef.h>

struct wire_request {
    struct MHD_Connection *connection;
    const char *method, *url, *version; /* as MHD gives them: the target's escapes are undone */
    bool too_long;                      /* the target; its query has been cut off */
    bool ended;
};

/* Called when a request's headers are there, and once more at its end. */
typedef void (*wire_see)(void *ctx, const struct wire_request *request);

/* Sends the bytes and the end of the stream. Returns how many bytes came back, 0 for none. */
size_t wire_send(const void *bytes, size_t size, wire_see see, void *ctx);

#endif
