/*
 * Replies. Each makes the response of a request, once; sending it is request.c's. When memory runs
 * out a plain 503 goes out instead.
 */
#ifndef ORL_SERVER_HTTP_REPLY_H
#define ORL_SERVER_HTTP_REPLY_H

#include <jansson.h>

#include "http/request.h"

/* Takes json; NULL (out of memory) becomes a 503. */
void orl_reply_json(struct orl_request *request, unsigned status, json_t *json);
/* The text that such a reply has, owned; takes json. NULL when that is, or memory runs out. */
char *orl_reply_text_of(json_t *json);
/* Such text, made before; it is copied. NULL becomes a 503. */
void orl_reply_json_text(struct orl_request *request, unsigned status, const char *text,
                         size_t size);
/* application/problem+json for an error of the core; those of ours (5xx) are logged. */
void orl_reply_error(struct orl_request *request, const struct orl_error *err);
/* ... and for one of HTTP itself; see orl_problem_new. */
void orl_reply_problem(struct orl_request *request, unsigned status, const char *type,
                       const char *title, const char *detail, ...)
    __attribute__((format(printf, 5, 6)));
/* The answers to a DELETE: 204, or 404 when there was nothing; 409: it is in use. */
void orl_reply_removed(struct orl_request *request, bool removed, const char *what);
void orl_reply_in_use(struct orl_request *request, const char *why);
/* 404: there is no such thing here. */
void orl_reply_not_found(struct orl_request *request, const char *what);
/* 503: the daemon stops. */
void orl_reply_stopping(struct orl_request *request);
/* Constant text. */
void orl_reply_text(struct orl_request *request, const char *type, const char *text);
/* Constant bytes. */
void orl_reply_bytes(struct orl_request *request, const char *type, const char *data, size_t size);
/* Text that it takes; NULL (out of memory) becomes a 503. */
void orl_reply_owned_text(struct orl_request *request, const char *type, char *text);
/* A file, by descriptor, which it takes. */
void orl_reply_file(struct orl_request *request, int fd, uint64_t size, const char *type);
/*
 * The same of a file that never changes, whose strong tag is known: the part of it that a Range
 * asks for (one range of bytes, as long as If-Range does not speak against it; RFC 9110, 14), or
 * all; 416 when there is no such part.
 */
void orl_reply_part(struct orl_request *request, int fd, uint64_t size, const char *type,
                    const char *tag);
/* 204, without a body. */
void orl_reply_no_content(struct orl_request *request);
/* A response that makes its body by itself; NULL (out of memory) becomes a 503. */
void orl_reply_stream(struct orl_request *request, struct MHD_Response *response, const char *type);
/* 304, without a body. */
void orl_reply_not_modified(struct orl_request *request);

/* Adds a header to the response made. */
void orl_reply_header(struct orl_request *request, const char *name, const char *value);
/* Adds the strong ETag "tag"; or, when the client has it already, replies 304 instead: true. */
bool orl_reply_if_none_match(struct orl_request *request, const char *tag);
void orl_reply_etag(struct orl_request *request, const char *tag);

/*
 * The answer made goes out once all that has been committed is safe (settling.h). Where that fails,
 * what goes out in its place says why: of a request that changes something. What only tells goes
 * out all the same.
 */
void orl_reply_when_safe(struct orl_request *request);
/* As orl_reply_when_safe, but waits only if the commit of that number is not safe yet. */
void orl_reply_when_commit_is_safe(struct orl_request *request, uint64_t commit);

/* Makes room in the budget for so many bytes more; or, where that cannot be, replies with a 507 and
 * returns true. */
bool orl_reply_if_full(struct orl_request *request, uint64_t bytes);
/* The refusal of what request->hold has met, which wanted so many bytes: 507, or 429 of its client.
 */
void orl_reply_held(struct orl_request *request, uint64_t bytes);

#endif
