/* HTTP framing of the bytes on a connection: each accepted request has one owner and one end. */
#include <string.h>

#include "fuzz/fuzz.h"
#include "http/request/parse_request.h"
#include "support/wire.h"

struct seen {
    size_t requests, sound;
    bool taken; /* true while a request is in progress */
};

struct count {
    size_t hosts, lengths, codings;
};

static enum MHD_Result count_header(void *ctx, enum MHD_ValueKind kind, const char *name,
                                    const char *value)
{
    struct count *count = ctx;
    (void)kind;
    count->hosts += strcasecmp(name, "Host") == 0;
    count->lengths += strcasecmp(name, "Content-Length") == 0;
    count->codings += strcasecmp(name, "Transfer-Encoding") == 0;
    for (const char *c = name; *c; c++)
        FUZZ_PROMISE((unsigned char)*c > ' ' && *c != 127 && *c != ':');
    for (const char *c = value ? value : ""; *c; c++)
        FUZZ_PROMISE((unsigned char)*c >= ' ' || *c == '\t');
    return MHD_YES;
}

static void see(void *ctx, const struct wire_request *request)
{
    struct seen *seen = ctx;
    struct count count = {0, 0, 0};
    if (request->ended) {
        seen->sound += seen->taken;
        return;
    }
    seen->requests++;
    const char *fault = orl_framing_check(request->connection, request->method, request->version);
    FUZZ_PROMISE(!fault || *fault);
    seen->taken = !fault;
    if (fault)
        return;
    MHD_get_connection_values(request->connection, MHD_HEADER_KIND, count_header, &count);
    FUZZ_PROMISE(count.hosts <= 1 && count.lengths + count.codings <= 1);
}

bool fuzz_framing(const uint8_t *data, size_t size)
{
    struct seen seen = {0, 0, false};
    wire_send(data, size, see, &seen);
    FUZZ_PROMISE(seen.sound <= seen.requests);
    return seen.sound > 0;
}
