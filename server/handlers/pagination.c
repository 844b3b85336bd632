#include "handlers/handlers.h"

#include <stdlib.h>
#include <string.h>

#include "http/request/parse_request.h"
#include "http/response/reply.h"
#include "process/limits.h"

bool orl_page_refuse(struct orl_request *request, const char *wanted)
{
    orl_reply_problem(request, 400, "invalid", "The query is not understood", "%s", wanted);
    return false;
}

bool orl_page_limit(struct orl_request *request, unsigned long *ret_limit)
{
    const char *limit = orl_request_query(request, "limit");
    char wanted[64];
    snprintf(wanted, sizeof wanted, "limit must be a number from 1 to %u", ORL_SERVER_LIST);
    if (limit && !orl_query_count(limit, ORL_SERVER_LIST, ret_limit))
        return orl_page_refuse(request, wanted);
    if (*ret_limit > ORL_SERVER_LIST_AT_ONCE)
        *ret_limit = ORL_SERVER_LIST_AT_ONCE;
    return true;
}

struct link {
    FILE *text;
    const char *const *names;
};

static enum MHD_Result add_argument(void *ctx, enum MHD_ValueKind kind, const char *key,
                                    const char *value)
{
    static const char plain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.~";
    const struct link *link = ctx;
    const char *const *name = link->names;
    (void)kind;
    while (*name && strcmp(*name, key) != 0)
        name++;
    if (!*name || !value)
        return MHD_YES;
    fprintf(link->text, "%s=", key);
    for (; *value; value++)
        if (strchr(plain, *value))
            putc(*value, link->text);
        else
            fprintf(link->text, "%%%02X", (unsigned char)*value);
    putc('&', link->text);
    return MHD_YES;
}

void orl_page_link(struct orl_request *request, const char *path, const char *const *names,
                   const char *cursor)
{
    char *text = NULL;
    size_t size = 0;
    struct link link = {open_memstream(&text, &size), names};
    if (!link.text)
        return; /* "more" in the body still shows that there is another page */
    fprintf(link.text, "<%s?", path);
    MHD_get_connection_values(request->connection, MHD_GET_ARGUMENT_KIND, add_argument, &link);
    fprintf(link.text, "cursor=%s>; rel=\"next\"", cursor);
    if (fclose(link.text) == 0)
        orl_reply_header(request, "Link", text);
    free(text);
}
