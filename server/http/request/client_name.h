/*
 * The name of a request's client, as job documents show it. If tokens are not required, clients
 * choose their own names, and the job queue is fair between names. If they are required, the queue
 * is fair between token ids (orl_jobs_fairness_key).
 */
#ifndef ORL_SERVER_HTTP_REQUEST_CLIENT_NAME_H
#define ORL_SERVER_HTTP_REQUEST_CLIENT_NAME_H

#include "http/request/request.h"

enum { ORL_CLIENT_NAME = 80, ORL_CLIENT_OWN_NAME = 64 };

/*
 * Writes the client's name. With tokens it is "token:" and the token's name. Without tokens it is
 * "name:" and the header X-Oriel-Client, or else "address:" and the address. Returns false after a
 * 400: the header must have 1 to 64 printable ASCII characters.
 */
bool orl_client_name(struct orl_request *request, char ret_name[ORL_CLIENT_NAME]);

#endif
