#include "framing.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

/* The headers that say whose a request is and how long. */
struct framing {
    unsigned hosts, lengths, codings;
    bool chunked; /* by the last of the codings */
};

static enum MHD_Result note(void *ctx, enum MHD_ValueKind kind, const char *name, const char *value)
{
    struct framing *framing = ctx;
    (void)kind;
    if (strcasecmp(name, MHD_HTTP_HEADER_HOST) == 0)
        framing->hosts++;
    else if (strcasecmp(name, MHD_HTTP_HEADER_CONTENT_LENGTH) == 0)
        framing->lengths++;
    else if (strcasecmp(name, MHD_HTTP_HEADER_TRANSFER_ENCODING) == 0) {
        framing->codings++;
        framing->chunked = value && strcasecmp(value, "chunked") == 0;
    }
    return MHD_YES;
}

const char *orl_framing_check(struct MHD_Connection *connection, const char *version)
{
    struct framing framing = {0};
    MHD_get_connection_values(connection, MHD_HEADER_KIND, note, &framing);
    if (framing.lengths > 1)
        return "it has more than one Content-Length";
    if (framing.codings > 0 && framing.lengths > 0)
        return "it has both Content-Length and Transfer-Encoding";
    if (framing.codings > 1 || (framing.codings == 1 && !framing.chunked))
        return "its Transfer-Encoding is not chunked";
    if (framing.hosts > 1)
        return "it has more than one Host";
    /* RFC 9112, 3.2; before 1.1 there were none. */
    if (framing.hosts == 0 && strcmp(version, MHD_HTTP_VERSION_1_0) != 0)
        return "it has no Host";
    return NULL;
}
