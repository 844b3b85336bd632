/*
 * Pages of other origins (--allow-origin), by the Fetch standard's CORS protocol: what their
 * browser asks before it sends anything that a form could not, and what it wants to read on every
 * answer.
 *
 * Access-Control-Allow-Origin names the one origin, never "*", and Access-Control-Allow-Credentials
 * is never sent: such a page sends a token by itself, no cookie. Vary says that answers differ by
 * Origin. Threads: the loop thread only.
 */
#ifndef ORL_SERVER_HTTP_CORS_H
#define ORL_SERVER_HTTP_CORS_H

#include "http/request.h"

/* An OPTIONS that asks whether a method of allow ("GET, HEAD") may come: true, with a 204 made. Not
 * from an origin that was let in, or no such question: false. */
bool orl_cors_preflight(struct orl_request *request, const char *allow);

/* To the response made. */
void orl_cors_add(struct orl_request *request);

#endif
