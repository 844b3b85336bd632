/*
 * The name of a request's client, as job documents show it. Turns in the queue go by it where no
 * tokens are needed: there a client may call itself what it likes. Where they are, turns go by the
 * token's id (orl_jobs_turn_key).
 */
#ifndef ORL_SERVER_HTTP_CLIENT_NAME_H
#define ORL_SERVER_HTTP_CLIENT_NAME_H

#include "http/request.h"

enum { ORL_CLIENT_NAME = 80, ORL_CLIENT_OWN_NAME = 64 };

/*
 * "token:" and its token's name where tokens are needed; elsewhere "name:" and what the client
 * calls itself in X-Oriel-Client, or "address:" and where it comes from. False after a 400: a name
 * is 1 to 64 printable characters of ASCII.
 */
bool orl_client_name(struct orl_request *request, char ret_name[ORL_CLIENT_NAME]);

#endif
