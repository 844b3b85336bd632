/*
 * Reports errors on stderr as "file:line: primitive: message (hint)", so that editors can jump
 * to the line. A daemon's problem document (RFC 9457) is reported in the same form.
 */
#ifndef ORL_CLIENT_OUTPUT_REPORT_ERROR_H
#define ORL_CLIENT_OUTPUT_REPORT_ERROR_H

#include <stddef.h>

#include <jansson.h>

#include <oriel/base/error.h>

/* Fills err from a reply that is not 2xx, also if its body is not a problem document. Returns
 * the code. */
int orl_report_reply_to_error(const char *body, size_t size, long status, struct orl_error *err);

/* Prints err to stderr. Returns ORL_EXIT_FAILED for convenience. */
int orl_report_error(const struct orl_error *err);

/* Prints "failed" with the reason from the job document's "error", if there is one. */
void orl_report_job_error(const json_t *job);

#endif
