/* Where a connection comes from. */
#ifndef ORL_SERVER_HTTP_ADDRESS_H
#define ORL_SERVER_HTTP_ADDRESS_H

#include <sys/socket.h>

enum { ORL_ADDRESS_KEY = 64 };

/*
 * Who an address belongs to, as text: of IPv6 the network, for a subscriber has a /64 of addresses
 * to choose from; IPv4 addresses as such, in IPv6's clothes too.
 */
void orl_address_key(const struct sockaddr *address, char ret_key[ORL_ADDRESS_KEY]);

#endif
