/* Keys of the addresses that connections come from. */
#ifndef ORL_SERVER_HTTP_CONNECTION_ADDRESS_H
#define ORL_SERVER_HTTP_CONNECTION_ADDRESS_H

#include <sys/socket.h>

enum { ORL_ADDRESS_KEY = 64 };

/*
 * Writes the key of an address's owner as text. For IPv6 it is the /64 network, since a subscriber
 * can choose any address of it. For IPv4, also when mapped into IPv6, it is the address.
 */
void orl_address_key(const struct sockaddr *address, char ret_key[ORL_ADDRESS_KEY]);

#endif
