/*
 * Pages of other origins (--allow-origin), by the CORS protocol of the Fetch standard: preflight
 * requests, and headers on every answer.
 *
 * Access-Control-Allow-Origin names the one origin, never "*". Access-Control-Allow-Credentials is
 * never sent: such a page sends a token itself, and no cookie. The answers vary by Origin (Vary).
 * Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_CORS_H
#define ORL_SERVER_HTTP_ACCESS_CORS_H

#include "http/request/request.h"

/* Answers a preflight OPTIONS. allow: the route's methods ("GET, HEAD"). Returns true, with a 204
 * made; false if it is not a preflight or its origin is not allowed. */
bool orl_cors_preflight(struct orl_request *request, const char *allow);

/* Adds the headers to the response made. */
void orl_cors_add(struct orl_request *request);

#endif
