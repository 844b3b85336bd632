/*
 * Raw HTTP: request lines as a browser or an attacker would send them, headers repeated any number
 * of times, on a separate connection (plain HTTP). Fails the running test if there is no answer.
 */
#ifndef ORL_TESTS_SUPPORT_HTTP_WIRE_H
#define ORL_TESTS_SUPPORT_HTTP_WIRE_H

#include "support/daemon.h"

/*
 * Sends a request. line: "GET /v1/jobs"; headers: lines that end in "\r
 * ", including Host; body may be NULL. The reply is owned: reply_done. Its headers are as received;
 * chunks of its body are not joined.
 */
void http_wire_ask(const struct daemon *daemon, const char *line, const char *headers,
                   const char *body, struct reply *ret_reply);

#endif
