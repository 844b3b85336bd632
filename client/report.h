/*
 * Trouble, in words: any error onto stderr as "file:line: primitive: message (hint)", so that
 * editors can jump to it; a daemon's problem document (RFC 9457) reads like one of our own.
 */
#ifndef ORL_CLIENT_REPORT_H
#define ORL_CLIENT_REPORT_H

#include <stddef.h>

#include <jansson.h>

#include <oriel/error.h>

/* Fills err from a reply that is not 2xx; copes with bodies that are no problems. Returns code. */
int orl_report_reply_to_error(const char *body, size_t size, long status, struct orl_error *err);

/* Prints it to stderr; returns ORL_EXIT_FAILED for the convenience of commands. */
int orl_report_error(const struct orl_error *err);

/* "failed" with the reason in a job document's "error", if there is one. */
void orl_report_job_error(const json_t *job);

#endif
