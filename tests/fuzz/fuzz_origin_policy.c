/*
 * Requests to a daemon without tokens. The first three lines of the input are Host, Origin and
 * Sec-Fetch-Site; any bytes after them mark the request as forwarded by a proxy. An admitted
 * request names this machine as its host, and comes from the daemon's own page or an allowed
 * origin.
 */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "fuzz/fuzz.h"
#include "http/access/origin_policy.h"

enum { HEADERS = 3 };

/* Compares with each accepted spelling of this machine's name. */
static bool names_this_machine(const char *host)
{
    const char *port = NULL;
    if (strncasecmp(host, "localhost", 9) == 0)
        port = host + 9;
    else if (strncmp(host, "127.", 4) == 0)
        port = host + strspn(host, "0123456789.");
    else if (host[0] == '[' && strchr(host, ']') && strchr(host, '1'))
        port = strchr(host, ']') + 1;
    return port &&
           (*port == '\0' || (*port == ':' && port[1 + strspn(port + 1, "0123456789")] == '\0'));
}

bool fuzz_origin_policy(const uint8_t *data, size_t size)
{
    char *lines[HEADERS] = {NULL, NULL, NULL};
    for (int i = 0; i < HEADERS && size > 0; i++) {
        const uint8_t *end = memchr(data, '\n', size);
        const size_t length = end ? (size_t)(end - data) : size, used = length + (end != NULL);
        lines[i] = length > 0 ? strndup((const char *)data, length) : NULL;
        data += used;
        size -= used;
    }
    static const char *const origins[] = {"https://tool.example"};
    bool allowed = false;
    const struct orl_origin_policy_input asked = {.host = lines[0],
                                                  .origin = lines[1],
                                                  .fetch_site = lines[2],
                                                  .forwarded = size > 0,
                                                  .http = true,
                                                  .allowed = origins,
                                                  .n_allowed = 1};
    const char *refusal = orl_origin_policy_check(&asked, &allowed);
    FUZZ_PROMISE(!refusal || *refusal);
    if (!refusal) {
        FUZZ_PROMISE(!asked.forwarded);
        FUZZ_PROMISE(!lines[0] || names_this_machine(lines[0]));
        FUZZ_PROMISE(!allowed || strcmp(lines[1], origins[0]) == 0);
        FUZZ_PROMISE(allowed || !lines[1] ||
                     (lines[0] && strlen(lines[1]) == strlen(lines[0]) + 7));
        FUZZ_PROMISE(allowed || !lines[2] || strcasecmp(lines[2], "cross-site") != 0);
    }
    for (int i = 0; i < HEADERS; i++)
        free(lines[i]);
    return !refusal;
}
