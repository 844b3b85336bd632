#include "http/connection/address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdio.h>
#include <string.h>

void orl_address_key(const struct sockaddr *address, char ret_key[ORL_ADDRESS_KEY])
{
    char text[INET6_ADDRSTRLEN] = "unknown";
    struct sockaddr_in6 v6;
    struct sockaddr_in v4;
    const char *network = "";
    if (address && address->sa_family == AF_INET6) {
        memcpy(&v6, address, sizeof v6);
        if (IN6_IS_ADDR_V4MAPPED(&v6.sin6_addr)) {
            inet_ntop(AF_INET, &v6.sin6_addr.s6_addr[12], text, sizeof text);
        } else {
            memset(&v6.sin6_addr.s6_addr[8], 0, 8);
            inet_ntop(AF_INET6, &v6.sin6_addr, text, sizeof text);
            network = "/64";
        }
    } else if (address && address->sa_family == AF_INET) {
        memcpy(&v4, address, sizeof v4);
        inet_ntop(AF_INET, &v4.sin_addr, text, sizeof text);
    }
    snprintf(ret_key, ORL_ADDRESS_KEY, "%s%s", text, network);
}
