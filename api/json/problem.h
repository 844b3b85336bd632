/*
 * Errors as RFC 9457 problem documents (application/problem+json).
 *
 *     {"type": "urn:oriel:error:syntax", "title": "The text does not parse", "status": 400,
 *      "detail": "...", "file": "room.rad", "line": 12, "primitive": "polygon floor",
 *      "hint": "..."}
 *
 * The last four appear only if known. One table, in problem.c, maps orl_err to an HTTP status.
 * Functions return new references, owned by the caller, or NULL when out of memory.
 */
#ifndef ORL_API_JSON_PROBLEM_H
#define ORL_API_JSON_PROBLEM_H

#include <jansson.h>

#include <oriel/base/error.h>

/* Returns the problem document for err. ret_status, which may be NULL, gets its HTTP status. */
json_t *orl_problem_from_error(const struct orl_error *err, int *ret_status);

/*
 * Returns a problem of HTTP itself, outside orl_err. type is the last part of the URN
 * ("not-found"); detail is printf-style.
 */
json_t *orl_problem_new(int status, const char *type, const char *title, const char *detail, ...)
    __attribute__((format(printf, 4, 5)));

/* Returns the HTTP status for an orl_err. */
int orl_problem_status(int code);

/* Reads a problem document back, for clients; missing members leave fields empty. */
void orl_problem_to_error(const json_t *problem, struct orl_error *ret_err);

#endif
