/*
 * HTTP by hand: a request's lines as a browser or an attacker would write them, any header any
 * number of times, on a connection of its own (plain HTTP). Fails the running test when nothing
 * answers.
 */
#ifndef ORL_TESTS_SUPPORT_HTTP_WIRE_H
#define ORL_TESTS_SUPPORT_HTTP_WIRE_H

#include "support/daemon.h"

/*
 * line: "GET /v1/jobs"; headers: lines that end in "\r\n", Host among them; body may be NULL. The
 * reply is owned: reply_done. Its headers are as received, without a body's chunks put together.
 */
void http_wire_ask(const struct daemon *daemon, const char *line, const char *headers,
                   const char *body, struct reply *ret_reply);

#endif
