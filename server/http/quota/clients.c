#include "http/quota/quota.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/access/access.h"
#include "http/connection/connections.h"
#include "http/context.h"
#include "http/response/reply.h"
#include "process/limits.h"

static void name_client(const struct orl_request *request, char *ret_name, size_t size)
{
    char key[ORL_ADDRESS_KEY];
    if (request->context->config->needs_token) {
        snprintf(ret_name, size, "token:%s", request->token_row.id);
        return;
    }
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    orl_address_key(info ? info->client_addr : NULL, key);
    snprintf(ret_name, size, "address:%s", key);
}

/* Returns the limit of one client: `part` if tokens are required, otherwise `all`. */
static uint64_t client_limit(const struct orl_http_context *context, uint64_t all, uint64_t part)
{
    return context->config->needs_token ? part : all;
}

struct orl_client *orl_client_ref(struct orl_request *request)
{
    struct orl_http_context *context = request->context;
    char name[sizeof context->clients.first->name];
    name_client(request, name, sizeof name);
    struct orl_client *client = context->clients.first;
    while (client && strcmp(client->name, name) != 0)
        client = client->next;
    if (!client) {
        client = calloc(1, sizeof *client);
        if (!client)
            return NULL;
        memcpy(client->name, name, sizeof name);
        client->next = context->clients.first;
        context->clients.first = client;
    }
    client->refs++;
    const uint64_t budget = context->calls->budget(context->server);
    atomic_store(&client->bytes.most, client_limit(context, budget, budget / 2));
    return client;
}

void orl_client_unref(struct orl_clients *clients, struct orl_client *client)
{
    if (!client || --client->refs > 0)
        return;
    struct orl_client **at = &clients->first;
    while (*at != client)
        at = &(*at)->next;
    *at = client->next;
    free(client);
}

bool orl_client_may_stream(struct orl_request *request)
{
    const uint64_t most =
        client_limit(request->context, ORL_SERVER_STREAMS, ORL_SERVER_CLIENT_STREAMS);
    if (!request->client || request->client->streams < most)
        return true;
    orl_reply_problem(request, 429, "too-many-streams", "Too many event streams are open",
                      "this client has %u open, the maximum; close some, or poll the job",
                      (unsigned)most);
    orl_reply_header(request, "Retry-After", "10");
    return false;
}

bool orl_client_may_queue(struct orl_request *request)
{
    const uint64_t most = client_limit(request->context, UINT64_MAX, ORL_SERVER_CLIENT_JOBS);
    if (!request->client || most == UINT64_MAX ||
        request->context->calls->jobs_of(request->server, orl_access_owner(request)) < most)
        return true;
    orl_reply_problem(
        request, 429, "queue-full", "Too many jobs are waiting",
        "this client has %u queued or running, the maximum; try again when some have ended",
        (unsigned)most);
    orl_reply_header(request, "Retry-After", "30");
    return false;
}
