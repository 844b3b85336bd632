#include "http/request/client_name.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <string.h>

#include "http/context.h"
#include "http/response/reply.h"

static bool is_name(const char *text)
{
    const size_t length = strlen(text);
    for (size_t i = 0; i < length; i++)
        if (text[i] < 0x20 || text[i] > 0x7e)
            return false;
    return length >= 1 && length <= ORL_CLIENT_OWN_NAME;
}

static void name_by_address(const struct orl_request *request, char ret_name[ORL_CLIENT_NAME])
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    char text[INET6_ADDRSTRLEN] = "unknown";
    if (info && info->client_addr && info->client_addr->sa_family == AF_INET6) {
        struct sockaddr_in6 v6;
        memcpy(&v6, info->client_addr, sizeof v6);
        inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
    } else if (info && info->client_addr && info->client_addr->sa_family == AF_INET) {
        struct sockaddr_in v4;
        memcpy(&v4, info->client_addr, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
    }
    snprintf(ret_name, ORL_CLIENT_NAME, "address:%s", text);
}

bool orl_client_name(struct orl_request *request, char ret_name[ORL_CLIENT_NAME])
{
    const char *own = orl_request_header(request, "X-Oriel-Client");
    if (request->context->config->needs_token) {
        snprintf(ret_name, ORL_CLIENT_NAME, "token:%s", request->token);
        return true;
    }
    if (!own) {
        name_by_address(request, ret_name);
        return true;
    }
    if (!is_name(own)) {
        orl_reply_problem(request, 400, "invalid", "A header is not understood",
                          "X-Oriel-Client is a name of 1 to %d printable characters",
                          ORL_CLIENT_OWN_NAME);
        return false;
    }
    snprintf(ret_name, ORL_CLIENT_NAME, "name:%s", own);
    return true;
}
