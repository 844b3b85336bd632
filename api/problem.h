/*
 * Errors as RFC 9457 problem documents (application/problem+json).
 *
 *     {"type": "urn:oriel:error:syntax", "title": "The text does not parse", "status": 400,
 *      "detail": "...", "file": "room.rad", "line": 12, "primitive": "polygon floor", "hint":
 * "..."}
 *
 * The last four appear only when known. One table, in problem.c, maps orl_err to an HTTP status.
 * Returned objects are new references, the caller's; NULL when out of memory.
 */
#ifndef ORL_API_PROBLEM_H
#define ORL_API_PROBLEM_H

#include <jansson.h>

#include <oriel/error.h>

/* ret_status, which may be NULL, is the HTTP status that goes with it. */
json_t *orl_problem_from_error(const struct orl_error *err, int *ret_status);

/*
 * A problem of HTTP itself, outside orl_err: type is the last part of the urn ("not-found"),
 * detail printf-style.
 */
json_t *orl_problem_new(int status, const char *type, const char *title, const char *detail, ...)
    __attribute__((format(printf, 4, 5)));

/* The HTTP status for an orl_err. */
int orl_problem_status(int code);

/* A problem document read back, for clients; missing members are left empty. */
void orl_problem_to_error(const json_t *problem, struct orl_error *ret_err);

#endif
